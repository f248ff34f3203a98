r"""Quantities of every contact of a run, for any grid of its pressure: forces, moments of the patch, and the Hertz
solution.

The classes for the grids are `result.ContactResult`, nodes of the first body's contact grid, and
`cell_result.CellContactResult`, cells that move with the patch. A grid class provides the positions of columns and rows
and the pressures, and integrates them; everything else is here.
"""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.model.surfaces.form_deviations import MeasuredForm
from warpffrf.output.contact.friction import FrictionResult
from warpffrf.output.contact.hertz import (
    HertzLine,
    HertzPoint,
    effective_modulus,
    effective_radius,
    hertz,
    inapplicable,
    pair_curvature,
    patch_kind,
)
from warpffrf.output.contact.patch_moments import Moments
from warpffrf.output.contact.stress_error import StressError
from warpffrf.output.contact.wear import wear
from warpffrf.output.exposed_histories import Recorded
from warpffrf.output.geometry.places import Pose, grid_theta_offset
from warpffrf.output.geometry.scene_view import PairView

log = logging.getLogger("warpffrf")


class PatchPressure(NamedTuple):
    """Pressure of one saved step, at the nodes of the first body's contact grid or at cell centres."""

    theta: np.ndarray  # (columns,) rad (m on a plane), grid angle on the first surface, increasing, not wrapped
    arc: np.ndarray  # (columns,) m, along the mid-width circle, from the line of centres
    z: np.ndarray  # (rows,) m, along the axis of the first surface
    pressure: np.ndarray  # (columns, rows) Pa


class LineMoments(NamedTuple):
    """Line load, centre and half-width of the pressures in one section, each (T,); zero without contact."""

    load: np.ndarray  # N/m
    center: np.ndarray  # m
    half_width: np.ndarray  # m, twice the root of the second moment


def section_moments(x: np.ndarray, p: np.ndarray, h: Any, own: float) -> LineMoments:
    """Moments of pressures p (T, n) [Pa] at x (T, n) or (n,) [m], with shape functions of spacing h [m], a number or
    (T,), whose second moment about their own centre is `own` h^2."""
    h = np.asarray(h, dtype=float)
    total = p.sum(axis=-1)
    touching = total > 0.0
    safe = np.where(touching, total, 1.0)
    center = np.where(touching, (p * x).sum(axis=-1) / safe, 0.0)
    second = (p * ((x - center[..., None]) ** 2 + own * (h * h)[..., None])).sum(axis=-1) / safe
    half_width = np.where(touching, 2.0 * np.sqrt(np.maximum(second, 0.0)), 0.0)
    return LineMoments(h * total, center, half_width)


