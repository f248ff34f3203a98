r"""`ReducedThermal`: temperature and thermal expansion of a reduced body.

With theta the temperature less that of reference, conductivity K (convection included) and capacity C, heat fluxes q
[W/m2] into the contact surfaces, sum_j psi_j q_j with the functions of their grids, B_ij = int N_i psi_j dA, and
surroundings of temperature T_k less the reference, h_k = int h N dA of convection (fixed temperatures alike)

    C theta' + K theta = B q + sum_k h_k T_k,

is reduced as the deformation is, to modes and the static response in addition:

    theta = sum_k T_k theta_k + Phi a + G_res q,      a' = -Lambda a + Phi^T B q - P dT/dt,
    theta_k = K^-1 h_k,   Phi^T C Phi = 1,   Phi^T K Phi = Lambda,   G_res = K^-1 B - Phi Lambda^-1 Phi^T B,
    P = Phi^T C theta_k.

sum_k theta_k = 1. So steady states are those of the finite elements, for every flux in the span of psi, and the
amplitudes advance exactly over a time with constant fluxes; the modes omitted follow at once. Phi has the slowest modes
and the responses to smooth fluxes and surroundings that rise like e^(s t), at rates s up to the resolution of a step
(`warpffrf.offline.thermal`).

Expansion. The strain alpha theta loads the body with f = int B^T D alpha theta dV = A theta, linear in theta, and every
displacement is a static response to it under inertia relief: M-orthogonal to rigid motion (Tisserand frame), whatever
holds the body later. It is divided as every load is: modal forces Phi_g^T A theta on the global modes, whose static
answer divided by omega^2 moves interfaces exactly (their attachment modes are among the modes), and the residual on the
contact surfaces and the skin, which local modes would add.

Quantities are linear in x = (T_k of all surroundings, a, q), one matrix each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oil_temperature import temperature_of

Array = np.ndarray
Flux = Mapping[str, Any]
_MATRICES = ("rates", "inflow", "carried", "mean", "skin", "modal", "skin_expansion")


@dataclass(frozen=True, eq=False)
class Warmth:
    """A state of `ReducedThermal`: `surroundings` (b,) [degrees Celsius], `amplitudes` (r,) and `flux` (N,) [W/m2] into
    all grid nodes."""

    surroundings: Array
    amplitudes: Array
    flux: Array


@dataclass(frozen=True, eq=False)
class ReducedThermal:
    """Heat conduction and thermal expansion of a reduced body, see the module.

    `surroundings`: name -> temperature [degrees Celsius] as reduced; `reference` [degrees Celsius]; `capacity` [J/K];
    `rates` (r,) [1/s] of the modes; `inflow` (r, N) and `carried` (r, b), what fluxes and surroundings do to them;
    `grids`: contact surface -> (columns, rows), whose nodes are numbered one surface after the other; matrices
    (..., b + r + N): `mean` (1,), `skin` (n,) and `surfaces` by name, temperatures; `modal` (m,) forces on the global
    modes, `expansion` by name, outward normal displacement [m] in addition to global modes, `skin_expansion` (3 n,).
    """

    surroundings: dict[str, float]
    reference: float
    capacity: float
    rates: Array
    inflow: Array
    carried: Array
    grids: dict[str, tuple[int, int]]
    mean: Array
    skin: Array
    surfaces: dict[str, Array]
    modal: Array
    expansion: dict[str, Array]
    skin_expansion: Array

    @property
    def time(self) -> float:
        """Largest time constant [s]."""
        return float(1.0 / self.rates[0])

    # --- the file of a body

    def arrays(self) -> dict[str, Array]:
        """All arrays by path."""
        found = {name: getattr(self, name) for name in _MATRICES}
        for name in self.grids:
            found |= {f"surfaces/{name}": self.surfaces[name], f"expansion/{name}": self.expansion[name]}
        return found

    def facts(self) -> dict[str, Any]:
        """All that is no array."""
        return {
            "surroundings": [[name, T] for name, T in self.surroundings.items()],
            "reference": self.reference,
            "capacity": self.capacity,
            "grids": [[name, *shape] for name, shape in self.grids.items()],
        }

    @classmethod
    def restore(cls, arrays: Mapping[str, Array], facts: Mapping[str, Any]) -> ReducedThermal:
        """From `arrays` and `facts`."""
        grids = {name: (columns, rows) for name, columns, rows in facts["grids"]}
        return cls(
            surroundings=dict(facts["surroundings"]), reference=facts["reference"], capacity=facts["capacity"],
            grids=grids, surfaces={name: arrays[f"surfaces/{name}"] for name in grids},
            expansion={name: arrays[f"expansion/{name}"] for name in grids},
            **{name: arrays[name] for name in _MATRICES},
        )  # fmt: skip

    # --- states

    @named_arguments
    def uniform(self, temperature: float) -> Warmth:
        """The body at one temperature [degrees Celsius] throughout, in its surroundings, without fluxes."""
        T = temperature_of(temperature, "body temperature: uniform")
        known = np.array(list(self.surroundings.values()))
        return Warmth(known, self.carried @ (T - known), np.zeros(self.size))

    @named_arguments
    def steady(self, flux: Flux | None = None, *, surroundings: Mapping[str, float] | None = None) -> Warmth:
        """The steady state under `flux`, {contact surface: number or (columns, rows) [W/m2] into the body}; surfaces
        without a flux are insulated there. surroundings: {name: temperature [degrees Celsius]} that differ from those
        of the reduction. Raises `InputError`."""
        q = self._flux(flux)
        return Warmth(self._surroundings(surroundings), self.inflow @ q / self.rates, q)

    @named_arguments
    def advance(
        self, state: Warmth, duration: float, *, flux: Flux | None = None,
        surroundings: Mapping[str, float] | None = None,
    ) -> Warmth:  # fmt: skip
        """`state` after `duration` [s] under a constant `flux`, as of `steady`, in surroundings that change at once.
        Raises `InputError`."""
        t = require_number(duration, "body temperature: duration", non_negative=True)
        q = self._flux(flux)
        known = dict(zip(self.surroundings, state.surroundings, strict=True))
        now = self._surroundings({**known, **(surroundings or {})})
        a = state.amplitudes - self.carried @ (now - state.surroundings)
        at_rest = self.inflow @ q / self.rates
        return Warmth(now, at_rest + np.exp(-self.rates * t) * (a - at_rest), q)

    # --- what follows from a state

    def temperature(self, state: Warmth, surface: str) -> Array:
        """Temperature (columns, rows) [degrees Celsius] at the grid nodes of a contact surface."""
        return self.reference + self._of(self.surfaces[self._named(surface)], state).reshape(self.grids[surface])

    def mean_temperature(self, state: Warmth) -> float:
        """Mean [degrees Celsius] over the body, weighted by capacity."""
        return self.reference + float(self._of(self.mean, state)[0])

    def skin_temperature(self, state: Warmth) -> Array:
        """Temperature (n,) [degrees Celsius] at the points of the skin, `body.surface.points`."""
        return self.reference + self._of(self.skin, state)

    def hottest(self, state: Warmth) -> float:
        """Highest temperature [degrees Celsius] of the skin; that of the body, while it is heated from there."""
        return float(self.skin_temperature(state).max())

    def response(self, target: str, source: str, duration: float) -> Array:
        """Temperature (nodes, nodes) [K m2/W] of surface `target` per constant flux at the nodes of `source`, after a
        `duration` [s], which may be infinite."""
        b, r = len(self.surroundings), len(self.rates)
        sizes = [columns * rows for columns, rows in self.grids.values()]
        first = sum(sizes[: list(self.grids).index(self._named(source))])
        here = slice(first, first + self.grids[source][0] * self.grids[source][1])
        matrix = self.surfaces[self._named(target)]
        grown = -np.expm1(-self.rates * duration) / self.rates
        return matrix[:, b : b + r] @ (grown[:, None] * self.inflow[:, here]) + matrix[:, b + r :][:, here]

    def modal_force(self, state: Warmth) -> Array:
        """Forces (m,) [N sqrt(kg)/kg] of the expansion on the global modes."""
        return self._of(self.modal, state)

    def local_expansion(self, state: Warmth, surface: str) -> Array:
        """Outward normal displacement (columns, rows) [m] of a contact surface in addition to that of global modes."""
        return self._of(self.expansion[self._named(surface)], state).reshape(self.grids[surface])

    def _of(self, matrix: Array, state: Warmth) -> Array:
        x = np.concatenate([state.surroundings - self.reference, state.amplitudes, state.flux])
        return np.asarray(matrix, dtype=np.float64) @ x

    # --- arguments

    @property
    def size(self) -> int:
        """Number of grid nodes of all contact surfaces."""
        return sum(c * r for c, r in self.grids.values())

    def _named(self, surface: str) -> str:
        if surface not in self.grids:
            raise unknown_name("body temperature: contact surface", surface, self.grids)
        return surface

    def _flux(self, flux: Flux | None) -> Array:
        """(N,) of all surfaces."""
        given = dict(flux or {})
        for name in given:
            self._named(name)
        parts = [np.zeros(0)]
        for name, shape in self.grids.items():
            label = f"body temperature: flux into {name!r} [W/m2]"
            value = given.get(name, 0.0)
            value = np.full(shape, require_number(value, label)) if np.ndim(value) == 0 else value
            parts.append(require_array(value, label, shape).ravel())
        return np.concatenate(parts)

    def _surroundings(self, given: Mapping[str, float] | None) -> Array:
        """(b,) [degrees Celsius]."""
        for name in given or {}:
            if name not in self.surroundings:
                raise unknown_name("body temperature: surroundings", name, self.surroundings)
        found = {**self.surroundings, **(given or {})}
        return np.array([temperature_of(T, f"body temperature: {name!r}") for name, T in found.items()])


@dataclass(frozen=True, eq=False)
class Expansion:
    """Thermal expansion of a body free of loads, user axes, about its frame (M-orthogonal to rigid motion): translation
    [m] and rotation [rad] (6,) of `interfaces`, outward normal displacement (columns, rows) [m] of contact `surfaces`,
    displacement (n, 3) [m] of the points of the `skin`."""

    interfaces: dict[str, Array]
    surfaces: dict[str, Array]
    skin: Array


def expansion(body: Any, state: Warmth) -> Expansion:
    """See `ReducedBody.expansion`."""
    heat = require_thermal(body)
    q = heat.modal_force(state) / (2.0 * np.pi * body.frequencies) ** 2
    surfaces = {
        name: (s.mode_normal @ q).reshape(s.grid.columns, s.grid.rows) + heat.local_expansion(state, name)
        for name, s in body.contact_surfaces.items()
    }
    local = heat._of(heat.skin_expansion, state).reshape(-1, 3)
    return Expansion(
        {name: q @ interface.modes for name, interface in body.interfaces.items()},
        surfaces,
        np.einsum("m,mni->ni", q, np.asarray(body.surface.modes, dtype=np.float64)) + local,
    )


def require_thermal(body: Any) -> ReducedThermal:
    """The thermal model of a body; `InputError` for one reduced without."""
    if body.thermal is None:
        raise InputError(
            "this body was reduced without temperatures; give reduce(thermal=films.BodyTemperature(...)), and its "
            "material conductivity, heat_capacity and expansion"
        )
    return body.thermal
