"""Bodies that fell through the whole of a run because nothing holds them: a joint that was forgotten.

A body hangs on the ground by chains of joints, springs, films and laps, and of contacts that have touched in the run.
One that hangs on nothing moves with gravity, which is meant in free flight and else a mistake, so it is noted where
gravity acts.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.checks.scene import reached_from
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import History

FELL = 0.5  # of g t^2/2, by which a body has to have gone down that fell


def fall_notes(scene: Scene, history: History) -> list[str]:
    """A note naming the bodies that fell from the first to the last saved step with nothing to hold them."""
    size = float(np.linalg.norm(scene.gravity))
    seconds = float(history.time[-1] - history.time[0]) if len(history.time) else 0.0
    if size == 0.0 or seconds <= 0.0:
        return []
    touched = [c for c in scene.contacts if np.any(history.contacts[c.name].force != 0.0)]
    touched += [c for c in scene.lumped_contacts if np.any(history.lumped_contacts[c.name].force != 0.0)]
    held = reached_from(GROUND_INDEX, [*scene.joints, *scene.forces, *touched, *scene.films, *scene.laps])
    down = scene.gravity / size
    fell = []
    for body in scene.bodies:
        if body.index in held:
            continue
        motion = history.bodies[body.name]
        drop = float((motion.position[-1] - motion.position[0] - motion.velocity[0] * seconds) @ down)
        if drop > FELL * 0.5 * size * seconds**2:
            fell.append(f"body {body.name!r} by {drop:.3g} m")
    if not fell:
        return []
    return [
        f"fell freely through the whole run: {', '.join(fell)}; no joint, spring or contact that touched leads to the "
        "ground; where that is not meant, add the joint that is missing, or close the gap"
    ]
