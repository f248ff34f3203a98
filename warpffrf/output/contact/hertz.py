r"""Kind of a contact, and its Hertz solution, from the true surfaces and the computed patch.

With relative curvatures `K_x`, `K_z` across and along the width w of the surfaces, a patch of half-width a and equal
depth in both directions ends at `z = a sqrt(K_x/K_z)`. Beyond w/2 the surfaces touch to their ends: "line". A patch
that reaches both ends of an arc is a "line_around", and one that ends inside is a "point". Without curvature: "flat".

Hertz contact of two bodies in a line or a point, from relative curvatures and E*.

K. L. Johnson, Contact Mechanics, 1985, sections 4.1 and 4.2. Line, 1/R the relative curvature:

    a^2 = 4 P' R / (pi E*),      p0 = 2 P' / (pi a).

Point, with the relative principal curvatures `2A <= 2B`, semi-axes a >= b, k = b/a, Carlson's integrals R_D and R_F,
p = p0 sqrt(1 - x^2/a^2 - y^2/b^2), p0 = 3 P / (2 pi a b) (eq. 4.25 and 4.26):

    B/A = R_D(0, 1, k^2)/R_D(0, k^2, 1),      a^3 = P R_D(0, k^2, 1) / (2 pi E* A),      delta = p0 b R_F(0, k^2, 1)/E*.

A sphere has k = 1, R_D = 3 pi/4 and a^3 = 3 P R/(4 E*). Hertz's theory requires a patch much smaller
than the radii of both bodies; `conforms` checks this.

Hertz stress. Stress below the centre of a Hertz patch in closed form, and its maximum.

A line of half-width a, t = z/a, in plane strain (K. L. Johnson, Contact Mechanics, 1985, eq. 4.46):

    sigma_x = p0 [2 t - (1 + 2 t^2)/w],      sigma_z = -p0/w,      sigma_y = nu (sigma_x + sigma_z),     w^2 = 1 + t^2.

The largest shear (sigma_x - sigma_z)/2 = p0 (t - t^2/w) is 0.300 p0 at 0.786 a, von Mises' stress at nu = 0.3 0.558 p0
at 0.704 a. At any (x, z), with M and N of the signs of z and x (Johnson, eq. 4.49), r^2 = M^2 + N^2,

    2 M^2, 2 N^2 = sqrt((a^2 - x^2 + z^2)^2 + 4 x^2 z^2) +- (a^2 - x^2 + z^2),
    sigma_x = -p0/a (M (1 + (z^2 + N^2)/r^2) - 2 z),    sigma_z = -p0/a M (1 - (z^2 + N^2)/r^2),
    tau_zx = -p0/a N (M^2 - z^2)/r^2,

and under the traction mu p along x (eq. 7.8) in addition mu times tau_zx for sigma_z, sigma_x for tau_zx, and

    sigma_x = p0/a (N (2 - (z^2 - M^2)/r^2) - 2 x).

An ellipse of semi-axes a > b, x along a, m = 1 - b^2/a^2, t = z/a = cot phi, T^2 = (b^2 + z^2)/(a^2 + z^2),
F and E the incomplete elliptic integrals of (phi, m) (H. R. Thomas and V. A. Hoersch, Univ. of Illinois Bull. 212,
1930; Johnson eq. 4.28; tests/output compares them with the half-space under the Hertz pressure):

    sigma_x = c [-(1 - T)/2 + t (F - E)  + nu (1 - T a^2/b^2 + t (E a^2/b^2 - F))],             c = 2 p0 b/(m a),
    sigma_y = c [1/2 + 1/(2 T) - T a^2/b^2 + t (E a^2/b^2 - F)  + nu (T - 1 + t (F - E))],
    sigma_z = -c/2 (1 - T^2)/T.

A circle: sigma_x = sigma_y = p0 [1/2/(1 + t^2) - (1 + nu)(1 - t acot t)], sigma_z = -p0/(1 + t^2); the largest shear is
half of the von Mises stress, 0.310 p0 and 0.620 p0 at 0.481 a with nu = 0.3.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.stress_field import max_shear, von_mises
from warpffrf.output.geometry.places import Pose, grid_theta_offset, relative_curvature
from warpffrf.output.geometry.scene_view import PairView

THIN = 0.25  # half-width over the depth of the material: up to this value the peak on a bonded layer is Hertz's to 3 %
FLAT = 1e-9  # relative curvature times the width of the surface: a height of 1e-10 of the width, below any approach


def pair_curvature(contact: Any, i: int) -> np.ndarray:
    """(2, 2) 1/m, relative curvature along (e_theta, t_z) of the first surface at the centre of pressure of saved step
    `i`; without contact at the line of centres at mid-width."""
    view: PairView = contact.view
    poses = [Pose.of(contact.bodies, body.name, i) for body in (view.first_body, view.second_body)]
    return relative_curvature(view.first.shape, view.second.shape, (poses[0], poses[1]), *_centre(contact, i))


def _centre(contact: Any, i: int) -> tuple[float, float]:
    """theta and z of the centre of pressure on the first shape in saved step `i`."""
    surface, (arc, z) = contact.view.first, contact.moments.center[i]
    theta = surface.grid.theta_start + grid_theta_offset(surface)
    theta += surface.grid.pitch * float(contact.history.center_column[i]) + arc / float(surface.shape.radius_at(z))
    places = getattr(contact, "places", None)
    return float(theta if places is None else theta + places.shift_at(i, z)), float(z)


def heaviest(contact: Any) -> int:
    """The saved step with the largest load; the first if none is finite."""
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
    """1/(relative curvature across the patch) [m] at the largest load; NaN without curvature."""
    across = float(contact.curvature(heaviest(contact))[0, 0])
    return 1.0 / across if across > 0.0 else float("nan")


def effective_modulus(view: PairView) -> float:
    """E* [Pa], `1/E* = sum (1 - nu^2)/E` over the flexible bodies, from the provenance of their reduction.

    Raises `InputError` for a body without material data.
    """
    compliance = 0.0
    for body, surface in flexible_sides(view):
        material = body.reduced.provenance.get("contact_materials", {}).get(surface.name)
        if not material:
            raise InputError(
                f"contact '{view.name}': body '{body.name}' has no material data, so Hertz cannot be computed; "
                "reduce the body again"
            )
        compliance += (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"]
    return 1.0 / compliance


def hertz(contact: Any, i: int) -> HertzLine | HertzPoint:
    """Hertz solution in saved step `i`; raises `InputError` with the reason if the theory does not apply."""
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
        raise InputError(f"{label}: the surfaces conform without a gap at the edge, so that the patch has no boundary")
    found = (
        hertz_point(float(contact.normal_load[i]), K, modulus)
        if kind == "point"
        else hertz_line(float(contact.line_load[i]), float(K[0, 0]), modulus)
    )
    own = np.ravel(contact.view.first.shape.curvatures(*_centre(contact, i)))
    sharpest = np.abs([own, np.diag(K) - own]).max(axis=0)  # of both bodies, along (e_theta, t_z) of the first
    ways = [(found.half_width, sharpest[0])]
    if isinstance(found, HertzPoint):  # each side of an ellipse is compared with the radii in its direction
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
                "behind its surface, which is not a half-space; compare with a solution for a layer"
            )
    return found


def inapplicable(kind: str, reason: str) -> HertzLine | HertzPoint:
    """NaN as the solution of a contact of `kind`, with the reason."""
    nan = float("nan")
    if kind == "point":
        return HertzPoint((nan, nan), nan, nan, nan, nan, (nan, nan), nan, reason)
    return HertzLine(nan, nan, nan, nan, nan, reason)


def flexible_sides(view: PairView) -> list[tuple[Any, Any]]:
    """Flexible bodies of the contact and their surfaces."""
    sides = ((view.first_body, view.first), (view.second_body, view.second))
    return [(body, surface) for body, surface in sides if body.reduced is not None]


CONFORMAL = 0.25  # half-width over the smallest radius above which Hertz's half-space does not apply
LOG_SLOPE = 2.0 / 3.0  # of ln(a/b) over ln(B/A) of a nearly round patch
MOST_SECANTS, CONVERGED = 20, 1e-13  # of ln(a/b)


class HertzLine(NamedTuple):
    """Hertz line contact at the computed line load at mid-width."""

    half_width: float  # m
    peak_pressure: float  # Pa
    line_load: float  # N/m
    radius: float  # m, 1/(1/R1 + 1/R2) at mid-width
    modulus: float  # Pa, E*
    reason: str = ""  # why the theory does not apply; the numbers are NaN then

    def stress(self, x: Any, z: Any, *, friction: float = 0.0, poisson_ratio: float = 0.3) -> np.ndarray:
        """(..., 6) Pa: stress xx, yy, zz, xy, yz, zx in plane strain at x across the line from its middle, z > 0 the
        depth [m], of any shape that broadcasts, tension positive; friction [-]: traction along x over the pressure."""
        x, z = np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))
        square = self.half_width**2 - x * x + z * z
        root = np.hypot(square, 2.0 * x * z)
        M, N = np.sqrt(0.5 * (root + square)), np.sign(x) * np.sqrt(0.5 * np.maximum(root - square, 0.0))
        size = self.peak_pressure / self.half_width
        x_x, z_z = -size * (M * (1.0 + (z * z + N * N) / root) - 2.0 * z), -size * M * (1.0 - (z * z + N * N) / root)
        z_x = -size * N * (M * M - z * z) / root
        along = size * (N * (2.0 - (z * z - M * M) / root) - 2.0 * x)
        x_x, z_z, z_x = x_x + friction * along, z_z + friction * z_x, z_x + friction * x_x
        return np.stack([x_x, poisson_ratio * (x_x + z_z), z_z, 0.0 * x, 0.0 * x, z_x], axis=-1)


class HertzPoint(NamedTuple):
    """Hertz elliptical contact at the computed load."""

    semi_axes: tuple[float, float]  # m, the larger one first
    angle: float  # rad, of the larger axis from e_theta of the first surface towards t_z
    peak_pressure: float  # Pa
    load: float  # N
    approach: float  # m, of distant points
    radii: tuple[float, float]  # m, 1/(2A) >= 1/(2B)
    modulus: float  # Pa, E*
    reason: str = ""  # why the theory does not apply; the numbers are NaN then

    @property
    def half_width(self) -> float:
        """Half the side of the ellipse's bounding rectangle along e_theta [m]."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(np.hypot(a * c, b * s))

    @property
    def half_width_along(self) -> float:
        """Half the side of the bounding rectangle along t_z [m]."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(np.hypot(a * s, b * c))

    @property
    def section(self) -> float:
        """Half the length of the section through the centre along e_theta [m]; 0 without a load."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(1.0 / np.hypot(c / a, s / b)) if a > 0.0 else 0.0

    @property
    def section_along(self) -> float:
        """Half the length of the section through the centre along t_z [m]; 0 without a load."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(1.0 / np.hypot(s / a, c / b)) if a > 0.0 else 0.0


def hertz_line(line_load: float, curvature: float, modulus: float) -> HertzLine:
    """Line contact at `line_load` [N/m], relative `curvature` [1/m] and `modulus` E* [Pa]."""
    radius = 1.0 / curvature
    a = float(np.sqrt(4.0 * line_load * radius / (np.pi * modulus)))
    return HertzLine(a, 2.0 * line_load / (np.pi * a) if a > 0.0 else 0.0, line_load, radius, modulus)


def hertz_point(load: float, curvature: np.ndarray, modulus: float) -> HertzPoint:
    """Point contact at `load` [N], the relative curvature tensor (2, 2) [1/m] along (e_theta, t_z), `modulus` E* [Pa].

    Both principal curvatures must be positive.
    """
    values, axes = np.linalg.eigh(curvature)  # ascending: the larger semi-axis is along the first
    angle = float(np.arctan2(axes[1, 0], axes[0, 0]))
    angle -= float(np.pi * np.round(angle / np.pi))  # the direction of an axis has no sign
    a, b, peak, approach = (float(x) for x in hertz_ellipse(load, values[0], values[1], modulus))
    return HertzPoint((a, b), angle, peak, load, approach, (1.0 / float(values[0]), 1.0 / float(values[1])), modulus)


def hertz_ellipse(load: Any, small: Any, large: Any, modulus: float) -> tuple[Array, Array, Array, Array]:
    """Half-axes along and across the direction of the curvature `small` [m], peak pressure [Pa] and approach [m] of
    point contacts, for loads [N] and relative principal curvatures [1/m] that broadcast, `modulus` E* [Pa]. The first
    half-axis is the larger one if `small` is the smaller curvature."""
    from scipy.special import elliprd, elliprf

    k = half_axis_ratio(np.asarray(large) / small)
    a = np.cbrt(load * elliprd(0.0, k * k, 1.0) / (np.pi * modulus * small))
    b = k * a
    area = np.where(a > 0.0, np.pi * a * b, np.inf)
    peak = 1.5 * load / area
    return a, b, peak, peak * b * elliprf(0.0, k * k, 1.0) / modulus


def half_axis_ratio(ratio: Any) -> Array:
    """k = b/a of ellipses at ratios B/A of the relative curvatures."""
    from scipy.special import elliprd

    wanted = np.log(ratio)

    def excess(log_k: Array) -> Array:
        k2 = np.exp(2.0 * log_k)
        return np.log(elliprd(0.0, 1.0, k2) / elliprd(0.0, k2, 1.0)) - wanted

    # nearly linear, and odd: secants converge from everywhere
    before, at = np.zeros_like(wanted), -LOG_SLOPE * wanted
    f_before, f = -wanted, excess(at)
    for _ in range(MOST_SECANTS):
        bend = f - f_before
        step = np.divide(f * (at - before), bend, out=np.zeros_like(f), where=bend != 0.0)
        before, at = at, at - step
        if np.abs(step).max(initial=0.0) < CONVERGED:
            break
        f_before, f = f, excess(at)
    return np.exp(at)


def conforms(half_width: float, curvature: float) -> bool:
    """True if a patch of this half-width [m] is not small compared with the radius 1/|curvature| of a body."""
    return half_width * abs(curvature) > CONFORMAL


Array = np.ndarray
STRESS_ROUND = (
    1e-7  # of m: below it a circle, with an error of m; the terms of the ellipse lose 1e-16/m of their digits
)
DEEPEST = 2.0  # of the smaller half-width: the maxima are within
PLACES = 2001  # evaluated, before a parabola through the largest: 1e-6 of the depth


class Largest(NamedTuple):
    """The maximum of a stress below the centre, and its depth."""

    stress: float  # Pa
    depth: float  # m


def stress_on_axis(hertz: HertzLine | HertzPoint, depth: Array, poisson_ratio: float) -> Array:
    """Stress (n, 6) [Pa] at depths (n,) [m] below the centre of a Hertz patch: xx across a line or along the larger
    semi-axis, yy the other surface direction, zz into the depth; tension is positive."""
    z, p0, nu = np.asarray(depth, dtype=float), hertz.peak_pressure, poisson_ratio
    if isinstance(hertz, HertzLine):
        t = z / hertz.half_width
        w = np.hypot(1.0, t)
        x, down = 2.0 * t - (1.0 + 2.0 * t * t) / w, -1.0 / w
        y = nu * (x + down)
    else:
        x, y, down = _under_ellipse(*hertz.semi_axes, z, nu)
    zero = np.zeros_like(z)
    return p0 * np.stack([x, y, down, zero, zero, zero], axis=-1)


def _under_ellipse(a: float, b: float, z: Array, nu: float) -> tuple[Array, Array, Array]:
    """sigma_x, sigma_y, sigma_z over p0."""
    from scipy.special import ellipeinc, ellipkinc

    m, t = 1.0 - (b / a) ** 2, z / a
    if m < STRESS_ROUND:
        down = -1.0 / (1.0 + t * t)
        around = -0.5 * down - (1.0 + nu) * (1.0 - t * np.arctan2(1.0, t))
        return around, around, down
    phi, T, k = np.arctan2(1.0, t), np.sqrt((b * b + z * z) / (a * a + z * z)), (a / b) ** 2
    F, E = ellipkinc(phi, m), ellipeinc(phi, m)
    c, one, two = 2.0 * b / (m * a), t * (F - E), t * (k * E - F)
    x = c * (-0.5 * (1.0 - T) + one + nu * (1.0 - k * T + two))
    y = c * (0.5 + 0.5 / T - k * T + two + nu * (T - 1.0 + one))
    return x, y, -0.5 * c * (1.0 - T * T) / T


def largest_below(hertz: HertzLine | HertzPoint, poisson_ratio: float) -> tuple[Largest, Largest]:
    """The largest von Mises stress below the centre of a Hertz patch, and the largest shear stress."""
    small = hertz.half_width if isinstance(hertz, HertzLine) else hertz.semi_axes[1]
    depth = small * np.linspace(0.0, DEEPEST, PLACES)
    stress = stress_on_axis(hertz, depth, poisson_ratio)
    return largest_of(depth, von_mises(stress)), largest_of(depth, max_shear(stress))


def largest_of(depth: Array, values: Array) -> Largest:
    """Vertex of the parabola through the largest of `values` (n,) [Pa] at evenly spaced depths (n,) [m] and its
    neighbours; at an end the value there."""
    n = int(np.argmax(values))
    if n in (0, len(values) - 1):
        return Largest(float(values[n]), float(depth[n]))
    before, top, after = (float(v) for v in values[n - 1 : n + 2])
    bend: Any = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend != 0.0 else 0.0
    return Largest(top - 0.25 * (before - after) * shift, float(depth[n] + shift * (depth[1] - depth[0])))
