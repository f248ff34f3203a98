"""Notes on rolling bearings of which one side of each contact is flexible and the other rigid, and on those of
flexible and rigid elements.

A rigid body has no local compliance. Of two bodies of one material half of Hertz's compliance is then missing: E* is
twice as large, and at a given load the peak pressure, ~ E*^(1/2) of lines and ~ E*^(2/3) of points, too.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bearings import Bearing
from warpffrf.model.bearings.geometry import SIDES
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import History

TIMES = {"roller": 2.0 ** (1.0 / 2.0), "ball": 2.0 ** (2.0 / 3.0)}  # by how much peak pressures are too high


MORE = 1.05  # of the largest load of flexible elements: rigid ones with more are named


def bearing_notes(scene: Scene, history: History) -> list[str]:
    """Notes on each bearing with contacts between a flexible and a rigid part."""
    notes = [note for bearing in scene.bearings if (note := _one_sided(bearing))]
    return notes + [note for bearing in scene.bearings if bearing.distributed for note in _mixed(bearing, history)]


def _mixed(bearing: Bearing, history: History) -> list[str]:
    """Of a bearing with flexible and rigid elements: which are rigid and why, and those with large loads."""
    kind, chosen = f"{bearing.kind}s", bearing.distributed or ()
    why = "as named in distributed="
    if bearing.load is not None:
        at = ", ".join(f"{x:.6g}" for x in bearing.load)
        why = f"with half of the largest load or more under ({at}) N between rigid rings"
    note = (
        f"bearing {bearing.name!r}: distributed contact of {kind} {', '.join(map(str, chosen))}, {why}; the other "
        f"{len(bearing.elements) - len(chosen)} are rigid, with lumped contact of the same stiffness"
    )
    flexible = [ring.name for ring in (bearing.inner, bearing.outer) if ring.reduced is not None]
    if flexible:
        note += (
            f" on the rigid ring only: their pressures on {flexible[0]!r} are those of rigid {kind}, and "
            "result.bearing(...).peak_pressure has Hertz's at their load"
        )
    largest: dict[int, float] = {}
    for side in SIDES:
        for (i, _), contact in zip(bearing.geometry.contacts, bearing.contacts_of(side), strict=True):
            lumped = isinstance(contact, LumpedContact)
            force = (
                history.lumped_contacts[contact.name].normal_force
                if lumped
                else (np.linalg.norm(history.contacts[contact.name].force, axis=1))
            )
            largest[i + 1] = max(largest.get(i + 1, 0.0), float(force.max(initial=0.0)))
    most = max(load for i, load in largest.items() if i in chosen)
    heavy = {i: load for i, load in largest.items() if load > MORE * most}
    if not heavy:
        return [note]
    return [
        note,
        f"bearing {bearing.name!r}: rigid {kind} {', '.join(map(str, heavy))} carry up to "
        f"{max(heavy.values()):.5g} N, those with distributed contact {most:.5g} N; name them in distributed=",
    ]


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
