"""Location of a failure: the joint, body or contact with the largest residual of the last attempt.

Residuals are compared as fractions of their scales in `warpffrf_kernels.step.balance.balance`: forces
of the largest force in play, modal forces of the largest modal force, joints of 1 m or 1 rad, spring forces of their
laws, gaps of the penetration, tractions of the largest bound of all contacts (`add_friction`).
For a singular system the undetermined direction is
reported instead, the singular vector of the equilibrated matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.films.heat import missing_path
from warpffrf.model.oil_temperature import HOTTEST
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.engine import Engine
from warpffrf_kernels.core import control as k
from warpffrf_kernels.friction.cell_forces import TRACTION_SLACK

TOLD = 1e-8  # smaller shares are converged
MOST_LOST = 4  # names with values not finite: these spread through joints within an iteration
AT_BOUND = 1e-9  # of the bound of a cell: tractions this near slide
NO_FORCE = 1e-30  # N: keeps fractions finite where nothing acts
CONTACT_BITS = int(k.CYCLING) | int(k.CAPACITY) | int(k.INDEFINITE) | int(k.STENCIL) | int(k.PASSED)
LARGEST_SYSTEM = 1500  # unknowns: a singular value decomposition of them takes some seconds


@dataclass(frozen=True)
class Residual:
    """One residual: its `share` of its scale, and the text that names its owner."""

    share: float
    text: str


def failure_owner(engine: Engine, bits: int, world: int = 0) -> str:
    """A clause that names the body, the joint or force, and the pair with the largest residual of `world` after the
    failure `bits`, the worst of them first; "" if none is left."""
    if bits & int(k.TOO_HOT):
        return hottest_film(engine, world)
    with np.errstate(all="ignore"):  # what diverged may overflow
        kinds = [_bodies(engine, world), _rows(engine, world), _pairs(engine, world), _tractions(engine, world)]
    lost = [residual.text for kind in kinds for residual in kind if not np.isfinite(residual.share)]
    if lost:
        return ", ".join(lost[:MOST_LOST])
    if bits & int(k.TRACTIONS):
        return "the largest residual: " + max(_tractions(engine, world), key=lambda residual: residual.share).text
    if bits & int(k.SINGULAR):
        return _undetermined(engine, world)
    if bits & CONTACT_BITS:
        return _at_pair(engine, bits, world)
    worst = [max(kind, key=lambda residual: residual.share) for kind in kinds if kind]
    told = sorted((r for r in worst if r.share > TOLD), key=lambda residual: -residual.share)
    return f"the largest residual: {', '.join(residual.text for residual in told)}" if told else ""


def hottest_film(engine: Engine, world: int) -> str:
    """The hottest film if it exceeds the temperatures of oils, and by which way its heat could leave; else ""."""
    starts, T = engine.compiled.films.heat_start.numpy(), _array(engine.state, "film_temperature", world)
    hottest = {
        i: float(np.nan_to_num(T[starts[i] : starts[i + 1]], nan=np.inf).max())
        for i, film in enumerate(engine.scene.films) if film.temperature is not None
    }  # fmt: skip
    if max(hottest.values(), default=0.0) <= HOTTEST:
        return ""
    film = engine.scene.films[max(hottest, key=lambda i: hottest[i])]
    return f"{film.label} exceeds {HOTTEST:g} degrees Celsius: {missing_path(film)}"


def row_owners(engine: Engine) -> list[str]:
    """The owner of each row of the equations: "joint 'hinge'", "force 'spring'"."""
    compiled = engine.compiled
    owners = [""] * compiled.row_count
    for kind, table in (("joint", compiled.joints.rows), ("force", compiled.forces.rows)):
        for name, rows in table.items():
            for row in rows:
                owners[row] = f"{kind} {name!r}"
    return owners


def _array(owner: Arrays, name: str, world: int) -> np.ndarray:
    return np.asarray(getattr(owner, name).numpy()[world], dtype=np.float64)


def largest_force(engine: Engine, world: int) -> float:
    """The largest of weight, inertia force, multiplier of a length, contact force, force of a small-sliding contact,
    and point force, as those of a bolt cancel each other on a body [N].
    """
    m, scratch, state = engine.compiled.model, engine.scratch, engine.state
    B, R, P = m.bodies.count, m.rows.count, m.pairs.count
    rate = np.linalg.norm(_array(scratch, "v1_rate", world)[:B], axis=1)
    forces = m.bodies.mass.numpy()[:B] * (np.linalg.norm(engine.scene.gravity) + rate)
    lengths = np.isin(m.rows.kind.numpy()[:R], (int(k.TRANSLATION), int(k.DISTANCE)))
    pulls = np.abs(_array(state, "lam", world)[:R][lengths])
    contact = np.linalg.norm(_array(scratch, "pair_wrench", world)[:P, :3], axis=1)
    lumped = _array(state, "lumped_force", world)[1, : engine.compiled.elements.lumped.places]
    points = np.linalg.norm(_array(state, "applied", world)[1, : engine.compiled.external.forces.count], axis=1)
    columns = engine.compiled.matched.rigid_column.numpy()[: engine.compiled.matched.matched]
    push = _array(scratch, "matched_push", world)
    matched = [np.linalg.norm(push[at : at + 3]) for at in columns if at >= 0]
    values = np.concatenate([forces, pulls, contact, lumped, matched, points])
    return float(max(values[np.isfinite(values)], default=0.0)) + NO_FORCE


def _bodies(engine: Engine, world: int) -> list[Residual]:
    m, scratch, found = engine.compiled.model, engine.scratch, []
    residual = _array(scratch, "residual", world)[: 6 * m.bodies.count].reshape(-1, 6)
    mass, inertia = m.bodies.mass.numpy(), m.bodies.inertia.numpy()
    scale = largest_force(engine, world)
    modal = np.abs(_array(scratch, "modal_residual", world)[: m.modes.count])
    elastic = np.abs(m.modes.stiffness.numpy()[: m.modes.count] * _array(scratch, "q1", world)[: m.modes.count])
    pairs = np.abs(_array(engine.state, "pair_modal", world)[: m.pairs.count, 1]).ravel()
    loads = np.concatenate([elastic, np.abs(_array(scratch, "qd1_rate", world)[: m.modes.count]), pairs])
    modal_scale = float(max(loads[np.isfinite(loads)], default=0.0)) + NO_FORCE
    starts = engine.compiled.modal_start
    for i, body in enumerate(engine.scene.bodies):
        force, torque = float(np.linalg.norm(residual[i, :3])), float(np.linalg.norm(residual[i, 3:]))
        gyration = float(np.sqrt(np.trace(inertia[i]) / (3.0 * mass[i])))
        own = modal[starts[i] : starts[i + 1]]
        if not np.isfinite(force + torque + own.sum()):
            found.append(Residual(np.inf, f"the motion of body {body.name!r} is not finite"))
            continue
        if torque / gyration > force:
            text = f"an unbalanced torque of {torque:.3g} N m on body {body.name!r}"
        else:
            text = f"an unbalanced force of {force:.3g} N on body {body.name!r}"
        found.append(Residual(max(force, torque / gyration) / scale, text))
        if len(own):
            text = f"an unbalanced force on the modes of body {body.name!r}"
            found.append(Residual(float(own.max()) / modal_scale, text))
    return found


def _rows(engine: Engine, world: int) -> list[Residual]:
    m, scratch, found = engine.compiled.model, engine.scratch, []
    defect, softness = (_array(scratch, name, world)[: m.rows.count] for name in ("defect", "softness"))
    kinds, rigid = m.rows.kind.numpy(), m.rows.rigid.numpy()
    scale = largest_force(engine, world)
    for row, owner in enumerate(row_owners(engine)):
        if not np.isfinite(defect[row]):
            found.append(Residual(np.inf, f"{owner} is not finite"))
        elif rigid[row]:
            unit = "m" if kinds[row] in (int(k.TRANSLATION), int(k.DISTANCE)) else "rad"
            found.append(Residual(abs(defect[row]), f"{owner} is violated by {abs(defect[row]):.3g} {unit}"))
        else:
            off = abs(defect[row]) / max(abs(softness[row]), NO_FORCE)
            found.append(Residual(off / scale, f"{owner} is {off:.3g} (N or N m) off its law"))
    return found


def _pairs(engine: Engine, world: int) -> list[Residual]:
    m, scratch, found = engine.compiled.model, engine.scratch, []
    if not m.pairs.count:
        return found
    opened, area = _array(scratch, "opened", world), _array(scratch, "area", world)
    active = _array(engine.state, "active", world) != 0
    penetration = float(_array(scratch, "gap_defect", world)[1])
    for i, contact in enumerate(engine.scene.finite_sliding):
        use = active[i] & (area[i] > 0.0)
        off = float(np.max(np.abs(opened[i][use] / area[i][use]), initial=0.0))
        if not np.isfinite(off):
            found.append(Residual(np.inf, f"contact {contact.name!r} is not finite"))
        elif penetration > 0.0:
            text = f"contact {contact.name!r} leaves a gap of {off:.3g} m under pressure"
            found.append(Residual(off / penetration, text))
    return found


def _tractions(engine: Engine, world: int) -> list[Residual]:
    """Residual of the friction law of each contact with friction, as in `add_friction`."""
    pairs, rows = engine.compiled.model.pairs, engine.compiled.model.surfaces.rows.numpy()
    rubbing = np.flatnonzero(pairs.friction.numpy()[: pairs.count] > 0.0)
    if not len(rubbing):
        return []
    bound, own, late, slip = (_array(engine.scratch, name, world) for name in ("bound", "cell_own", "late", "slip"))
    traction, h = _array(engine.state, "traction", world), float(engine.state.clk.numpy()[world]["h"])
    defect, texts = {}, {}
    for i in rubbing:
        lines = int(rows[pairs.first.numpy()[i]])
        cells = np.flatnonzero(bound[i] > 0.0)
        at = (cells // lines) * 2 * lines + cells % lines + np.array([[0], [lines]])
        b, t = bound[i][cells], traction[i][at]
        soft = h * pairs.slip_velocity.numpy()[i] / b + late[i][cells]
        aim = t - (slip[i][at] + soft * t) / (own[i][cells] + soft)
        aim *= np.minimum(1.0, b / np.maximum(np.linalg.norm(aim, axis=0), b))
        off = np.abs(aim - t).max(axis=0, initial=0.0)
        defect[i], worst = float(off.max(initial=0.0)), cells[np.argmax(off)] if len(cells) else 0
        sliding = int(np.sum(np.linalg.norm(t, axis=0) >= b * (1.0 - AT_BOUND)))
        texts[i] = (
            f"tractions of contact {engine.scene.finite_sliding[i].name!r}, {defect[i]:.3g} Pa off those of their slip "
            f"at column {worst // lines}, row {worst % lines}; of {len(cells)} loaded cells {sliding} slide"
        )
    largest = max(float(bound[i].max(initial=0.0)) for i in rubbing) * float(TRACTION_SLACK) + NO_FORCE
    return [Residual(defect[i] / largest, texts[i]) for i in rubbing]


def _at_pair(engine: Engine, bits: int, world: int) -> str:
    """The contact that failed: `_fullest` if the capacity did not suffice, else the one with the largest residual."""
    contacts = engine.scene.finite_sliding
    if len(contacts) == 1:
        return f"at contact {contacts[0].name!r}"
    if bits & int(k.CAPACITY):
        return _fullest(engine, world)
    residuals = [*_pairs(engine, world), *_tractions(engine, world)]
    worst = max(residuals, key=lambda residual: residual.share, default=Residual(0.0, ""))
    return f"the largest residual: {worst.text}" if worst.share > 0.0 else ""


def _fullest(engine: Engine, world: int) -> str:
    """The contact with the most active nodes among those with the widest window, or among all if there is none: deep
    penetration in one contact often spreads to its neighbours."""
    contacts = engine.scene.finite_sliding
    H = engine.compiled.model.window.half
    window = _array(engine.scratch, "window", world)[: len(contacts)]
    nodes = (_array(engine.state, "active", world)[: len(contacts)] != 0.0).reshape(len(contacts), -1).sum(axis=1)
    widest = [i for i, (low, high) in enumerate(window) if low <= -H or high >= H] or list(range(len(contacts)))
    worst = max(widest, key=lambda i: nodes[i])
    others = f"; further windows at full width: {len(widest) - 1}" if 1 < len(widest) < len(contacts) else ""
    return f"at contact {contacts[worst].name!r}, which has {int(nodes[worst])} active nodes{others}"


def _undetermined(engine: Engine, world: int) -> str:
    """Name the undetermined part of a singular system: the row or body with the largest singular-vector entry."""
    m = engine.compiled.model
    if not 0 < m.retained.count <= LARGEST_SYSTEM:
        return ""
    A = _array(engine.scratch, "tangent", world)[: m.retained.count, : m.retained.count]
    if not np.all(np.isfinite(A)):
        return ""
    scale = 1.0 / np.sqrt(np.where(np.diag(A) > 0.0, np.diag(A), 1.0))
    scale[m.retained.row_offset :] = 1.0
    rows = np.linalg.norm(A * scale, axis=1)
    scale[m.retained.row_offset :] = 1.0 / np.where(rows > 0.0, rows, 1.0)[m.retained.row_offset :]
    vector = np.abs(np.linalg.svd(scale[:, None] * A * scale)[2][-1])
    at = int(np.argmax(vector))
    if at < 6 * m.bodies.count:
        return f"nothing determines the motion of body {engine.scene.bodies[at // 6].name!r}"
    if at < m.retained.row_offset:
        body = int(m.dense.body.numpy()[at - 6 * m.bodies.count])
        return f"nothing determines the deformation of body {engine.scene.bodies[body].name!r}"
    return f"nothing determines the reaction of {row_owners(engine)[at - m.retained.row_offset]}"
