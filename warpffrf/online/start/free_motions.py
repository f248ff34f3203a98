r"""Rigid motions of the bodies that neither joints, springs nor closed contacts resist, and their constraint in a
static state.

Let C be the gradients, by the rigid coordinates z, of all active rows (joints, drives, springs) and L those of the weak
gaps of active nodes, of the gaps of closed lumped contacts and of cells of small-sliding contacts under pressure, with
their slips if they have friction. A motion is free where C z = 0 and L z = 0: a roller about its axle, regardless of
its contacts, a ball about any line, a body that slides along a plane. Free motions are the right singular vectors of
(C, L), of unit length in mass-weighted coordinates, with singular values below FREE. With lumped contacts only, L has a
second order as well (`bent_gaps`): a ball that climbs its groove is constrained.

Load steps with friction (`rubs`) start from a state under pressure, and loaded contacts also resist slip, up to the
friction bound. With T the gradients of slips of loaded cells, of closed lumped contacts and of joints with friction,
and N the motions above, those are free whose root-mean-square slips T N y are below STICKS: a roller that rolls on a
patch of half-width a moves it by (a/R)^2/2. Where friction cannot balance the loads, the load step finds no
equilibrium.

Motions that friction of surfaces resists (T N y above STICKS, with N those that joints leave free and gaps resist by
less than LEANS) are constrained by YIELD in the first round of a load step, and by a quarter of the previous value in
each further round (`warpffrf_kernels.step.proximal`). While the contact does not slip everywhere, the patch carries
the load, and a few rounds find its compliance. Without this constraint a body would move by metres under the load
alone, and the slips of the patch, of micrometres, would be resolved with eight digits less. Two balls that have slipped
by s resist each other by s/(R_1 + R_2). This soon exceeds FREE, but a stiffness multiplied by its square constrains no
body.

A constrained free motion n gets the inertia n n^T m/(HOLD L)^2, L the length of the scene, in proximal steps (kernels
`motion`), so that it does not move. The force along it must not exceed PULLED of the largest force: a load that drives
it finds no equilibrium, and it is not constrained.

**Slopes.** A motion that is free to first order may change a gap by up to FREE. There a force F drives it by slope
times F. This may be an error of the cells of a patch, 1e-7 of F, or real: the loads Q on a roller that is off the
middle of a ring by y tilt it by Q y/K, and push it further out along its axis by the same fraction of Q. Such motions
are followed, since a ball finds the bottom of its groove in this way, which is nearer than FREE of its radius. Where
they go further (`wanders`), or a proximal step fails, those driven by less than FREE of the largest force are
constrained as well, and reported with the force that drives them.

A slope requires that no load drives the motion. As a motion n moves against no row and no gap, its whole drive is that
of loads Q_b on bodies b, weights and constant forces. The load on a ring does little work as the roller under it goes
out: the ring sinks by a slope, Q_b n_b < FREE |Q_b| with n of unit length. The work of all others,

    sum |Q_b n_b|      over bodies with Q_b n_b > FREE |Q_b|      (`driven_by_loads`),

must be negligible, as above, however large forces elsewhere are: a pendulum next to the ring is followed to the
bottom, and a load on a body guided by a slide finds no equilibrium.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from warpffrf.model.bearings.bearing import loose_ring, not_guided
from warpffrf.model.bodies import Body
from warpffrf.model.checks.scene import connecting, floating_groups
from warpffrf.model.contact import Contact
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.scene import Scene
from warpffrf.online.diagnosis.failure_report import largest_force
from warpffrf.online.diagnosis.no_equilibrium import LOOK_AHEAD, approached
from warpffrf.online.engine import Engine
from warpffrf.online.start.gradients import cell_slips, closed_places, gap_gradients, joint_slips, lumped_gradients
from warpffrf.online.start.motions import held_by_matched, lines_of, told_of, without_stiff

# of a line of length one: the modes move an axle off the axis of the rim by a hundred-thousandth of its radius
FREE = 1e-5
STICKS = 3e-3  # the same of slips: patches of half-widths up to a fifteenth of a radius roll
TURNED = 1e-5  # of the largest force, at the radius of gyration: the effect of the same offset
PULLED = 1e-8  # of the largest force, along a free translation: ten times what Newton's method may leave unbalanced
# of the scene's length: displacement per step on a slope. The next step moves a hundred times as far, and a bottom
# that a slope below FREE leads to is not as far away
FAR = 1e-2 * FREE
LEANS = 0.1  # root mean square of the gaps of two bodies, which resist a hundredth of what friction does there
YIELD = 1e-2  # s/m: initial value, against friction: a mass of 1 kg in a scene of 0.1 m at 1e6 N/m
HOLD = 1e-5  # s/m: 1e-6 s for a scene of 0.1 m, in which a force F moves a mass m by F/m 1e-12 s2 per step
NEARLY = 1e-3  # of the largest force, unbalanced: contact has closed, and free motions can be identified
TAKES_PART = 0.1  # of a body's share in a motion, its square between 0 and 1
MOST_NAMED = 4
SLIDES = 0.5  # of a body's share: whether it slides or rotates
SLIDE = "slide along"
TURN = "turn about"
SLIDES_FOLDED = {2: f"{SLIDE} a plane", 3: f"{SLIDE} any line"}
TURNS_FOLDED = {2: f"{TURN} any line of a plane", 3: f"{TURN} any line"}
BY_ITSELF = 1e-6  # of a body's share, the remainder where the body moves without others
WHOLE = 0.5  # of a motion of unit length: whether it is among those that are constrained
STANDS = 1e-6  # of a motion's square: its sliding part in rotation about an axle slightly off the centre of mass


class FreeMotions:
    """Those of the worlds of an engine at the state of its last evaluation; rubs: friction resists motions."""

    holds, yields = HOLD, YIELD  # s/m
    bears = False  # whether free motions are constrained against loads, once a contact with friction is under pressure
    weakens = True  # constraint of what friction resists, from round to round
    lean = LEANS  # gaps under pressure do not constrain motions that change them by less; 0: by FREE, as free motions
    first = NEARLY  # of the largest force, unbalanced: constraints apply below it
    holds_driven = False  # whether motions driven by slopes are constrained
    wanders = False  # whether a motion driven by slopes has gone far in the last step

    def __init__(self, engine: Engine, *, rubs: bool = False) -> None:
        self.engine, self.rubs = engine, rubs
        none = np.zeros((0, 6 * len(engine.scene.bodies)))
        self.found: list[np.ndarray] = [none] * engine.worlds
        self.floating = floating_groups(engine.scene)
        self._sloping: list[np.ndarray] = [none] * engine.worlds  # the same with motions driven by slopes
        self.resisted: list[np.ndarray] = [none] * engine.worlds
        self._drive: tuple[int, np.ndarray, float] | None = None  # world, motion, force of a load that drives one
        self._way = np.zeros(0)  # motion of the bodies (6 bodies,) that all such loads drive together
        # over the weights: drive of motions that are constrained although slopes drive them (6 bodies,)
        self._slope = [np.zeros(6 * len(engine.scene.bodies))] * engine.worlds

    @property
    def possible(self) -> bool:
        """Without contact grids nothing drives free motions, nor do small-sliding contacts in load steps, each of which
        is near the previous one.
        """
        compiled = self.engine.compiled
        matched = compiled.matched.count > 0 and not self.rubs
        return (compiled.model.pairs.count > 0 or matched) and len(self.engine.scene.bodies) > 0

    @property
    def told(self) -> bool:
        """Whether there is something to report. In scenes of lumped contacts alone, and of floating bodies, the
        proximal step leaves free motions where they are, as nothing acts along them, to round-off; they are reported
        nevertheless.
        """
        lumped = len(self.engine.scene.lumped_contacts) > 0 and len(self.engine.scene.bodies) > 0
        return self.possible or lumped or len(self.floating) > 0

    def look(self) -> None:
        """Find the free motions at the state of the last step."""
        self._drive, self.wanders = None, False
        if not self.told:
            return
        for world in range(self.engine.worlds):
            weight = self._weight()
            motions = free_motions(self.engine, world, weight)
            motions = without_stiff(self.engine, world, weight, motions)
            if self.rubs:
                _, motions = parted(self.engine, world, weight, motions)
            if self.rubs and self._presses(world):
                self.resisted[world] = self._resisted(world, self.lean)
            scale = np.sqrt((motions**2) @ np.repeat(self._mass(), 6))
            left = self._forces(world)
            pull = motions @ (left / weight)
            along = pull * scale
            force = np.abs(along)
            sliding = np.array([np.sum(n.reshape(-1, 6)[:, :3] ** 2) for n in motions])
            largest = largest_force(self.engine, world)
            allowed = np.where(sliding > STANDS, PULLED, TURNED) * largest
            all_of_them = self.bears and self._presses(world)
            loads = driven_by_loads(self.engine, world, weight, motions, left) * scale
            slopes = (force > allowed) & (force <= FREE * largest) & (loads <= allowed)
            self._sloping[world] = motions[(force <= allowed) | slopes | all_of_them]
            away = np.abs(motions @ (self._step(world) * weight)) / scale
            self.wanders |= bool(np.any(slopes & (away > FAR * float(self.engine.compiled.model.length))))
            if self.holds_driven:
                self._slope[world] = pull[slopes] @ motions[slopes]
                allowed = np.where(slopes, FREE * largest, allowed)
            self.found[world] = motions[(force <= allowed) | all_of_them]
            if np.any(force > allowed):
                worst = int(np.argmax(force / allowed))
                self._drive = (world, motions[worst] * np.sign(along[worst]), float(force[worst]))
                self._way = np.where(force > allowed, pull, 0.0) @ motions / weight

    def _resisted(self, world: int, lean: float) -> np.ndarray:
        """What friction of surfaces under pressure resists."""
        weight = self._weight()
        return parted(self.engine, world, weight, unsprung_motions(self.engine, world, weight, lean))[0]

    def hold_driven(self) -> bool:
        """From now on also constrain motions driven by slopes; False where this adds none."""
        more = any(len(a) > len(b) for a, b in zip(self._sloping, self.found, strict=True))
        if self.holds_driven or not more or not self.possible:
            return False
        self.holds_driven, self.found = True, list(self._sloping)
        self.hold()
        return True

    def hold(self) -> None:
        """Constrain the motions that `look` found, from the next step on."""
        if not self.possible:
            return
        scratch, length = self.engine.scratch, self.engine.compiled.model.length
        vectors = scratch.hold.numpy().copy()
        count, firm = np.zeros((2, self.engine.worlds), dtype=np.int32)
        for world, (free, resisted) in enumerate(zip(self.found, self.resisted, strict=True)):
            firm[world], count[world] = len(free), len(free) + len(resisted)
            motions = np.vstack([free / self.holds, resisted / self.yields])
            vectors[world, : count[world]] = motions * self._weight() / length
        scratch.hold.assign(vectors)
        scratch.hold_count.assign(count)
        scratch.hold_firm.assign(firm if self.weakens else count)
        scratch.hold_weak.fill_(1.0)

    def hold_here(self) -> None:
        """Constrain what nothing resists at the present state."""
        if self.possible:
            self.release()
            self.engine.evaluate_here()
            self.look()
            self.hold()

    def release(self) -> None:
        """Remove all constraints."""
        if self.possible:
            self.engine.scratch.hold_count.zero_()

    def resisted_part(self, world: int, step: np.ndarray) -> np.ndarray:
        """Small motions of the bodies (bodies, 6), displacements [m] and rotations [rad], without the part that the
        last look found free.
        """
        weight = self._weight()
        motion, free = step.ravel() * weight, self.found[world]
        return ((motion - free.T @ (free @ motion)) / weight).reshape(step.shape)

    def unbalanced(self, *, turns: bool = True) -> str:
        """A clause on floating bodies whose loads do not balance, after a proximal step; else "". turns: whether
        torques count.
        """
        mass, weight = self._mass(), self._weight()
        for world in range(self.engine.worlds if self.floating else 0):
            forces, least = self._forces(world), PULLED * largest_force(self.engine, world)
            for group in self.floating:
                lines = lines_of(self.engine, world, group)
                force, torque = np.split(lines @ forces, 2)
                gyration = np.sqrt(np.sum((lines[3:] * weight) ** 2) / (3.0 * mass[group].sum()))
                told = f"({', '.join(f'{c:.3g}' for c in force)}) N" if np.linalg.norm(force) > least else ""
                if turns and np.linalg.norm(torque) > TURNED / PULLED * least * gyration:
                    told += " and " if told else ""
                    told += f"({', '.join(f'{c:.3g}' for c in torque)}) N m about the centre of mass"
                if told:
                    return f"{told_of(self.engine, group)} do not balance: the resultant is {told}"
        return ""

    def afloat(self) -> list[str]:
        """Text on groups that float in an equilibrium, in which their loads balance."""
        told = [(told_of(self.engine, group), "it is" if len(group) == 1 else "they are") for group in self.floating]
        return [f"equilibrium: {loads} balance: left where {left}" for loads, left in told]

    def _beside_afloat(self, world: int) -> np.ndarray:
        """Constrained motions other than those of groups that float as a whole."""
        motions = self.found[world]
        for group in self.floating:
            rigid = np.linalg.qr((lines_of(self.engine, world, group) * self._weight()).T)[0].T
            _, values, vectors = np.linalg.svd(motions - motions @ rigid.T @ rigid, full_matrices=False)
            motions = vectors[values > WHOLE]
        return motions

    def notes(self) -> list[str]:
        """One line on the motions that were left where they are."""
        clauses: dict[str, dict[str, float]] = {}
        for world in range(self.engine.worlds):
            found = self._beside_afloat(world)
            weight, least = self._weight().reshape(-1, 6), PULLED * largest_force(self.engine, world)
            for b, body in enumerate(self.engine.scene.bodies):
                own = slice(6 * b, 6 * b + 6)
                for clause, motions in _motions_of(found[:, own]):
                    told = clause or self._clause(world, b, motions[0], weight[b])
                    drive = float(np.linalg.norm(motions @ self._slope[world][own]))
                    way = slice(0, 3) if told.startswith(SLIDE) else slice(3, 6)
                    amount = drive * weight[b, way][0] / np.linalg.norm(motions[0, way])  # N, N m
                    drives = clauses.setdefault(told, {})
                    drives[body.name] = max(drives.get(body.name, 0.0), amount if drive * weight[b, 0] > least else 0.0)
        told = self.afloat()
        for clause, drives in clauses.items():
            names = list(drives)
            left = "it is" if len(names) == 1 else "they are"
            more = self._unpressed(names) if clause.startswith(SLIDE) else ""
            more += _against(drives, "N" if clause.startswith(SLIDE) else "N m")
            told.append(f"equilibrium: {_named(names)} free to {clause}, and left where {left}{more}")
        return told

    def _unpressed(self, names: list[str]) -> str:
        """For bodies that slide freely: the contacts of those that touch nothing, and what would press them
        together.
        """
        touching = self.engine.state.active.numpy().any(axis=(0, 2))
        owners = [(c, t, {port.body.name for port in c.ports}) for c, t in zip(self._contacts, touching, strict=False)]
        idle = {name for name in names if not any(t for _, t, bodies in owners if name in bodies)}
        pairs = [c.name for c, _, bodies in owners if bodies & idle]
        if not pairs:
            return ""
        joints = [str(j.name) for j in self.engine.scene.joints if any(port.body.name in idle for port in j.ports)]
        spring = "a spring with a preload" + (f" along joint {_listed(joints)}" if joints else "")
        return f": nothing presses on contact {_listed(pairs)}; {spring}, a force or gravity would"

    @property
    def _contacts(self) -> list[Contact]:
        return self.engine.scene.finite_sliding

    @property
    def unconverged(self) -> str:
        """Where the iteration of a static state did not converge, a clause on how bodies still moved at its end:
        towards an open contact, or against what resists it. "" where a motion is free.
        """
        if self._drive is not None:
            name = approached(self.engine, self._drive[0], self._way)
            return f"towards contact {name!r}, which is open" if name else ""
        if np.any(self.engine.word("status")):  # the last step is none
            return ""
        weight = self._weight()
        for world in range(self.engine.worlds):
            step, free = self._step(world) * weight, free_motions(self.engine, world, weight)
            if np.linalg.norm(free @ step) < WHOLE * np.linalg.norm(step):
                return "although that is resisted"
        return ""

    @property
    def driven(self) -> str:
        """A clause where a load drives a free motion at the state of the last look, towards no contact; else ""."""
        if self._drive is None or self.unconverged:
            return ""
        world, motion, force = self._drive
        parts = motion.reshape(-1, 6)
        b = int(np.argmax(np.sum(parts**2, axis=1)))
        weight = self._weight()[6 * b : 6 * b + 6]
        clause = self._clause(world, b, parts[b] / np.linalg.norm(parts[b]), weight)
        amount = f"{force:.3g} N" if clause.startswith(SLIDE) else f"{force * weight[3] / weight[0]:.3g} N m"
        body = self.engine.scene.bodies[b]
        missed = self._missed(body, parts[b][:3]) if clause.startswith(SLIDE) else ""
        missed += "" if self.rubs else _unrubbed(self.engine.scene, body)
        told = f"body {body.name!r} is free to {clause}, and {amount} drive it there{missed}"
        bearings, items = self.engine.scene.bearings, connecting(self.engine.scene)
        slides = not_guided(bearings, [], body) if clause.startswith(SLIDE) else ""
        return loose_ring(bearings, items, body) or slides or told

    def _missed(self, body: Body, direction: np.ndarray) -> str:
        """The contacts of a body that do not stop it along `direction`: those that it leaves, and those that it
        passes.
        """
        told = []
        for contact in self._contacts:
            side = {contact.b.body.name: 1.0, contact.a.body.name: -1.0}.get(body.name)
            before = facing_gap(contact)
            if side is None or before is None:
                continue
            step = side * LOOK_AHEAD * float(contact.a.surface.shape.radius) * direction / np.linalg.norm(direction)
            after = facing_gap(contact, step)
            leaves = after is None or after[0] > before[0]
            told.append(f"{'away from' if leaves else 'past'} contact {contact.name!r}")
        return f", {' and '.join(told)}" if told else ""

    def _clause(self, world: int, b: int, y: np.ndarray, weight: np.ndarray) -> str:
        axes = np.asarray(self.engine.scratch.axes.numpy()[world][b])
        slides = float(y[:3] @ y[:3]) > SLIDES
        direction = (y / weight)[:3] if slides else axes @ (y / weight)[3:]
        direction = direction / np.linalg.norm(direction)
        direction = np.round(direction * np.sign(direction[np.argmax(np.abs(direction))]), 2) + 0.0
        return f"{SLIDE if slides else TURN} ({', '.join(f'{c:g}' for c in direction)})"

    def _presses(self, world: int) -> bool:
        """Whether surfaces with friction are under pressure."""
        rubs = self.engine.compiled.model.pairs.friction.numpy()[: self.engine.compiled.model.pairs.count] > 0.0
        active = self.engine.state.active.numpy()[world, : len(rubs)]
        return bool(np.any(active[rubs]))

    def _mass(self) -> np.ndarray:
        return np.asarray(self.engine.compiled.model.bodies.mass.numpy()[: len(self.engine.scene.bodies)])

    def _weight(self) -> np.ndarray:
        """Root of mass, and of the mean moment of inertia (6 bodies,)."""
        mass = self._mass()
        inertia = self.engine.compiled.model.bodies.inertia.numpy()[: len(mass)]
        turning = np.sqrt(np.trace(inertia, axis1=1, axis2=2) / 3.0)
        return np.repeat(np.stack([np.sqrt(mass), turning], axis=1), 3, axis=1).ravel()

    def _forces(self, world: int) -> np.ndarray:
        """Unbalanced forces of the last proximal step: force, torque in body axes (6 bodies,); including the
        constraint's.
        """
        engine, mass = self.engine, self._mass()
        n = len(mass)
        inertia = engine.compiled.model.bodies.inertia.numpy()[:n]
        rate, turn = (np.asarray(a.numpy()[world][:n]) for a in (engine.scratch.v1_rate, engine.scratch.omega1_rate))
        own = np.hstack([mass[:, None] * rate, np.einsum("bij,bj->bi", inertia, turn)]).ravel()
        count = int(engine.scratch.hold_count.numpy()[world])
        held = engine.scratch.hold.numpy()[world, :count, : 6 * n]
        return own + held.T @ (held @ self._step(world))

    def _step(self, world: int) -> np.ndarray:
        """Displacements and rotations of the bodies in the last proximal step (6 bodies,)."""
        scratch, n = self.engine.scratch, len(self.engine.scene.bodies)
        return np.hstack([np.asarray(a.numpy()[world][:n]) for a in (scratch.dx, scratch.psi)]).ravel()


def _motions_of(part: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Motions of a body, from its part (n, 6) of the free motions: directions (k, 6) with a clause where it slides
    without rotation, or rotates without sliding, in more than one; each other direction with "".
    """
    projector = part.T @ part
    for at, folds in ((slice(0, 3), SLIDES_FOLDED), (slice(3, 6), TURNS_FOLDED)):
        share, directions = np.linalg.eigh(projector[at, at])
        alone = np.zeros((6, int(np.count_nonzero(share > 1.0 - BY_ITSELF))))
        alone[at] = directions[:, share > 1.0 - BY_ITSELF]
        projector = projector - alone @ alone.T
        if alone.shape[1] in folds:
            yield folds[alone.shape[1]], alone.T
        else:
            yield from (("", y[None]) for y in alone.T)
    share, directions = np.linalg.eigh(projector)
    yield from (("", y[None]) for y in directions.T[share > TAKES_PART])


