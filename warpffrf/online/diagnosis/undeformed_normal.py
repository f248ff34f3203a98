r"""What it costs where gaps are taken along undeformed normals, or nearly so.

A soft surface also moves along itself, by u_t outwards from under the load, and where the partner is inclined by x/R*
that opens the gap by u_t x/R*. To first order in x/R* that is in the compliance of soft bodies
(`warpffrf.offline.contact.slopes`). What is left, of second order, makes the line load at a given approach too high by
up to

    0.7 (b/R*)^2,

b the half-width, 1/R* the relative curvature. Where the first order is not there, as with dynamic local modes, or not
all of it, as on a surface that serves partners of different curvature, the load is too high by

    error = b^2/(R* H) (0.45 + b/(2 H)) ((nu - 0.3)/0.2)^2,      nothing to speak of below nu = 0.3,

since what is pressed out from under the load passes through the depth H of the material sideways, u_t ~ delta b/H; nu
is Poisson's ratio; of two soft bodies the mean weighted by (1 - nu^2)/E. Fitted to finite elements with the normal of
the partner (tests/verification, `plane_strain_cover`, bonded inside, R/H 1.4 to 10, b/H 0.1 to 1.3). Surfaces that are
touched in points are not judged.
"""

from __future__ import annotations

from collections.abc import Mapping

from warpffrf.model.contact import Contact
from warpffrf.model.reduced.slopes import compliance, curvature, leaning

MOST = 0.005  # of the line load: a larger error is worth a word
HARMLESS, SPAN = 0.3, 0.2  # Poisson's ratios from which on u_t counts, and up to that of an incompressible body
SECOND_ORDER = 0.7  # of (b/R*)^2: 0.4 on a rigid roller of the same radius, 0.7 on a plane


def line_load_error(half_width: float, radius: float, wall: float, poisson_ratio: float) -> float:
    """Estimated relative error of the line load at a given approach along undeformed normals; lengths in m."""
    squeezed = (max(poisson_ratio - HARMLESS, 0.0) / SPAN) ** 2
    return half_width**2 / (radius * wall) * (0.45 + 0.5 * half_width / wall) * squeezed


def normal_notes(contact: Contact, half_width: float, taken: Mapping[tuple[int, str], float]) -> list[str]:
    """A note where the error is noticeable in the largest patch of `contact`, of that `half_width` [m]; `taken`: the
    slope that each surface has taken into its compliance, by (index of the body, surface)."""
    relative = sum(curvature(port.surface) for port in contact.ports)
    if not relative > 0.0 or any(port.surface.shape.profile().crown for port in contact.ports):
        return []  # conformal, or touched in a point
    error = weight = 0.0
    for port in contact.ports:
        if (share := compliance(port)) == 0.0:
            continue
        known, own = port.body.reduced.provenance, leaning(contact, port)
        nu = known["contact_materials"][port.surface.name]["poisson_ratio"]
        wall = known.get("contact_walls", {}).get(port.surface.name) or 1.0 / relative
        missing = abs(1.0 - taken.get((port.body.index, port.name), 0.0) / own) if own != 0.0 else 1.0
        error += share * missing * line_load_error(half_width, 1.0 / relative, wall, nu)
        weight += share
    error = error / weight + SECOND_ORDER * (half_width * relative) ** 2 if weight > 0.0 else 0.0
    if error <= MOST:
        return []
    return [
        f"contact {contact.name!r}: the patch reaches {half_width * relative:.2g} of the relative radius to either "
        "side, and gaps follow the slope of the deformed surfaces to first order at most: the load of a line at a "
        f"given approach is up to {error:.1%} too high"
    ]
