"""Extent of the windows and stencils of a pair, from the sizes of its two surfaces.

In the section through the patch, across A's columns, both surfaces are circles (or lines) that touch: with s the
arc length on A, kappa = side/R its curvature, positive where the material is convex,

    x(s) = (sin(kappa s)/kappa, -(1 - cos(kappa s))/kappa),      B's circle has its centre at (0, 1/kappa_B),

and the opposite point on B is where the ray from that centre through x(s) meets it. This determines how many columns of
B face a window of A, and the support of a node of A. Where the two grids are rotated against each other, by as much as
at the start, or by any angle where one is a sphere, the extent of the support along the other direction is included.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf_kernels.kinematics.line_of_centres import GUARD

MIN_HALF_WINDOW = 6  # columns: margin and guard columns of a patch of a few columns
MAX_HALF_WINDOW = 60  # columns: 121 in all; a patch that needs more has too fine a contact grid
STENCIL_SPARE = 2  # a node's support of length x touches at most ceil(x) + 1 cells, ceil(x) + 2 columns
ROUND_OFF = 1e-9  # cells: a ratio of two grids that is a whole number up to this is one
REACH_SPARE = 1.02  # arc length over its projection at the edge of the widest window, and points that separate
# of A's curvature: a pin with a clearance below this part of its radius may touch along half its circumference
HUGGING = 0.05
TURNING = 0.05  # rad: rotation of the axes of a pair against each other in a run
RAYS = 801  # points in the section


@dataclass(frozen=True)
class Extent:
    """A flexible or rigid surface in the section and along the meridian."""

    curvature: float  # 1/m, in the section across the columns, positive where convex
    metric: float  # m per theta, smallest over the rows
    spacing: float  # m, between columns
    width: float  # m, length of the grid along the meridian
    reach: float  # m, longest support of a node along the meridian
    round: bool  # a sphere: it may rotate in any way
    planar: bool = False  # theta is a length

    @classmethod
    def of(cls, surface: ContactSurface | RigidSurface, axial: float = 0.0, *, flattest: bool = False) -> Extent:
        """Of a surface; `axial` [m] is where the curvature is taken, that of an extruded curve where it is sharpest, or
        `flattest`."""
        profile = surface.shape.profile()
        at = float(surface.shape.radius_at(axial))
        curvature = 0.0 if profile.planar else profile.side / at
        if profile.curve is not None:
            along = profile.curve.curvature(profile.curve.knots)
            curvature = float(np.min(along) if flattest else np.max(along))
        if profile.height is not None:
            along = surface.shape.sampled_curvatures()[0]
            curvature = float(np.min(along) if flattest else np.max(along))
        sphere = profile.spherical
        if surface.grid is None:
            return cls(curvature, at, np.inf, np.inf, np.inf, sphere, profile.planar)
        z = np.asarray(surface.grid.z)
        stretch = np.sqrt(1.0 + np.asarray(surface.shape.slope_at(z)) ** 2).max()
        support = max(z[min(i + 1, len(z) - 1)] - z[max(i - 1, 0)] for i in range(len(z)))
        metric = float(np.min(surface.shape.radius_at(z)))
        width, reach = (z[-1] - z[0]) * stretch, support * stretch
        return cls(curvature, metric, surface.grid.pitch * at, width, reach, sphere, profile.planar)


def between_axes(contact: Contact) -> float:
    """Angle [rad] in [0, pi/2] between the axes of the two surfaces at the start."""
    a, b = (port.body.to_world(port.surface.shape.e_a) - port.body.to_world(np.zeros(3)) for port in contact.ports)
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(float(a @ b))))


def half_window(
    surface: ContactSurface, first: Extent, second: Extent, turned: float, strain: float
) -> tuple[int, int]:
    """Grid columns on each side of the nearest one, and the number required, for a patch as wide as `strain` of the
    effective radius; for conformal surfaces all that can face each other.
    """
    grid = surface.grid
    opposite = second.curvature if turned <= TURNING or second.round else min(second.curvature, 0.0)
    relative = first.curvature + opposite
    most = grid.columns // 2  # of an arc that is the whole of it
    wanted = most
    if relative > 0.0:
        wanted = min(int(np.ceil(strain / relative / first.spacing)) + int(GUARD) + 1, most)
    limits = [most]
    if relative > HUGGING * abs(first.curvature) or first.curvature == 0.0:
        limits.append(MAX_HALF_WINDOW)
    if first.curvature != 0.0:  # no surface is opposite beyond a quarter of a revolution
        turn = grid.pitch * (abs(first.curvature) if first.planar else 1.0)
        limits.append(max(int(0.5 * np.pi / turn) - 2, int(GUARD) + 1))
    return int(min(max(wanted, MIN_HALF_WINDOW), *limits)), wanted


def facing(first: Extent, second: Extent, s: np.ndarray) -> np.ndarray:
    """Point on B [rad, of a plane or curve m] opposite arc lengths s [m] of A in the section."""
    kappa = first.curvature
    x = np.sin(kappa * s) / kappa if kappa else s
    y = -2.0 * np.sin(0.5 * kappa * s) ** 2 / kappa if kappa else 0.0 * s
    if second.curvature == 0.0:
        return x
    R = 1.0 / second.curvature
    angle = np.arctan2(x, R - y) if R > 0.0 else np.arctan2(x, y - R)
    return abs(R) * angle if second.planar else angle


def sine_between(first: Extent, second: Extent, turned: float) -> float:
    """Sine of the largest angle at which the grids may cross: that of the start and a little more; spheres and two
    planes may rotate in any way. 0 where the axes stay parallel.
    """
    free = first.round or second.round or first.curvature == second.curvature == 0.0
    angle = 0.5 * np.pi if free else min(turned + TURNING, 0.5 * np.pi)
    return 0.0 if angle <= TURNING else float(np.sin(angle))


def second_reach(
    surface: ContactSurface | RigidSurface, first: Extent, second: Extent, turned: float, half: int
) -> tuple[int, int, int]:
    """Columns of B on each side that face a window of `half` columns, and columns and rows of B under a node of A."""
    if surface.grid is None:
        return 1, 1, 1
    grid = surface.grid
    sine = sine_between(first, second, turned)
    edge = (half + 1.5) * first.spacing
    if first.curvature:
        edge = min(edge, 0.5 * np.pi / abs(first.curvature))
    s = np.linspace(-edge, edge, RAYS)
    place = facing(first, second, s)
    if not second.planar:
        place = np.unwrap(place)
    steepest = np.abs(np.gradient(place, s)).max() / grid.pitch  # columns of B per metre on A
    finest = 1.0 / (second.metric * grid.pitch)
    reach = np.abs(place).max() / grid.pitch + first.width * sine * finest
    side = int(min(np.ceil(reach + 0.5), grid.columns)) + STENCIL_SPARE
    columns = REACH_SPARE * (2.0 * first.spacing * steepest + first.reach * sine * finest)
    rows = (first.reach + 2.0 * first.spacing * sine) / np.min(np.diff(grid.z))
    return (
        side,
        int(np.ceil(columns - ROUND_OFF)) + STENCIL_SPARE,
        min(grid.rows, int(np.ceil(REACH_SPARE * rows - ROUND_OFF)) + STENCIL_SPARE),
    )
