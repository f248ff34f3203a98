r"""The static state of a scene, computed by proximal steps on the device.

A proximal step of size tau [s] balances `M d/tau^2 = F` at its end, d the displacement: a step of implicit motion
without velocity. A short one follows the gradient of the energy, a long one is Newton's step. So tau grows while steps
converge, and a step whose iteration fails or whose energy rises (`kernels commit`) is repeated with
a shorter tau; once the scene is much closer to rest, longer ones are tried again.

Motions that nothing resists (`warpffrf.online.start.free_motions`) are constrained as soon as the rest is known
to within the tolerance of Newton's method: round-off, and grid errors of torques that are zero, would drive
them. Motion along them, as of balls that rotate by round-off, does not count as motion of a scene at rest.

With friction in small-sliding contacts, the sum of the energy and of the friction loss since the initial state of their
history decreases; as pressures come to rest the loss falls, and the energy alone may rise by as much. Where even steps
shorter than the first one end higher, this condition is dropped.

Films are squeezed over the time tau while their walls slide with the scene's initial velocities, so that a state at
rest is a steady state; a film has no energy that could decrease.

Rest. Residual forces after a proximal step of an equilibrium: whether a scene that still moves is at rest.

A proximal step of size tau balances `m d/tau^2 = F` and `J psi/tau^2 = M` for every body, `d` and `psi` its
displacement and rotation in the step: these inertia forces are the residual of the static forces. A body unconstrained
in one direction, such as a roller free to rotate on its axle, keeps moving under the grid error of a torque that is
zero, some 1e-12 of the load, and never comes to rest. Its forces balance nevertheless.

Pressed. The state in which a scene is pressed together, before friction of its surfaces acts.

Tractions need pressures before anything slips. So where surfaces have friction, an equilibrium with
friction (`warpffrf.online.start.static_friction`) has two parts: first the scene comes to rest without friction, with
all motions that friction will resist constrained; then friction replaces these constraints.

Constrained are the rigid motions that joints and drives leave free and that neither open nor close a gap under
pressure, but cause slip of loaded surfaces with friction: with N the motions of

    C z = 0,   L z = 0        (`warpffrf.online.start.free_motions`; springs resist nothing here)

and T the slips of cells, of closed lumped contacts and of joints with friction, the combinations N y whose slips T N y
are more than STICKS. So a force along a plane, a spring or a weight down an incline moves nothing, and slip is measured
from the initial positions of the surfaces. These motions are known where the scene is pressed: so it is pressed twice,
first to find them, then from the initial state again with these constrained from the beginning, and determined again as
soon as a contact is under pressure.

A ball slightly off the top of another one is pushed off by its load, and friction holds it there, too:
where no contact is under pressure in the end, or no equilibrium with friction is found from there, motions that change
gaps by less than LEANS are constrained as well. Not at once, as such a motion may be the loading one, of a wedge or a
roller.

A free motion, such as of a wheel that rolls down an incline, is constrained here, too, and reported by the step with
friction.

These constraints carry the loads of the scene, and are stiffer than those of free motions: a force F moves a mass m by
F/m 1e-16 s2 per step in a scene of 0.1 m.

Joint friction. Friction of joints at the start of a run: which of them slip, and with which force.

A joint whose sides move against each other slips, against their velocity. One at rest sticks, unless it would need more
than the bound (`warpffrf.model.forces.laws.SlipLaw`); it then begins to slip in the direction of the load. All of
several overloaded ones begin to slip, until no other is overloaded. The bound follows from reactions that friction
changes, so it is evaluated again whenever they change.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.forces import SlipLaw
from warpffrf.online.diagnosis.failure_report import hottest_film, largest_force
from warpffrf.online.diagnosis.no_equilibrium import ROUND_OFF, gross_slip
from warpffrf.online.engine import Engine
from warpffrf.online.start.free_motions import HOLD, LEANS, FreeMotions
from warpffrf.online.start.motions import stretch
from warpffrf_kernels.core import control as k
from warpffrf_kernels.films.heat import CHANGE

MOST_STEPS = 150  # a snap-through takes about a hundred
GROWTH = 10.0  # of the proximal step from one to the next, ...
CAREFUL = 2.0  # ... below one that failed
# times are those that a length of the scene takes at some speed, as the times of its vibrations grow with its size
FIRST = 1e-2  # s/m: 1 ms for a scene of 0.1 m, moves a body by F/m * 1e-6 s2 at first
LEAST = 1e-6  # s/m: the failure of a step of this size does not depend on its size
# layers with low stiffness at touch, distant pairs that appear to close, light rings between lumped contacts: a body
# whose first displacement would be too large starts again with a shorter step
RETREATS, RETREAT = 2, 1000.0
# Surfaces in lumped contact, which may be apart at first, and the bodies between them: a step that moves a body by more
# than this share of the smallest radius, or rotates it by more rad, may have passed through them, and is repeated
FARTHEST, SHORTENED = 0.5, 6
# s/m: 1 kg of a scene of 0.1 m then weighs 1 N/m, far below any spring that carries a load; larger ill-conditions the
# joints
LAST = 10.0
# of it, where necessary: bodies of a tenth of a millimetre on springs of a few hertz, whose vibrations
# are not faster for being small, approach rest in each of them by less than CREEP
LONGER = 1e6
TOLERANCE = 1e-11  # of the scene's length, movement of the last proximal step: round-off of positions times 1e5
VOIDS_STAY = 1e-9  # of the clearance
TEMPERATURES_STAY = 1e-6  # K: 1e-7 of the heat that is generated, which falls by a few per cent per kelvin
TEMPERATURES_CREEP = 1e-3  # K: of a pad without load, which moves by as much as the tolerance of Newton's method allows
CREEP = 0.5  # of the movement of the previous step: motion towards rest decreases from one long step to the next
# of the largest force: energy differences are then within the errors of contact grids; second, of travelling cells,
# whose width follows from the pressures of the previous step
LEVEL = 1e-3, 1e-2


def settle(engine: Engine, free: FreeMotions | None = None) -> bool:
    """Bring every world of `engine` to its static state at the present time; True on success. free: the motions that
    are constrained, None: those without resistance.

    A scene in which a body creeps although its forces balance, to the tolerance of Newton's method, is at rest too.
    Creeping bodies, and free motions that were left where they are, are named in `engine.start_notes`.
    """
    engine.rates_to_zero()
    free = free or FreeMotions(engine)
    engine.control(energy_bounded=int(not engine.scene.films))
    engine.scratch.film_stretch.fill_(stretch(engine.scene, LAST * float(engine.compiled.model.length)))
    try:
        at_rest = _stepped(engine, free)
        if any(hottest_film(engine, world) for world in range(engine.worlds)):
            at_rest = False
            engine.control(status=int(k.TOO_HOT))
        engine.unconverged = "" if at_rest else free.unconverged
        engine.not_at_rest = "" if at_rest else free.unbalanced() or gross_slip(engine) or free.driven
        return at_rest
    finally:
        engine.control(energy_bounded=0)
        free.release()


def _stepped(engine: Engine, free: FreeMotions) -> bool:
    """The steps of `settle`."""
    model = engine.compiled.model
    length = float(model.length)
    least, last = LEAST * length, LAST * length
    longest = LONGER * last
    tau = FIRST * length if np.isfinite(free.first) else least
    level = LEVEL[1 if engine.compiled.patches else 0]
    too_long = np.inf
    before = latest = moved = failed_at = np.full(engine.worlds, np.inf)
    many = model.pairs.count > 1 or len(engine.scene.lumped_contacts) > 1
    retreats = RETREATS if many or engine.compiled.elements.layers.count else 0
    rubs = any(contact.friction.acts for contact in engine.scene.small_sliding)
    settled = balanced = still = False
    shortened, farthest = SHORTENED, _farthest(engine)
    for _ in range(MOST_STEPS):
        words = engine.state.ctl.numpy().copy()
        begin = engine.checkpoint() if shortened and np.isfinite(farthest) else {}
        engine.static_step(tau)
        if begin and not np.any(engine.word("status")) and _passes(engine, farthest):
            engine.resume(begin)
            shortened, too_long, failed_at, tau = shortened - 1, tau, moved, tau / GROWTH
            continue
        status = engine.word("status")
        if np.any(status):
            if still:  # the remaining forces and energies are round-off, and may increase
                engine.state.ctl.assign(words)
                return _at_rest(engine, free, creeping=False)
            if rubs and tau < FIRST * length and np.all((status == 0) | (status == int(k.ENERGY))):
                engine.state.ctl.assign(words)
                engine.control(energy_bounded=0)
                rubs, too_long, tau = False, np.inf, FIRST * length
                continue
            if free.hold_driven():
                engine.state.ctl.assign(words)
                continue
            can_be_shorter = not np.any(status & ~int(k.NOT_CONVERGED | k.ENERGY)) and tau > least
            if retreats == 0 and not (settled or balanced or can_be_shorter):
                return False
            engine.state.ctl.assign(words)
            if retreats > 0 and not (settled or balanced):
                retreats, tau = retreats - 1, tau / RETREAT
            else:
                too_long, failed_at, tau = tau, moved, tau / GROWTH
                before = np.zeros(engine.worlds)
            continue
        if free.unbalanced(turns=False):
            return False
        moved = np.maximum(engine.word("move"), _turned(engine))
        left = np.array([left_over(engine, world)[0] for world in range(engine.worlds)])
        free.look()
        if np.all(left <= free.first):
            free.hold()
        if free.wanders:
            free.hold_driven()
        if np.all(left <= level):
            engine.control(energy_bounded=0)
            shortened = 0
        if np.all(moved <= failed_at / GROWTH):
            too_long, before = np.inf, np.full(engine.worlds, np.inf)
        longer = [min(tau * growth, last) for growth in (GROWTH, CAREFUL, 1.0)]
        longer = next(t for t in longer if t < too_long)
        settled = bool(np.all(_moved_else(engine, free) <= TOLERANCE * length)) and _films_steady(engine)
        still = tau >= FIRST * length and bool(np.all(moved <= ROUND_OFF * length))
        balanced = bool(np.all(left <= model.limits.residual_tolerance)) and _temperatures_steady(
            engine, TEMPERATURES_CREEP
        )
        creeping = balanced and bool(np.any(moved > CREEP * before))
        if longer == tau and (creeping or (settled and (balanced or tau >= last))):
            return _at_rest(engine, free, creeping=not settled)
        if tau >= last:
            if last < longest and np.all(moved < latest) and np.any(moved > CREEP * latest):
                last *= GROWTH
            before = latest = moved
        tau = longer
    return balanced and _at_rest(engine, free, creeping=True)


def _farthest(engine: Engine) -> float:
    """The displacement [m] of a body per step beyond which it may pass through one in lumped contact."""
    ports = [port for contact in engine.scene.lumped_contacts for port in contact.ports]
    radii = [float(p.surface.shape.radius) for p in ports if not p.surface.shape.profile().planar]
    return FARTHEST * min(radii, default=np.inf)


def _passes(engine: Engine, farthest: float) -> bool:
    """Whether a body has moved that far [m], or rotated by more than `FARTHEST`, in the last step."""
    count = len(engine.scene.bodies)
    moves, turns = (getattr(engine.scratch, name).numpy()[:, :count] for name in ("dx", "psi"))
    return bool(np.any(np.linalg.norm(moves, axis=-1) > farthest) or np.any(np.linalg.norm(turns, axis=-1) > FARTHEST))


def _turned(engine: Engine) -> np.ndarray:
    """Largest rotation of a body in the last step times its radius of gyration (worlds,) [m]; a body that rotates about
    its centre of mass has no other motion."""
    turns = np.linalg.norm(engine.scratch.psi.numpy()[:, : len(engine.scene.bodies)], axis=-1)
    return np.asarray((_gyration(engine) * turns).max(axis=1, initial=0.0))


def _moved_else(engine: Engine, free: FreeMotions) -> np.ndarray:
    """Largest motion of a body in the last step except free motions (worlds,) [m], rotations at radii of gyration."""
    count, gyration = len(engine.scene.bodies), _gyration(engine)
    found = []
    for world in range(engine.worlds):
        step = np.hstack([getattr(engine.scratch, name).numpy()[world, :count] for name in ("dx", "psi")])
        rest = free.resisted_part(world, step)
        ways, turns = np.linalg.norm(rest.reshape(count, 2, 3), axis=-1).T
        found.append(max(ways.max(initial=0.0), (gyration * turns).max(initial=0.0)))
    return np.array(found)


def _gyration(engine: Engine) -> np.ndarray:
    """Radii of gyration (bodies,) [m]."""
    bodies, count = engine.compiled.model.bodies, len(engine.scene.bodies)
    return np.sqrt(np.trace(bodies.inertia.numpy(), axis1=1, axis2=2)[:count] / (3.0 * bodies.mass.numpy()[:count]))


def _films_steady(engine: Engine) -> bool:
    """Whether the cavity fractions of films, which need revolutions to become steady, have not changed in the last
    step.
    """
    films = engine.compiled.films
    if not films.count:
        return True
    moved = np.abs(engine.state.film_void.numpy()[:, 0] - engine.state.film_void_before.numpy()).max()
    return bool(moved <= VOIDS_STAY * films.thickness.numpy().min()) and _temperatures_steady(engine, TEMPERATURES_STAY)


def _temperatures_steady(engine: Engine, within: float) -> bool:
    """Whether the temperatures of films have not changed by more than `within` [K] in the last step."""
    return bool(np.all(engine.state.film_heat.numpy()[:, 0, :, int(CHANGE)] <= within))


def _at_rest(engine: Engine, free: FreeMotions, *, creeping: bool) -> bool:
    """True, with notes on free and creeping motions; history variables start here."""
    engine.start_notes.extend(free.notes())
    if creeping and np.isfinite(free.first):
        engine.start_notes.extend(creeping_notes(engine))
    engine.commit()
    return True


REST_ROUND_OFF = 1e-14  # of the largest force


def left_over(engine: Engine, world: int) -> tuple[float, str]:
    """The largest unbalanced force of the last proximal step, as a fraction of the largest force of the scene, a torque
    over the radius of gyration; and a clause that names the body that creeps under it.
    """
    m, scratch, bodies = engine.compiled.model, engine.scratch, engine.scene.bodies
    if not bodies:
        return 0.0, ""
    mass, inertia = m.bodies.mass.numpy()[: len(bodies)], m.bodies.inertia.numpy()[: len(bodies)]
    rate, turn = (np.asarray(a.numpy()[world][: len(bodies)]) for a in (scratch.v1_rate, scratch.omega1_rate))
    force = mass * np.linalg.norm(rate, axis=1)
    torque = np.linalg.norm(np.einsum("bij,bj->bi", inertia, turn), axis=1)
    gyration = np.sqrt(np.trace(inertia, axis1=1, axis2=2) / (3.0 * mass))
    both = np.maximum(force, torque / gyration)
    b = int(np.argmax(both))
    what = f"{force[b]:.2g} N" if force[b] * gyration[b] >= torque[b] else f"{torque[b]:.2g} N m"
    share = float(both[b]) / largest_force(engine, world)
    creeps = (
        f"body {bodies[b].name!r} is free in some direction and creeps under {what}, {share:.1g} of the largest force"
    )
    return share, creeps


def creeping_notes(engine: Engine) -> list[str]:
    """Note on an equilibrium in which a body keeps moving, in the worst world; none where round-off moves it."""
    share, clause = max(left_over(engine, world) for world in range(engine.worlds))
    if share <= REST_ROUND_OFF:
        return []
    return [f"equilibrium: {clause}; taken as at rest there, a weak spring on what is free would hold it"]


def press(engine: Engine, motions: PressedMotions) -> bool:
    """Bring every world of `engine` from its present state to the one in which it is pressed together; True on success,
    else why not is in its status and in `engine.not_at_rest`."""
    begin, notes = engine.checkpoint(), list(engine.start_notes)
    found = settle(engine, motions)
    if not any(len(m) for m in motions.resisted):
        return found
    engine.resume(begin)
    engine.start_notes[:] = notes
    motions.hold()
    return settle(engine, motions)


class PressedMotions(FreeMotions):
    """Motions that nothing resists, and those that friction will resist, constrained in the same way."""

    holds = yields = 1e-2 * HOLD
    weakens, bears = False, True
    first = np.inf
    leans = False  # whether some change gaps by less than LEANS

    def __init__(self, engine: Engine, lean: float = 0.0) -> None:
        super().__init__(engine, rubs=True)
        self.lean = lean

    def look(self) -> None:
        """As of `FreeMotions`, and whether gaps change by motions that friction will resist."""
        super().look()
        for world, resisted in enumerate(self.resisted):
            if not self.leans and self._presses(world):
                self.leans = len(self._resisted(world, LEANS)) > len(resisted)

    @property
    def presses(self) -> bool:
        """Whether surfaces with friction are under pressure in every world."""
        return all(self._presses(world) for world in range(self.engine.worlds))

    def notes(self) -> list[str]:
        """None: the state is an intermediate one."""
        return []


AT_REST = 1e-9  # of the fastest sliding surface and 1 m/s: round-off of velocities that are zero


class Friction:
    """Of the joints of one world, with velocities of the `rate` (rows,) of its rows."""

    def __init__(self, engine: Engine, world: int, rate: np.ndarray) -> None:
        self.engine, self.world = engine, world
        table = engine.compiled.slips
        self.rows, self.held = list(table.rows.values()), list(table.held.values())
        self.laws = list(table.laws.values())
        slip = [np.array(law.weights) * rate[rows] for law, rows in zip(self.laws, self.rows, strict=True)]
        fastest = max([1.0, *(float(np.linalg.norm(v)) for v in slip)])
        self.ways = [self._way(law, v, fastest) for law, v in zip(self.laws, slip, strict=True)]

    @property
    def sticking(self) -> list[int]:
        """Rows that stick."""
        return [row for rows, way in zip(self.rows, self.ways, strict=True) if way is None for row in rows]

    def forces(self, lam: np.ndarray) -> tuple[list[int], np.ndarray]:
        """Rows that slip, and their friction as multipliers, for reactions by the multipliers `lam`."""
        rows, found = [], []
        for e, way in enumerate(self.ways):
            if way is not None:
                rows += self.rows[e]
                found += list(np.array(self.laws[e].weights) * self._bound(e, lam) * way)
        return rows, np.array(found)

    def lets_go(self, lam: np.ndarray) -> bool:
        """Release sticking rows whose force exceeds the bound; True if there are any."""
        gone = False
        for e, (law, rows, way) in enumerate(zip(self.laws, self.rows, self.ways, strict=True)):
            force = lam[rows] / np.array(law.weights)
            size = float(np.linalg.norm(force))
            if way is None and size > self._bound(e, lam):
                self.ways[e], gone = force / size, True
        return gone

    def store(self, lam: np.ndarray) -> None:
        """Set in the engine which joints slip, where the others stick, and the bounds by the multipliers `lam`."""
        value = self.engine.scratch.coordinate.numpy()[self.world]
        arrays = [self.engine.state.slipping, self.engine.state.stuck_at, self.engine.scratch.slip_bound]
        slipping, stuck_at, bound = (array.numpy().copy() for array in arrays)
        for e, (rows, way) in enumerate(zip(self.rows, self.ways, strict=True)):
            slipping[self.world, e] = int(way is not None)
            stuck_at[self.world, e, : len(rows)] = value[rows]
            bound[self.world, e] = self._bound(e, lam)
        for array, values in zip(arrays, (slipping, stuck_at, bound), strict=True):
            array.assign(values)

    @staticmethod
    def _way(law: SlipLaw, v: np.ndarray, fastest: float) -> np.ndarray | None:
        """Friction divided by its bound, None if sticking."""
        speed, slow = float(np.linalg.norm(v)), law.friction.creep_limit
        if slow > 0.0:
            return v / max(speed, slow)
        return v / speed if speed > AT_REST * fastest else None

    def _bound(self, e: int, lam: np.ndarray) -> float:
        law, wrench = self.laws[e], self.engine.scratch.row_wrench.numpy()[self.world]
        row = wrench[self.rows[e][0]]
        axis = row[:3] if law.coordinates[0].kind == "translation" else row[3:]
        on_second = -lam[self.held[e]] @ wrench[self.held[e]]
        return law.bound(on_second[:3], on_second[3:], axis)
