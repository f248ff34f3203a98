"""Accelerations and multipliers of a state: equations of motion, and the joints' equations twice differentiated.

With generalised velocities V (translation in world axes, rotation in body axes, modes), the rows c of joints and
drives, their gradient C and their signals s(t), a state satisfies

    R(a, lam) = M a + C^T lam - F(x, V, t) = 0,        C V = s',        C a + gamma = s'',

    gamma = d/de C(x(e)) V  at e = 0,    x(e): every body moved with its velocity, r + e v, A exp(e omega^), q + e qd.

R is evaluated on the device, with everything that a step includes; springs and dampers enter by their laws. gamma is a
central difference of the device's own gradients, `(8 (g(d) - g(-d)) - (g(2d) - g(-2d)))/(12 d)` with `g(e) = C(x(e))
V`. With d such that nothing rotates by more than `TURN`, its error is (TURN^4)/30 of gamma, and round-off is
divided by TURN only once. A step of size h in positions divides by its square instead, which for h = 1e-7 s makes
1e-16 m to 1e-2 m/s2.

The equations are linear in a and lam. They are solved with the mass matrix of the undeformed bodies, and corrected by R
until convergence; inertia terms of the deformed body are small compared with it, so this contracts. Joints with
friction that stick are rows like the others; the friction of those that slip follows from the multipliers
(`joint_friction`). Pretensions at fixed length are rows like the others, too; the others apply their force.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.checks.redundancy import scene_length
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.arrays.state import LUMPED
from warpffrf.online.engine import Engine
from warpffrf.online.start.static_equilibrium import Friction
from warpffrf_kernels.core import control as k

TURN = 2e-3  # rad, or of the shortest length: see the module; truncation and round-off are then both near 1e-13
CORRECTIONS = 12  # an inertia that deformation changes by a tenth converges to 1e-12
RUBBING_CORRECTIONS = 60  # friction that is half of its effect on reactions converges to 1e-13 in about as many
SETTLED = 1e-13  # of the largest acceleration and multiplier
INDEPENDENT = 1e-11  # smallest over largest eigenvalue of the scaled C M^-1 C^T: below, the pose is singular
TOLERABLE = 1e-9  # of the same: error by round-off of large spring forces
SLOWEST = 1e-6  # 1/s: slower motions have no curvature
NEVER = 1e100  # s: a step so long that the increments of positions make no acceleration
STENCIL = ((1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0))  # of the central difference, over 12 d


def refine(engine: Engine, given: Mapping[str, np.ndarray]) -> bool:
    """Give every world of `engine`, after its START step, velocities that satisfy the rows, and the corresponding
    accelerations and multipliers, to round-off, and open the ledger with the energies of that state.

    `given`: the velocities v, omega, qd (worlds, ...) before the start; the new ones differ from them least, in kinetic
    energy. Contact keeps the pressures of START. False where the pose is singular or the corrections do not converge;
    the values of START are then kept.
    """
    refined = [_World(engine, w).refine(given) for w in range(engine.worlds)]
    engine.graph.open_books()
    if engine.compiled.model.pairs.count:  # START left gaps and forces of the end of its tiny step, rotated by omega h
        engine.control(run=1, moved=1, iteration=0)
        engine.graph.contact()
    engine.control(run=0, moved=0)
    return all(refined)


class _World:
    """One world of an engine as arrays over its retained coordinates (6 per body), then modes."""

    def __init__(self, engine: Engine, w: int) -> None:
        self.engine, self.w = engine, w
        m = engine.compiled.model
        self.bodies, self.modes, self.rows = m.bodies.count, m.modes.count, m.rows.count
        self.rigid = m.rows.rigid.numpy()[: self.rows].astype(bool)
        self.rigid[engine.locked_rows(w)] = True
        self.mass = m.bodies.mass.numpy()[: self.bodies]
        self.inertia = m.bodies.inertia.numpy()[: self.bodies]

    # --- the state

    def _stacked(self, translation: np.ndarray, rotation: np.ndarray, modal: np.ndarray) -> np.ndarray:
        """Arrays of all worlds as one over the coordinates of this one."""
        pair = [array[self.w, : self.bodies] for array in (translation, rotation)]
        return np.concatenate([np.hstack(pair).ravel(), modal[self.w, : self.modes]])

    def _of_state(self, *names: str) -> np.ndarray:
        return self._stacked(*(getattr(self.engine.state, name).numpy() for name in names))

    def _store(self, names: tuple[str, str, str], values: np.ndarray) -> None:
        rigid = values[: 6 * self.bodies].reshape(-1, 6)
        for name, part in zip(names, (rigid[:, :3], rigid[:, 3:], values[6 * self.bodies :]), strict=True):
            self._put(self.engine.state, name, part)

    def _put(self, owner: Arrays, name: str, part: np.ndarray) -> None:
        """Overwrite the leading entries of this world in a device array."""
        if part.size == 0:
            return
        array = getattr(owner, name).numpy().copy()
        array[self.w, : len(part)] = part
        getattr(owner, name).assign(array)

    # --- evaluations on the device

    def _evaluate(self, shift: np.ndarray) -> None:
        """Residuals and rows at the present state moved by `shift`, with accelerations `-v_rate` and so on: with
        alpha_f = 1/2 and an infinite step, the formulas of `warpffrf_kernels.bodies.motion` give `v_1 = v_0` and
        `vdot_1 = -vdot_0`.
        """
        engine = self.engine
        words, reals = engine.state.ctl.numpy().copy(), engine.state.clk.numpy().copy()
        words["run"] = 0  # of the other worlds
        for word, value in (("run", 1), ("moved", 1), ("iteration", 0)):
            words[word][self.w] = value
        reals["h"][self.w], reals["next_time"][self.w] = NEVER, self.time
        for word, value in (
            ("alpha_m", 0.0), ("alpha_f", 0.5), ("beta", 0.5), ("gamma", 0.0), ("acc", 0.0), ("vel", 1.0),
            ("restart", 0.0),
        ):  # fmt: skip
            reals["retained"][word][self.w] = value
        engine.state.ctl.assign(words)
        engine.state.clk.assign(reals)
        rigid = shift[: 6 * self.bodies].reshape(-1, 6)
        for name, part in (("dx", rigid[:, :3]), ("psi", rigid[:, 3:]), ("dq", shift[6 * self.bodies :])):
            self._put(engine.scratch, name, part)
        engine.graph.stand_still()
        engine.graph.move_and_load()

    def _gradient(self) -> np.ndarray:
        """C (rows, coordinates) of the last evaluation."""
        scratch = self.engine.scratch
        C = scratch.C.numpy()[self.w, : self.rows, : 6 * self.bodies]
        return np.hstack([C, scratch.C_modal.numpy()[self.w, : self.rows, : self.modes]])

    def _residual(self) -> np.ndarray:
        """R (coordinates,) of the last evaluation, contact by its last forces."""
        scratch, state, w = self.engine.scratch, self.engine.state, self.w
        rigid = scratch.residual.numpy()[w, : 6 * self.bodies].astype(np.float64)
        modal = scratch.modal_residual.numpy()[w, : self.modes].astype(np.float64)
        m = self.engine.compiled.model
        if m.pairs.count:
            wrench, body = state.pair_force.numpy()[w, : m.pairs.count, 0], m.surfaces.body.numpy()
            if m.capacity.cells:
                wrench = wrench + state.friction_force.numpy()[w, : m.pairs.count, 0]
            for pair in range(m.pairs.count):
                for side, surface in enumerate((m.pairs.first.numpy()[pair], m.pairs.second.numpy()[pair])):
                    if body[surface] < 0:
                        continue  # the ground
                    at = 6 * body[surface]
                    rigid[at : at + 6] -= wrench[pair, 6 * side : 6 * side + 6]
            modal -= state.modal_load.numpy()[w, 0, : self.modes]
        return np.concatenate([rigid, modal])

    def _spring_forces(self) -> np.ndarray:
        """Multipliers (rows,) by the laws of springs and dampers at the last evaluation, and pretensions; 0 for
        joints.
        """
        scratch, forces = self.engine.scratch, self.engine.compiled.forces
        value = scratch.coordinate.numpy()[self.w]
        rate = self.engine.state.drive_rate.numpy()[self.w, 1]
        lam = np.zeros(self.rows)
        for name, rows in forces.rows.items():
            lam[rows] = forces.laws[name].force(value[rows], rate[rows])
        for name, row in self.engine.compiled.tensions.rows.items():
            force = self.engine.compiled.inputs.resolved(self.engine.compiled.tensions.laws[name].force)
            lam[row] = force(self.time)
        return lam

    def _signals(self) -> tuple[np.ndarray, np.ndarray]:
        """First and second derivative of the signals of all rows at the present time."""
        m = self.engine.compiled.model
        first, second = np.zeros(self.rows), np.zeros(self.rows)
        start, breaks, c = (getattr(m.signals, name).numpy() for name in ("start", "breaks", "coefficient"))
        for row, s in enumerate(m.rows.signal.numpy()[: self.rows]):
            if s < 0 or self.time < breaks[start[s]]:
                continue
            piece = start[s] + np.searchsorted(breaks[start[s] : start[s + 1]], self.time, side="right") - 1
            polynomial = np.polynomial.Polynomial(c[piece])
            x = self.time - breaks[piece]
            first[row], second[row] = polynomial.deriv(1)(x), polynomial.deriv(2)(x)
        return first, second

    # --- the equations

    def refine(self, given: Mapping[str, np.ndarray]) -> bool:
        """See `refine`."""
        self.time = float(self.engine.word("time")[self.w])
        names = ("v_rate", "omega_rate", "qd_rate")
        V, found = self._of_state("v", "omega", "qd"), self._of_state(*names)
        lam = self.engine.state.lam.numpy()[self.w, : self.rows].copy()
        self._store(("v_alg", "omega_alg", "qd_alg"), np.zeros_like(V))
        self._store(names, -found)
        still = np.zeros_like(V)
        self._evaluate(still)
        solution = self._solved(self._stacked(given["v"], given["omega"], given["qd"]), found, lam)
        V, a, lam, good = solution if solution is not None else (V, found, lam, False)
        self._store(("v", "omega", "qd"), V)
        self._store(names, -a)
        self._put(self.engine.state, "lam", lam)
        self._evaluate(still)  # recorded quantities and the ledger belong to this state
        self._store(names, a)
        self._store(("v_alg", "omega_alg", "qd_alg"), a)
        self._put(self.engine.state, "lam0", lam)
        self._accept()
        return good

    def _solved(
        self, V: np.ndarray, a: np.ndarray, lam: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, bool] | None:
        """Velocities, accelerations, multipliers; None where the rows are dependent or there is no convergence."""
        gradient = self._gradient()
        C = gradient[self.rigid]
        system = _Constrained(self.mass, self.inertia, self.modes, C)
        if not system.independent:
            return None
        rate, rate2 = self._signals()
        V = V - system.solve(np.zeros_like(V), C @ V - rate[self.rigid])[0]
        self._store(("v", "omega", "qd"), V)
        gamma = self._curvature(V)
        friction = Friction(self.engine, self.w, gradient @ V)
        while True:
            held = self.rigid.copy()
            held[friction.sticking] = True
            if friction.sticking:
                system = _Constrained(self.mass, self.inertia, self.modes, gradient[held])
            if not system.independent:
                return None
            found = self._balanced(system, held, gamma[held], rate2[held], friction, a, lam)
            if found is None:
                return None
            a, lam = found
            if not friction.lets_go(lam):
                friction.store(lam)
                return V, a, lam, True
            system = _Constrained(self.mass, self.inertia, self.modes, C)

    def _balanced(
        self,
        system: _Constrained,
        held: np.ndarray,
        gamma: np.ndarray,
        rate2: np.ndarray,
        friction: Friction,
        a: np.ndarray,
        lam: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Accelerations and multipliers with C a + gamma = s'' of the rows `held`; None where there is no
        convergence.
        """
        C, change, first = system.C, np.inf, a
        for _ in range(RUBBING_CORRECTIONS if friction.laws else CORRECTIONS):
            self._store(("v_rate", "omega_rate", "qd_rate"), -a)
            self._put(self.engine.state, "lam", lam)
            self._evaluate(np.zeros_like(a))
            springs = self._spring_forces()
            rubbing, pulls = friction.forces(lam)
            springs[rubbing] = pulls
            gap = np.where(held, 0.0, springs - lam)
            step, pull = system.solve(self._residual() + self._gradient().T @ gap, C @ a + gamma - rate2)
            a, lam = a - step, lam + gap
            lam[held] -= pull
            pulled = system.over_mass(C.T @ lam[held])  # in balance with the loads, also where nothing moves
            change = max(_share(step, a, pulled, first), _share(pull, lam))
            if change <= SETTLED:
                return a, lam
        return (a, lam) if change <= TOLERABLE else None

    def _curvature(self, V: np.ndarray) -> np.ndarray:
        """gamma (rows,), see the module."""
        d = TURN / max(self._pace(V), SLOWEST)
        gamma = np.zeros(self.rows)
        for factor, weight in STENCIL:
            self._evaluate(factor * d * V)
            gamma += weight * (self._gradient() @ V)
        return gamma / (12.0 * d)

    def _pace(self, V: np.ndarray) -> float:
        """A bound [1/s] of the rates at which axes rotate and distances change relative to their length."""
        rigid, m = V[: 6 * self.bodies].reshape(-1, 6), self.engine.compiled.model
        kinds, lengths = m.rows.kind.numpy()[: self.rows], self.engine.scratch.coordinate.numpy()[self.w, : self.rows]
        distances = np.abs(lengths[kinds == int(k.DISTANCE)])
        length = float(min(distances[distances > 0.0], default=scene_length(self.engine.scene)))
        turning = np.linalg.norm(rigid[:, 3:], axis=1).max(initial=0.0)
        moving = np.linalg.norm(rigid[:, :3], axis=1).max(initial=0.0)
        swinging = np.abs(V[6 * self.bodies :]).sum() * np.abs(m.interfaces.modes.numpy()).max(initial=0.0)
        return float(turning + swinging + (moving + swinging) / length)

    def _accept(self) -> None:
        """Values of the accepted state for the ledger, from the last evaluation."""
        state, w = self.engine.state, self.w
        films = ("film_power", "film_energy")
        for name in ("drive_rate", "applied", "applied_at", "load", "load_on_modes", *LUMPED, *films):
            array = getattr(state, name).numpy().copy()
            array[w, 0] = array[w, 1]
            getattr(state, name).assign(array)
        self._put(state, "stretch", self.engine.scratch.coordinate.numpy()[w, : self.rows])


