"""Room for hats and cells in play, to begin with.

Matrices grow with its square, so pairs that never load a whole window need not pay for one; `Engine` doubles it where
it is short.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from warpffrf.model.contact import Contact

LEAST_SLOTS, USUAL_PATCH = 64, 4  # hats; windows a patch


def slots_of(contact: Contact, hats: int) -> int:
    """Active nodes of a pair of which `hats` can be active, at most."""
    if contact.capacity is not None:
        return min(hats, contact.capacity)
    return min(hats, max(LEAST_SLOTS, hats // USUAL_PATCH))


@dataclass(frozen=True)
class CellRoom:
    """Cells with friction of a pair that there is room for: it grows as that of the hats in play does.

    slots, limit: hats in play of the scene, to begin with and at all; first: cells of a pair to begin with, the most of
    all pairs; most: that it can ever need.
    """

    slots: int = 1
    limit: int = 1
    first: int = 0
    most: int = 0

    def cells(self, slots: int) -> int:
        """Room where there are `slots` hats in play."""
        if slots >= self.limit:
            return self.most
        return min(self.most, ceil(self.first * slots / self.slots))
