r"""Which kind of contact a pair is, and Hertz's solution for it, from the true surfaces and the patch that was found.

At relative curvatures `K_x`, `K_z` across and along the width w of the surfaces, a patch of half-width a that is as
deep across as along ends at `z = a sqrt(K_x/K_z)`. Beyond w/2 the surfaces touch to their ends: "line". A patch that
reaches both ends of an arc is a "line_around", and one that ends inside a "point". Neither curved: "flat".
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.contact.hertz_patch import HertzLine, HertzPoint, conforms, hertz_line, hertz_point
from warpffrf.output.geometry.grid_places import grid_theta_offset
from warpffrf.output.geometry.poses import Pose, relative_curvature
from warpffrf.output.geometry.scene_view import PairView

THIN = 0.25  # half-width over the depth of the material: up to there the peak on a bonded cover is Hertz's to 3 %
FLAT = 1e-9  # relative curvature times the width of the surface: a drop of 1e-10 of the width, below any approach


def pair_curvature(contact: Any, i: int) -> np.ndarray:
    """(2, 2) 1/m, relative curvature along (e_theta, t_z) of the first surface under the centre of pressure of saved
    step `i`; where nothing touches under the line of centres at mid-width."""
    view: PairView = contact.view
    surface = view.first
    arc, z = contact.moments.center[i]
    theta = surface.grid.theta_start + grid_theta_offset(surface)
    theta += surface.grid.pitch * float(contact.history.center_column[i]) + arc / float(surface.shape.radius_at(z))
    poses = [Pose.of(contact.bodies, body.name, i) for body in (view.first_body, view.second_body)]
    return relative_curvature(surface.shape, view.second.shape, (poses[0], poses[1]), float(theta), float(z))


def heaviest(contact: Any) -> int:
    """The saved step with the largest load; the first where none is finite."""
    load = contact.moments.load
    return int(np.argmax(np.where(np.isfinite(load), load, -1.0))) if len(load) else 0


def patch_kind(contact: Any) -> str:
    """ "line", "line_around", "point" or "flat", see the module; at the largest load of the run."""
    if not len(contact.moments.load):
        return "line"
    i = heaviest(contact)
    K = contact.curvature(i)
    grids = [s.grid for s in (contact.view.first, contact.view.second) if s.grid is not None]
    width = min(float(g.z[-1] - g.z[0]) for g in grids)
    across, along = float(K[0, 0]), float(K[1, 1])
    if max(abs(across), abs(along)) * width < FLAT:
        return "flat"
    squares = 4.0 * np.diagonal(contact.moments.covariance[i])
    if along * (0.5 * width) ** 2 <= across * squares[0]:
        return "line"
    return "line_around" if contact.reaches_ends(i) else "point"


def effective_radius(contact: Any) -> float:
    """1/(relative curvature across the patch) [m] at the largest load; NaN where there is none."""
    across = float(contact.curvature(heaviest(contact))[0, 0])
    return 1.0 / across if across > 0.0 else float("nan")


def effective_modulus(view: PairView) -> float:
    """E* [Pa], `1/E* = sum (1 - nu^2)/E` over the flexible bodies, from the provenance of their reduction.

    Raises `InputError` for a body that does not say its material.
    """
    compliance = 0.0
    for body, surface in flexible_sides(view):
        material = body.reduced.provenance.get("contact_materials", {}).get(surface.name)
        if not material:
            raise InputError(
                f"contact '{view.name}': body '{body.name}' does not say its material, so Hertz cannot be computed; "
                "reduce the body again"
            )
        compliance += (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"]
    return 1.0 / compliance


def hertz(contact: Any, i: int) -> HertzLine | HertzPoint:
    """Hertz's contact in saved step `i`; raises `InputError` saying why where his theory does not apply."""
    label = f"contact '{contact.name}': Hertz does not apply"
    if not contact.touching[i]:
        raise InputError(f"{label}: nothing touches in saved step {i}; choose one of those where `touching` is true")
    kind, modulus = contact.patch_kind, contact.effective_modulus
    if kind == "flat":
        raise InputError(f"{label}: the faces are flat, and their pressure is that of a stamp")
    if kind == "line_around":
        raise InputError(
            f"{label} here: the line lies along the arc; name the round body first, or turn the plane's axis"
        )
    K = contact.curvature(i)
    if not (np.linalg.eigvalsh(K)[0] > 0.0 if kind == "point" else K[0, 0] > 0.0):
        raise InputError(f"{label}: the surfaces curve into each other, so that the patch has no edge")
    found = (
        hertz_point(float(contact.normal_load[i]), K, modulus)
        if kind == "point"
        else hertz_line(float(contact.line_load[i]), float(K[0, 0]), modulus)
    )
    own = np.ravel(contact.view.first.shape.curvatures(0.0, float(contact.moments.center[i, 1])))
    sharpest = np.abs([own, np.diag(K) - own]).max(axis=0)  # of both bodies, along (e_theta, t_z) of the first
    ways = [(found.half_width, sharpest[0])]
    if isinstance(found, HertzPoint):  # a long ellipse is small in each direction against the radii in that direction
        ways.append((found.half_width_along, sharpest[1]))
    for extent, curvature in ways:
        if conforms(extent, float(curvature)):
            raise InputError(
                f"{label}: the surfaces conform, its half-width would be {extent:.3g} m at a radius of "
                f"{1.0 / curvature:.3g} m; compare with a conformal solution"
            )
    extent = found.semi_axes[1] if isinstance(found, HertzPoint) else found.half_width
    for body, surface in flexible_sides(contact.view):
        wall = body.reduced.provenance.get("contact_walls", {}).get(surface.name)
        if wall is not None and extent > THIN * wall:
            raise InputError(
                f"{label}: its half-width would be {extent:.3g} m, and body '{body.name}' is only {wall:.3g} m deep "
                "behind its surface, no half-space; compare with a solution for a layer"
            )
    return found


def inapplicable(kind: str, reason: str) -> HertzLine | HertzPoint:
    """NaN in the place of a contact of `kind`, with the reason."""
    nan = float("nan")
    if kind == "point":
        return HertzPoint((nan, nan), nan, nan, nan, nan, (nan, nan), nan, reason)
    return HertzLine(nan, nan, nan, nan, nan, reason)


def flexible_sides(view: PairView) -> list[tuple[Any, Any]]:
    """Bodies and surfaces of the pair that are not rigid."""
    sides = ((view.first_body, view.first), (view.second_body, view.second))
    return [(body, surface) for body, surface in sides if body.reduced is not None]
