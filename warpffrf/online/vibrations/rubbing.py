r"""Energy loss of small-sliding contacts in a mode of given amplitude: quasi-static cycles in the mode's shape.

About a state at rest everything but the small-sliding contacts is linear (`linearise`), with K_0 its stiffness without
that of sticking contacts. The contacts respond with the forces f to their relative motion z = P y, including its
history. Inertia forces of a vibration in the mode phi, phi^T M phi = 1, are proportional to M phi; so with the mode's
coordinate a given,

    K_0 y - P^T (f(z) - f_0) + C^T dlambda = alpha M phi,     C y = 0,     phi^T M y = q(t) = a sin(2 pi t),

whose unknowns are y and the load alpha. All other coordinates follow the slip: the result of a step does not depend on
which part of a body's flexibility is in its modes, and which in its cells. At small amplitudes y = q phi and
alpha = omega^2 q. Cycles of `steps` steps are computed up to the last, each step with the history of the cells as in a
static run. With D the loss of the last cycle, and the first harmonic of alpha,

    omega_a^2 = 2/(a steps) sum alpha sin(2 pi t),      U = omega_a^2 a^2/2,      zeta = D/(4 pi U):

the linear oscillator with this stiffness and the same loss per cycle. A free vibration loses D in one cycle;
the amplitude itself falls by another ratio, as the frequency changes with it.

The equations are solved on the host by Newton's method, in the coordinates of the modes of the stuck state, with the
kernels' forces and their tangent T_zz (`warpffrf_kernels.matched.retained`); a step that fails is halved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.online.checkpoint import off_end_of
from warpffrf.online.compile.matched import matched_order
from warpffrf.online.engine import Engine
from warpffrf.online.step import phases
from warpffrf.online.step.matched import MATCHED
from warpffrf.online.vibrations.eigenmodes import SceneModes, free_basis
from warpffrf.online.vibrations.linearise import Linearisation
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.core import control as k
from warpffrf_kernels.matched.forms import STICK

Array = np.ndarray
BALANCED = 1e-9  # of the modal forces of a step: those of the cells are accurate to 1e-11 of the largest
AT_REST = 1e-10  # of the initial contact forces: round-off of smaller ones
MOST_ITERATIONS = 40
MOST_HALVINGS = 6
REMEMBERED = 5  # iterations
RIDGE = 1e-8  # of the largest of their differences
STANDING = 0.02  # of the kinetic energy: part that is out of phase with the rest of a mode
SLACK = 1e-13  # of the largest stiffness: a motion with less is unconstrained and stays where it is


@dataclass(frozen=True, eq=False)
class Cycle:
    """The last of the cycles of one amplitude, `steps` + 1 rows from q = 0 upwards."""

    coordinate: Array  # (rows,) m kg^(1/2), of the mode
    load: Array  # (rows,) alpha, N kg^(-1/2)
    loss: dict[str, float]  # J, of each small-sliding contact
    slipping: dict[str, float]  # share of the cells of each contact that slip or are open at some time
    before: float  # J, the loss of the cycle before: the same where cycles are periodic


class MatchedForces:
    """The small-sliding contacts of world 0 of an engine about its accepted state: forces on z for displacements x (n,)
    of the bodies.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine, self.matched = engine, engine.compiled.matched
        self.shape = engine.state.v.shape[1]
        bodies = engine.compiled.model.bodies.count
        self.rigid, self.bodies = 6 * bodies, bodies

    def at(self, x: Array) -> Array | None:
        """f (z,); None where the states of the cells do not converge."""
        engine, s = self.engine, self.engine.scratch
        rigid = np.zeros((engine.worlds, self.shape, 6))
        rigid[0, : self.bodies] = x[: self.rigid].reshape(-1, 6)
        s.dx.assign(np.ascontiguousarray(rigid[:, :, :3]))
        s.psi.assign(np.ascontiguousarray(rigid[:, :, 3:]))
        modal = np.zeros(s.dq.shape)
        modal[0, : len(x) - self.rigid] = x[self.rigid :]
        s.dq.assign(modal)
        engine.control(run=1, moved=1, iteration=0, failure=0)
        engine.graph.program.run(("move",))
        self._launch("load")
        failed = bool(engine.word("failure")[0])
        return None if failed else s.matched_push.numpy()[0, : int(self.matched.column_start.numpy()[-1])].copy()

    def tangent(self) -> Array:
        """-T_zz (z, z), the derivative of f, at the last evaluation."""
        columns, squares = self.matched.column_start.numpy(), self.matched.square_start.numpy()
        self.engine.control(run=1, moved=1, refresh=1)
        self._launch("assemble")
        stiffness = self.engine.scratch.matched_stiffness.numpy()
        S = np.zeros((columns[-1], columns[-1]))
        for group in range(self.matched.count):
            own = slice(columns[group], columns[group + 1])
            z = int(own.stop - own.start)
            S[own, own] = -stiffness[squares[group] :][: z * z].reshape(z, z).T
        return S

    def accept(self) -> None:
        """Accept the last evaluation into the history."""
        self.engine.control(accept=1, commit=1, mode=int(k.LOADING))
        self._launch("keep")
        self._launch("commit")
        self.engine.control(accept=0, commit=0)

    def _launch(self, phase: str) -> None:
        program = self.engine.graph.program
        parts = MATCHED.phases[phase][:1]  # the cells; their residuals are not needed
        phases.record([((), part) for part in parts], program.arrays, program.sizes, program.device)


