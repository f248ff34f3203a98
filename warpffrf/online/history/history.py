"""Results of a run: plain NumPy arrays, one row per saved step.

`T` is the number of saved steps. World axes and SI units unless a field says otherwise.
Derived quantities (half-width, peak pressure, fields) are computed in `warpffrf.output`.

Budget line. One line of the error budget of a run, `warpffrf.output.budget`.
"""

from __future__ import annotations

from dataclasses import InitVar, dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.errors import unknown_name
from warpffrf.model.messages import reprs
from warpffrf.model.messages.status import Status
from warpffrf.model.reduced.body import library_versions
from warpffrf.online.history.interface_motion import point_motion, turned

ENERGY_MEANINGS = {
    "kinetic": "rigid motion and global modes",
    "strain": "global modes",
    "contact": "local modes and surface layers, 1/2 s.G.s; lumped contacts",
    "potential": "gravity and springs",
    "force_work": "cumulative work of applied forces",
    "drive_work": "cumulative work of prescribed joint motion",
    "damping": "cumulative energy removed by dampers and modal damping, positive",
    "contact_grid": "cumulative change of the contact energy not balanced by any wrench (grid defect)",
    "numerical": "closes the balance; negative values are numerical dissipation",
    "friction": "cumulative work of friction, never positive",
}
ENERGY_LINES = tuple(ENERGY_MEANINGS)
VERSIONED = ("warpffrf", "warp-lang", "numpy", "scipy")  # packages whose versions a run states


_NOT_RECORDED = np.zeros(0)  # default of arrays that are not given


@dataclass(repr=False)
class BodyHistory(reprs.Rows):
    """Motion of one body at the saved steps, world axes.

    position (T, 3) [m] of the origin of its user frame, rotation (T, 4), unit quaternions (x, y, z, w) from the user
    frame to the world; velocity (T, 3) [m/s] and acceleration (T, 3) [m/s2] of that origin, angular_velocity (T, 3)
    [rad/s], angular_acceleration (T, 3) [rad/s2]; of its m global modes the coordinates modal (T, m) [kg^0.5 m],
    modal_velocity [kg^0.5 m/s] and modal_acceleration [kg^0.5 m/s2]. Values not recorded are NaN.
    """

    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray
    modal: np.ndarray
    acceleration: np.ndarray = field(default_factory=lambda: _NOT_RECORDED)
    angular_acceleration: np.ndarray = field(default_factory=lambda: _NOT_RECORDED)
    modal_velocity: np.ndarray = field(default_factory=lambda: _NOT_RECORDED)
    modal_acceleration: np.ndarray = field(default_factory=lambda: _NOT_RECORDED)

    def __post_init__(self) -> None:
        """Fill values not recorded with NaN."""
        for name in ("acceleration", "angular_acceleration"):
            if getattr(self, name) is _NOT_RECORDED:
                setattr(self, name, np.full(np.shape(self.velocity), np.nan))
        for name in ("modal_velocity", "modal_acceleration"):
            if getattr(self, name) is _NOT_RECORDED:
                setattr(self, name, np.full(np.shape(self.modal), np.nan))


@dataclass(repr=False)
class JointHistory(reprs.Rows):
    """Reaction of one joint on its second body, and its joint coordinates, if any: `named("rotation")`.

    force (T, 3) [N] and torque (T, 3) [N m] about the joint point on the second body, world axes. coordinate and
    second_coordinate (T,) [rad or m], those called by the first and second of `names`, which are coordinate_names:
    "translation", "rotation", "second_rotation", "distance"; NaN where the joint has none.
    """

    coordinate: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    second_coordinate: np.ndarray | None = None
    coordinate_names: InitVar[tuple[str, ...]] = ()

    def __post_init__(self, coordinate_names: tuple[str, ...]) -> None:
        self.names = coordinate_names
        if self.second_coordinate is None:
            self.second_coordinate = np.full(len(self.coordinate), np.nan)

    def named(self, name: str) -> np.ndarray:
        """The coordinate (T,) [m or rad] called `name`; raises `InputError` that lists the existing ones."""
        if name not in self.names:
            raise unknown_name("joint coordinate", name, self.names)
        values = (self.coordinate, self.second_coordinate)[self.names.index(name)]
        return np.asarray(values)