def _against(drives: dict[str, float], unit: str) -> str:
    """For bodies that slide or rotate freely, by name: the largest unbalanced force with which slopes drive one."""
    worst = max(drives, key=lambda name: drives[name])
    if drives[worst] == 0.0:
        return ""
    return f", although {drives[worst]:.2g} {unit} drive {worst!r}; friction, a rib or a joint would hold it"


def free_motions(engine: Engine, world: int, weight: np.ndarray) -> np.ndarray:
    """Orthonormal lines (n, 6 bodies) in coordinates times `weight`: displacement in world, rotation in body axes."""
    return _free_of(engine, world, weight, _rigid_rows(engine, world) | _sprung_rows(engine, world))


def unsprung_motions(engine: Engine, world: int, weight: np.ndarray, lean: float) -> np.ndarray:
    """As `free_motions`, but without resistance of springs, nor of gaps between two bodies whose root-mean-square
    change is less than `lean`.
    """
    return _free_of(engine, world, weight, _rigid_rows(engine, world), lean)


def _rigid_rows(engine: Engine, world: int) -> np.ndarray:
    """Which rows are joints, drives and pretensions at fixed length (rows,)."""
    m = engine.compiled.model
    holds = m.rows.rigid.numpy()[: m.rows.count] != 0
    holds[engine.locked_rows(world)] = True
    return holds


