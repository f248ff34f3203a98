"""Unconstrained bodies that fall during the whole run, for example because of a missing joint.

A body is connected to the ground by chains of joints, springs, films and small-sliding contacts, and of contacts that
touched in the run. An unconnected body moves with gravity, intended in free flight and otherwise a mistake, so it is
noted if gravity acts.

Steep falls. Notes on coefficients of friction that fell too steeply for a step
(`warpffrf_kernels.friction.slip_speed`).

Load notes. Assessment of the load steps of a static run by its energy ledger.

The work of a load step is booked by the trapezoidal rule, which is exact where displacements are in proportion to loads
and has an error of the cube of the step otherwise. The difference is the numerical line. This line also contains the
energy lost when a structure snaps to another equilibrium, at any step; such jumps are noted separately.

Hidden inertia. Bodies so light compared with their neighbours that round-off removes them from the equations of the
joints.

A row c of a joint has the compliance c_b M_b^-1 c_b^T on its side b. A joint between a heavy and a light
body adds both; if one is 1e16 times the other, double precision has no digit for the latter, and independent rows
appear dependent. A system that is singular although its rows are independent is of that kind.

Untouched. Contacts without load in a whole run: surfaces that only touch, that cannot touch, or that stay apart.

Forces below `UNLOADED` of the largest contact force are round-off of the balance of forces. Each note names the
contact, the observation and the cure; contacts that stay apart share one note, with the smallest distance of each.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.bearings.geometry import SIDES
from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.checks.contacts import out_of_reach
from warpffrf.model.checks.scene import reached_from
from warpffrf.model.contact import Contact
from warpffrf.model.forces import JointSpringDamper
from warpffrf.model.friction import rubbing
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Signal
from warpffrf.online.diagnosis.energy_watch import round_off_energy
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import ContactHistory, History
from warpffrf_kernels.core import control as k
from warpffrf_kernels.friction.slip_speed import COUNT, MILDER, WORST

FELL = 0.5  # of g t^2/2, by which a body has to have gone down that fell


def fall_notes(scene: Scene, history: History) -> list[str]:
    """A note naming the unconstrained bodies that fell from the first to the last saved step."""
    size = float(np.linalg.norm(scene.gravity))
    seconds = float(history.time[-1] - history.time[0]) if len(history.time) else 0.0
    if size == 0.0 or seconds <= 0.0:
        return []
    touched = [c for c in scene.finite_sliding if np.any(history.contacts[c.name].force != 0.0)]
    touched += [c for c in scene.lumped_contacts if np.any(history.lumped_contacts[c.name].force != 0.0)]
    held = reached_from(GROUND_INDEX, [*scene.joints, *scene.forces, *touched, *scene.films, *scene.small_sliding])
    down = scene.gravity / size
    fell = []
    for body in scene.bodies:
        if body.index in held:
            continue
        motion = history.bodies[body.name]
        drop = float((motion.position[-1] - motion.position[0] - motion.velocity[0] * seconds) @ down)
        if drop > FELL * 0.5 * size * seconds**2:
            fell.append(f"body {body.name!r} by {drop:.3g} m")
    if not fell:
        return []
    return [
        f"fell freely through the whole run: {', '.join(fell)}; no joint, spring or closed contact connects it to the "
        "ground; if this is not intended, add the missing joint, or close the gap"
    ]


def steep_notes(scene: Scene, steep: np.ndarray) -> list[str]:
    """A note for every pair with steps whose slip was not the only one; steep (pairs, 3): see `slip_speed.mark`."""
    notes = []
    for contact, found in zip(scene.finite_sliding, steep, strict=False):
        if not found[int(COUNT)]:
            continue
        cure = "take a shorter step"
        if found[int(WORST)] == int(MILDER):
            cure = (
                "the elastic surface, which has no inertia of its own, is too soft for it at any step: let the "
                "coefficient fall over higher speeds"
            )
        notes.append(
            f"contact {contact.name!r}: in {found[int(COUNT)]} steps the coefficient of friction fell faster with the "
            "slip speed than the resistance of the surfaces rises, so that the slip was not unique; the one nearest to "
            f"the previous state was used; {cure}"
        )
    return notes


OFF = 0.01  # of the largest energy of the ledger
IDLE = 1e-14  # of mass times (length over the longest proximal step)^2: without loads, the work of round-off is less


def is_static(engine: Engine) -> bool:
    """Whether the engine is at the end of a load step."""
    return int(engine.word("mode")[0]) == int(k.LOADING)


def load_notes(engine: Engine, energy: dict[str, np.ndarray]) -> list[str]:
    """A note where the numerical and contact-grid lines together exceed `OFF` of the largest energy; none for rigid
    bodies in lumped contact without friction, such as a bearing, whose equilibria depend on no path."""
    scene = engine.scene
    rigid = scene.lumped_contacts and all(body.reduced is None for body in scene.bodies)
    if not len(energy["kinetic"]) or (rigid and not rubbing(scene)):
        return []
    left_out = ("potential", "numerical", "contact_grid")
    hand = max((float(np.abs(values).max()) for name, values in energy.items() if name not in left_out), default=0.0)
    mass = max((body.mass for body in engine.scene.bodies), default=0.0)
    idle = IDLE * mass * (float(engine.compiled.model.length) / float(engine.word("tau")[0])) ** 2
    defect = energy["numerical"] + energy["contact_grid"]
    open_end = float(np.abs(defect - defect[0]).max()) - engine.given_off
    if open_end <= max(OFF * hand, idle, round_off_energy(engine)):
        return []
    return [
        f"the works of the load steps leave {open_end:.3g} J open, {open_end / max(hand, 1e-300):.1%} of the largest "
        "energy of the ledger (lines numerical and contact grid): the steps are long for the trapezoidal rule, or the "
        "structure has snapped; a smaller step shows which"
    ]


INDEPENDENT = 1e-8  # smallest over largest singular value of the rows, of length one: they depend on each other below
APART = 1e10  # ratio of the compliances of both sides above which round-off is reported


def hidden_inertia(engine: Engine, world: int = 0) -> str:
    """A message for a singular system whose joints are independent; "" if they are not, or if the masses are
    similar."""
    m, scratch, bodies = engine.compiled.model, engine.scratch, engine.scene.bodies
    count, rows = m.bodies.count, np.flatnonzero(m.rows.rigid.numpy()[: m.rows.count])
    C = np.asarray(scratch.C.numpy()[world], dtype=np.float64)[rows, : 6 * count]
    shapes = np.asarray(scratch.C_modal.numpy()[world], dtype=np.float64)[rows, : m.modes.count]
    if not len(rows) or not np.all(np.isfinite(C)) or not _independent(C, shapes, float(m.length)):
        return ""
    gives = _gives_way(C, m.bodies.mass.numpy()[:count], m.bodies.inertia.numpy()[:count])
    two = np.count_nonzero(gives > 0.0, axis=1) == 2
    if not np.any(two):
        return ""
    apart = np.where(two, gives.max(axis=1) / np.where(gives > 0.0, gives, np.inf).min(axis=1), 0.0)
    row = int(np.argmax(apart))
    if apart[row] < APART:
        return ""
    light, heavy = int(np.argmax(gives[row])), int(np.argmin(np.where(gives[row] > 0.0, gives[row], np.inf)))
    return (
        f"body {bodies[light].name!r} is too light for a joint with body {bodies[heavy].name!r}: there it "
        f"has {apart[row]:.1g} times the compliance, of which double precision keeps 16 digits; give it more mass or "
        "inertia (it stays negligible with a millionth of its neighbour's), or connect its neighbours directly"
    )


def _independent(C: np.ndarray, shapes: np.ndarray, length: float) -> bool:
    """Whether the rows are independent: C (rows, 6 bodies), rotations scaled by `length` [m], and `shapes` (rows,
    modes), scaled by the largest.
    """
    scaled = C.reshape(len(C), -1, 6) / np.repeat([1.0, length], 3)
    scaled = np.hstack([scaled.reshape(len(C), -1), shapes / max(float(np.abs(shapes).max(initial=0.0)), 1e-300)])
    sizes = np.linalg.norm(scaled, axis=1)
    if len(C) > scaled.shape[1] or not np.all(sizes > 0.0):
        return False
    values = np.linalg.svd(scaled / sizes[:, None], compute_uv=False)
    return bool(values[-1] > INDEPENDENT * values[0])


def _gives_way(C: np.ndarray, mass: np.ndarray, inertia: np.ndarray) -> np.ndarray:
    """c_b M_b^-1 c_b^T (rows, bodies)."""
    c = C.reshape(len(C), len(mass), 6)
    turned = np.einsum("rbi,bij,rbj->rb", c[..., 3:], np.linalg.inv(inertia), c[..., 3:])
    return np.sum(c[..., :3] ** 2, axis=2) / mass + turned


CELLS = 'or grid="contact_fixed" with bodies that were reduced with contact_fixed=True'
UNLOADED, TINY = 1e-12, 1e-15  # of the largest contact force, N: round-off of contacts that carry nothing
SHALLOW = 1e-6  # of the radius: overlaps that round-off of positions makes


def loaded_contacts(scene: Scene, history: History) -> list[Contact]:
    """The pairs with saved rows that carry a load in any of them."""
    largest = max((_largest(found) for found in history.contacts.values()), default=0.0)
    return [c for c in _saved(scene, history) if _largest(history.contacts[c.name]) > max(UNLOADED * largest, TINY)]


def untouched_notes(scene: Scene, history: History) -> list[str]:
    """Notes on pairs, lumped ones too, without any load in the run: those that only touch or cannot, and overlaps that
    the grid does not see."""
    loaded = loaded_contacts(scene, history)
    notes, apart = [], []
    for contact in _saved(scene, history):
        if contact in loaded:
            continue
        surface = contact.a.surface
        if np.any(history.contacts[contact.name].pressure > 0.0):
            notes.append(
                f"contact {contact.name!r}: the surfaces touch without a load; to load them, add a spring "
                "with a preload, a force or gravity"
            )
            continue
        apart.append(contact)
        radius, approach = float(surface.shape.radius), float(history.contacts[contact.name].approach[0])
        if approach > SHALLOW * radius:
            notes.append(
                f"contact {contact.name!r}: an overlap of {approach:.3g} m without any pressure: the modes accommodate "
                f"it, or it is too shallow for columns {surface.grid.pitch * radius:.2g} m apart; use a finer mesh "
                f"(half_width=), {CELLS}"
            )
    notes += out_of_reach(scene, {c.name: facing_gap(c) for c in apart if c.meeting is None})
    gaps = {c.name: -float(np.max(history.contacts[c.name].approach)) for c in apart}
    gaps |= {
        name: -float(np.max(found.approach))
        for name, found in history.lumped_contacts.items()
        if len(found.approach) and not np.any(found.force != 0.0)
    }
    beyond = _beyond_load_zones(scene, gaps) | _out_of_mesh(scene, gaps)
    open_ones = [
        f"{name!r} ({gap:.2g} m apart at least)" if np.isfinite(gap) else repr(name)
        for name, gap in gaps.items()
        if not gap < 0.0 and name not in beyond and not any(note.startswith(f"contact {name!r}:") for note in notes)
    ]
    if open_ones:
        what = "contact" if len(open_ones) == 1 else "contacts"
        cure = f"check the gaps{pulled_apart(scene)}"
        notes.append(f"{what} not closed in the run: {', '.join(open_ones)}; if this is not intended, {cure}")
    return notes


def _beyond_load_zones(scene: Scene, gaps: Mapping[str, float]) -> set[str]:
    """Names of the contacts of bearings that carry load: those of elements outside the load zone, and ribs."""
    carry = [b for b in scene.bearings if any(c.name not in gaps for side in SIDES for c in b.contacts_of(side))]
    return {str(contact.name) for bearing in carry for contact in bearing.contacts.values()}


def _out_of_mesh(scene: Scene, gaps: Mapping[str, float]) -> set[str]:
    """Names of the contacts of gear pairs that carry load: those of teeth which meet at other angles."""
    carry = [pair for pair in scene.gears if any(c.name not in gaps for c in pair.contacts.values())]
    return {str(contact.name) for pair in carry for contact in pair.contacts.values()}


def _saved(scene: Scene, history: History) -> list[Contact]:
    found = history.contacts
    return [c for c in scene.finite_sliding if c.name in found and len(found[c.name].approach)]


def _largest(found: ContactHistory) -> float:
    return float(np.linalg.norm(found.force, axis=1).max(initial=0.0))


def pulled_apart(scene: Scene) -> str:
    """A clause on preloads of springs, whose sign is the usual reason where one is in the scene."""
    loaded = [f for f in scene.forces if isinstance(f, JointSpringDamper) and f.preload != 0.0]
    if not loaded:
        return ""
    sizes = ["a signal" if isinstance(f.preload, Signal) else f"{f.preload:+g} N" for f in loaded]
    signs = ", ".join(f"{f.name!r} ({size})" for f, size in zip(loaded, sizes, strict=True))
    return (
        f" and the sign of the preload of {signs}: a positive one is a tension, which draws the second body against "
        "the axis of the joint"
    )
