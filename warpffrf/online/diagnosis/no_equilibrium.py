"""Why no static state was found: friction that does not hold, a mechanism, or an iteration that did not converge.

A mechanism has a motion that nothing resists, along which loads act. At the last state of an iteration that failed, a
motion may also be free because a contact is not closed yet, which carries the load in an equilibrium that was not
reached. The two differ in what the motion does to the gaps of open contacts: it closes one only in the second case
(`approached`). Where bodies still move although the tangent stiffness resists it, the iteration did not converge
either.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bearings.bearing import loose_ring, not_guided, swivelling
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.checks.scene import connecting
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.messages.status import Status
from warpffrf.model.placement.gap import closing_distance, facing_gap
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.online.compile.matched import matched_order
from warpffrf.online.engine import Engine
from warpffrf_kernels.matched.forms import OPEN, SLIP, STICK

NO_LOAD_PATH = "a mechanism with no load path; add a joint, a spring, a drive or a contact that carries the load"
STATIC_CURE = "; constrain free rotation or sliding (a weak spring is sufficient), or begin with a smaller load"
NEARER = "; begin nearer to the equilibrium, at positions in which contacts are closed, or with a smaller load"
ROUND_OFF = 1e-16  # of the scene's length: no body moves
LOOK_AHEAD = 1e-3  # of a radius: a small motion that shows whether a gap closes
CLOSES = 0.1  # of that motion: the gap becomes smaller by more
APART = 1e-3  # of the largest displacement of a body: two bodies move against each other by more


def not_found(engine: Engine) -> tuple[Status, str]:
    """Status and reason of a static state that was not found although no step failed: the body that moves."""
    moves = np.linalg.norm(engine.scratch.dx.numpy()[0], axis=-1)
    if moves.max() <= ROUND_OFF * float(engine.compiled.model.length):
        return Status.NO_EQUILIBRIUM, f"no body moves any more, and yet the forces do not balance{STATIC_CURE}"
    body = engine.scene.bodies[int(np.argmax(moves))]
    parts = engine.scene.bearings, connecting(engine.scene), body
    loose = loose_ring(*parts) or not_guided(*parts) or swivelling(*parts)
    if engine.unconverged and not loose:
        moving = f"in its last step body {body.name!r} still moves by {moves.max():.3g} m, {engine.unconverged}"
        return Status.NOT_CONVERGED, f"the iteration did not converge: {moving}{NEARER}"
    reason = loose or f"body {body.name!r} does not come to rest ({moves.max():.3g} m in the last step)"
    return Status.NO_EQUILIBRIUM, f"{reason}: {NO_LOAD_PATH}"


def gross_slip(engine: Engine) -> str:
    """The small-sliding contacts of which every loaded cell slips at the last state of a failed iteration; "" if there
    are none."""
    return too_much_for([
        str(contact.name)
        for contact, state in _matched(engine, 0)
        if contact.friction.acts and np.any(state == int(SLIP)) and not np.any(state == int(STICK))
    ])  # fmt: skip


def too_much_for(names: list[str]) -> str:
    """A clause on contacts whose friction does not hold the loads; "" without names."""
    if not names:
        return ""
    return (
        f"the loads are more than friction of {', '.join(map(repr, names))} holds (where it slides, drive a joint from "
        'place to place, quantity="position", and read the force of that joint)'
    )


def _matched(engine: Engine, world: int) -> list[tuple[Contact, np.ndarray]]:
    """The small-sliding contacts, and the states of their cells."""
    found, start, state = [], 0, engine.state.matched_state.numpy()[world]
    for number in matched_order(engine.scene.small_sliding):
        contact = engine.scene.small_sliding[number]
        count = len(cells_of(contact).cell)
        found.append((contact, state[start : start + count]))
        start += count
    return found


def approached(engine: Engine, world: int, way: np.ndarray) -> str:
    """The name of an open contact whose gap a motion of the bodies closes, to first order at their initial pose; "" if
    there is none. way: displacements, and rotations in body axes (6 bodies,)."""
    parts = way.reshape(-1, 6)
    largest = float(np.linalg.norm(parts[:, :3], axis=1).max())
    active = engine.state.active.numpy()[world].any(axis=1)
    for contact, touches in zip(engine.scene.finite_sliding, active, strict=False):
        before = None if touches else facing_gap(contact)
        if before is None:
            continue
        place = contact.a.body.to_world(contact.a.surface.shape.point(*before[1:]))
        apart = _moved(engine, world, parts, contact.b, place) - _moved(engine, world, parts, contact.a, place)
        size = float(np.linalg.norm(apart))
        if size <= APART * largest:
            continue
        step = LOOK_AHEAD * float(contact.a.surface.shape.radius)
        after = facing_gap(contact, step / size * apart)
        if after is not None and after[0] < before[0] - CLOSES * step and _meet(contact, apart):
            return str(contact.name)
    for contact, state in _matched(engine, world):
        if np.any(state != int(OPEN)):
            continue
        cells = cells_of(contact)
        place = contact.a.body.to_world(cells.area @ cells.points / cells.area.sum())
        apart = _moved(engine, world, parts, contact.b, place) - _moved(engine, world, parts, contact.a, place)
        normals = cells.frames[:, 0] @ rot.matrix(contact.a.body.rotation).T
        if cells.area @ (normals @ apart) < -CLOSES * cells.area.sum() * np.linalg.norm(apart):
            return str(contact.name)
    return ""


def _meet(contact: Contact, along: np.ndarray) -> bool:
    """Whether the second body touches the first somewhere along a direction, instead of passing it."""
    try:
        closing_distance(contact, along, 0.0)
    except InputError:
        return False
    return True


def _moved(engine: Engine, world: int, parts: np.ndarray, port: SurfacePort, place: np.ndarray) -> np.ndarray:
    """Displacement (3,) of a point of the body of `port` that is at `place` (3,) [m], in the motion `parts` (bodies,
    6)."""
    if port.on_ground:
        return np.zeros(3)
    b = next(i for i, body in enumerate(engine.scene.bodies) if body is port.body)
    axes, r = (np.asarray(a.numpy()[world][b]) for a in (engine.scratch.axes, engine.scratch.r1))
    return parts[b, :3] + np.cross(axes @ parts[b, 3:], place - r)