@dataclass(repr=False)
class JointFrictionHistory(reprs.Rows):
    """Friction in one joint, at the sliding surfaces, along the joint's axis and around it; 0 in a constrained
    direction. If their radius is unknown, the values around the axis refer to an arm of 1 m."""

    state: np.ndarray  # (T,) int8: 1 stick, 2 slip, as of contact
    slip_velocity: np.ndarray  # (T, 2) m/s, of the second body against the first
    traction: np.ndarray  # (T, 2) N, on the second body
    bound: np.ndarray  # (T,) N, upper bound of the norm of the traction
    power: np.ndarray  # (T,) W, dissipated in the last step, never negative


@dataclass(repr=False)
class ForceHistory(reprs.Rows):
    """One force element: its force on the loaded body; for an element between two ports on the second body, with the
    opposite on the first.

    force (T, 3) [N] and torque (T, 3) [N m] about the (second) port, of surface and nodal loads about the user origin;
    world axes. deformation (T, k): coordinates of its law [m, rad], as `warpffrf.forces` defines them, k = 0 for loads.
    friction: of friction in a joint its state, else None.
    """

    force: np.ndarray
    torque: np.ndarray
    deformation: np.ndarray
    friction: JointFrictionHistory | None = None


@dataclass(repr=False)
class SensorHistory(reprs.Rows):
    """The `values` (T, components) [`unit`] of one sensor, with its kind, unit, frame of the axes ("world" or "body")
    and names of the components."""

    kind: str
    unit: str
    frame: str
    components: tuple[str, ...]
    values: np.ndarray


@dataclass(repr=False)
class CellHistory(reprs.Rows):
    """Position of the contact-fixed cells of a contact: equal strips across, over `half_width` W on each side
    of the coordinate `column` of the first surface's grid; rows on its meridian."""

    column: np.ndarray  # (T,) of the first surface's contact grid, a real number
    half_width: np.ndarray  # (T,) m
    z: np.ndarray  # (T, rows) m, middles of the rows
    length: np.ndarray  # (T, rows) m, along z
    column_second: np.ndarray  # (T,) opposite, of the second surface's grid, 0 where it is rigid
    row_shift: np.ndarray  # (T, rows) columns of the middle of each row from `column`, 0 but on a helical surface


@dataclass(repr=False)
class FrictionHistory(reprs.Rows):
    """Friction of one contact, in the window of `ContactHistory.pressure`, along (e_theta, t_z) of the first
    surface: circumferential and meridional."""

    traction: np.ndarray  # (T, 2, columns, rows) Pa, on the first body
    slip_velocity: np.ndarray  # (T, 2, columns, rows) m/s, of the first surface against the second, 0 where open
    state: np.ndarray  # (T, columns, rows) int8: 0 open, 1 stick, 2 slip
    power: np.ndarray  # (T,) W, dissipated in the last step, never negative
    creep_velocity: np.ndarray  # (T, 2) m/s, of the surfaces as rigid bodies, at the patch
    rolling_velocity: np.ndarray  # (T,) m/s, mean of both surfaces through the patch, along e_theta
    cells_per_step: np.ndarray  # (T,) most columns that the patch advanced in a step since the last saved row


@dataclass(repr=False)
class ContactHistory(reprs.Rows):
    """One contact. Pressure refers to nodes of the first body's contact grid, loads of the second to its own grid."""

    force: np.ndarray  # (T, 3) N, on the first body
    torque: np.ndarray  # (T, 3) N m, on the first body, about its user origin
    force_second: np.ndarray  # (T, 3) N, on the second body, integrated on its own surface
    torque_second: np.ndarray  # (T, 3) N m, about the second body's user origin
    first_column: (
        np.ndarray
    )  # (T,) int, grid column of pressure[:, 0] on the first surface (modulo the columns of the full circumference)
    center_column: np.ndarray  # (T,) float, grid column coordinate of the line of centres on the first surface
    pressure: np.ndarray  # (T, columns, rows) Pa, nodal values in the window
    first_column_second: np.ndarray  # (T,) int
    load_second: np.ndarray  # (T, columns2, rows2) N, nodal forces on the second surface, positive inwards
    approach: np.ndarray  # (T,) m, rigid approach at mid-width: sum of radii minus the distance of the axes
    # ... or minus the smallest undeformed gap with closest-point kinematics
    active_nodes: np.ndarray  # (T,) int
    friction: FrictionHistory | None = None  # None if frictionless
    cells: CellHistory | None = None  # if `pressure` is constant on contact-fixed cells


