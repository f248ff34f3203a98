"""Notes on rolling bearings of which one side of each contact is flexible and the other rigid.

A rigid body has no local compliance. Of two bodies of one material half of Hertz's compliance is then missing: E* is
twice as large, and at a given load the peak pressure, ~ E*^(1/2) of lines and ~ E*^(2/3) of points, too.
"""

from __future__ import annotations

from warpffrf.model.bearings import Bearing
from warpffrf.model.scene import Scene

TIMES = {"roller": 2.0 ** (1.0 / 2.0), "ball": 2.0 ** (2.0 / 3.0)}  # by how much peak pressures are too high


def bearing_notes(scene: Scene) -> list[str]:
    """A note for each bearing with contacts between a flexible and a rigid part."""
    return [note for bearing in scene.bearings if (note := _one_sided(bearing))]


def _one_sided(bearing: Bearing) -> str:
    flexible = [ring.name for ring in (bearing.inner, bearing.outer) if getattr(ring, "reduced", None) is not None]
    elements = any(element.reduced is not None for element in bearing.elements)
    if elements and len(flexible) == 2 or not elements and not flexible:
        return ""
    kind = f"{bearing.kind}s"
    if elements:
        sides = f"{'other ring is' if flexible else 'rings are'} rigid, its {kind} flexible"
        cure = "make both rings flexible"
    else:
        sides = f"{kind} are rigid, {' and '.join(map(repr, flexible))} flexible"
        cure = f"make the {kind} flexible, Materials(element_body=...)"
    return (
        f"bearing {bearing.name!r}: its {sides}: contacts between them have the compliance of one body only. Of equal "
        f"materials peak pressures are {TIMES[bearing.kind]:.2g} times too high at a given load, and fewer {kind} "
        f"share the load; {cure}"
    )