class _Constrained:
    """`M x + C^T y = r, C x = g` for block-diagonal M: mass, inertia tensor (body axes), unit modal masses.

    y follows from `(C M^-1 C^T) y = C M^-1 r - g`, scaled to a unit diagonal; `independent` is False where that matrix
    is singular."""

    def __init__(self, mass: np.ndarray, inertia: np.ndarray, modes: int, C: np.ndarray) -> None:
        self.mass, self.flexibility, self.modes, self.C = mass, np.linalg.inv(inertia), modes, C
        self.CW = np.array([self.over_mass(row) for row in C]).reshape(C.shape)
        A = self.CW @ C.T
        self.scale = 1.0 / np.sqrt(np.where(np.diag(A) > 0.0, np.diag(A), 1.0))
        values, self.vectors = np.linalg.eigh(self.scale[:, None] * A * self.scale)
        self.independent = not len(values) or bool(values[0] > INDEPENDENT * values[-1])
        self.inverse_values = 1.0 / values if self.independent else np.zeros_like(values)

    def over_mass(self, r: np.ndarray) -> np.ndarray:
        """M^-1 r."""
        rigid = r[: 6 * len(self.mass)].reshape(-1, 6)
        moved = rigid[:, :3] / self.mass[:, None]
        turned = np.einsum("bij,bj->bi", self.flexibility, rigid[:, 3:])
        return np.concatenate([np.hstack([moved, turned]).ravel(), r[6 * len(self.mass) :]])

    def solve(self, r: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x (coordinates,) and y (rows,)."""
        right = self.scale * (self.CW @ r - g)
        y = self.scale * (self.vectors @ (self.inverse_values * (self.vectors.T @ right)))
        return self.over_mass(r - self.C.T @ y), y


def _share(step: np.ndarray, *values: np.ndarray) -> float:
    """The largest of `step` over the largest of `values`."""
    largest = max(np.abs(array).max(initial=0.0) for array in values)
    return float(np.abs(step).max(initial=0.0) / largest) if largest > 0.0 else 0.0
