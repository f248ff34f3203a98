"""How a run of a hard case is judged.

    pass       completed, and right to the first limit of the case
    degraded   completed, and right to the second
    said       wrong, and the run says so: it ended early with a message, or a note names a step that is too long
    refused    not begun: `InputError` names what is wrong and the cure
    silent     wrong, and nothing in the result says so

The error is the largest of the case's own, of the energy that nothing supplied, and of what joints miss: the distance
of the two places that a revolute or spherical joint holds together, over the size of the scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.joints import Revolute, Spherical
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.study.stability.case import Case

PASS, DEGRADED, SAID, REFUSED, SILENT = "pass", "degraded", "said", "refused", "silent"
CLASSES = (PASS, DEGRADED, SAID, REFUSED, SILENT)
WARNINGS = ("use a smaller step", "reduce step", "steps were halved")  # of notes that tell of a step too long


@dataclass(frozen=True)
class Judged:
    """One run of a case: its class, its error (NaN where there is none), and what the run said."""

    case: str
    step: float
    verdict: str
    error: float
    said: str


def judge(case: Case, step: float) -> Judged:
    """Run `case` with `step` [s] and judge it."""
    scene = case.build()
    duration = round(case.duration / step) * step
    try:
        result = simulate(scene, duration, step=step, progress=False, **case.options)
    except InputError as error:
        return Judged(case.name, step, REFUSED, np.nan, str(error))
    return verdict_of(case, step, scene, result)


def verdict_of(case: Case, step: float, scene: Scene, result: Result) -> Judged:
    """The class of a run that has been made."""
    if result.status != "completed":
        return Judged(case.name, step, SAID, np.nan, f"{result.status}: {result.message}")
    found = max(case.error(scene, result), gained(result), missed(scene, result))
    error = float(found) if np.isfinite(found) else np.inf
    told = [note for note in result.history.notes if any(text in note for text in WARNINGS)]
    said = told[0] if told else ""
    if error <= case.good:
        return Judged(case.name, step, PASS, error, said)
    if error <= case.usable:
        return Judged(case.name, step, DEGRADED, error, said)
    return Judged(case.name, step, SAID if told else SILENT, error, said)


def gained(result: Result) -> float:
    """Energy that nothing supplied, over the largest at hand; 0 where it was not booked."""
    residual = np.nan_to_num(result.energy_residual)
    return float(np.max(residual - np.minimum.accumulate(residual), initial=0.0))


def missed(scene: Scene, result: Result) -> float:
    """The largest distance of the two places of a joint, over the size of the scene."""
    worst, size = 0.0, 0.0
    for joint in scene.joints:
        if not isinstance(joint, Revolute | Spherical) or any(_flexible(port.body) for port in joint.ports):
            continue
        ends, markers = [], joint.frames()
        for marker, port in zip(markers, joint.ports, strict=True):
            if port.body.index < 0:
                ends.append(np.broadcast_to(marker.point, (len(result.time), 3)))
                continue
            motion = result.body(port.body.name)
            A = np.stack([rot.matrix(p) for p in motion.rotation])
            ends.append(motion.position + A @ marker.point)
        worst = max(worst, float(np.linalg.norm(ends[0] - ends[1], axis=1).max(initial=0.0)))
        size = max(size, float(np.abs(ends[0]).max(initial=0.0)), *(float(np.abs(m.point).max()) for m in markers))
    return worst / size if size > 0.0 else 0.0


def _flexible(body: Any) -> bool:
    return body.index >= 0 and body.reduced is not None
