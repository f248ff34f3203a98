"""Notes on coefficients of friction that fell too steeply for a step (`warpffrf_kernels.friction.slip_speed`)."""

from __future__ import annotations

import numpy as np

from warpffrf.model.scene import Scene
from warpffrf_kernels.friction.slip_speed import COUNT, MILDER, WORST


def steep_notes(scene: Scene, steep: np.ndarray) -> list[str]:
    """A note for every pair with steps whose slip was not the only one; steep (pairs, 3): see `slip_speed.mark`."""
    notes = []
    for contact, found in zip(scene.contacts, steep, strict=False):
        if not found[int(COUNT)]:
            continue
        cure = "take a shorter step"
        if found[int(WORST)] == int(MILDER):
            cure = (
                "the elastic surface, which has no inertia of its own, is too soft for it at any step: let the "
                "coefficient fall over higher speeds"
            )
        notes.append(
            f"contact {contact.name!r}: in {found[int(COUNT)]} steps the coefficient of friction fell faster with the "
            "slip speed than what holds the surfaces resists, so that more than one slip was possible; the one next to "
            f"the state before was taken; {cure}"
        )
    return notes
