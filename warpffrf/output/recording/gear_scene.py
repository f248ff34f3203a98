"""One gear pair in a recording: the flanks of gear 1 at the pitch point with the pressure of all pairs of teeth,
without gear 2, which would hide them. The view stands still while teeth pass through it; `/world/gears/<pair>` is its
frame.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.recording.contact_scene import relief_name
from warpffrf.output.recording.extent import EYE, FIELD, FRONT

PITCHES, WIDE = 1.2, 0.7  # half of what the view shows, in base pitches, or of the width of the teeth
RAISED, ASIDE = 1.0, 0.7  # towards the eye: above the flank, over the tip of the next tooth, and along the axis


class GearScene:
    """The view of one gear pair."""

    def __init__(self, recorder: Any, name: str) -> None:
        self.recorder, self.name = recorder, name
        self.gear = recorder.result.gear(name)

    def path(self, *parts: str) -> str:
        """Entity below the frame of the view."""
        return self.recorder.path("world", "gears", self.name, *parts)

    def static(self) -> None:
        """Log the frame, at the pitch point."""
        gear = self.gear
        center = np.asarray(gear.description["centers"][0])
        at = center + 0.5 * gear.pair.working_diameters[0] * gear.axes[0]
        z = gear.result.contact(gear.contacts[0]).view.first.grid.z
        at = at + 0.5 * (z[0] + z[-1]) * gear.axes[2]
        size = max(PITCHES * gear.pair.gear_1.base_pitch, WIDE * float(z[-1] - z[0]))
        self.recorder.log_static(self.path(EYE), self.recorder.rr.Transform3D(translation=at, scale=size))

    def frame(self, i: int) -> None:
        """Nothing: the view shows entities of bodies and contacts."""

    def view(self) -> Any:
        """Gear 1 and the pressure on it."""
        import rerun.blueprint as rrb

        recorder, gear = self.recorder, self.gear
        body = recorder.path("world", gear.description["bodies"][0])
        own = [scene for scene in recorder.scenes if scene.contact.name in gear.contacts]
        reliefs = [scene.world(relief_name("pressure")) for scene in own]
        aside = gear.axes[2] if gear.axes[2] @ FRONT > 0.0 else -gear.axes[2]
        eye = gear.line_of_action + RAISED * gear.axes[0] + ASIDE * aside
        return rrb.Spatial3DView(
            origin=self.path(EYE),
            contents=[f"+ {entity}" for entity in (f"{body}/surface", f"{body}/solid", *reliefs)],
            name=f"Flanks of '{gear.description['bodies'][0]}'",
            eye_controls=rrb.EyeControls3D(
                position=FIELD * eye / np.linalg.norm(eye), look_target=(0.0, 0.0, 0.0), eye_up=tuple(gear.axes[0])
            ),
            line_grid=False,
        )
