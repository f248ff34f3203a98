r"""Surfaces of revolution: the chart that cylinder, crown, groove, sphere, cone and their inside forms share.

    x(theta, z) = c + z e_a + R(z) (cos(theta) e_0 + sin(theta) e_1),      n = side (e_r - R' e_a) / sqrt(1 + R'^2),

with R(z) of the kind's profile. The distance of a point is that in its meridian half plane; `chart` returns theta of
the point and z of the nearest point. Principal curvatures, positive where the material is convex:

    around   side / (R sqrt(1 + R'^2)),      along   -side R'' / (1 + R'^2)^(3/2).

Profiled cylinder. Outside of a cylinder with a profile by a table: R(z) = R_0 - table(z), cubic pieces with continuous
slope.

The pieces are Hermite polynomials through the drops: with the slopes of the table, else with those of PCHIP (Fritsch
and Carlson 1980), which do not overshoot. Beyond the table the profile is extrapolated linearly.

Logarithmic profile (Lundberg 1939; the form with a finite end is that of Fujiwara and Kawase 2007)

    drop(z) = A ln 1/(1 - (1 - exp(-e/A)) (2 z/L)^2),      |z| <= L/2:

of a roller that a load Q presses on a straight partner, A = Q/(pi L E*) with 1/E* the sum of (1 - nu^2)/E gives a
pressure without edges in the limit of a large end drop e. Its slope is closed too, 4 A (exp(e/A) - 1)/L at the ends.

Refused: z that does not increase, so that the profile is not monotonic; a slope above 80 degrees; a drop of more than
the radius; a hollow so narrow that normals of the profile cross far within its own depth, curvature times depth above
3: its points would then be nearest to several points. The root of a wheel's flange has 2.4, and a tread that fits it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.base import Shape
from warpffrf.model.surfaces.fit import Revolution, fit_revolution, reference_direction, rms_distance
from warpffrf.model.surfaces.profile import SurfaceProfile

# A fitted arc must be significant: nodes that a straight profile fits as well, or to their round-off, have none.
BETTER = 0.9  # rms distance over that of the straight profile: one unknown more explains noise of n nodes by 1 - 1/n
ROUND_OFF = 1e-9  # of the radius


@dataclass(frozen=True, eq=False, kw_only=True)
class RevolutionShape(Shape):
    """A surface of revolution; parameters that are None are fitted to the nodes of the facet set.

    radius [m] at `axis_point` (3,) [m], where z = 0; axis_direction (3,); user frame of the body. theta = 0 is +x made
    perpendicular to the axis, or +y where the axis is near x. fit_tolerance [m]: 1e-5 of the radius where None.
    """

    radius: float | None = None
    axis_point: Any = None
    axis_direction: Any = None

    required = ("radius", "axis_point", "axis_direction")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.radius is not None:
            self._keep_number("radius", positive=True)
        if self.axis_point is not None:
            self._keep_point("axis_point")
        if self.axis_direction is not None:
            self._keep_direction("axis_direction")

    @property
    def size(self) -> float:
        return self._known()[0]

    def profile(self) -> SurfaceProfile:
        return SurfaceProfile(planar=False, side=self.side, radius=self._known()[0])

    # --- frame

    @property
    def e_a(self) -> np.ndarray:
        return self._known()[2]

    @property
    def e_0(self) -> np.ndarray:
        return reference_direction(self.e_a)

    # --- chart

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        _, c, _ = self._known()
        local = (np.asarray(points, float) - c) @ self.frame.T
        z, distance = self.profile().foot(np.hypot(local[..., 0], local[..., 1]), local[..., 2])
        return np.arctan2(local[..., 1], local[..., 0]), z, self.side * distance

    def point(self, theta: Any, z: Any) -> np.ndarray:
        _, c, e_a = self._known()
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return c + z[..., None] * e_a + self.radius_at(z)[..., None] * self.radial(theta)

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        radial, axial = self.profile().normal_at(z)
        return self.side * (radial[..., None] * self.radial(theta) + axial[..., None] * self.e_a)

    def radial(self, theta: Any) -> np.ndarray:
        """Radial unit vectors e_r (..., 3) at theta [rad], away from the axis."""
        theta = np.asarray(theta, float)[..., None]
        return np.cos(theta) * self.e_0 + np.sin(theta) * self.e_1

    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        theta = np.asarray(theta, float)[..., None]
        return self.side * (np.cos(theta) * self.e_1 - np.sin(theta) * self.e_0)

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        profile = self.profile()
        _, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        if profile.crown and profile.closed:  # finite at the poles of a sphere too
            return self.side / profile.measure_at(z), np.full(z.shape, self.side * profile.curvature)
        steep = np.sqrt(1.0 + profile.slope_at(z) ** 2)
        return self.side / (profile.radius_at(z) * steep), -self.side * profile.bend_at(z) / steep**3

    # --- fit

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        fit = self._fit(points, curvature=0.0)
        return replace(self, radius=fit.radius, axis_point=fit.axis_point, axis_direction=fit.axis_direction)

    def _fit(self, points: np.ndarray, **profile: Any) -> Revolution:
        return fit_revolution(points, self.kind, self.radius, self.axis_point, self.axis_direction, **profile)

    def _known(self) -> tuple[float, np.ndarray, np.ndarray]:
        if self.radius is None or self.axis_point is None or self.axis_direction is None:
            raise InputError(f"surface {self.kind}: radius and axis are not determined yet; call fitted(points) first")
        return self.radius, self.axis_point, self.axis_direction

    def _completed_arc(self, points: np.ndarray, name: str, sign: float, flat: str) -> Any:
        """The shape with its arc fitted: the field `name` is its radius, `sign` +1 of a crown and -1 of a hollow."""
        given = getattr(self, name)
        fit = self._fit(points, curvature=None if given is None else sign / given)
        if given is None:
            straight = rms_distance(points, self._fit(points, curvature=0.0))
            better = rms_distance(points, fit) < BETTER * straight and straight > ROUND_OFF * fit.radius
            if not (better and sign * fit.curvature > 0.0):
                raise InputError(
                    f"surface {self.kind}: the points show no {flat} (a straight profile is off them by "
                    f"{straight:.2g} m, curvature {sign * fit.curvature:.3g} 1/m)"
                )
        found = {"radius": fit.radius, "axis_point": fit.axis_point, "axis_direction": fit.axis_direction}
        return replace(self, **found, **{name: sign / fit.curvature if given is None else given})

    def _arc(self, name: str, sign: float) -> float:
        """Rc [m], signed, of the field `name`."""
        if getattr(self, name) is None:
            raise InputError(f"surface {self.kind}: {name} is not determined yet; call fitted(points) first")
        return sign * getattr(self, name)


STEEPEST = np.tan(np.radians(80.0))  # a steeper profile is an end face, and the chart hardly moves along it
LEVEL = 1e-9  # slope, and drop over length, below which a table is level: round-off of the nodes it would be seen by
BEYOND = 0.01  # of the table's length: how far nodes may lie outside it
DEEPEST = 3.0  # curvature times depth of the profile of its sharpest hollow
LOGARITHMIC_NODES = 129  # with exact slopes: error (step)^4/384 of the fourth derivative, 1e-4 of the end drop or less


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class ProfiledCylinder(RevolutionShape):
    """Outside of a cylinder whose radius drops by a table; other parameters that are None are fitted to the nodes.

    table: arrays (z, drop) or (z, drop, slope) (n,) [m, m, -], z increasing and counted from `axis_point`, drop the
    distance below `radius`. Not symmetric: `axis_direction` should then be given. Other arguments as for `Cylinder`.
    Raises `InputError` for a table that does not rise in z or is of unlike lengths.
    """

    table: Any = None

    kind = "profiled_cylinder"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.table is None:
            raise InputError(f"surface {self.kind}: table is missing, give (z, drop), two arrays in metres")
        try:
            length = len(self.table)
        except TypeError:
            length = 0
        if length not in (2, 3):
            raise InputError(f"surface {self.kind}: table must be (z, drop) or (z, drop, slope)")
        lengths = [np.size(row) for row in self.table]
        if len(set(lengths)) > 1:
            told = " and ".join(f"{n} of {what}" for n, what in zip(lengths, ("z", "drop", "slope"), strict=False))
            raise InputError(f"surface {self.kind}: table needs arrays of one length, got {told}")
        table = require_array(self.table, f"surface {self.kind}: table", (length, None))
        object.__setattr__(self, "table", table)
        self._check_table(table)

    @classmethod
    def logarithmic(
        cls, *, length: float, amplitude: float, end_drop: float, radius: float | None = None, **others: Any
    ) -> ProfiledCylinder:
        """The logarithmic profile of a roller of `length` L [m], `amplitude` A [m] and `end_drop` e [m] at z = +-L/2.

        `radius` and `others` as for the class. Raises `InputError` for numbers that are not positive.
        """
        label = f"surface {cls.kind}: logarithmic"
        L = require_number(length, f"{label} length", positive=True)
        A = require_number(amplitude, f"{label} amplitude", positive=True)
        e = require_number(end_drop, f"{label} end_drop", positive=True)
        most = A * float(np.log1p(STEEPEST * L / (4.0 * A)))  # the end's slope 4 A (exp(e/A) - 1)/L is too steep there
        if not e < most:
            raise InputError(
                f"{label} end_drop must be below {most:.3g} m at an amplitude of {A:g} m, where the ends are too "
                f"steep, got {e:g} m"
            )
        if radius is not None and not e < require_number(radius, f"surface {cls.kind}: radius", positive=True):
            raise InputError(f"{label} end_drop must be below the radius {radius:g} m, got {e:g} m")
        x = np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, LOGARITHMIC_NODES))  # dense at the ends, where it bends most
        q = -np.expm1(-e / A)
        left = 1.0 - q * x**2
        table = (0.5 * L * x, -A * np.log(left), A * 2.0 * q * x / left / (0.5 * L))
        try:
            cls(table=table)
        except InputError:
            raise InputError(
                f"{label} end_drop {e:g} m is too much for an amplitude of {A:g} m: the ends are sharper than the "
                f"{LOGARITHMIC_NODES} points of the table can represent; use a smaller end_drop or a greater amplitude"
            ) from None
        return cls(radius=radius, table=table, **others)

    def profile(self) -> SurfaceProfile:
        breaks, coefficients = self._piecewise
        return replace(super().profile(), breaks=breaks, coefficients=coefficients)

    @cached_property
    def _piecewise(self) -> tuple[np.ndarray, np.ndarray]:
        return _pieces(self.table)

    @property
    def length(self) -> float:
        """Axial length [m] that the table covers."""
        return float(self.table[0, -1] - self.table[0, 0])

    def fitted(self, points: Any, normals: Any = None) -> Any:
        shape = super().fitted(points, normals)
        z = shape.chart(points)[1]
        low, high, margin = self.table[0, 0], self.table[0, -1], BEYOND * self.length
        if z.min() < low - margin or z.max() > high + margin:
            raise InputError(
                f"surface {self.kind}: the facets reach from z = {z.min():.6g} to {z.max():.6g} m, the table only from "
                f"{low:.6g} to {high:.6g} m; extend it, or check axis_point and axis_direction"
            )
        return shape

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        meridian = SurfaceProfile(False, self.side, 0.0, 0.0, 0.0, *self._piecewise)
        known = self.axis_point
        if np.max(np.abs(meridian.slope_at(self.table[0]))) <= LEVEL and np.ptp(self.table[1]) <= LEVEL * self.length:
            return self._completed_level(points)
        fit = self._fit(points, curvature=0.0, table=lambda z: (-meridian.radius_at(z), -meridian.slope_at(z)))
        return replace(self, radius=fit.radius, axis_point=known if known is not None else fit.axis_point,
                       axis_direction=fit.axis_direction)  # fmt: skip

    def _completed_level(self, points: np.ndarray) -> Any:
        """With a table without drop: a cylinder, with the middle of the table in the middle of the nodes."""
        drop, middle = float(np.mean(self.table[1])), 0.5 * float(self.table[0, 0] + self.table[0, -1])
        radius = None if self.radius is None else self.radius - drop
        fit = fit_revolution(points, self.kind, radius, self.axis_point, self.axis_direction, curvature=0.0)
        point = fit.axis_point - middle * fit.axis_direction if self.axis_point is None else self.axis_point
        return replace(self, radius=fit.radius + drop, axis_point=point, axis_direction=fit.axis_direction)

    def _check_table(self, table: np.ndarray) -> None:
        label, z, drop = f"surface {self.kind}: table", table[0], table[1]
        if len(z) < 2:
            raise InputError(f"{label} requires at least two points")
        if not np.all(np.diff(z) > 0.0):
            k = int(np.flatnonzero(np.diff(z) <= 0.0)[0])
            raise InputError(
                f"{label} is not monotonic: z must increase, but entry {k + 2} is {z[k + 1]:g} m after {z[k]:g} m; "
                "sort it, or leave the entry out"
            )
        meridian = SurfaceProfile(False, self.side, 0.0, 0.0, 0.0, *self._piecewise)
        at = np.unique(np.concatenate([z + 0.0, *(z[:-1] + f * np.diff(z) for f in (1e-9, 0.25, 0.5, 0.75, 1 - 1e-9))]))
        slope, bend = meridian.slope_at(at), meridian.bend_at(at)
        worst = int(np.argmax(np.abs(slope)))
        if abs(slope[worst]) > STEEPEST:
            raise InputError(
                f"{label} is too steep at z = {at[worst]:g} m, slope {abs(slope[worst]):.3g} (80 degrees: "
                f"{STEEPEST:.3g}); end it before the end face"
            )
        if self.radius is not None and not np.max(drop) < self.radius:
            raise InputError(f"{label} drops by {np.max(drop):g} m, more than the radius {self.radius:g} m")
        depth, hollow = float(np.ptp(drop)), self.side * bend / (1.0 + slope**2) ** 1.5
        worst = int(np.argmax(hollow))
        if hollow[worst] * depth > DEEPEST:
            raise InputError(
                f"{label} intersects itself: near z = {at[worst]:g} m its hollow has a radius of "
                f"{1.0 / hollow[worst]:.3g} m, too little for the depth of the profile, {depth:.3g} m: its normals "
                "cross; smooth the table there"
            )


def _pieces(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Breaks (n+2,) [m] and coefficients (n+1, 4) of the drop: Hermite pieces between straight ones."""
    z, drop = table[0], table[1]
    slope = table[2] if len(table) == 3 else _pchip_slopes(z, drop)
    h, chord = np.diff(z), np.diff(drop) / np.diff(z)
    pieces = np.stack(
        [
            drop[:-1],
            slope[:-1],
            (3.0 * chord - 2.0 * slope[:-1] - slope[1:]) / h,
            (slope[:-1] + slope[1:] - 2.0 * chord) / h**2,
        ],
        axis=1,
    )
    length = z[-1] - z[0]
    before = [drop[0] - slope[0] * length, slope[0], 0.0, 0.0]
    after = [drop[-1], slope[-1], 0.0, 0.0]
    breaks = np.concatenate([[z[0] - length], z, [z[-1] + length]])
    return breaks, np.vstack([before, pieces, after])


def _pchip_slopes(z: np.ndarray, drop: np.ndarray) -> np.ndarray:
    if len(z) == 2:
        return np.full(2, (drop[1] - drop[0]) / (z[1] - z[0]))
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(z, drop).derivative()(z))
