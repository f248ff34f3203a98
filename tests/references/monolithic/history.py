"""Results of a monolithic run: arrays with one row per saved step, named as in `warpffrf.online.history.history`."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from references.monolithic.core.state import State


@dataclass
class BodyMotion:
    """User-frame motion of a body; fields as in `warpffrf.online.history.history.BodyHistory`, world axes."""

    position: np.ndarray  # (T, 3) m
    rotation: np.ndarray  # (T, 4)
    velocity: np.ndarray  # (T, 3) m/s
    angular_velocity: np.ndarray  # (T, 3) rad/s
    modal: np.ndarray  # (T, m)
    acceleration: np.ndarray  # (T, 3) m/s2
    angular_acceleration: np.ndarray  # (T, 3) rad/s2
    modal_velocity: np.ndarray  # (T, m)
    modal_acceleration: np.ndarray  # (T, m)


@dataclass
class ContactForces:
    """A contact pair; fields as in `warpffrf.online.history.history.ContactHistory`, and those of this solver only."""

    force: np.ndarray  # (T, 3) N, on the first body
    torque: np.ndarray  # (T, 3) N m, about its user origin
    force_second: np.ndarray  # (T, 3) N
    torque_second: np.ndarray  # (T, 3) N m
    first_column: np.ndarray  # (T,) int
    center_column: np.ndarray  # (T,)
    pressure: np.ndarray  # (T, columns, rows) Pa; of law "nodes" see `line_of_centres.record`
    first_column_second: np.ndarray  # (T,) int
    load_second: np.ndarray  # (T, columns, rows) N
    approach: np.ndarray  # (T,) m
    active: np.ndarray  # (T,) int, active tests
    pressures: list[dict[int, float]]  # multiplier by number of the test: Pa for a grid node, N for an FE node
    local: tuple[np.ndarray, np.ndarray]  # local coordinates (T, n) of both surfaces, of each with its body's others
    friction: dict[str, np.ndarray] | None = None  # fields of `warpffrf.online.history.history.FrictionHistory`


@dataclass
class FilmForces:
    """An oil film; fields as in `warpffrf.online.history.history.FilmHistory`, of asperities none."""

    force: np.ndarray  # (T, 3) N, on the first body
    torque: np.ndarray  # (T, 3) N m, about its user origin
    torque_second: np.ndarray  # (T, 3) N m
    smallest_gap: np.ndarray  # (T,) m
    largest_pressure: np.ndarray  # (T,) Pa
    pressure_loss: np.ndarray  # (T,) W
    friction_power: np.ndarray  # (T,) W
    feed_flow: np.ndarray  # (T,) m3/s
    end_flow: np.ndarray  # (T,) m3/s
    void_fraction: np.ndarray  # (T,)
    oil_volume: np.ndarray  # (T,) m3
    pressure: np.ndarray  # (T, columns, rows) Pa
    gap: np.ndarray  # (T, columns, rows) m
    void: np.ndarray  # (T, columns, rows) m


@dataclass
class MonolithicHistory:
    """A monolithic run. `energy` has "kinetic", "strain", "contact", "potential" [J], and with the law at nodes of true
    shapes "friction" (cumulative work, not positive) and "layer" (cumulative loss of layers). `spring_rows` (T,
    coordinates, 7): value, force and torque on the second body of every coordinate of every spring law, in the order of
    the forces. `tensions`: name -> (T, 7), the same for every pretension. `dropped`: rows of joints omitted as
    redundant."""

    scene: object
    time: np.ndarray
    step_size: np.ndarray
    bodies: dict[str, BodyMotion]
    reactions: dict[str, tuple[np.ndarray, np.ndarray]]  # joint -> force, torque (T, 3) on its second body at its point
    contacts: dict[str, ContactForces]
    energy: dict[str, np.ndarray]
    iterations: np.ndarray
    factorisations: np.ndarray
    status: str = "completed"
    message: str = ""
    notes: list[str] = field(default_factory=list)
    counters: dict[str, float] = field(default_factory=dict)
    final: State | None = None  # for continuation
    spring_rows: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 7)))
    dropped: list = field(default_factory=list)
    tensions: dict[str, np.ndarray] = field(default_factory=dict)
    films: dict[str, FilmForces] = field(default_factory=dict)
