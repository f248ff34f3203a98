"""Do the surfaces of a pair lie in one another at the start by more than elastic bodies ever would?

A pair may start with an interference: that is how an approach is given, and deformation takes it up. Its depth is that
of a Hertz contact, (a/R)^2 R = (pi p0 / 2 E*)^2 R with the relative radius R: 3e-3 R at p0 = 4 GPa between steel balls,
where raceways are dented for good. Much more is a body in the wrong place, and the run would begin with an explosion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.checks.wedge import Wedge, find_wedge
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import closing_direction, facing_gap, moved_body

if TYPE_CHECKING:
    from warpffrf.model.contact import Contact
    from warpffrf.model.scene import Scene

OVERLAP_FRACTION = 1e-2  # of the smallest radius of curvature: three times what steel takes (above); 0.4 mm of 50 mm
FLAT = 1e-9  # of 1 over the width; a curvature below this is none


def allowed_overlap(contact: Contact, theta: float, z: float) -> float:
    """Depth [m] by which the surfaces may overlap at the start: the pair's own, or OVERLAP_FRACTION of the smallest
    radius of curvature of the two at chart coordinates theta, z of the first; between planes, of the width."""
    if contact.overlap is not None:
        return contact.overlap
    first, second = contact.a, contact.b
    there = second.body.to_user(first.body.to_world(first.surface.shape.point(theta, z)))
    places = ((first.surface.shape, theta, z), (second.surface.shape, *second.surface.shape.chart(there)[:2]))
    curvature = max(float(np.max(np.abs(shape.curvatures(t, s)))) for shape, t, s in places)
    width = float(np.ptp(first.surface.grid.z))
    return OVERLAP_FRACTION / curvature if curvature * width > FLAT else OVERLAP_FRACTION * width


def refuse_overlap(scene: Scene) -> None:
    """Raises `InputError` for a pair whose surfaces overlap at the initial pose by more than is allowed, with the depth
    and the cure."""
    gaps = {contact.name: facing_gap(contact) for contact in scene.contacts}
    for contact in scene.contacts:
        gap, theta, z = gaps[contact.name] or (0.0, 0.0, 0.0)
        allowed = excessive_overlap(contact, gap, theta, z)
        if allowed is not None:
            if (wedge := find_wedge(scene, gaps)) is not None and (said := excessive_wedge(wedge)):
                raise InputError(said)
            along = closing_direction(contact, theta, z)
            cure = f" with scene.close_gap(pair, along={along})" if along else ""
            raise InputError(
                f"contact {contact.name!r}: the surfaces {contact.a.label} and {contact.b.label} overlap at the start "
                f"by {-gap:.3g} m, more than the {allowed:.3g} m that are allowed; move "
                f"{moved_body(contact).name!r}{cure}, or allow it with Contact(..., overlap={-1.05 * gap:.2g})"
            )


def excessive_wedge(wedge: Wedge) -> str:
    """What is to be said of a wedge that is deeper than the overlap that its pairs allow; else ""."""
    allowed = min(allowed_overlap(c, *near[1:]) for c in wedge.contacts if (near := facing_gap(c)) is not None)
    if wedge.depth <= allowed:
        return ""
    return str(wedge) if wedge.all_round else f"{wedge}; {allowed:.3g} m are allowed, or Contact(..., overlap=)"


def excessive_overlap(contact: Contact, gap: float, theta: float, z: float) -> float | None:
    """The allowed overlap [m] where the smallest gap `gap` [m], at theta, z of the first surface, exceeds it; else
    None."""
    if gap >= 0.0:
        return None
    allowed = allowed_overlap(contact, theta, z)
    return allowed if -gap > allowed else None
