r"""Small motions about a state: M, D, K of a scene, evaluated with the kernels of the step.

For given positions x, velocities v and accelerations a of all bodies and modes and given multipliers lambda and
pressures s, the kernels evaluate the unbalanced forces R(x, v, a; lambda, s), the value of every row and the law of
every spring. With the coefficients of the step set so that displacement, velocity and acceleration are independent
(alpha_m = 1, alpha_f = gamma = 0, h -> 0: `r_1 = r_0 + dx`, `v_1 = v_0`, `vdot_1 = a_0` in `motion`) the three can be
varied one at a time. R is linear in a and a quadratic polynomial in v (gyroscopic and centrifugal terms), so that
central differences in them are exact; for x two central differences are combined, with an error of fourth order in a
step of 10 um, or less where lumped contacts are closed. The matrices therefore contain everything that the kernels
evaluate: the geometric stiffness of joints, springs and loads, on rigid coordinates and modes, inertia terms,
stiffening. Characteristics of springs and dampers enter by their slopes at the state, as differences would span their
kinks.

    R_a da + R_v dv + R_x dx + C^T dlambda - L^T ds = 0
    C_r dx = 0                            rigid rows: joints and drives
    dlambda_s = law_x dx + law_v dv       spring rows, so that they add C_s^T law_x to R_x, C_s^T law_v to R_v
    L dx + G ds = 0                       closed contacts, so that they add L^T G^-1 L to R_x; `stuck_contacts`

C, and on the active set L and the local compliance G (nodes without the modes), are those of the kernels. The phases of
the contact grids are fixed, as in the kernels' own gradient: the travel of the patch over the material is not part of
small motions. The pressures' line of action rotates with the bodies; that is in R_x.

**Friction** is zero in a static state. In a state of a run, joints and pairs of surfaces have friction unknowns
(multipliers, tractions), which are kept constant: their friction neither constrains nor damps. In lumped contacts
friction is a function of the motion, and in the matrices: where it sticks its stiffness is in R_x; where it slips, up
to the bound on one side and along its spring on the other, the difference is the mean of both; regularised friction,
rolling resistance and pivoting have their slopes at the velocities of the state in R_v.

**Rotating bodies.** x varies by dr (world axes) and by psi (body axes, A = A_0 exp(psi^)), so that
`dw = psi' + w x psi`, `dwdot = psi'' + w x psi' + wdot x psi`. In coordinates y that rotate with the body,
`dr = A y_r`, `psi = y_t`,

    dv = A (y_r' + w x y_r),     dvdot = A (y_r'' + 2 w x y_r' + w x (w x y_r) + wdot x y_r),

and with forces in body axes too the coefficients are constant where the machine rotates as a whole. Where all rotating
bodies are rigid and symmetric about their axis of rotation, coordinates in world axes are preferable (`dr = y_r`,
`psi = A^T y_t`, `dw = A^T y_t'`, `dwdot = A^T y_t'' - w x A^T y_t'`): supports may then be any. In both, with
`x = T y, v = T y' + U y, a = T y'' + V y' + W y`, the equations multiplied by T^T are

    M y'' + D y' + K y + (C T)^T dlambda = 0,      C T y = 0,
    M = T^T R_a T,      D = T^T (R_a V + R_v T),      K = T^T (R_a W + R_v U + R_x T).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.compile.inertia import mode_reach
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.engine import Engine
from warpffrf.online.start.motions import gradients
from warpffrf.online.vibrations import stuck_contacts
from warpffrf.online.vibrations.film_system import GAP_STEP, FilmSystem, film_systems, smallest_gap
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import PATCH

Array = np.ndarray
LENGTH_STEP = 1e-5  # m, rad: fourth-order error 1e-12 at lengths of 10 mm, round-off 1e-11 of the forces per m
RATE_STEP = 1.0  # m/s, rad/s and their rates: exact for quadratic terms, whatever its size
# where lumped contacts are closed, whose force is a power of an approach of micrometres: of the smallest approach, with
# a fourth-order error of 1e-12; and a rate at which damping is far from its cut-off
APPROACH_STEP, LUMPED_RATE_STEP = 1e-3, 1e-5
NO_TIME = 1e-20  # s: the step for which velocities and accelerations keep their given values
FAR_ITERATION = 10**6  # beyond the most iterations: the kernels evaluate, and leave the loop
RIGID_TANGENT = 1e30  # 1/s2: an inertia so large that modes do not move, which leaves the local compliance alone
ROUND_OFF = 1e-13  # of a sum of forces: machine precision times the few hundred operations of a force
KINK = 1e-9  # of the scene's length [m, rad, m/s or rad/s]: a kink this near counts as at the state
TURNING = 1e-3  # rad/s: one revolution in two hours; bodies at rest rotate more slowly after a start
SYMMETRIC = 1e-6  # relative difference of the two moments of a body of revolution
PATCHED = (
    "active", "pressure", "patch_offset", "ctl", "clk", "modal_load", "lam", "film_pressure", "film_void", "film_full",
    "film_asperity",
)  # fmt: skip
"""Arrays that an evaluation may change."""


@dataclass
class Linearisation:
    """M, D, K (n, n) and rigid rows C (rows, n) over y: per body translation (3) and rotation (3), then all modes.

    `T` (n, n): y -> world displacement of the centres of mass, rotations in body axes, modes. `co_rotating`: whether y
    rotates with the bodies. SI units.
    """

    M: Array
    D: Array
    K: Array
    C: Array
    T: Array
    co_rotating: bool
    turning: list[str]  # names of the rotating bodies
    closed: int  # active nodes of closed contacts
    kinked: list[str]  # names of springs and dampers whose slope jumps at the state
    lumped: int  # closed places of lumped contacts
    films: list[FilmSystem]  # oil films, in addition to M, D and K
    U: Array  # y -> rates of displacements by the rotation of bodies
    K_matched: Array  # contribution of sticking small-sliding contacts to K
    matched: Array  # B (z, n) of `stuck_contacts`, y -> motion at small-sliding contacts
    resolution: float  # 1/s, frequency of the stiffness that is round-off of the differences


class Probe:
    """Evaluates the kernels at positions, velocities and accelerations near a state."""

    def __init__(self, engine: Engine) -> None:
        self.engine, self.state, self.scratch = engine, engine.state, engine.scratch
        self.model = engine.compiled.model
        self.scratch.lasting.zero_()
        stuck_contacts.hold(engine)
        self.bodies, self.modes, self.rows = self.model.bodies.count, self.model.modes.count, self.model.rows.count
        self.count = 6 * self.bodies + self.modes
        self.base = engine.state.to_numpy()
        clk, ctl = self.base["clk"], self.base["ctl"]
        clk["next_time"] = clk["time"]
        clk["h"] = NO_TIME
        for word, value in (("alpha_m", 1.0), ("alpha_f", 0.0), ("beta", 1.0), ("gamma", 0.0),
                            ("acc", RIGID_TANGENT), ("vel", 1.0), ("restart", 0.0)):  # fmt: skip
            clk["retained"][word] = value  # dampers follow their law where vel > 0
        for word, value in (("run", 1), ("moved", 1), ("reassemble", 1), ("refresh", 1), ("recenter", 0),
                            ("iteration", 0), ("failure", 0), ("slots", 0), ("fresh", 0), ("changes", 0),
                            ("round", -1)):  # fmt: skip
            ctl[word] = value
        ctl["mode"][ctl["mode"] == int(k.LOADING)] = int(k.STATIC)  # load steps have no accelerations of the motion
        self.rates = (self._joined("v_rate", "omega_rate", "qd_rate"), self._joined("v", "omega", "qd"))
        self.spring = self._springs()
        self.tangents: dict[int, tuple[float, float]] = {}  # row with characteristics -> tangent stiffness and damping
        self.length_step, self.rate_step = LENGTH_STEP, RATE_STEP

    def settle_windows(self) -> None:
        """Place the windows of the contact pairs as at the beginning of a step; keep the active set that they
        contain.
        """
        if not self.model.pairs.count:
            return
        zero = np.zeros(self.count)
        self.place(zero, zero, zero, first=True)
        for name in PATCHED:
            getattr(self.state, name).assign(self.base[name])
        self.engine.graph.contact()
        for name in ("active", "pressure", "patch_offset"):
            self.base[name] = getattr(self.state, name).numpy().copy()

    def measure_lumped(self) -> int:
        """Closed places of lumped contacts at the last state; makes the steps of the differences small compared with
        their approaches.
        """
        places = self.engine.compiled.elements.lumped.places
        load = self.scratch.lumped_load.numpy()[0, :places]
        approach = -load["touch"]["gap"][load["force"] > 0.0]
        if len(approach):
            self.length_step = min(LENGTH_STEP, APPROACH_STEP * float(np.abs(approach).min()))
            self.rate_step = LUMPED_RATE_STEP
        return len(approach)

    def measure_films(self) -> None:
        """Makes the steps of the differences small compared with the gaps of films at the last state."""
        self.length_step = min(self.length_step, GAP_STEP * smallest_gap(self.engine))

    def _joined(self, linear: str, angular: str, modal: str) -> Array:
        """Velocities or accelerations of world 0 in the order of the coordinates."""
        rigid = np.concatenate([self.base[linear][0, : self.bodies], self.base[angular][0, : self.bodies]], axis=1)
        return np.concatenate([rigid.ravel(), self.base[modal][0, : self.modes]])

    def _springs(self) -> list[int]:
        """Spring rows, and those of pretensions with a given force; a pretension at fixed length is a rigid row."""
        rigid = self.model.rows.rigid.numpy()
        locked = self.engine.locked_rows(0)
        return [i for i in range(self.rows) if not rigid[i] and i not in locked]

    def _put(self, array: Any, value: Array, like: Array) -> None:
        full = np.zeros_like(like)
        full[0].reshape(-1)[: value.size] = value.ravel()
        array.assign(full)

    def place(self, dx: Array, dv: Array, da: Array, first: bool = False) -> None:
        """Run the kernels at the state plus displacements, velocities and accelerations (n,)."""
        s, x, base, B = self.state, self.scratch, self.base, self.bodies
        for name in PATCHED:
            getattr(s, name).assign(base[name])
        if not first:
            words = base["ctl"].copy()
            words["iteration"], words["refresh"] = FAR_ITERATION, 0
            s.ctl.assign(words)
        for values, (linear, angular, modal) in (
            (dx, (x.dx, x.psi, x.dq)),
            (self.rates[1] + dv, (s.v, s.omega, s.qd)),
            (self.rates[0] + da, (s.v_alg, s.omega_alg, s.qd_alg)),
        ):
            rigid = values[: 6 * B].reshape(B, 6)
            self._put(linear, rigid[:, :3], base["v"])
            self._put(angular, rigid[:, 3:], base["v"])
            if self.modes:
                self._put(modal, values[6 * B :], base["qd"])
        self.engine.graph.stand_still()
        self.engine.graph.iterate()

    def forces(self, dx: Array, dv: Array, da: Array) -> Array:
        """Unbalanced forces (n,) and spring laws (springs,) at fixed multipliers and pressures, one array."""
        self.place(dx, dv, da)
        rigid = self.scratch.residual.numpy()[0, : 6 * self.bodies]
        modal = self.scratch.modal_residual.numpy()[0, : self.modes]
        if self.model.pairs.count:  # pressures move with the patch over the modes' shapes: kept constant
            modal = modal + self.state.modal_load.numpy()[0, 1, : self.modes]
        return np.concatenate([rigid, modal, self.laws()])

    def find_tangents(self) -> list[str]:
        """Take the tangents of characteristics at the last evaluated state, once: differences would span their kinks.
        Returns the forces whose slope jumps at the state.
        """
        m, forces = self.model, self.engine.compiled.forces
        value, rate = self.scratch.coordinate.numpy()[0], self.state.drive_rate.numpy()[0, 1]
        aside, kinked = KINK * float(m.length), []
        for name, own in forces.rows.items():
            law = forces.laws[name]
            if not law.elastic:
                continue
            elastic, viscous = law.slopes(value[own], rate[own])
            stiffness, damping = np.diag(law.stiffness) + elastic, np.diag(law.damping) + viscous
            self.tangents.update(zip(own, zip(stiffness, damping, strict=True), strict=True))
            places = zip((*law.elastic, *law.viscous), (*(value[own] - law.reference), *rate[own]), strict=True)
            if any(curve is not None and curve.has_kink(x, aside) for curve, x in places):
                kinked.append(name)
        return kinked

    def laws(self) -> Array:
        """Spring forces by their laws (springs,): lambda + (effective stiffness) (defect); with characteristics their
        tangents, without constant terms.
        """
        if not self.spring:
            return np.zeros(0)
        x, m = self.scratch, self.model
        lam = self.base["lam"][0, : self.rows]
        defect, softness = x.defect.numpy()[0, : self.rows], x.softness.numpy()[0, : self.rows]
        group = m.rows.group.numpy()[: self.rows]
        stiffness = np.zeros(self.rows)
        single = [i for i in self.spring if group[i] < 0]
        stiffness[single] = defect[single] / softness[single]
        for g in range(m.groups.count):
            start, size = int(m.groups.start.numpy()[g]), int(m.groups.size.numpy()[g])
            F = x.flexibility.numpy()[36 * g : 36 * (g + 1)].reshape(6, 6)[:size, :size]
            stiffness[start : start + size] = np.linalg.solve(F, defect[start : start + size])
        value, rate = x.coordinate.numpy()[0], self.state.drive_rate.numpy()[0, 1]
        for row, (c, d) in self.tangents.items():
            stiffness[row] = c * value[row] + d * rate[row] - lam[row]
        return (lam + stiffness)[self.spring]

    def steps(self) -> Array:
        """Displacement of each coordinate (n,) for the differences; modes are scaled by their largest displacement."""
        reach = [np.full(6 * self.bodies, 1.0)]
        for body in self.engine.scene.bodies:
            if body.mode_count:
                found = mode_reach(body.flexible)
                reach.append(np.where(found > 0.0, found, 1.0))
        return self.length_step / np.concatenate(reach)


def linearise(engine: Engine) -> Linearisation:
    """M, D, K and rigid rows of world 0 of `engine` about its present state; the state is left as it was.

    The state must be balanced (multipliers, pressures and accelerations those of its positions and velocities).
    """
    kept = engine.state.to_numpy()
    engine.make_room(int(np.count_nonzero(kept["active"], axis=(1, 2)).max()))  # probes run without the engine's loop
    try:
        return _linearise(Probe(engine))
    finally:
        engine.put_back(kept)


def _linearise(probe: Probe) -> Linearisation:
    n, zero = probe.count, np.zeros(probe.count)
    probe.settle_windows()
    probe.place(zero, zero, zero, first=True)
    x, B, Q, rows = probe.scratch, probe.bodies, probe.modes, probe.rows
    C = np.concatenate([x.C.numpy()[0, :rows, : 6 * B], x.C_modal.numpy()[0, :rows, :Q]], axis=1)
    contact, closed = _closed_contacts(probe)
    matched, seen = stuck_contacts.stuck_stiffness(probe.engine, n), gradients(probe.engine, n)
    kinked = probe.find_tangents()
    lumped = probe.measure_lumped()
    probe.measure_films()

    steps = probe.steps()
    R_x, R_v, R_a = (np.zeros((n + len(probe.spring), n)) for _ in range(3))
    for j in range(n):
        e = np.zeros(n)
        e[j] = steps[j]
        near = probe.forces(e, zero, zero) - probe.forces(-e, zero, zero)
        far = probe.forces(2.0 * e, zero, zero) - probe.forces(-2.0 * e, zero, zero)
        R_x[:, j] = (8.0 * near - far) / (12.0 * steps[j])
        e[j] = probe.rate_step
        R_v[:, j] = (probe.forces(zero, e, zero) - probe.forces(zero, -e, zero)) / (2.0 * probe.rate_step)
        e[j] = RATE_STEP
        R_a[:, j] = (probe.forces(zero, zero, e) - probe.forces(zero, zero, -e)) / (2.0 * RATE_STEP)
    C_spring = C[probe.spring]
    R_x = R_x[:n] + C_spring.T @ R_x[n:] + contact + matched
    R_v = R_v[:n] + C_spring.T @ R_v[n:]
    R_a = R_a[:n]
    T, U, V, W, turning, co_rotating = _coordinates(probe)
    probe.place(zero, zero, zero)
    return Linearisation(
        films=film_systems(probe.engine, n),
        U=U,
        K_matched=T.T @ matched @ T,
        matched=seen @ T,
        M=T.T @ R_a @ T,
        D=T.T @ (R_a @ V + R_v @ T),
        K=T.T @ (R_a @ W + R_v @ U + R_x @ T),
        C=np.delete(C, probe.spring, axis=0) @ T,
        T=T,
        co_rotating=co_rotating,
        turning=turning,
        closed=closed,
        kinked=kinked,
        lumped=lumped,
        resolution=_resolution(probe, C),
    )


def _resolution(probe: Probe, C: Array) -> float:
    """Frequency below which stiffness is not resolved: round-off of the forces over the step of differences; and, with
    the patch of closed contacts fixed, the work of their force on the deflections of the bodies that roll.
    """
    bodies, base, B = probe.engine.scene.bodies, probe.base, probe.bodies
    lam = base["lam"][0, : probe.rows, None]
    pulls = float(np.abs(C[:, : 6 * B] * lam).max(initial=0.0))
    weights = [
        b.mass * float(np.linalg.norm(probe.engine.scene.gravity) + np.linalg.norm(base["v_rate"][0, b.index]))
        for b in bodies
    ]
    contact = float(np.abs(probe.scratch.pair_wrench.numpy()[0, : probe.model.pairs.count]).max(initial=0.0))
    lumped = float(base["lumped_force"][0].max(initial=0.0))
    forces = max(pulls, contact, lumped, stuck_contacts.largest_pull(probe.engine), *weights)
    noise = ROUND_OFF * forces / probe.length_step  # N/m, and on arms as long as positions N m/rad
    extent = float(np.linalg.norm(base["r"][0, :B], axis=-1).max())
    lightest = min(float(np.linalg.eigvalsh(b.inertia)[0]) for b in bodies)
    squares = [noise / min(b.mass for b in bodies), noise * extent / lightest]
    if contact > 0.0:
        q = base["q"][0, : probe.modes]
        deflection = float(np.sum(np.abs(q) * probe.length_step / probe.steps()[6 * B :]))
        squares.append(contact * deflection / lightest)
    return float(np.sqrt(max(squares)))


def _closed_contacts(probe: Probe) -> tuple[Array, int]:
    """L^T G^-1 L of the active nodes (n, n), and their number; after an evaluation with rigid modes."""
    n, m, x = probe.count, probe.model, probe.scratch
    total = np.zeros((n, n))
    count = int(probe.state.ctl.numpy()["slots"][0]) if m.pairs.count else 0
    if not count:
        return total, 0
    slot_pair = x.slot_node.numpy()[0, :count, 0]
    L = np.zeros((count, n))
    local = x.L.numpy()[0, :count, :12]
    J = x.J.numpy()[: m.capacity.slots * m.pairs.most_modes].reshape(m.capacity.slots, m.pairs.most_modes)[:count]
    start, sizes = m.surfaces.modal_start.numpy(), m.surfaces.modal_count.numpy()
    surface_body = m.surfaces.body.numpy()
    sides = m.pairs.first.numpy(), m.pairs.second.numpy()
    for slot in range(count):
        at = 0
        for side in (0, 1):
            surface = sides[side][slot_pair[slot]]
            body, first, size = int(surface_body[surface]), int(start[surface]), int(sizes[surface])
            if body >= 0:  # not the ground
                L[slot, 6 * body : 6 * body + 6] += local[slot, 6 * side : 6 * side + 6]
            L[slot, 6 * probe.bodies + first : 6 * probe.bodies + first + size] += J[slot, at : at + size]
            at += size
    G = _local_compliance(probe, count)
    return L.T @ np.linalg.solve(0.5 * (G + G.T), L), count


def _local_compliance(probe: Probe, count: int) -> Array:
    """G with the yield of layers (count, count) [m^3/Pa] of the active slots: of nodes the matrix of the kernels, of
    cells the displacements due to unit pressures.
    """
    m, x, s = probe.model, probe.scratch, probe.state
    G = np.zeros((count, count))
    pairs, at = x.slot_node.numpy()[0, :count].T
    on_cells = m.pairs.family.numpy()[pairs] == PATCH
    if m.pairs.dense:
        G = np.where(on_cells[:, None] | on_cells, 0.0, x.G.numpy()[0, :count, :count])
        if not m.pairs.beside:  # it has blocks between pairs only where local modes couple them
            G = np.where(pairs[:, None] == pairs, G, 0.0)
        if probe.engine.compiled.elements.layers.count:
            G = G + np.where(on_cells, 0.0, slot_flexibility(probe.engine.compiled, x, count))
    if not np.any(on_cells):
        return G
    before, words = s.pressure.numpy(), s.ctl.numpy().copy()
    words["run"] = 1
    s.ctl.assign(words)

    def displaced(pressure: Array) -> Array:
        s.pressure.assign(pressure)
        probe.engine.graph.displace()
        return x.first_local.numpy()[: before[0].size].reshape(before[0].shape)[pairs[on_cells], at[on_cells]]

    unloaded = displaced(np.zeros_like(before))  # depths at which the tangents of layers have no pressure
    for slot in np.flatnonzero(on_cells):
        unit = np.zeros_like(before)
        unit[0, pairs[slot], at[slot]] = 1.0
        G[on_cells, slot] = displaced(unit) - unloaded
    s.pressure.assign(before)
    return G


def _coordinates(probe: Probe) -> tuple[Array, Array, Array, Array, list[str], bool]:
    """T, U, V, W of the module docstring, the names of rotating bodies, and whether y rotates with them."""
    n = probe.count
    bodies = probe.engine.scene.bodies
    omega = probe.base["omega"][0]
    turning = [b for b in bodies if np.linalg.norm(omega[b.index]) > TURNING]
    co_rotating = not all(not b.mode_count and _is_symmetric(b.inertia, omega[b.index]) for b in turning)
    T, U, V, W = np.eye(n), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    for b in bodies:
        A = rot.matrix(probe.base["p"][0, b.index])
        w, wdot = (cross(probe.base[name][0, b.index]) for name in ("omega", "omega_rate"))
        r = slice(6 * b.index, 6 * b.index + 3)
        t = slice(6 * b.index + 3, 6 * b.index + 6)
        if co_rotating:
            T[r, r], U[r, r], V[r, r], W[r, r] = A, A @ w, 2.0 * A @ w, A @ (w @ w + wdot)
            U[t, t], V[t, t], W[t, t] = w, w, wdot
        else:
            T[t, t], V[t, t] = A.T, -w @ A.T
    return T, U, V, W, [b.name for b in turning], co_rotating and bool(turning)


def cross(w: Array) -> Array:
    """Matrix (3, 3) of w x."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def _is_symmetric(J: Array, w: Array) -> bool:
    """Whether inertia J is symmetric about w."""
    e = w / np.linalg.norm(w)
    P = np.eye(3) - np.outer(e, e)
    across = P @ J @ P
    moment = 0.5 * np.trace(across)
    return bool(np.abs(J - moment * P - (e @ J @ e) * np.outer(e, e)).max() <= SYMMETRIC * np.abs(J).max())


def slot_flexibility(compiled: CompiledScene, scratch: Scratch, count: int) -> np.ndarray:
    """E (count, count) [m^3/Pa] of the nodes in the first `count` slots of world 0, at the last linearisation."""
    E = np.zeros((count, count))
    m = compiled.model
    kinds, first = compiled.elements.layers.kind.numpy(), m.pairs.first.numpy()
    pairs, grid_nodes = scratch.slot_node.numpy()[0, :count].T
    slot_of, tangent = scratch.slot_of.numpy()[0], scratch.layer_tangent.numpy()[0]
    rows = m.surfaces.rows.numpy()[first]
    for i, (pair, grid_node) in enumerate(zip(pairs, grid_nodes, strict=True)):
        if not kinds[pair]:
            continue
        column, row = divmod(int(grid_node), int(rows[pair]))
        for n in range(9):
            c, r = column + n // 3 - 1, row + n % 3 - 1
            if 0 <= c < m.window.columns and 0 <= r < rows[pair]:
                j = slot_of[pair, c * rows[pair] + r]
                if j >= 0:
                    E[i, j] = tangent[pair, grid_node, n]
    return E