@dataclass(repr=False)
class LumpedHistory(reprs.Rows):
    """One lumped contact; world axes. If the surfaces are apart, the forces are zero and the place is the closest
    point.

    On the first body: force (T, 3) [N], normal and friction, torque (T, 3) [N m] about its user origin, friction_force
    (T, 3) [N], moment (T, 3) [N m] against rolling and pivoting, included in the torque. place (T, 3) [m]: point of
    action of the force, with laminae the mean of their points weighted by their forces. approach (T,) [m] of the
    undeformed surfaces, the largest of all laminae, negative where apart. normal_force (T,) [N]; slip_velocity (T, 3)
    [m/s] of the first surface against the second at the place, tangential; lamina_force (T, laminae) [N], the normal
    force of each, one column for a law without laminae.
    """

    force: np.ndarray
    torque: np.ndarray
    place: np.ndarray
    approach: np.ndarray
    normal_force: np.ndarray
    friction_force: np.ndarray
    slip_velocity: np.ndarray
    lamina_force: np.ndarray
    moment: np.ndarray


@dataclass(repr=False)
class SmallSlidingHistory(reprs.Rows):
    """One small-sliding contact: fields on its cells (c), in their frames (n, t_1, t_2), which rotate with body 1."""

    force: np.ndarray  # (T, 3) N, on the first body, world axes; the opposite acts on the second
    torque: np.ndarray  # (T, 3) N m, on the first body, about its user origin, world axes
    normal_force: np.ndarray  # (T,) N, sum over cells, irrespective of direction
    pressure: np.ndarray  # (T, c) Pa
    traction: np.ndarray  # (T, c, 2) Pa, on the first face along t_1, t_2
    gap: np.ndarray  # (T, c) m
    slip: np.ndarray  # (T, c, 2) m, accumulated, first relative to second, along t_1, t_2; includes sliding while open
    state: np.ndarray  # (T, c) 0 open, 1 stick, 2 slip
    loss: np.ndarray  # (T, c) J, accumulated friction loss


@dataclass(repr=False)
class FilmHistory(reprs.Rows):
    """One oil film. Fields are given at the nodes of the contact grid of the first surface."""

    force: np.ndarray  # (T, 3) N, on the first body, shear included; the opposite acts on the second
    torque: np.ndarray  # (T, 3) N m, on the first body, about its user origin
    torque_second: np.ndarray  # (T, 3) N m, on the second body, about its user origin, of the ground the world's
    smallest_gap: np.ndarray  # (T,) m, at a point of the film; of quadrature "reduced" around nodes, the ends with them
    largest_pressure: np.ndarray  # (T,) Pa
    pressure_loss: np.ndarray  # (T,) W, dissipated by pressure-driven flow, closing cavities and feeds
    friction_power: np.ndarray  # (T,) W, dissipated by sliding
    feed_flow: np.ndarray  # (T,) m3/s, of oil in through feeds; NaN of quadrature "reduced"
    end_flow: np.ndarray  # (T,) m3/s, of oil out at the ends; likewise
    void_fraction: np.ndarray  # (T,) volume of cavities divided by that of the gap
    oil_volume: np.ndarray  # (T,) m3 in the film, at the density without pressure
    asperity_force: np.ndarray  # (T,) N, normal force of the asperities, irrespective of direction
    largest_asperity_pressure: np.ndarray  # (T,) Pa
    eccentricity: np.ndarray  # (T, 2) m, axis of the inner surface relative to that of the outer, as rigid bodies, at
    # ... the middle of the grid along e_0 and e_1 of the first surface's shape, rotating with it; NaN for a plane
    pressure: np.ndarray  # (T, columns, rows) Pa
    gap: np.ndarray  # (T, columns, rows) m
    void: np.ndarray  # (T, columns, rows) m, cavity volume per area
    asperity: np.ndarray  # (T, columns, rows) Pa, pressure of the asperities, in addition to that of the oil
    load_second: np.ndarray | None = None  # (T, columns2, rows2) N, nodal forces on a flexible second surface, inwards
    # --- of films with a temperature, None of isothermal ones
    temperature: np.ndarray | None = None  # (T, columns, rows) degC, mean across the gap
    inlet_temperature: np.ndarray | None = None  # (T,) degC, of oil that enters at feeds and leading edges
    heat_generated: np.ndarray | None = None  # (T,) W, by sliding, flow, closing cavities and asperities
    heat_carried: np.ndarray | None = None  # (T,) W, by oil that leaves, above the supply's, less that of oil entering
    heat_to_a: np.ndarray | None = None  # (T,) W, conducted into the first surface
    heat_to_b: np.ndarray | None = None  # (T,) W, into the second surface
    heat_stored: np.ndarray | None = None  # (T,) W, by the oil in the film

    @property
    def fill(self) -> np.ndarray:
        """(T, columns, rows) film fraction of the gap, 1 without cavity."""
        part = np.zeros_like(self.gap)
        np.divide(self.void, self.gap, out=part, where=self.gap > 0.0)
        return 1.0 - part


