r"""Notes on contacts that limit the accuracy of their pressures.

Each note names the contact, the observation and the cure: a patch of too few columns of the contact grid, nodes whose
support extends beyond the second surface, patches that reach an end (`border_notes`), axes that became skewed,
surfaces that overlapped at the start, and spurious energy.

Skew. Parallel-axes kinematics treats the section of the second body as a circle. If its axis is skewed by an
angle e that section is an ellipse, of the curvature cos(e)^2/R_B on its side: with equal radii the relative curvature
is too large by e^2/2. Contacts skewed at the start use closest-point kinematics; the kinematics do not change in a run.

Sampling check. The online check of quadrature "reduced": few points compared with all points, at
sampled saved steps, on the host.

At a saved step the poses, global coordinates and nodal forces are known. With the points x_p of a rule and weights w_p

    g_i = sum_p w_p psi_i(x_p) [g(x_p) - u_B(x_p)],   S_in = sum_p w_p psi_i(x_p) psi^B_n(x_p),

g the distance of x_p from B's true surface, u_B = Phi_B q_B - D_B S^T s B's outward displacement there. A's own
displacement enters through the exact Gram matrix of its nodes and is equal for both rules; a layer with nonlinear
compression y(p) is evaluated at the same points and adds `sum_p w_p psi_i(x_p) y(p(x_p))`. The difference dg between
the few points and the Gauss points of quadrature "full" changes the pressures of the active nodes, at fixed bodies, by

    ds = -G^-1 dg,     G = M D_A M + S D_B S^T + E,     E_ij = sum_p w_p psi_i psi_j y'(p(x_p)),

to first order and for the same active set. Reported are the largest |dg_i|/a_i over the depth of the patch, |sum a_i
ds_i| over the force, and |ds| over |s| in the norm of M. The gap here is the distance normal to B; the engine may
measure it along the line of centres, which is equal to second order in the angle and equal for both rules. For
a damped layer the static curve is used.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Body
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves import Curve
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.reduced.contact_surface import ContactSurface, gauss_points
from warpffrf.model.reduced.local_modes import leanings
from warpffrf.model.scene import Scene
from warpffrf.online.diagnosis.bearing_notes import bearing_notes
from warpffrf.online.diagnosis.border_notes import border_notes
from warpffrf.online.diagnosis.cell_notes import arc_per_theta, cell_notes, near_patches, normal_notes
from warpffrf.online.diagnosis.motion_notes import CELLS, SHALLOW, loaded_contacts, untouched_notes
from warpffrf.online.history.history import ContactHistory, History
from warpffrf.online.history.interface_motion import turned
from warpffrf.online.settings import Settings

AT_POINTS = 'give the contact kinematics="closest_point"'
FEWEST_COLUMNS = 4  # across the largest patch: with fewer, peaks and half-widths are those of the grid
# errors of forces at a given approach, and of peaks and half-widths, of a patch of fewer, of lines and of points:
# docs/studies/contact_grid.md, worst positions at one to two spacings in a half-width
FEW = (0.05, 0.33), (0.1, 0.5)
CUT = 0.05  # of the load beyond the end of the second surface: more is noted
GAINED = 0.01  # of the largest present energy: a larger gain is noted
TAKEN = 0.01  # the same for the loss by the integrator
LEAST_TILT = 1e-7  # rad: less is round-off of poses
MOMENT_LEFT = 0.01  # of the moment of a pair on the line of centres
MOST_SKEW = 0.07  # rad: e^2/2 is 0.25 %; compared with closest-point kinematics: force 0.1 %, peak pressure 0.2 %


def contact_notes(scene: Scene, history: History, on_axes: Collection[str] = ()) -> list[str]:
    """Notes on the patches of all contacts of a run; `on_axes`: names of those with parallel-axes kinematics."""
    notes = []
    taken = leanings(scene.finite_sliding)
    for contact in loaded_contacts(scene, history):
        found = history.contacts[contact.name]
        columns = _widest(found)
        if found.cells is not None:
            notes += cell_notes(contact, found, history)
            continue
        notes += _coarse(contact, columns) + _cut(contact, found) + border_notes(contact, found, history.time)
        notes += normal_notes(contact, 0.5 * columns * contact.a.surface.grid.pitch * arc_per_theta(contact), taken)
        if contact.name in on_axes:
            notes += _skewed(contact, found, history)
    return notes + near_patches(scene, history) + untouched_notes(scene, history) + bearing_notes(scene, history)


def _skewed(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    loaded = np.any(found.pressure > 0.0, axis=(1, 2))
    angles = angle_between_axes(contact, history)[loaded]
    if angles.max() <= MOST_SKEW:
        return _tilted(contact, found, history)
    return [
        f"contact {contact.name!r}: the axes of the two surfaces were skewed by up to "
        f"{angles.max():.3g} rad, more than the {MOST_SKEW:g} allowed by parallel-axes kinematics, and "
        f"pressures have an error of the order of {0.5 * angles.max() ** 2:.1%}; {AT_POINTS}"
    ]


def _tilted(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    """Parallel-axes kinematics neglect R_B tilt^2/2, and thus the moment R_B tilt F, if axes tilt towards each
    other; noted if it is a noticeable part of the moment of the contact."""
    lean = Leaning.of(contact, found, history)
    if lean.left <= MOMENT_LEFT * lean.moment:
        return []
    return [
        f"contact {contact.name!r}: the axes of the two surfaces are inclined by up to {lean.tilt:.2g} rad; "
        f"parallel-axes kinematics omits about {lean.left:.2g} N m of the moment due to this, of "
        f"{lean.moment:.2g} N m in all; {AT_POINTS} where that matters"
    ]


@dataclass(frozen=True)
class Leaning:
    """Maximum error for axes that are inclined towards each other by `tilt` [rad]: R_B tilt F, the moment `left` [N m]
    missing for a pair with parallel-axes kinematics, with its `moment` [N m] and its `force` [N].
    """

    tilt: float
    left: float
    moment: float
    force: float

    @classmethod
    def of(cls, contact: Contact, found: ContactHistory, history: History) -> Leaning:
        """In a run of some rows."""
        force, moment = np.linalg.norm(found.force, axis=1), np.linalg.norm(found.torque, axis=1)
        tilt = _tilt(contact, found, history)
        left = force * float(contact.b.surface.shape.radius) * np.where(tilt > LEAST_TILT, tilt, 0.0)
        at = int(np.argmax(left))
        return cls(float(tilt[at]), float(left[at]), float(moment[at]), float(force[at]))


def _tilt(contact: Contact, found: ContactHistory, history: History) -> np.ndarray:
    """(T,) rad, tilt of the axes towards each other along the normal."""
    axes = [turned(history.bodies[port.body.name].rotation, port.surface.shape.e_a) for port in (contact.a, contact.b)]
    normal = found.force / np.maximum(np.linalg.norm(found.force, axis=1), 1e-300)[:, None]
    return np.abs(np.subtract(*(np.einsum("ti,ti->t", normal, axis) for axis in axes)))


def angle_between_axes(contact: Contact, history: History) -> np.ndarray:
    """Angle (T,) [rad] in [0, pi/2] between the axes of the two surfaces of a pair in a run."""
    a, b = (turned(history.bodies[port.body.name].rotation, port.surface.shape.e_a) for port in (contact.a, contact.b))
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.abs(np.einsum("ti,ti->t", a, b)))


def _widest(found: ContactHistory) -> int:
    """Columns of the grid under pressure in the saved step with the largest load."""
    load = found.pressure.sum(axis=(1, 2))
    return int(np.count_nonzero(found.pressure[int(np.argmax(load))].max(axis=1) > 0.0))


def few_columns(found: ContactHistory, patch_kind: str) -> tuple[float, float] | None:
    """Errors of the force at a given approach, and of peak pressure and half-widths, of a patch on fewer columns of the
    body-fixed grid than `FEWEST_COLUMNS` where it is most loaded; None of a wider one."""
    return FEW[patch_kind == "point"] if _widest(found) < FEWEST_COLUMNS else None


def _coarse(contact: Contact, columns: int) -> list[str]:
    if columns >= FEWEST_COLUMNS:
        return []
    (force, peak), (force_of_points, peak_of_points) = FEW
    return [
        f"contact {contact.name!r}: the patch is {columns} columns of the grid wide where it is most loaded, under "
        f"{FEWEST_COLUMNS}: peak pressures and half-widths may err by {peak:.0%} (points: by {peak_of_points:.0%} and "
        f"more), forces at a given approach by {force:.0%} (points: by {force_of_points:.0%}); use a finer mesh "
        f"(half_width=), {CELLS}"
    ]


def _cut(contact: Contact, found: ContactHistory) -> list[str]:
    """Pressures times nodal areas, compared with the normal force: equal on parts that face each other."""
    surface, other = contact.a.surface, contact.b.surface
    if surface.shape.side < 0.0 or other.shape.side < 0.0:
        return []  # conformal: the pressures' directions differ
    areas = surface.grid.pitch * surface.gram_z.sum(axis=0)
    last = int(np.argmax(found.pressure.sum(axis=(1, 2))))
    pressed = float(found.pressure[last].sum(axis=0) @ areas)
    force = float(np.linalg.norm(found.force[last]))
    if found.friction is not None:
        cells = surface.tangential.grid
        sizes = cells.pitch * np.diag(cells.gram_z(surface.shape))
        rubbed = np.einsum("djk,k->d", found.friction.traction[last], sizes)
        force = float(np.sqrt(max(force**2 - rubbed @ rubbed, 0.0)))
    if pressed <= (1.0 + CUT) * force:
        return []
    return [
        f"contact {contact.name!r}: pressures of the first surface extend beyond the end of the second: they sum to "
        f"{pressed / max(force, 1e-300):.2f} of the normal force; name the narrower surface first, or give the first "
        "finer rows there"
    ]


def overlap_notes(scene: Scene) -> list[str]:
    """Contacts whose surfaces overlap at the initial poses, so that a run starts with an impulse."""
    notes = []
    for contact in scene.finite_sliding:
        try:
            gap = smallest_gap(contact)[0]
        except InputError:  # the surfaces do not face each other
            continue
        if -gap > SHALLOW * float(contact.a.surface.shape.radius):
            notes.append(
                f"contact {contact.name!r}: the run starts with an overlap of {-gap:.3g} m, which acts as an impulse; "
                "scene.close_gap(contact, along=...) or start='equilibrium' avoids this"
            )
    return notes


def energy_notes(energy: dict[str, np.ndarray], nothing: float) -> list[str]:
    """Notes where the ledger shows energy that nothing supplied, or that the integrator took: numerical and
    contact-grid lines together rose by more than `GAINED` of the largest of the other lines, the numerical one fell by
    more than `TAKEN` of it. Changes up to `nothing` [J] are round-off."""
    if not len(energy["kinetic"]):
        return []
    left_out = ("potential", "numerical", "contact_grid")  # the zero of the potential is arbitrary
    lines = [np.abs(values) for name, values in energy.items() if name not in left_out]
    hand = float(np.max(lines)) if lines else 0.0
    defect = energy["numerical"] + energy["contact_grid"]
    gained = float(np.max(defect - np.minimum.accumulate(defect)))
    taken = float(np.max(np.maximum.accumulate(energy["numerical"]) - energy["numerical"]))
    notes = []
    if gained > max(GAINED * hand, nothing):
        notes.append(
            f"the run gained {gained:.3g} J, {gained / max(hand, 1e-300):.1%} of the largest energy of the ledger, "
            "without a source (ledger lines numerical and contact grid): use a smaller step, step_error=, or "
            "initial velocities that agree with the drives"
        )
    if taken > max(TAKEN * hand, nothing):
        notes.append(
            f"the integrator dissipated {taken:.3g} J, {taken / max(hand, 1e-300):.1%} of the largest energy of the "
            "ledger (line numerical), from motions that the step does not resolve: use a smaller step, step_error=, or "
            "less numerical damping (rho_inf=)"
        )
    return notes


SAMPLED = 8  # saved steps checked, evenly distributed: a patch changes slowly compared with a step
MARGIN = 1  # columns next to the active ones
NOTED = 0.01  # a larger difference of the force is noted with a cure


@dataclass(frozen=True)
class SamplingCheck:
    """Largest differences over the evaluated steps: `gap` over the depth of the patch, `force` over the force,
    `pressure` over the pressure in the L2 norm; at the saved rows `rows`.
    """

    gap: float
    force: float
    pressure: float
    rows: tuple[int, ...]

    def note(self, name: str, few: int, all_points: int) -> str:
        """The line for the report."""
        if not self.rows:
            return f"contact {name!r}: quadrature 'reduced' was not checked, no saved step with contact"
        text = (
            f"contact {name!r}: quadrature 'reduced', {few} of {all_points} points per strip; compared with all points "
            f"on {len(self.rows)} saved steps at most {self.gap:.2%} of the depth in a gap, {self.force:.2%} of the "
            f"force, {self.pressure:.2%} of the pressure (L2)"
        )
        if self.force > NOTED:
            text += "; reduce the first body with a smaller sampling_error"
        return text


def sampling_notes(scene: Scene, history: History) -> list[str]:
    """One note for each contact of quadrature "reduced"."""
    notes = []
    for contact in scene.finite_sliding:
        if contact.quadrature != "reduced":
            continue
        surface = contact.a.surface
        settings = Settings()
        every = len(gauss_points(surface.grid.rows, settings.theta_points, settings.z_points)[0])
        notes.append(check_sampling(contact, history).note(contact.name, surface.sampling.count, every))
    return notes


def check_sampling(contact: Contact, history: History, sampled: int = SAMPLED) -> SamplingCheck:
    """Compare the sampling points of the first surface with all Gauss points on `sampled` saved steps of `history`."""
    surface, settings = contact.a.surface, Settings()
    x, row, zeta, share = gauss_points(surface.grid.rows, settings.theta_points, settings.z_points)
    points = surface.sampling
    z = points.axial(surface.grid.z)
    few = _Rule(points.fraction, row=points.row, zeta=points.zeta, z=z, weight=points.weight)
    lines, shape = surface.grid.z, surface.shape
    z = lines[row] + zeta * (lines[row + 1] - lines[row])
    measure = shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2)
    every = _Rule(x, row, zeta, z, share * surface.grid.pitch * np.diff(lines)[row] * measure)
    record = history.contacts[contact.name]
    touching = np.flatnonzero((record.pressure > 0.0).any(axis=(1, 2)))
    rows = touching[np.unique(np.linspace(0, len(touching) - 1, min(sampled, len(touching))).astype(int))]
    found = [_compare(contact, history, int(t), few, every) for t in rows]
    worst = np.max(np.array(found).reshape(-1, 3), axis=0, initial=0.0)
    return SamplingCheck(float(worst[0]), float(worst[1]), float(worst[2]), tuple(int(t) for t in rows))


@dataclass(frozen=True, eq=False)
class _Rule:
    """Points of a strip: fraction of a column, row, zeta, axial place z [m], weight [m^2]."""

    fraction: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    z: np.ndarray
    weight: np.ndarray


def _compare(contact: Contact, history: History, t: int, few: _Rule, every: _Rule) -> tuple[float, float, float]:
    """Differences of gap, force and pressure at the saved row t."""
    record, grid = history.contacts[contact.name], contact.a.surface.grid
    s = record.pressure[t]
    loaded = np.flatnonzero((s > 0.0).any(axis=1))
    low, high = int(loaded[0]) - MARGIN, int(loaded[-1]) + 1 + MARGIN
    columns = int(record.first_column[t]) + np.arange(low, high)
    active = np.zeros((len(columns), grid.rows), dtype=bool)
    active[MARGIN:-MARGIN] = s[loaded[0] : loaded[-1] + 1] > 0.0
    pressure = np.zeros(active.shape)
    pressure[active] = s[s > 0.0]
    active, pressure = active.ravel(), pressure.ravel()
    gaps, stencils = [], []
    E = np.zeros((len(active), len(active)))
    for rule in (few, every):
        g, S, depth = _weak(contact, history, t, rule, columns, pressure)
        if contact.law.bent is not None:
            y, E = _weak_yield(contact.law.bent, rule, columns, grid.rows, pressure)
            g = g + y
        gaps.append(g[active])
        stencils.append(S[active])
    area = np.tile(grid.pitch * np.asarray(contact.a.surface.gram_z).sum(axis=1), len(columns))[active]
    dg = gaps[0] - gaps[1]
    M = _gram(contact.a.surface, len(columns))
    G = M @ _compliance(contact.a.surface, columns) @ M + contact.law.compliance * M + E
    G = G[np.ix_(active, active)]
    B = contact.b.surface
    if B.grid is not None:
        second = _second_columns(record, t, B)
        G = G + stencils[1] @ _compliance(B, second) @ stencils[1].T
    ds = -np.linalg.solve(G, dg)
    p, inside = pressure[active], M[np.ix_(active, active)]
    size = float(np.sqrt(p @ inside @ p))
    depth = max(depth, float(np.finfo(float).tiny))
    return (
        float(np.abs(dg / area).max() / depth),
        float(abs(area @ ds) / (area @ p)),
        float(np.sqrt(max(ds @ inside @ ds, 0.0)) / size),
    )


def _weak(
    contact: Contact, history: History, t: int, rule: _Rule, columns: np.ndarray, pressure: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Weak gaps (nodes,) [m^3] of the columns under `pressure` (nodes,) without A's displacement, stencils (nodes,
    nodes of B's window) [m^2], and the depth of the patch [m].
    """
    A, B = contact.a.surface, contact.b.surface
    grid = A.grid
    x = np.concatenate([columns[:1] - 1, columns])[:, None] + rule.fraction  # strips below and above each column
    theta = _grid_angle(A) + grid.theta_start + grid.pitch * x
    z = np.broadcast_to(rule.z, x.shape)
    (r_a, A_a, _), (r_b, A_b, q_b) = (_pose(port.body, history, t) for port in (contact.a, contact.b))
    world = r_a + A.shape.point(theta, z) @ A_a.T
    theta_b, z_b, gap = B.shape.chart((world - r_b) @ A_b)
    depth = float(max(-gap.min(), 0.0))
    weights = _node_weights(rule, columns, grid.rows)
    if B.grid is None:
        return weights @ gap.ravel(), np.zeros((len(weights), 0)), depth
    # points outside B have no opposite point
    weights = weights * ((z_b >= B.grid.z[0]) & (z_b <= B.grid.z[-1])).ravel()
    second = _second_columns(history.contacts[contact.name], t, B)
    S = weights @ _opposite(B, theta_b, z_b, second)
    modal = B.mode_normal.reshape(B.grid.columns, B.grid.rows, -1)[second % B.grid.columns] @ q_b
    u = modal.ravel() - _compliance(B, second) @ (S.T @ pressure)
    return weights @ gap.ravel() - S @ u, S, depth


