r"""What it costs that gaps are taken along undeformed normals.

A soft surface also moves along itself, by u_t outwards from under the load, and where the partner is inclined by x/R
that opens the gap by u_t x/R. It is left out of the gap, and the slope of the partner out of the direction of the push
(consistent with the energy: both or neither), so that the line load at a given approach comes out too high. What is
pressed out from under the load passes through the depth H of the material sideways, u_t ~ delta b/H, which is
b^2/(R H) of the load. Fitted to finite elements with the normal of the partner (tests/verification,
`plane_strain_cover`, bonded inside, R/H 1.4 to 10, b/H 0.1 to 1.3):

    error = b^2/(R H) (0.45 + b/(2 H)) ((nu - 0.3)/0.2)^2,      nothing to speak of below nu = 0.3,

1/R the relative curvature, nu Poisson's ratio; of two soft bodies the mean weighted by (1 - nu^2)/E.
"""

from __future__ import annotations

from typing import Any

import numpy as np

MOST = 0.005  # of the line load: a larger error is worth a word
HARMLESS, SPAN = 0.3, 0.2  # Poisson's ratios from which on u_t counts, and up to that of an incompressible body


def line_load_error(half_width: float, radius: float, wall: float, poisson_ratio: float) -> float:
    """Estimated relative error of the line load at a given approach; lengths in m."""
    squeezed = (max(poisson_ratio - HARMLESS, 0.0) / SPAN) ** 2
    return half_width**2 / (radius * wall) * (0.45 + 0.5 * half_width / wall) * squeezed


def normal_notes(contact: Any, columns: int) -> list[str]:
    """A note where the error is noticeable in the largest patch of `contact`, of so many columns."""
    first = contact.a.surface
    curvature = sum(_curvature(port.surface) for port in contact.ports)
    if not curvature > 0.0 or any(port.surface.shape.profile().crown for port in contact.ports):
        return []  # conformal, or touched in a point
    radius = 1.0 if first.shape.profile().planar else float(first.shape.radius_at(_middle(first)))
    half_width = 0.5 * columns * first.grid.pitch * radius
    error = weight = 0.0
    for port in contact.ports:
        reduced = port.body.reduced
        known = {} if reduced is None else reduced.provenance
        material = known.get("contact_materials", {}).get(port.surface.name)
        if material is None:
            continue
        nu = material["poisson_ratio"]
        wall = known.get("contact_walls", {}).get(port.surface.name) or 1.0 / curvature
        share = (1.0 - nu**2) / material["youngs_modulus"]
        error += share * line_load_error(half_width, 1.0 / curvature, wall, nu)
        weight += share
    if weight == 0.0 or error <= MOST * weight:
        return []
    return [
        f"contact {contact.name!r}: gaps are taken along undeformed normals, and the patch reaches "
        f"{half_width * curvature:.2g} of the relative radius to either side: the load of a line at a given approach "
        f"is about {error / weight:.1%} too high"
    ]


def _curvature(surface: Any) -> float:
    """Around the axis [1/m]; of a bore negative, of a plane zero."""
    shape = surface.shape
    return 0.0 if shape.profile().planar else float(shape.side / shape.radius_at(_middle(surface)))


def _middle(surface: Any) -> float:
    return 0.0 if surface.grid is None else float(np.mean(surface.grid.z[[0, -1]]))