def _sprung_rows(engine: Engine, world: int) -> np.ndarray:
    """Which rows are springs (rows,)."""
    m, scratch = engine.compiled.model, engine.scratch
    holds = m.rows.stiffness.numpy()[: m.rows.count] > 0.0
    for start, sprung in zip(m.groups.start.numpy()[: m.groups.count], m.groups.sprung.numpy(), strict=False):
        holds[start : start + sprung] = True
    value, rate = scratch.coordinate.numpy()[world], engine.state.drive_rate.numpy()[world, 1]
    for name, own in engine.compiled.forces.rows.items():
        elastic, _ = engine.compiled.forces.laws[name].slopes(value[own], rate[own])
        holds[own] |= elastic != 0.0
    return holds


def _free_of(engine: Engine, world: int, weight: np.ndarray, holds: np.ndarray, lean: float = 0.0) -> np.ndarray:
    """Motions that the active rows and the gaps under pressure leave free, as in `free_motions`; each involves only
    coupled bodies, so that what drives one mechanism is not reported for another. lean: see `unsprung_motions`.
    """
    lines, _ = _lines(engine, world, len(weight), holds)
    rows, gaps = (_of_length_one(own / weight) for own in np.split(lines, [np.count_nonzero(holds)]))
    if lean > 0.0 and len(gaps):  # as seen by the heavier of two bodies, which moves less because of its mass
        parts = np.linalg.norm(gaps.reshape(len(gaps), -1, 6), axis=2)
        _, which, count = np.unique(parts > 0.0, axis=0, return_inverse=True, return_counts=True)
        least = np.min(np.where(parts > 0.0, parts, np.inf), axis=1)
        gaps = gaps * (FREE / lean / least / np.sqrt(count[which.ravel()]))[:, None]
    lines = np.vstack([rows, gaps])
    found = []
    for bodies in _groups(lines):
        columns = (6 * bodies[:, None] + np.arange(6)).ravel()
        own = lines[np.any(lines[:, columns] != 0.0, axis=1)][:, columns]
        _, values, vectors = np.linalg.svd(own, full_matrices=True)
        rank = int(np.count_nonzero(values > FREE))
        motions = np.zeros((len(columns) - rank, len(weight)))
        motions[:, columns] = vectors[rank:]
        found.append(motions)
    return np.vstack(found)