@dataclass(repr=False)
class History(reprs.Shown):
    """A run: histories, the energy ledger, solver counts, status, and the state to continue from."""

    scene: Any  # the Scene of the run, or its description from a file
    time: np.ndarray  # (T,) s
    step_size: np.ndarray  # (T,) s, size of the step that led here (0 in the first row)
    bodies: dict[str, BodyHistory]
    joints: dict[str, JointHistory]
    contacts: dict[str, ContactHistory]
    energy: dict[str, np.ndarray]  # ENERGY_LINES -> (T,) J
    iterations: np.ndarray  # (T,) int, Newton iterations of the step
    factorisations: np.ndarray  # (T,) int, factorisations of the active contact block in the step
    status: str = Status.COMPLETED
    message: str = ""
    counters: dict[str, float] = field(
        default_factory=dict
    )  # steps, rejected_steps, max_iterations, seconds_in_graph, ...
    notes: list[str] = field(
        default_factory=list
    )  # dropped terms, capped counts, fallbacks: printed by Result.report()
    forces: dict[str, ForceHistory] = field(default_factory=dict)
    lumped_contacts: dict[str, LumpedHistory] = field(default_factory=dict)
    small_sliding: dict[str, SmallSlidingHistory] = field(default_factory=dict)
    films: dict[str, FilmHistory] = field(default_factory=dict)
    sensors: dict[str, SensorHistory] = field(default_factory=dict)
    checkpoint: dict[str, np.ndarray] = field(default_factory=dict)  # the complete device state at the end
    options: dict[str, str] = field(default_factory=dict)  # of `simulate`, name -> value as text
    samples: Any = None  # intermediate states, `online.samples.Samples`, only for a run in this process
    cell_checks: dict[int, Any] = field(default_factory=dict)  # by contact, `online.diagnosis.cell_check`, as samples
    film_checks: dict[str, Any] = field(default_factory=dict)  # by film, `online.diagnosis.film_notes`, likewise
    film_grids: dict[str, Any] = field(default_factory=dict)  # by film, `online.diagnosis.film_grid`, likewise
    budget: list[BudgetLine] = field(default_factory=list)  # the errors of the run, once evaluated
    versions: dict[str, str] = field(default_factory=lambda: library_versions(VERSIONED))  # of the run, by package
    stopping: bool = False  # True if Ctrl-C was pressed while the run finished: nothing further may start

    def motion(
        self, port: Port, *, point: np.ndarray | None = None, frame: str = "world"
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position [m], velocity [m/s] and acceleration [m/s2] (T, 3) of a `port`, or of the `point` (3,) [m, user
        frame] that moves with its interface or body. frame: axes of the components, "world" or "body"."""
        found = point_motion(port, np.asarray(port.point if point is None else point), self.bodies, len(self.time))
        if frame == "world":
            return found
        back = self.bodies[port.body.name].rotation * np.array([-1.0, -1.0, -1.0, 1.0])
        x, v, a = (turned(back, value) for value in found)
        return x, v, a

    def shown(self) -> dict[str, Any]:
        """Status and contents, name -> value, for a table."""
        kinds = ("bodies", "joints", "forces", "contacts", "lumped_contacts", "films", "small_sliding", "sensors")
        found = {kind: reprs.names(getattr(self, kind)) for kind in kinds if getattr(self, kind)}
        message = {"message": self.message} if self.message else {}
        return {"status": self.status, **message, "rows": len(self.time), **found}

    _facts = shown


@dataclass(frozen=True)
class BudgetLine:
    """Effect of one source of error on one quantity of a run.

    size: a fraction of the quantity `of`, NaN if it could not be determined; `basis` states how it was determined,
    or why not, `cure` how to reduce it. share: of a deformation its part of the largest displacement, or of the
    energy, in the machine, the larger.
    """

    source: str
    of: str
    size: float
    basis: str
    cure: str = ""
    share: float = 1.0

    @property
    def found(self) -> bool:
        """Whether there is a size."""
        return bool(np.isfinite(self.size))
