"""What a run leaves behind: plain NumPy arrays, one row per saved step, no behaviour.

`T` is the number of saved steps. World axes and SI units unless a field says otherwise.
Everything that can be derived from these arrays (half-width, peak pressure, fields) is derived in `warpffrf.output`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

ENERGY_LINES = (
    "kinetic",  # rigid motion and global modes
    "strain",  # global modes
    "contact",  # local modes and surface layers, 1/2 s.G.s
    "potential",  # gravity and springs
    "force_work",  # cumulative work of applied forces
    "drive_work",  # cumulative work of prescribed joint motion
    "damping",  # cumulative energy removed by dampers and modal damping, positive
    "contact_grid",  # cumulative change of the contact energy that no wrench accounts for (grid defect)
    "numerical",  # what closes the balance; negative values are numerical dissipation
)


@dataclass
class BodyHistory:
    """Motion of one body: user-frame origin, orientation, velocities, modal coordinates."""

    position: np.ndarray  # (T, 3) m, origin of the user frame
    rotation: np.ndarray  # (T, 4) unit quaternion (x, y, z, w), user frame -> world
    velocity: np.ndarray  # (T, 3) m/s, of the user origin
    angular_velocity: np.ndarray  # (T, 3) rad/s
    modal: np.ndarray  # (T, m) global modal coordinates, kg^0.5 m


@dataclass
class JointHistory:
    """Reaction of one joint on its second body, and the joint coordinate where it has one."""

    coordinate: np.ndarray  # (T,) rad or m; NaN where the joint has none
    force: np.ndarray  # (T, 3) N
    torque: np.ndarray  # (T, 3) N m, about the joint point on the second body


@dataclass
class ContactHistory:
    """One contact pair. Pressure lives on the hats of the first body's contact grid, loads of the second on its own."""

    force: np.ndarray  # (T, 3) N, on the first body
    torque: np.ndarray  # (T, 3) N m, on the first body, about its user origin
    force_second: np.ndarray  # (T, 3) N, on the second body, integrated on its own surface
    torque_second: np.ndarray  # (T, 3) N m, about the second body's user origin
    first_column: (
        np.ndarray
    )  # (T,) int, grid column of pressure[:, 0] on the first surface (modulo the columns of the full turn)
    center_column: np.ndarray  # (T,) float, grid column coordinate of the line of centres on the first surface
    pressure: np.ndarray  # (T, columns, rows) Pa, hat coefficients in the window
    first_column_second: np.ndarray  # (T,) int
    load_second: np.ndarray  # (T, columns2, rows2) N, hat forces on the second surface, positive inwards
    approach: np.ndarray  # (T,) m, rigid approach at mid-width: sum of radii minus the distance of the axes
    active_modes: np.ndarray  # (T,) int


@dataclass
class History:
    """A run: histories, the energy ledger, solver counts, status, and the state to continue from."""

    scene: object  # the Scene that was run
    time: np.ndarray  # (T,) s
    step_size: np.ndarray  # (T,) s, size of the step that led here (0 in the first row)
    bodies: dict[str, BodyHistory]
    joints: dict[str, JointHistory]
    contacts: dict[str, ContactHistory]
    energy: dict[str, np.ndarray]  # ENERGY_LINES -> (T,) J
    iterations: np.ndarray  # (T,) int, Newton iterations of the step
    factorisations: np.ndarray  # (T,) int, factorisations of the active contact block in the step
    status: str = (
        "completed"  # completed | interrupted | no_equilibrium | step_underflow | a word of `online.run.MESSAGES`
    )
    message: str = ""
    counters: dict[str, float] = field(
        default_factory=dict
    )  # steps, rejected_steps, max_iterations, seconds_in_graph, ...
    notes: list[str] = field(
        default_factory=list
    )  # dropped terms, capped counts, fallbacks: printed by Result.report()
    checkpoint: dict[str, np.ndarray] = field(default_factory=dict)  # the complete device state at the end