class RubbingMode:
    """A real mode phi (n,) over y, of angular frequency omega [rad/s], at given amplitudes."""

    def __init__(self, engine: Engine, linear: Linearisation, basis: Array, phi: Array, omega: float) -> None:
        """`basis` (n, free): M-orthonormal, of all y that satisfy the rigid rows."""
        self.matched, self.engine = MatchedForces(engine), engine
        self.state = engine.state.to_numpy()
        self.T, self.basis = linear.T, basis
        self.seen = linear.matched @ basis
        stiffness = basis.T @ (linear.K - linear.K_matched) @ basis
        self.K_0 = 0.5 * (stiffness + stiffness.T)
        self.shape = basis.T @ (linear.M @ phi)
        self.omega = omega

    @WARP_LOCK
    def cycle(self, amplitude: float, cycles: int, steps: int) -> Cycle:
        """The last of `cycles` cycles, at least two, of `amplitude`, of `steps` steps each. Raises `InputError` where
        one fails."""
        self.engine.put_back(self.state)
        f_0 = self.matched.at(np.zeros(len(self.T)))
        if f_0 is None:
            raise InputError(
                "equivalent_damping: the cells of the small-sliding contacts do not converge at the state of the "
                "modes; compute it again"
            )
        self.f_0, self.eta, self.alpha, self.q = f_0, np.zeros(len(self.shape)), 0.0, 0.0
        self.matched.accept()
        lost, rows, slipping = [self._lost()], [(0.0, 0.0)], np.zeros(len(self._lost()), bool)
        for step in range(1, cycles * steps + 1):
            if step % steps == 1:
                rows, slipping[:] = rows[-1:], False
            self._go_to(amplitude * np.sin(2.0 * np.pi * step / steps), MOST_HALVINGS)
            rows.append((self.q, self.alpha))
            slipping |= self.engine.state.matched_state.numpy()[0] != int(STICK)
            if step % steps == 0:
                lost.append(self._lost())
        q, alpha = np.array(rows).T
        before, loss = np.diff(np.array(lost), axis=0)[-2:]
        cells = self._cells()
        return Cycle(
            q, alpha, {name: float(loss[own].sum()) for name, own in cells.items()},
            {name: float(slipping[own].mean()) for name, own in cells.items()}, float(before.sum()),
        )  # fmt: skip

    def _lost(self) -> Array:
        return self.engine.state.matched_lost.numpy()[0].copy()

    def _cells(self) -> dict[str, slice]:
        found, start = {}, 0
        for number in matched_order(self.engine.scene.small_sliding):
            contact = self.engine.scene.small_sliding[number]
            count = len(cells_of(contact).cell)
            found[contact.name] = slice(start, start + count)
            start += count
        return found

    def _go_to(self, q: float, halvings: int) -> None:
        """One accepted step to the coordinate q, in two halves where it fails."""
        if self._step(q):
            self.matched.accept()
            self.q = q
            return
        if not halvings:
            raise InputError(
                f"equivalent_damping: no equilibrium of the small-sliding contacts was found at {q:.3g} "
                "m kg^(1/2) of the mode's coordinate; take more steps, or a smaller amplitude"
            )
        self._go_to(0.5 * (self.q + q), halvings - 1)
        self._go_to(q, halvings - 1)

    def _step(self, q: float) -> bool:
        """Newton's method for eta and alpha at the coordinate q; False where it does not converge. Tangents omit the
        rotation of the slip directions, which is estimated from the differences of the last iterations.
        """
        n, c, unit = len(self.shape), self.shape, self.omega**2
        x = np.append(self.eta + (q - self.q) * c, self.alpha / unit)
        rest = AT_REST * np.linalg.norm(self.seen.T @ self.f_0)
        met: list[tuple[Array, Array]] = []
        for _ in range(MOST_ITERATIONS):
            f = self.matched.at(self.T @ (self.basis @ x[:n]))
            if f is None:
                return False
            pushed, held = self.seen.T @ (f - self.f_0), self.K_0 @ x[:n]
            left = np.append(held - pushed - unit * x[n] * c, unit * (c @ x[:n] - q))
            scale = np.linalg.norm(pushed) + np.linalg.norm(held)
            if np.linalg.norm(left) <= BALANCED * scale + rest:
                self.eta, self.alpha = x[:n], unit * x[n]
                return True
            A = np.zeros((n + 1, n + 1))
            A[:n, :n] = self.K_0 + self.seen.T @ self.matched.tangent() @ self.seen
            A[:n, n], A[n, :n] = -unit * c, unit * c
            met = [*met, (x, left)][-REMEMBERED:]
            x, left = _mixed(met)
            x = x - np.linalg.lstsq(A, left, rcond=SLACK)[0]
        return False


