r"""Contact surfaces whose normals lean as they are pressed: which compliance a scene takes for them.

Pressed together, two surfaces share one form in the patch. What that bends of each follows from how compliant it is: of
the relative curvature 1/R* a body takes the share s = c_A/(c_A + c_B), c = (1 - nu^2)/E (Johnson, Contact Mechanics,
section 4.2), so that its normals lean by s x/R*, and its compliance becomes (`warpffrf.offline.contact.slopes`)

    D + s (R/R*) S.

On a rigid plane, and between two equal rollers, s R/R* = 1: all of a patch is pressed in one direction. A pin in a
bore of its own radius has R/R* = 0. A surface that serves several pairs takes their mean.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np


def leaning(contact: Any, port: Any) -> float:
    """s R/R* of the surface of `port` in `contact`; 0 of surfaces that are touched in points, and of bodies that do
    not say their material."""
    if any(other.surface.shape.profile().crown for other in contact.ports):
        return 0.0
    own, whole = compliance(port), sum(compliance(other) for other in contact.ports)
    if own == 0.0:
        return 0.0
    relative = sum(curvature(other.surface) for other in contact.ports)
    return own / whole * relative * _radius(port.surface)


def leanings(contacts: Iterable[Any]) -> dict[tuple[int, str], float]:
    """`leaning` by (index of the body, surface) of all surfaces with a compliance of slopes: the mean over their
    pairs."""
    found: dict[tuple[int, str], list[float]] = {}
    for contact in contacts:
        for port in contact.ports:
            if getattr(port.surface, "slope_lags", None) is not None:
                found.setdefault((port.body.index, port.name), []).append(leaning(contact, port))
    return {place: float(np.mean(values)) for place, values in found.items()}


def leant(surface: Any, by: float) -> Any:
    """The contact surface with the compliance D + `by` S."""
    return surface if by == 0.0 else replace(surface, lags=surface.lags + by * surface.slope_lags)


def curvature(surface: Any) -> float:
    """Around the axis [1/m]; of a bore negative, of a plane zero."""
    shape = surface.shape
    return 0.0 if shape.profile().planar else float(shape.side / _radius(surface))


def _radius(surface: Any) -> float:
    """At mid-width [m]."""
    z = 0.0 if surface.grid is None else float(np.mean(surface.grid.z[[0, -1]]))
    return float(surface.shape.radius_at(z))


def compliance(port: Any) -> float:
    """(1 - nu^2)/E [1/Pa]; 0 of a rigid body, and of one that does not say its material."""
    reduced = port.body.reduced
    known = {} if reduced is None else reduced.provenance
    material = known.get("contact_materials", {}).get(port.surface.name)
    return 0.0 if material is None else (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"]
