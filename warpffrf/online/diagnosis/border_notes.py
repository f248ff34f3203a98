"""Patches that reach the end of a contact surface, and the pressure there.

A contact grid ends where its facets do. Pressure on its outermost row or column is cut there. This is correct where the
body ends too, and then a peak at the end is as sharp as the grid resolves it; it is wrong where the body continues and
only the named facets end. Neither is an error, so that the run continues, and a note states which end, when, and how
much.

Saved states are evaluated: on the rows of the first grid the pressures themselves, on those of the second, and on its
columns where it is an arc or a plane, the loads of its nodes over their areas. The columns of the first grid have a
separate note (`run`). Two straight profiles that are pressed on each other over all of their common width do so by
design, and are not noted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.online.history.history import ContactHistory

BORDER = 0.05  # of the largest pressure at the time: allowed on the last row without a note


@dataclass(frozen=True)
class End:
    """Largest pressure (T,) [Pa] on the first (`high` False) or last row or column of a pair's first or second grid."""

    second: bool
    along: str  # "row" or "column"
    high: bool
    pressure: np.ndarray


def border_notes(contact: Contact, found: ContactHistory, time: np.ndarray) -> list[str]:
    """A note for each surface of a pair whose outermost rows, or columns, had more than `BORDER` of the largest
    pressure of the time; `found` is its history, `time` (T,) [s] that of the saved steps."""
    peak = np.maximum(found.pressure.max(axis=(1, 2)), np.finfo(float).tiny)
    ends = _ends(contact, found)
    notes = []
    for second, along in ((False, "row"), (True, "row"), (True, "column")):
        part = [end.pressure / peak for end in ends if end.second == second and end.along == along]
        if not part:
            continue
        most = np.where(_by_design(contact, ends, along, peak), 0.0, np.max(part, axis=0))
        at = int(np.argmax(most))
        if most[at] > BORDER:
            surface = contact.b if second else contact.a
            notes.append(
                f"contact {contact.name!r}: the patch reaches the end of {surface.label}, whose last {along} had "
                f"{most[at]:.0%} of the largest pressure at {time[at]:.4g} s; the pressure is cut there: where the "
                "body continues, define a larger contact surface; where it ends too, the grid resolves its peak"
            )
    return notes


def _ends(contact: Contact, found: ContactHistory) -> list[End]:
    ends = [End(False, "row", high, found.pressure[:, :, -int(high)].max(axis=1)) for high in (False, True)]
    surface = contact.b.surface
    if surface.grid is None:  # rigid: it has no end
        return ends
    pressure = found.load_second / (surface.grid.pitch * surface.gram_z.sum(axis=0))
    ends += [End(True, "row", high, pressure[:, :, -int(high)].max(axis=1)) for high in (False, True)]
    if not surface.grid.periodic:
        number = found.first_column_second[:, None] + np.arange(pressure.shape[1])
        for high, last in ((False, 0), (True, surface.grid.columns - 1)):
            ends.append(End(True, "column", high, np.where(number == last, pressure.max(axis=2), 0.0).max(axis=1)))
    return ends


def _by_design(contact: Contact, ends: list[End], along: str, peak: np.ndarray) -> np.ndarray:
    """(T,) bool: straight profiles, or planes, that are pressed on each other from one end of their common width to the
    other.
    """
    shapes = [port.surface.shape for port in contact.ports]
    profiles = [shape.profile() for shape in shapes]
    straight = all(p.planar or (p.crown == 0.0 and not len(p.coefficients)) for p in profiles)
    if not straight or (along == "column" and not all(p.planar for p in profiles)):
        return np.zeros(len(peak), dtype=bool)
    axes = [rot.matrix(port.body.rotation) @ port.surface.shape.e_a for port in contact.ports]
    opposed = float(axes[0] @ axes[1]) < 0.0
    loaded: dict[tuple[bool, bool], np.ndarray] = {}
    for end in ends:
        if end.along == along:
            loaded[end.second, end.high != (end.second and opposed)] = end.pressure > BORDER * peak
    reached = [
        loaded[low] & loaded[high]
        for low in ((False, False), (True, False))
        for high in ((False, True), (True, True))
        if low in loaded and high in loaded
    ]
    return np.any(reached, axis=0)
