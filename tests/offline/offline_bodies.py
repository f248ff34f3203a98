"""Reduced bodies that the tests of the reduction share."""

from __future__ import annotations

import numpy as np

from scenes.flat_settings import reduce_flat
from warpffrf.model.material import Material
from warpffrf.model.surfaces import Cylinder

STEEL = Material(210e9, 0.3, 7850.0)


def reduced(mesh, *, general: bool = False, **settings):
    """`reduce` with a rigid bore and a contact rim, without cache and contact-fixed grid; `general` forbids the cyclic
    path."""
    given = {"interfaces": {"bore": "rigid"}, "contact": {"rim": Cylinder()}, "cache": False, "progress": False}
    given["contact_fixed"] = False
    if general:
        given["periodic"] = False
    return reduce_flat(mesh, STEEL, **{**given, **settings})


def skin_order(body) -> np.ndarray:
    """Permutation that sorts skin points by place, to compare bodies that number them differently."""
    return np.lexsort(np.round(body.surface.points, 9).T)
