"""What is said of pairs whose pressures stand on cells that travel with the patch: where they are not fine enough, and
where the half-space under them is not what the bodies are."""

from __future__ import annotations

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.model.far_field import WHOLE
from warpffrf.online.history.history import ContactHistory

FEWEST = 6  # strips, or rows of a point contact, under pressure: with 8 forces err by 0.1 %, peaks by 0.9 %
ROLLED = 0.1  # of W: less is a contact that does not roll
WIDE = 0.9  # of WHOLE that a patch may span without a word


def cell_notes(contact: Contact, found: ContactHistory) -> list[str]:
    """Notes on the cells of a pair in a run."""
    cells = found.cells
    if cells is None:
        return []
    notes = []
    last = int(np.argmax(found.pressure.sum(axis=(1, 2))))
    strips = int(np.count_nonzero(found.pressure[last].max(axis=1) > 0.0))
    if strips < FEWEST:
        notes.append(
            f"contact {contact.name!r}: the patch is {strips} cells wide where it is most loaded, under {FEWEST}: "
            "forces may be off by 1 %, peak pressures by 3 %; use cells= with more strips across"
        )
    travelled = np.abs(cells.column - cells.column[0]).max() * contact.a.surface.grid.pitch
    if contact.law.chi > 0.0 and travelled * _metric(contact) > ROLLED * float(np.max(cells.half_width)):
        notes.append(
            f"contact {contact.name!r}: the patch rolled over the first body, and its layer is damped by how fast its "
            "depth changes in each cell of the patch, not at each place of the material; damping in a rolling contact "
            "wants grid='material'"
        )
    middle = float(np.mean(np.asarray(contact.a.surface.grid.z)[[0, -1]]))
    curvature = max(abs(float(np.max(np.abs(port.surface.shape.curvatures(0.0, middle))))) for port in contact.ports)
    widest = 2.0 * float(np.max(cells.half_width)) * curvature
    if widest > WIDE * WHOLE:
        notes.append(
            f"contact {contact.name!r}: the patch spans {widest:.2g} rad of a surface, and the half-space under it is "
            f'flat; beyond {WHOLE:g} rad pressures err by more than 2 %: use grid="material", with a finer mesh'
        )
    return notes


def _metric(contact: Contact) -> float:
    """Metres of arc per unit of theta on the first surface."""
    surface = contact.a.surface
    return float(surface.shape.radius_at(float(np.mean(np.asarray(surface.grid.z)[[0, -1]]))))