def _node_weights(rule: _Rule, columns: np.ndarray, rows: int) -> np.ndarray:
    """w_p psi_i(x_p) (nodes of the columns, points of their strips) [m^2]."""
    n = len(rule.fraction)
    weights = np.zeros((len(columns), rows, len(columns) + 1, n))
    for j in range(len(columns)):
        for strip, part in ((j, rule.fraction), (j + 1, 1.0 - rule.fraction)):
            for up, piece in ((0, 1.0 - rule.zeta), (1, rule.zeta)):
                weights[j, rule.row + up, strip, np.arange(n)] = rule.weight * part * piece
    return weights.reshape(len(columns) * rows, -1)


def _weak_yield(
    curve: Curve, rule: _Rule, columns: np.ndarray, rows: int, pressure: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Weak compression (nodes,) [m^3] of a layer under `pressure` (nodes,), and its tangent E (nodes, nodes)
    [m^3/Pa].
    """
    weights = _node_weights(rule, columns, rows)
    psi = weights / np.tile(rule.weight, len(columns) + 1)
    y, slope = curve.yielding(pressure @ psi)
    return weights @ y, (weights * slope) @ psi.T


def _pose(body: Body, history: History, t: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position of the user origin, axes (3, 3) and global coordinates of a body, or the ground, at the saved row t."""
    if body.index < 0:
        return np.zeros(3), np.eye(3), np.zeros(0)
    motion = history.bodies[body.name]
    return motion.position[t], rot.matrix(motion.rotation[t]), motion.modal[t]


def _grid_angle(surface: ContactSurface) -> float:
    """Angle of the grid's e_0 in the chart of the shape."""
    shape, e_0 = surface.shape, surface.grid.e_0
    return float(np.arctan2(e_0 @ shape.e_1, e_0 @ shape.e_0))


def _second_columns(record: ContactHistory, t: int, B: ContactSurface) -> np.ndarray:
    """Columns of B's window at the saved row t, those that exist."""
    columns = int(record.first_column_second[t]) + np.arange(record.load_second.shape[1])
    if not B.grid.periodic:
        return columns[(columns >= 0) & (columns < B.grid.columns)]
    return columns[: B.grid.columns]


def _opposite(B: ContactSurface, theta: np.ndarray, z: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Values (points, nodes) of the shape functions of the window's `columns` of B at chart points theta, z."""
    grid = B.grid
    x = ((theta - _grid_angle(B) - grid.theta_start) / grid.pitch).ravel()
    middle = 0.5 * float(columns[0] + columns[-1])
    turn = B.shape.profile().turn / grid.pitch
    if np.isfinite(turn):
        x = x - turn * np.floor((x - middle) / turn + 0.5)
    column = np.floor(x).astype(int)
    u = x - column
    row = np.clip(np.searchsorted(grid.z, z.ravel(), side="right") - 1, 0, grid.rows - 2)
    v = np.clip((z.ravel() - grid.z[row]) / np.diff(grid.z)[row], 0.0, 1.0)
    out = np.zeros((len(x), len(columns), grid.rows))
    n = np.arange(len(x))
    for step, part in ((0, 1.0 - u), (1, u)):
        at = column + step - columns[0]
        held = (at >= 0) & (at < len(columns))
        for up, piece in ((0, 1.0 - v), (1, v)):
            out[n[held], at[held], row[held] + up] += (part * piece)[held]
    return out.reshape(len(x), -1)


def _compliance(surface: ContactSurface, columns: np.ndarray) -> np.ndarray:
    """D of the nodes of `columns`; periodic on a full circumference."""
    grid = surface.grid
    turn = len(surface.lags) * grid.columns_per_sector
    if grid.periodic:
        columns = columns % turn
    known = (columns >= 0) & (columns < grid.columns)
    D = np.zeros((len(columns) * grid.rows,) * 2)
    at = np.repeat(known, grid.rows)
    D[np.ix_(at, at)] = surface.compliance(columns[known])
    return D


def _gram(surface: ContactSurface, columns: int) -> np.ndarray:
    """M of the nodes of that many adjacent columns [m^2]."""
    around = np.diag(np.full(columns, 2.0 / 3.0)) + np.diag(np.full(columns - 1, 1.0 / 6.0), 1)
    around += np.diag(np.full(columns - 1, 1.0 / 6.0), -1)
    return surface.grid.pitch * np.kron(around, np.asarray(surface.gram_z))