def vertex(x: np.ndarray, p: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Positions (T,) of the largest value of parabolas through the samples p (T, n) at x (T, n), ascending, before, at
    and after the largest one `at` (T,); that of the sample itself where a neighbour is zero or missing."""
    steps, before, after = np.arange(len(x)), np.maximum(at - 1, 0), np.minimum(at + 1, x.shape[1] - 1)
    (x0, x1, x2), (p0, p1, p2) = ([values[steps, n] for n in (before, at, after)] for values in (x, p))
    inside = (before < at) & (at < after) & (p0 > 0.0) & (p2 > 0.0)
    rise = np.divide(p1 - p0, x1 - x0, out=np.zeros_like(p1), where=inside)
    bend = np.divide(p2 - p1, x2 - x1, out=np.zeros_like(p1), where=inside) - rise
    inside &= bend < 0.0
    return np.where(inside, 0.5 * (x0 + x1) - 0.5 * rise * (x2 - x0) / np.where(inside, bend, 1.0), x1)


class PairResult(reprs.Shown, ABC):
    """One contact of a run; arrays have one row per saved step.

    Forces act on the contact's first body in world axes, torques about that body's user origin. `friction` has
    tractions, slip and creepage of a contact with friction.
    """

    loaded = "nodes"  # carrier of the pressure

    _hidden = frozenset(
        {
            "history", "view", "bodies", "loaded", "side", "moments", "cell_lines", "reaches_ends", "in_section",
            "section_row", "patch_center", "creep_place", "ends", "window", "rows", "cell_areas", "spacing", "measure",
            "mid_radius", "places",
        }
    )  # fmt: skip

    force = Recorded("(T, 3) N, the force on the first body, world axes: pressures and tractions of the pair together.")
    torque = Recorded("(T, 3) N m, its torque on the first body about that body's user origin, world axes.")
    force_second = Recorded(
        "(T, 3) N, the force on the second body, world axes, integrated on its own surface: the opposite of `force` up "
        "to the difference of the two grids."
    )
    torque_second = Recorded(
        "(T, 3) N m, its torque on the second body about that body's user origin, of the ground about the world's, "
        "world axes."
    )
    approach = Recorded(
        "(T,) m, approach of the bodies beyond undeformed contact: for parallel axes the sum of the radii minus the "
        "distance of the axes at mid-width, for closest points minus the smallest undeformed gap. Negative if they are "
        "apart; on an extruded surface at least minus the length of its curve."
    )
    active_nodes = Recorded("(T,) number of active nodes of the contact grid, or of loaded cells.")

    def __init__(
        self, history: Any, view: PairView, bodies: dict[str, Any] | None = None, time: np.ndarray | None = None
    ) -> None:
        """bodies: motions by name, `History.bodies`; without them both user frames are at the world's origin. time (T,)
        [s]: required by `wear`."""
        self.history = history
        self.view = view
        self.name = view.name
        self.bodies = bodies or {}
        self.time = np.zeros(0) if time is None else time  # (T,) s

    def _facts(self) -> dict[str, Any]:
        touch = int(np.count_nonzero(self.touching))
        facts = {"name": self.name, "rows": len(self.force), "touching": f"in {touch} rows", "patch": self.patch_kind}
        return {**facts, "friction": self.has_friction}

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N, the length of `force`."""
        return np.linalg.norm(self.force, axis=1)

    @property
    def has_friction(self) -> bool:
        """True for a contact with friction, whose `friction` is available."""
        return getattr(self.history, "friction", None) is not None

    @cached_property
    def friction(self) -> FrictionResult:
        """Tractions, slip, stick and slip areas, creepages, forces and spin moment, T-gamma, power and wear index;
        raises `InputError` for a contact without friction."""
        return FrictionResult(self)

    def wear(self, coefficient: Any, *, repetitions: float = 1.0) -> tuple[MeasuredForm | None, MeasuredForm | None]:
        """Depth that both surfaces wear by during the saved rows, by Archard's law, coefficient times int p |w| dt with
        pressure p and slip speed |w|; forms of `warpffrf.films`, for `body["rim"].add_form(form)` in the next run.

        coefficient [m2/N, the same as m3/(N m)]: specific wear coefficient, one number or (first, second); a surface
        with 0 does not wear, its form is None. repetitions: of the run, each with the same wear. The depth depends on z
        of a surface of revolution, as its mean around, and on the length u along the curve of an extruded one, as the
        mean over the width covered. Its volume is exactly coefficient * repetitions * int p |w| dA dt, friction work
        over coefficient of friction. Raises `InputError` without friction, without slip, and for planes and hollow
        surfaces of revolution with a coefficient above 0.

        `MeasuredForm.values` are the depths [m] at `z`, of an extruded surface at `theta` [m], its u.
        """
        return wear(self, self.time, coefficient, repetitions)

    # --- the grid on the first surface ---

    @property
    @abstractmethod
    def z(self) -> np.ndarray:
        """Positions [m] of the rows of pressures along the axis of the first surface: (rows,) for fixed nodes, (T,
        rows) for cells; `rows` has the second form for both."""

    @property
    @abstractmethod
    def spacing(self) -> Any:
        """Arc [m] between columns of pressures: a number for nodes, (T,) for cells."""

    @property
    @abstractmethod
    def rows(self) -> np.ndarray:
        """(T, rows) m along the axis of the first surface, positions of the rows of pressures."""

    @property
    @abstractmethod
    def arc(self) -> np.ndarray:
        """(T, columns) m, positions of the columns of pressures along the mid-width circle, from the line of
        centres."""

    @property
    @abstractmethod
    def theta(self) -> np.ndarray:
        """(T, columns) rad (m on a plane), positions of the columns of pressures on the first surface's grid."""

    @property
    @abstractmethod
    def cell_areas(self) -> np.ndarray:
        """(T, rows) m2, areas of the cells of one column, on which tractions are constant."""

    @property
    @abstractmethod
    def patch_center(self) -> np.ndarray:
        """(T, 2) theta [rad, m on a plane] on the first surface's grid and z [m] of the point of least distance of the
        surfaces, the reference of creep and spin, see `creep`."""

    @property
    @abstractmethod
    def creep_place(self) -> np.ndarray:
        """(T, 2) theta [rad, m on a plane] and z [m], as for `patch_center`, of the point where the run records the
        creep."""

    @property
    @abstractmethod
    def window(self) -> float:
        """Half the arc [m] with pressures, the longest of the run."""

    @property
    def ends(self) -> tuple[float, float]:
        """Ends [m] of the first surface's contact grid along its axis."""
        z = self.view.first.grid.z
        return float(z[0]), float(z[-1])

    @abstractmethod
    def cell_lines(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Lines between the cells of saved step `i`, with the outermost ones: arc (columns + 1,) [m] from the line of
        centres, and z (rows + 1,) [m]."""

    @abstractmethod
    def reaches_ends(self, i: int) -> bool:
        """True if the patch of saved step `i` reaches both ends of an arc, to within a column."""

    @property
    def side(self) -> float:
        """+1 if e_theta of the first surface, direction 0 of tractions, points to increasing arc, -1 on an inside form,
        where it points to decreasing arc."""
        return float(self.view.first.shape.side)

    # --- pressure ---

    @cached_property
    def touching(self) -> np.ndarray:
        """(T,) bool, whether any pressure is positive."""
        return np.any(self.history.pressure > 0.0, axis=(1, 2))

    @cached_property
    def open_times(self) -> np.ndarray:
        """(n, 2) s, begin and end of each time without contact: the first saved row without pressure and the next one
        with it, at the end of the run the last row."""
        shut = np.concatenate([[True], self.touching, [True]]).astype(int)
        begin, end = (np.flatnonzero(np.diff(shut) == sign) for sign in (-1, 1))
        return np.stack([self.time[begin], self.time[np.minimum(end, len(self.time) - 1)]], axis=1)

    @cached_property
    def second_place(self) -> np.ndarray:
        """(T, 2) where the centre of pressure lies on the second surface: theta [rad] from its direction e_0, of an
        extruded surface the length u along its curve [m], of a plane m, and z [m] along its axis; NaN without
        contact."""
        first, second = self.view.first, self.view.second
        arc, z = self.center_of_pressure.T
        theta = first.grid.theta_start + first.grid.pitch * np.asarray(self.history.center_column, dtype=float)
        theta = theta + grid_theta_offset(first) + arc / np.asarray(first.shape.radius_at(z))
        points, found = first.shape.point(theta, z), np.full((len(z), 2), np.nan)
        names = self.view.first_body.name, self.view.second_body.name
        for i in np.flatnonzero(self.touching):
            one, two = (Pose.of(self.bodies, name, int(i)) for name in names)
            found[i] = np.ravel(second.shape.chart(two.to_user(one.to_world(points[i : i + 1])))[:2])
        return found

    @property
    @abstractmethod
    def mean_pressure(self) -> np.ndarray:
        """(T, columns, rows) Pa, pressure of each node or cell."""

    @property
    @abstractmethod
    def moments(self) -> Moments:
        """Load, centre and covariance of the whole patch."""

    @property
    @abstractmethod
    def _line(self) -> LineMoments:
        """Moments of the section."""

    @property
    @abstractmethod
    def patch_area(self) -> np.ndarray:
        """(T,) m2, area of the cells with positive pressure: to within half a cell along the edge of the patch."""

    @property
    @abstractmethod
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure in the patch."""

    @cached_property
    def peak_position(self) -> np.ndarray:
        """(T, 3) m, user frame of the first body: point of its undeformed surface with the largest pressure, by
        parabolas through the largest node or cell across the patch, for a point contact also along the meridian; NaN
        without contact."""
        p, surface = self.mean_pressure, self.view.first
        steps = np.arange(len(p))
        j, k = np.unravel_index(np.argmax(p.reshape(len(p), p.shape[1] * p.shape[2]), axis=1), p.shape[1:])
        theta, z = vertex(self.theta, p[steps, :, k], j), self.rows[steps, k]
        if self.patch_kind == "point":
            z = vertex(self.rows, p[steps, j], k)
        points = surface.shape.point(theta + grid_theta_offset(surface), z)
        return np.where(self.touching[:, None], points, np.nan)

    @property
    @abstractmethod
    def mid_peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure in the section of `mid_pressure`: for comparison with Hertz."""

    @abstractmethod
    def pressure_resultants(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Factors of the force and torque of the pressure, with shape functions psi_j of theta and zeta_k of z: the
        length (T,) [-] of int psi_j e_r dtheta, int psi_j dtheta (T,) [rad], and (T, 3, rows) of each zeta_k the
        integrals of R, R R' and (z + R R') R [m2, m2, m3]."""

    @cached_property
    def _section(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows (T,) around the section of each saved step and the weight of the second: mid-width, for a point contact
        the centre of pressure."""
        z = self.rows
        steps = np.arange(len(z))
        if z.shape[1] == 1:
            return 0 * steps, 0 * steps, 0.0 * steps
        at = 0.5 * (z[:, 0] + z[:, -1])
        if self.patch_kind == "point":
            at = np.where(self.touching, self.moments.center[:, 1], at)
        k = np.clip((z <= at[:, None]).sum(axis=1) - 1, 0, z.shape[1] - 2)
        return k, k + 1, (at - z[steps, k]) / (z[steps, k + 1] - z[steps, k])

    def in_section(self, values: np.ndarray, steps: slice = slice(None)) -> np.ndarray:
        """(n, columns) of values (n, columns, rows) at the saved `steps`: along the arc at mid-width, for a point
        contact through the centre of pressure."""
        k, k1, w = (part[steps] for part in self._section)
        i = np.arange(len(values))
        return (1.0 - w)[:, None] * values[i, :, k] + w[:, None] * values[i, :, k1]

    def section_row(self, i: int) -> int:
        """The grid row nearest to the section at saved step `i`."""
        k, k1, w = (part[i] for part in self._section)
        return int(k1 if w > 0.5 else k)

    @cached_property
    def mid_pressure(self) -> np.ndarray:
        """(T, columns) Pa, `mean_pressure` at mid-width, for a point contact through the centre of pressure."""
        return self.in_section(self.mean_pressure)

    @property
    def normal_load(self) -> np.ndarray:
        """(T,) N, integral of the pressure over the surface."""
        return self.moments.load

    @property
    def line_load(self) -> np.ndarray:
        """(T,) N/m, integral of the pressure across the patch at mid-width, for a point contact through its centre."""
        return self._line.load

    @property
    def center(self) -> np.ndarray:
        """(T,) m of arc, centre of the pressure at mid-width, for a point contact of the whole patch, from the line of
        centres."""
        return self.moments.center[:, 0] if self.patch_kind == "point" else self._line.center

    @property
    def center_of_pressure(self) -> np.ndarray:
        """(T, 2) m, of the whole patch: arc from the line of centres, and z; (0, mid-width) without contact."""
        return self.moments.center

    @property
    def half_width(self) -> np.ndarray:
        """(T,) m, along the arc: twice the root of the second moment of the mid-width pressure; for a point or flat
        contact that of the whole patch, `half_widths[:, 0]`; for a line along the arc `half_widths[:, 1]`; 0 without
        contact."""
        if self.patch_kind == "line":
            return self._line.half_width
        return self.half_widths[:, 1 if self.patch_kind == "line_around" else 0]

    @cached_property
    def half_widths(self) -> np.ndarray:
        """(T, 2) m, along e_theta and t_z, from the second moments of the whole patch; 0 without contact. For a skewed
        ellipse these are the sides of its bounding rectangle; see `semi_axes`."""
        return self.moments.half_widths(self.patch_kind)

    @property
    def semi_axes(self) -> np.ndarray:
        """(T, 2) m, the larger first, of the ellipse of a point contact with the second moments of the patch."""
        return self.moments.principal()[0]

    @property
    def patch_angle(self) -> np.ndarray:
        """(T,) rad, direction of the larger of `semi_axes`, from e_theta towards t_z."""
        return self.moments.principal()[1]

    def pressure(self, i: int) -> PatchPressure:
        """Pressure of the nodes or cells of saved step `i`, with positions."""
        return PatchPressure(self.theta[i], self.arc[i], self.rows[i], self.mean_pressure[i])

    # --- against Hertz ---

    def curvature(self, i: int) -> np.ndarray:
        """(2, 2) 1/m, relative curvature of the true surfaces along (e_theta, t_z) at the patch of saved step `i`: the
        gap is 1/2 x.K.x."""
        return pair_curvature(self, i)

    @cached_property
    def patch_kind(self) -> str:
        """One of "line", "line_around" (the line is along the arc), "point" or "flat", see `hertz`; at the largest load
        of the run."""
        return patch_kind(self)

    @cached_property
    def effective_radius(self) -> float:
        """1/(1/R1 + 1/R2) across the patch [m], negative for inside forms, at the largest load of the run; NaN without
        relative curvature across it."""
        return effective_radius(self)

    @cached_property
    def effective_modulus(self) -> float:
        """E* [Pa] of the contact, from the materials in the reduced bodies' provenance; a rigid body does not
        contribute."""
        return effective_modulus(self.view)

    def hertz(self, i: int) -> HertzLine | HertzPoint:
        """Hertz solution in saved step `i`: of a line at the computed line load at mid-width, of a point at the load.

        Without contact, and where the theory does not apply (flat faces, conforming surfaces, a line along the arc, a
        layer that is thin compared with the patch), its numbers are NaN, its `reason` states why, and a warning is
        issued.
        """
        try:
            return hertz(self, i)
        except InputError as error:
            log.warning("%s", error)
            return inapplicable(self.patch_kind, str(error))

    @abstractmethod
    def stress_errors(self, i: int) -> dict[str, StressError]:
        """Errors of the von Mises stress below the line in saved step `i`, and of the depth of its maximum, by flexible
        body; NaN, with the reason, if unknown."""

    def hertz_pressure(self, i: int, x: np.ndarray) -> np.ndarray:
        """Hertz pressure (n,) [Pa] at arc positions `x` (n,) [m] in the section of `mid_pressure`, about the computed
        centre in step `i`."""
        found = self.hertz(i)
        reach = found.section if isinstance(found, HertzPoint) else found.half_width
        return found.peak_pressure * np.sqrt(np.maximum(0.0, 1.0 - ((x - self.center[i]) / reach) ** 2))
