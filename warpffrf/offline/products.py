"""What both reduction paths return, before it is dressed as a `ReducedBody`; and the mass properties of a body."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.laps import LapSurface
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.model.reduced.cross_compliance import CrossCompliance
from warpffrf.model.reduced.data import Interface
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.recovery import Recovery
from warpffrf.model.reduced.second_order_motion import SecondOrderMotion
from warpffrf.model.reduced.tangential import Tangential


@dataclass(frozen=True)
class Limits:
    """Which vibration modes are wanted: the first `count`, those up to `omega_max` [rad/s], or the fewer of both.
    Both None: none."""

    count: int | None
    omega_max: float | None

    @property
    def none(self) -> bool:
        """True when no vibration mode is wanted."""
        return self.count == 0 or (self.count is None and self.omega_max is None)


@dataclass
class SurfaceProduct:
    """Operators of one contact surface, see `ContactSurface`, and what the independence check looks at: the flexible
    compliance `(B psi)^T G (B psi)` of a window of hats, with (`window`) and without (`residual_window`) the global
    modes' part.

    `observed`, `observed_tangential`: transfer of each observer, by name, of normal and of tangential forces. The grid
    begins at `first_column` of the `whole_columns` that its plan has. `traces`: the eigenvalue ratio of the traces
    of its functions on the mesh (`contact.independence`).
    """

    grid: ContactGrid
    lags: np.ndarray
    mode_normal: np.ndarray
    recovery: Recovery
    window: np.ndarray
    residual_window: np.ndarray
    traces: float
    tangential: Tangential | None = None
    local_mass: LocalMass | None = None
    slope_lags: np.ndarray | None = None
    observed: dict[str, Recovery] = field(default_factory=dict)
    observed_tangential: dict[str, Recovery] = field(default_factory=dict)
    first_column: int = 0
    whole_columns: int = 0


@dataclass
class LapProduct:
    """The laps of a body by name, the `compliance` (N, N) [m/N] among all their forces, the transfer (rows, N) of each
    observer by name, and what the report says of them."""

    surfaces: dict[str, LapSurface]
    compliance: np.ndarray
    observed: dict[str, np.ndarray]
    notes: list[str]
    warnings: list[str]

    def by_force(self, observer: str, components: int) -> np.ndarray | None:
        """What an observer sees of each force (N, places, components), None where it was not asked."""
        if observer not in self.observed:
            return None
        seen = self.observed[observer]
        return np.ascontiguousarray(seen.T).reshape(seen.shape[1], -1, components)


@dataclass(frozen=True, eq=False)
class MembraneTerms:
    """Membrane energy of the first modes of a body.

    `forms` L (R, k, k) [sqrt(J)/m^2], of k modes the first of which have entries; with the `modes` U (3 n, k),
    `products` (R, k, k) and `motion` (3 n, R) [m/sqrt(J)] the strain of second order is
    E2 = sum_r e_r (eps(motion_r) + sum_ij products_rij sym(H_i^T H_j)/2), `offline.inertia.membrane`.
    `second_order`: the motion of second order of all points, on the `shapes` (3 n, S). `facts`: what the report says.
    """

    forms: np.ndarray
    modes: np.ndarray
    products: np.ndarray
    motion: np.ndarray
    second_order: SecondOrderMotion
    shapes: np.ndarray
    facts: dict[str, Any]


@dataclass
class PathProduct:
    """Everything that a path computes. `observed_modes`: what each observer sees of the global modes, (rows, m), or on
    the cyclic path `ObservedModes`."""

    mass: float
    center: np.ndarray  # (3,) m
    inertia: np.ndarray  # (3, 3) kg m2 about the centre
    omega: np.ndarray  # (m,) rad/s
    interfaces: dict[str, Interface]
    surfaces: list[SurfaceProduct]
    skin_points: np.ndarray
    skin_triangles: np.ndarray
    skin_modes: np.ndarray  # (m, n, 3)
    facts: dict = field(default_factory=dict)
    observed_modes: dict[str, Any] = field(default_factory=dict)
    inertia_terms: InertiaTerms | None = None
    cross: list[CrossCompliance] = field(default_factory=list)  # of each surface under loads on each later one
    laps: LapProduct | None = None
    membrane: MembraneTerms | None = None
    skin_second_order: np.ndarray | None = None  # (S, n, 3), of the shapes of `membrane`


def mass_properties(J: np.ndarray, origin: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m2] from the rigid mass matrix J (6, 6) about
    `origin`.

    J = [[m 1, -m c~], [m c~, I_o]] with c the centre relative to `origin`, I = I_o - m (c.c 1 - c c^T) (Steiner).
    """
    mass = float(np.trace(J[:3, :3]) / 3.0)
    coupling = J[3:, :3] / mass  # c~
    c = 0.5 * np.array(
        [coupling[2, 1] - coupling[1, 2], coupling[0, 2] - coupling[2, 0], coupling[1, 0] - coupling[0, 1]]
    )
    inertia = J[3:, 3:] - mass * (c @ c * np.eye(3) - np.outer(c, c))
    return mass, origin + c, 0.5 * (inertia + inertia.T)
