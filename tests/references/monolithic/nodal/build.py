"""Pairs with the law at nodes from the contacts of a scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from references.monolithic.core.local_coordinates import LocalCoordinates
from references.monolithic.core.state import Layout
from references.monolithic.line_of_centres.pair import STIFFER, default_layer
from references.monolithic.nodal.friction import MINDLIN
from references.monolithic.nodal.pair import REMEMBERED, NodePairData
from references.monolithic.nodal.surface import node_side, partner_side


def node_pairs(
    scene: Any, layout: Layout, surfaces: list[tuple[int, int | None]], local: list[LocalCoordinates],
    stick: float | None,
) -> list[NodePairData]:  # fmt: skip
    """All contacts of `scene`; `surfaces`: numbers of both sides in `local` and in the layout, None for a rigid one;
    stick [Pa/m]: stick stiffness of friction, None for the default of `friction`."""
    found, first = [], 0
    for contact, (i, j) in zip(scene.finite_sliding, surfaces, strict=True):
        rough = contact.friction.acts
        a = node_side(contact.a, local[i], rough, f"contact {contact.name!r}")
        b = partner_side(contact.b, None if j is None else local[j], rough)
        rigid = [6 * side.body + np.arange(6) for side in (a, b) if side.body >= 0]
        flexible = []
        for side, surface in ((a, i), (b, j)):
            if surface is not None:
                flexible += [6 * layout.bodies + layout.body_modes(side.body), layout.of_surface(surface)]
        k = stick_stiffness(contact) if stick is None else stick
        search = MINDLIN * default_layer(contact.a.surface) / STIFFER
        columns = np.concatenate([*rigid, *flexible])
        found.append(
            NodePairData(contact.name, a, b, contact.law, contact.friction, k, search, columns, 6 * len(rigid), first)
        )
        first += found[-1].count
    return found


def stick_stiffness(contact: Any) -> float:
    """Default k_t [Pa/m] of `contact`, see `friction`."""
    law = contact.law
    return MINDLIN * (1.0 / law.compliance if law.compliance else default_layer(contact.a.surface))


def memory(pairs: list[NodePairData]) -> np.ndarray:
    """Empty storage for the memory of all nodes."""
    return np.zeros((sum(pair.count for pair in pairs), REMEMBERED))
