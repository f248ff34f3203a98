r"""Small-sliding contacts of a scene -> device tables of their groups (kernels of `matched`).

Small-sliding contacts that share a flexible body are coupled by its compliance, and form a *group*. With P_b from the
forces s of the cells of a group to those of the interface compliance C_b of body b (`face_loads`),

    G = sum_b P_b^T C_b P_b + E,      J = [rigid relative motion of each contact | P_b^T modes_b of each body],

E the compliance of layers, divided by the areas of cells. Without friction only the normal parts are kept.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import get_lapack_funcs

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Body
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding import matched_surface
from warpffrf.model.small_sliding.sliding import MatchedCells, cells_of, small_sliding_notes, yields
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.inertia import retained_modes
from warpffrf_kernels.core.model import Matched
from warpffrf_kernels.matched import motion
from warpffrf_kernels.matched.tableau import MOST

Array = np.ndarray
RIGID = int(motion.RIGID)
MANY = 1500  # cells of a group
FEWEST = 64  # lines of cells that may differ from those of a table
DEPENDENT = 1e-10  # of the mean compliance of a force: its part independent of the others
THIN = 1e-6  # of that mean: layer that is added then
STIFF = 1e4  # times the stiffness of single cells: no deformation is left


def groups_of(matched: list[Contact]) -> list[list[int]]:
    """Numbers of the small-sliding contacts, grouped by shared flexible bodies."""
    found: list[tuple[set[int], list[int]]] = []
    for number, contact in enumerate(matched):
        bodies = {port.body.index for port in contact.ports if not port.rigid}
        joined, numbers = set(bodies), [number]
        rest = []
        for known, members in found:
            if known & bodies:
                joined |= known
                numbers = members + numbers
            else:
                rest.append((known, members))
        found = [*rest, (joined, sorted(numbers))]
    return sorted(numbers for _, numbers in found)


def matched_order(matched: list[Contact]) -> list[int]:
    """Numbers of the small-sliding contacts in the order of their cells on the device."""
    return [number for numbers in groups_of(matched) for number in numbers]


def fill_matched(collector: Collector) -> None:
    """Tables of all small-sliding contacts. Raises `InputError` for faces that do not face each other."""
    declared: Any = Matched
    scene = collector.scene
    ones: dict[str, list[Any]] = {}
    parts: dict[str, list[Array]] = {}

    def one(**values: Any) -> None:
        for name, value in values.items():
            ones.setdefault(name, []).append(value)

    def part(**values: Any) -> None:
        for name, value in values.items():
            parts.setdefault(name, []).append(np.asarray(value))

    modal = np.cumsum([0, *collector.mode_counts])
    retained = np.cumsum([0, *retained_modes(collector)])
    column = 0
    for numbers in groups_of(scene.small_sliding):
        members = [scene.small_sliding[number] for number in numbers]
        cells = [cells_of(contact) for contact in members]
        flexible = _bodies(members, rigid=False)
        friction = np.concatenate(
            [
                np.full(len(c.cell), contact.friction.static_coefficient)
                for contact, c in zip(members, cells, strict=True)
            ]
        )
        components = 3 if np.any(friction > 0.0) else 1
        G = _compliance(members, cells, flexible)
        J = _motion(members, cells, flexible)
        kept = slice(None) if components == 3 else slice(0, None, 3)
        collector.notes.extend(_tell_apart(members, G, J, kept))
        diagonal = np.diag(G).reshape(-1, 3)
        columns, lines = J.shape[1], len(J[kept])
        within = 0
        for contact in members:
            between = contact.b is not None
            one(
                first=contact.a.body.index, second=contact.b.body.index if between else contact.a.body.index,
                rigid_column=column + within if between else -1, **_frames(contact),
            )  # fmt: skip
            within += RIGID if between else 0
        mode = [np.full(within, -1)] + [modal[b.index] + np.arange(b.mode_count) for b in flexible]
        moving = _bodies([contact for contact in members if contact.b is not None], rigid=True)
        rigid = np.concatenate([np.zeros(0, int), *(6 * b.index + np.arange(6) for b in moving)])
        dense = [6 * len(scene.bodies) + retained[b.index] + np.arange(b.mode_count) for b in flexible]
        one(
            components=components, yields=float(diagonal[:, 0].mean()), matched=len(members), cells=len(friction),
            columns=columns, lines=lines + columns, coordinates=len(rigid) + columns - within,
        )  # fmt: skip
        part(
            compliance=G[kept, kept].T.ravel(), motion=J[kept].T.ravel(), friction=friction,
            gap=np.concatenate([c.gap for c in cells]),
            own=diagonal[:, 1:].mean(axis=1),
            column_mode=np.concatenate(mode), retained=np.concatenate([rigid, *dense]),
            retained_column=np.concatenate([np.full(len(rigid), -1), within + np.arange(columns - within)]),
        )  # fmt: skip
        column += columns
        collector.notes.extend(_notes(members, cells, lines))
    values: dict[str, Any] = dict.fromkeys(declared.declarations, np.zeros(0))
    if scene.small_sliding:
        values |= {name: ones[name] for name in values if name in ones}
        values |= {name: np.concatenate(parts[name]) for name in values if name in parts}
        lines, columns, coordinates = (np.array(ones[name]) for name in ("lines", "columns", "coordinates"))
        most = np.minimum(np.maximum((lines - columns) // 2, FEWEST), np.minimum(lines - columns, MOST))
        for name, sizes in (
            ("matched", ones["matched"]), ("cell", ones["cells"]), ("column", columns), ("line", lines), ("table",
            lines**2),
            ("square", columns**2), ("retained", coordinates), ("followed", coordinates * columns), ("differing", most),
            ("factor", most**2), ("update", most * lines),
        ):  # fmt: skip
            values[f"{name}_start"] = np.concatenate([[0], np.cumsum(sizes)])
        for name in ("compliance", "motion"):
            values[f"{name}_start"] = np.cumsum([0, *map(len, parts[name])])[:-1]
    collector.fill(collector.matched, count=len(ones.get("matched", [])), matched=len(scene.small_sliding), **values)


def _bodies(matched: list[Contact], *, rigid: bool) -> list[Body]:
    """Bodies of these contacts that move, flexible ones alone or all, each once, in the order of the scene."""
    found = {
        p.body.index: p.body
        for contact in matched
        for p in contact.ports
        if p.body.index >= 0 and (rigid or not p.rigid)
    }
    return [found[index] for index in sorted(found)]


def _frames(contact: Contact) -> dict[str, Array]:
    """Origin and axes in which the relative motion of two bodies is measured, and R_0."""
    if contact.b is None:
        return {"first_point": np.zeros(3), "second_point": np.zeros(3), "turn": np.eye(3)}
    point = contact.a.body.to_world(contact.a.surface.points.mean(axis=0))
    arms = []
    for port in contact.ports:
        center = port.body.center_of_mass if port.body.index >= 0 else np.zeros(3)
        arms.append(port.body.to_user(point) - center)
    turn = rot.matrix(contact.a.body.rotation).T @ rot.matrix(contact.b.body.rotation)
    return {"first_point": arms[0], "second_point": arms[1], "turn": turn}


def _loads(contact: Contact, cells: MatchedCells, body: Body) -> sp.csr_matrix | None:
    """P of a contact on a body (unknowns of its interface compliance, 3 c); None where it does not load it."""
    surfaces = body.flexible.matched
    if contact.a.body is body:
        return matched_surface.on_own(surfaces, contact.a.name, cells.cell)
    if contact.b is None or contact.b.rigid or contact.b.body is not body or cells.weights is None:
        return None
    turn = rot.matrix(body.rotation).T @ rot.matrix(contact.a.body.rotation)
    return matched_surface.on_partner(surfaces, contact.b.name, cells.weights, cells.frames @ turn.T)


def _all_loads(matched: list[Contact], cells: list[MatchedCells], body: Body) -> sp.csr_matrix:
    """P of all contacts of a group on a body."""
    total = matched_surface.count(body.flexible.matched)
    parts = []
    for contact, own in zip(matched, cells, strict=True):
        found = _loads(contact, own, body)
        parts.append(sp.csr_matrix((total, 3 * len(own.cell))) if found is None else found)
    return sp.csr_matrix(sp.hstack(parts))


def _compliance(matched: list[Contact], cells: list[MatchedCells], bodies: list[Body]) -> Array:
    """G (3 c, 3 c) [m/N]."""
    n = 3 * sum(len(own.cell) for own in cells)
    G = np.zeros((n, n))
    for body in bodies:
        P = _all_loads(matched, cells, body)
        G += P.T @ np.asarray(P.T @ body.flexible.matched_compliance).T
    layers = [
        np.array(yields(contact))[[0, 1, 1]] / own.area[:, None] for contact, own in zip(matched, cells, strict=True)
    ]
    G[np.diag_indices(n)] += np.concatenate(layers).ravel()
    return 0.5 * (G + G.T)


def _tell_apart(matched: list[Contact], G: Array, J: Array, kept: slice) -> list[str]:
    """Where forces of cells cause no displacement independent of the others, a layer on the diagonal of G that makes
    them unique, and a note of it. Raises `InputError` where such forces move the bodies nevertheless: then there is no
    compliance between them.
    """
    label = ", ".join(contact.label for contact in matched)
    part = np.array(G[kept, kept], order="F")
    mean = float(np.trace(part)) / len(part)
    (pivoted_cholesky,) = get_lapack_funcs(("pstrf",), (part,))
    _, _, rank, _ = pivoted_cholesky(part / mean, tol=DEPENDENT)
    missing = len(part) - rank
    if not missing:
        return []
    G[np.diag_indices(len(G))] += THIN * mean
    stiffness = np.einsum("ij,ij->j", J[kept], np.linalg.solve(G[kept, kept], J[kept])) * mean
    soft = np.einsum("ij,ij->j", J[kept], J[kept])
    if np.any(stiffness > STIFF * soft):
        raise InputError(
            f"{label}: no local compliance is left for the cells: the global modes contain all deformation by some of "
            "their forces; reduce with fewer modes, with more elements across the thickness, or with fewer cells"
        )
    return [
        f"{label}: {missing} of {len(part)} forces of cells cause no independent displacement, as with more "
        f"cells than nodes; a layer with {THIN:g} of the mean compliance of a cell makes them unique, "
        "surfaces.Matched(size=) gathers cells"
    ]


def _motion(matched: list[Contact], cells: list[MatchedCells], bodies: list[Body]) -> Array:
    """J (3 c, columns)."""
    starts = np.cumsum([0, *(3 * len(own.cell) for own in cells)])
    parts = []
    for start, contact, own in zip(starts, matched, cells, strict=False):
        if contact.b is None:
            continue
        rigid = np.zeros((starts[-1], RIGID))
        arm = own.points - contact.a.surface.points.mean(axis=0)
        turned = np.cross(np.eye(3)[None, :, :], arm[:, None, :])  # e_i x arm
        block = np.concatenate([own.frames, np.einsum("cki,cji->ckj", own.frames, turned)], axis=2)
        rigid[start : start + 3 * len(own.cell)] = block.reshape(-1, RIGID)
        parts.append(rigid)
    for body in bodies:
        modes = np.concatenate([surface.modes for surface in body.flexible.matched.values()], axis=1)
        parts.append(np.asarray(_all_loads(matched, cells, body).T @ modes.T))
    return np.concatenate(parts, axis=1)


def _notes(matched: list[Contact], cells: list[MatchedCells], lines: int) -> list[str]:
    """Notes on a group for the report of a run."""
    notes = []
    for contact, own in zip(matched, cells, strict=True):
        notes.extend(small_sliding_notes(contact, own))
    count = sum(len(own.cell) for own in cells)
    if count > MANY:
        notes.append(
            f"{', '.join(contact.label for contact in matched)}: {count} cells with {lines} unknown forces, all "
            "coupled; use surfaces.Matched(size=, growth=) for larger cells where little changes"
        )
    return notes
