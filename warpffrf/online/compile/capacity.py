"""Initial capacity for active nodes and cells.

Matrices grow with its square, so that pairs that never load a whole window need not pay for one; `Engine` doubles it
where it is too small.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from warpffrf.model.contact import Contact

LEAST_SLOTS, USUAL_PATCH = 64, 4  # active nodes; windows per patch


def slots_of(contact: Contact, grid_nodes: int) -> int:
    """Largest number of active nodes of a pair with `grid_nodes` nodes."""
    if contact.capacity is not None:
        return min(grid_nodes, contact.capacity)
    return min(grid_nodes, max(LEAST_SLOTS, grid_nodes // USUAL_PATCH))


@dataclass(frozen=True)
class CellRoom:
    """Capacity for cells with friction of a pair: it grows with that for active nodes.

    slots, limit: active nodes of the scene, initial and largest capacity; first: initial cells of a pair, the largest
    of all pairs; most: the largest number that it can ever need.
    """

    slots: int = 1
    limit: int = 1
    first: int = 0
    most: int = 0

    def cells(self, slots: int) -> int:
        """Capacity for cells where there are `slots` active nodes."""
        if slots >= self.limit:
            return self.most
        return min(self.most, ceil(self.first * slots / self.slots))