def _groups(lines: np.ndarray) -> list[np.ndarray]:
    """Bodies that lines (n, 6 bodies) couple with each other."""
    from scipy.sparse.csgraph import connected_components

    takes_part = np.any(lines.reshape(len(lines), lines.shape[1] // 6, 6) != 0.0, axis=2).astype(int)
    count, group = connected_components(takes_part.T @ takes_part, directed=False)
    return [np.flatnonzero(group == i) for i in range(count)]


def driven_by_loads(
    engine: Engine, world: int, weight: np.ndarray, motions: np.ndarray, left: np.ndarray
) -> np.ndarray:
    """The largest force with which loads drive `motions` (lines as in `free_motions`), except those on bodies that move
    across their load, up to FREE (n,), conjugate to the size of the motions. left: forces on the bodies (6 bodies,).
    """
    lines, forces = _lines(engine, world, len(weight), _rigid_rows(engine, world) | _sprung_rows(engine, world))
    loads = ((left - forces @ lines) / weight).reshape(-1, 6)
    drive = np.abs(np.einsum("bi,nbi->nb", loads, motions.reshape(len(motions), *loads.shape)))
    along = drive > FREE * np.linalg.norm(loads, axis=1)
    return np.asarray(np.sum(np.where(along, drive, 0.0), axis=1))


def _lines(engine: Engine, world: int, size: int, holds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradients of the active rows and of the gaps under pressure, by the rigid coordinates (n, size), and the loads
    along them, forces [N], torques [N m], pressures [Pa] (n,).
    """
    rows = np.asarray(engine.scratch.C.numpy()[world][: len(holds), :size])[holds]
    pulls = np.asarray(engine.state.lam.numpy()[world][: len(holds)])[holds]
    gaps, pressures = gap_gradients(engine, world, size)
    closed = closed_places(engine, world)
    touches = lumped_gradients(engine, world, size)
    pushes = np.asarray(engine.state.lumped_force.numpy()[world, 1])[closed]
    matched, pressed = held_by_matched(engine, world, size)
    return np.vstack([rows, gaps, touches, matched]), np.concatenate([pulls, pressures, pushes, pressed])


def parted(engine: Engine, world: int, weight: np.ndarray, motions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Splits `motions`, orthonormal lines as in `free_motions`, into the combinations that cause slip under pressure,
    and the rest.
    """
    size = len(weight)
    rows = [joint_slips(engine, world, size), lumped_gradients(engine, world, size, slips=True)]
    lines = _of_length_one(np.vstack([*rows, *cell_slips(engine, world, size)]) / weight)
    if not len(lines) or not len(motions):
        return motions[:0], motions
    _, values, vectors = np.linalg.svd(lines @ motions.T / np.sqrt(len(lines)), full_matrices=True)
    slips = int(np.count_nonzero(values > STICKS))
    return vectors[:slips] @ motions, vectors[slips:] @ motions


def _unrubbed(scene: Scene, body: Body) -> str:
    """For a body in a static state without friction: its contacts with friction, and when friction counts."""
    contacts = [
        c for c in (*scene.finite_sliding, *scene.lumped_contacts) if c.friction.acts and not c.friction.creep_limit
    ]
    names = [str(c.name) for c in contacts if body in [port.body for port in c.ports]]
    if not names or scene.films:
        return ""
    return f", and friction of {_listed(names)} counts in equilibrium(scene, friction=True) only"


def _of_length_one(lines: np.ndarray) -> np.ndarray:
    """The nonzero lines, normalised."""
    length = np.linalg.norm(lines, axis=1, keepdims=True)
    return lines[length[:, 0] > 0.0] / length[length[:, 0] > 0.0]


def _named(names: list[str]) -> str:
    return f"body {_listed(names)} is" if len(names) == 1 else f"bodies {_listed(names)} are"


def _listed(names: list[str]) -> str:
    quoted = [repr(name) for name in names[:MOST_NAMED]]
    if len(names) > MOST_NAMED:
        quoted.append(f"and {len(names) - MOST_NAMED} more")
    return ", ".join(quoted)