def _mixed(met: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """The last point minus the combination of differences of points and residuals that minimises the residual."""
    x, left = met[-1]
    if len(met) == 1:
        return x, left
    points, residuals = (np.array(values, dtype=float) for values in zip(*met, strict=True))
    dx, dleft = (points[1:] - points[:-1]).T, (residuals[1:] - residuals[:-1]).T
    weight = np.linalg.lstsq(dleft, left, rcond=RIDGE)[0]
    return x - dx @ weight, left - dleft @ weight


@WARP_LOCK
def rubbing_mode(modes: SceneModes, i: int) -> RubbingMode:
    """Mode i of `modes`. Raises `InputError` for scenes without small-sliding contacts, and for modes that are not
    standing vibrations.
    """
    label, linear, value = "equivalent_damping", modes.linear, modes.eigenvalues[i]
    if not modes.scene.small_sliding:
        raise InputError(f"{label}: the scene has no small-sliding contact; use damping_ratios")
    if linear.turning:
        raise InputError(
            f"{label}: {', '.join(map(repr, linear.turning))} turns; take modes about an equilibrium, or the end of a "
            "static run"
        )
    if modes.about == "last state of a run":
        raise InputError(f"{label}: the modes are about a state in motion; take an equilibrium or a static run")
    phi = np.real(modes.vectors[:, i])
    mass = float(phi @ linear.M @ phi)
    if value.imag <= 0.0 or 1.0 - mass > STANDING:
        raise InputError(
            f"{label}: mode {i} is no standing vibration (eigenvalue {value:.3g} 1/s): strong dampers, or nothing that "
            "pulls it back; choose another"
        )
    engine = Engine(modes.scene, device=modes.device, settings=modes.settings, off_end=off_end_of(modes.state))
    engine.resume(modes.state)
    return RubbingMode(engine, linear, free_basis(linear.M, linear.K, linear.C), phi / np.sqrt(mass), abs(value))


def equivalent(cycle: Cycle, amplitude: float) -> tuple[float, float, float, float]:
    """D [J], U [J], zeta and omega_a [rad/s] of a cycle with `amplitude` of the mode's coordinate."""
    steps = len(cycle.load) - 1
    phase = np.sin(2.0 * np.pi * np.arange(steps) / steps)
    square = 2.0 / (amplitude * steps) * float(cycle.load[:-1] @ phase)
    if square <= 0.0:
        raise InputError("equivalent_damping: nothing pulls the mode back at this amplitude; take a smaller one")
    loss, energy = sum(cycle.loss.values()), 0.5 * square * amplitude**2
    return loss, energy, loss / (4.0 * np.pi * energy), float(np.sqrt(square))
