r"""Small-sliding contacts on the host: constants of their groups, and their relative motion.

Bent gaps. Stiffness of a loaded lumped contact against motions which neither open nor close its gap.

To first order a ball slides freely across the bottom of its groove. To second order it climbs: the normal tilts, and
the force F with it. A motion that gives the two bodies the displacements u_1, u_2 at the point x and the rotations
phi_1, phi_2 moves the point and tilts the normal by dx and dn (`warpffrf_kernels.lumped.places`), and the force on the
first body and its moment about r_1 change by

    df = F dn,      dm = (dx - dr_1) x F n + (x - r_1) x F dn,

opposite ones on the second. Over the motions, -(df . dr + dm . phi) of both bodies is a matrix, whose symmetric part is
the stiffness: F/(r - R) of a ball of radius R in a groove of radius r, zero for a ball that spins or rolls on a plane.

Floating. Groups of bodies without a path to the ground: the external loads on a group either balance, and it stays
where it is, or it has no equilibrium.

Forces between bodies of a group have no resultant, so that the resultant is that of loads and weights. An unbalanced
force remains unbalanced; a torque may become balanced as the group rotates.

Slow films. Time for films to become steady, for equilibria: cavity fractions travel around with half of the sliding
speed.

A proximal step squeezes films over its own time, which is limited by the joints; where walls slide slowly a
film needs far longer. So its time is stretched relative to that of the bodies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.films import Film
from warpffrf.model.scene import Scene
from warpffrf.online.diagnosis.failure_report import largest_force
from warpffrf.online.engine import Engine
from warpffrf_kernels.matched import motion
from warpffrf_kernels.matched.forms import OPEN

Array = np.ndarray


@dataclass(frozen=True)
class MatchedGroup:
    """Constants of a group of small-sliding contacts on the host, s its forces, z its relative motion."""

    cells: slice
    columns: slice  # of z
    components: int  # forces of a cell: 3, or only the normal one
    G: Array  # (s, s) m/N
    J: Array  # (s, z)
    friction: Array  # (cells,)

    def closed(self, pressed: Array) -> Array:
        """Components (s,) that the cells `pressed` (cells,) constrain: gaps, and slips of those with friction."""
        closed = np.repeat(pressed[:, None], self.components, axis=1)
        if self.components == 3:
            closed[:, 1:] &= (self.friction > 0.0)[:, None]
        return closed.ravel()

    def stiffness(self, pressed: Array) -> Array:
        """S (z, z) of the cells `pressed` (cells,)."""
        A = self.closed(pressed)
        J_A = self.J[A]
        return J_A.T @ np.linalg.solve(self.G[np.ix_(A, A)], J_A)


def matched_groups(engine: Engine) -> list[MatchedGroup]:
    """All groups of small-sliding contacts of a scene."""
    matched = engine.compiled.matched
    table = {name: getattr(matched, name).numpy() for name in (
        "cell_start", "column_start", "components", "compliance", "compliance_start", "motion", "motion_start",
        "friction",
    )}  # fmt: skip
    found = []
    for group in range(matched.count):
        cells, columns = (slice(*table[f"{name}_start"][group : group + 2]) for name in ("cell", "column"))
        components = int(table["components"][group])
        s, z = components * (cells.stop - cells.start), columns.stop - columns.start
        G, J = (table[name][table[f"{name}_start"][group] :] for name in ("compliance", "motion"))
        found.append(
            MatchedGroup(
                cells, columns, components, G[: s * s].reshape(s, s), J[: s * z].reshape(z, s).T,
                table["friction"][cells],
            )
        )  # fmt: skip
    return found


def gradients(engine: Engine, coordinates: int, world: int = 0) -> Array:
    """B (z, coordinates) at the last evaluated state, over displacements of the centres of mass, rotations in body
    axes, and modes.
    """
    matched, bodies = engine.compiled.matched, engine.compiled.model.bodies.count
    if not matched.count:
        return np.zeros((0, coordinates))
    B = np.zeros((int(matched.column_start.numpy()[-1]), coordinates))
    own = engine.scratch.matched_gradient.numpy()[world]
    rigid, sides = matched.rigid_column.numpy(), (matched.first.numpy(), matched.second.numpy())
    for contact in range(matched.matched):
        at = rigid[contact]
        for side, body in enumerate(sides):
            if at >= 0 and body[contact] >= 0:
                here = slice(6 * body[contact], 6 * body[contact] + 6)
                B[at : at + int(motion.RIGID), here] += own[contact, :, 6 * side : 6 * side + 6]
    for column, mode in enumerate(matched.column_mode.numpy()):
        if mode >= 0:
            B[column, 6 * bodies + mode] = 1.0
    return B


def held_by_matched(engine: Engine, world: int, size: int) -> tuple[Array, Array]:
    """Gradients, by the rigid coordinates (n, size), of the gaps of cells under pressure, and of their slips if they
    have friction, and the forces [N] along them (n,); at the last evaluated state.
    """
    lines, pulls = [np.zeros((0, size))], [np.zeros(0)]
    if engine.compiled.matched.count:
        B = gradients(engine, engine.compiled.model.bodies.count * 6 + engine.compiled.model.modes.count, world)
        pressed = engine.state.matched_state.numpy()[world] != int(OPEN)
        force = engine.state.matched_force.numpy()[world]
        for group in matched_groups(engine):
            closed = group.closed(pressed[group.cells])
            lines.append(group.J[closed] @ B[group.columns, :size])
            pulls.append(force[group.cells, : group.components].ravel()[closed])
    return np.vstack(lines), np.concatenate(pulls)


SOFT = 1e-6  # of the largest force over the length of the scene: a stiffness below counts as zero


def without_stiff(engine: Engine, world: int, weight: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """The combinations of `motions`, orthonormal lines (n, 6 bodies) as of `free_motions`, that no loaded lumped
    contact resists.
    """
    if not len(motions):
        return motions
    K = _stiffness(engine, world, motions / weight)
    values, vectors = np.linalg.eigh(0.5 * (K + K.T))
    mass = weight[::6] ** 2
    soft = SOFT * largest_force(engine, world) / (float(engine.compiled.model.length) * float(mass.mean()))
    return vectors.T[values <= soft] @ motions


def _stiffness(engine: Engine, world: int, motions: np.ndarray) -> np.ndarray:
    """Stiffness of all closed places (n, n)."""
    m, lumped = engine.compiled.model, engine.compiled.elements.lumped
    loads = engine.scratch.lumped_load.numpy()[world, : lumped.places]
    closed = np.flatnonzero(loads["force"] > 0.0)
    touch, F = loads["touch"][closed], loads["force"][closed, None]
    x, n, H, Y = (np.asarray(touch[name]) for name in ("x", "n", "H", "Y"))
    r, axes = engine.scratch.r1.numpy()[world], engine.scratch.axes.numpy()[world]
    contact, of_body = lumped.contact.numpy()[closed], motions.reshape(len(motions), -1, 6)
    moves, turns, displaced, levers = [], [], [], []  # (n, places, 3), levers (places, 3)
    for surface in (lumped.first.numpy()[contact], lumped.second.numpy()[contact]):
        body = m.surfaces.body.numpy()[surface]
        moving = (body >= 0)[:, None]
        part = of_body[:, body] * moving
        levers.append(x - r[body] * moving)
        moves.append(part[..., :3])
        turns.append(np.einsum("mpk,pik->mpi", part[..., 3:], axes[body]))
        displaced.append(moves[-1] + np.cross(turns[-1], levers[-1]))
    (u1, u2), (t1, t2) = displaced, turns
    way = np.einsum("mpi,pij->mpj", u2 - u1, H)
    dx = u1 + np.einsum("mpi,pij->mpj", np.cross(t1 - t2, n) + way, Y)
    dx += (touch["between"] * np.einsum("mpi,pi->mp", u2 - u1, n))[..., None] * n
    dn = np.cross(t2, n) + np.einsum("mpi,pij->mpj", dx - u2, H)
    K = np.zeros((len(motions), len(motions)))
    for sign, move, turn, lever in zip((1.0, -1.0), moves, turns, levers, strict=True):
        moment = np.cross(dx - move, F * n) + np.cross(lever, F * dn)
        K -= sign * (np.tensordot(F * dn, move, ((1, 2), (1, 2))) + np.tensordot(moment, turn, ((1, 2), (1, 2))))
    return K


def lines_of(engine: Engine, world: int, group: list[int]) -> Array:
    """The six rigid motions (6, 6 bodies) of a group, displacement in world, rotation in body axes: unit displacements,
    and unit rotations about its centre of mass.
    """
    r, axes = (np.asarray(a.numpy()[world]) for a in (engine.scratch.r1, engine.scratch.axes))
    mass = engine.compiled.model.bodies.mass.numpy()[group]
    centre = mass @ r[group] / mass.sum()
    lines = np.zeros((6, len(engine.scene.bodies), 6))
    for b in group:
        lines[:3, b, :3] = np.eye(3)
        lines[3:, b, :3] = np.cross(np.eye(3), r[b] - centre)
        lines[3:, b, 3:] = axes[b]
    return lines.reshape(6, -1)


def told_of(engine: Engine, group: list[int]) -> str:
    """The bodies of a group, as the beginning of a sentence on their loads."""
    names = ", ".join(repr(engine.scene.bodies[b].name) for b in group)
    return f"nothing leads to the ground from {names}, whose loads"


TURNS = 30.0  # of the oil in the longest step: each such step leaves a thirtieth of the transient


def stretch(scene: Scene, longest: float) -> float:
    """Time of films over that of the bodies; longest [s]: step of the bodies."""
    times = [time for film in scene.films if (time := slide_time(film)) is not None]
    return max([1.0, *(TURNS * time / longest for time in times)])


def slide_time(film: Film) -> float | None:
    """Time [s] that the oil takes through a film with the scene's initial velocities; None where nothing slides."""
    shape, grid = film.a.surface.shape, film.grid
    theta, z = film.theta[grid.columns // 2], 0.5 * (grid.z[0] + grid.z[-1])
    at = film.a.body.to_world(shape.point(theta, z))
    velocities = []
    for body in (film.a.body, film.b.body):
        still = np.zeros(3)
        moving = isinstance(body, Body)
        velocities.append(body.velocity + np.cross(body.angular_velocity, at - body.position) if moving else still)
    normal = film.a.body.to_world(shape.point(theta, z) + shape.normal(theta, z)) - at
    sliding = velocities[1] - velocities[0]
    speed = 0.5 * float(np.linalg.norm(sliding - (sliding @ normal) * normal))
    radius = 1.0 if shape.profile().planar else float(shape.radius_at(z))
    length = max(radius * grid.pitch * grid.columns, float(grid.z[-1] - grid.z[0]))
    return length / speed if speed > 0.0 else None
