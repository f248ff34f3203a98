"""Displacements of the contact surfaces of a body under loads on them -> device tables (`surfaces.responses`).

A side of a pair measures its surface weakly and loads it by nodal functions of pressure (the first side), or does both
at nodes (the second): the tables contain the necessary Gram matrices. Each is made once, for all sides that use it.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np

from warpffrf.model.bodies import Ground
from warpffrf.model.reduced.contact_surface import ContactSurface, CrossCompliance
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import (
    by_column,
    columns_of_turn,
    node_gram,
    product,
    response_table,
    transposed,
)
from warpffrf_kernels.core.model import Model, Window

SPARE = 2  # columns that a window may have moved since the sources were counted
NORMAL, RUBBED, PRESSED, TANGENTIAL = "normal", "rubbed", "pressed", "tangential"
NO_TABLE = -1


class Key(NamedTuple):
    """Content of a table: displacements of `target` under loads on `source`, numbers of surfaces; whether they are
    measured and loaded weakly or at nodes; and the compliance [m/Pa] of a layer between the two of a pair's own.
    """

    kind: str
    target: int
    source: int
    nodes_read: bool
    nodes_load: bool
    layer: float


def loads_on_sides(collector: Collector) -> list[list[int]]:
    """For every side of every pair, the sides whose loads displace it by local modes, its own first."""
    surfaces, sides = collector.surfaces, collector.sides
    found: list[list[int]] = []
    for side, target in enumerate(sides):
        if not isinstance(surfaces[target].surface, ContactSurface):
            found.append([])
            continue
        others = [
            other for other, source in enumerate(sides)
            if other != side and (source == target or _cross(collector, target, source) is not None)
        ]  # fmt: skip
        found.append([side, *others])
    return found


def fill_responses(collector: Collector, m: Model) -> None:
    """The loads on every side and the tables of their displacements."""
    loads = loads_on_sides(collector)
    rubbing = [contact.friction.acts for contact in collector.scene.finite_sliding]
    layers = [contact.law.compliance for contact in collector.scene.finite_sliding]
    asked: dict[Key, int] = {}
    far: set[Key] = set()
    numbers: dict[str, list[int]] = {kind: [] for kind in (NORMAL, RUBBED, PRESSED, TANGENTIAL)}
    for reads, sources in enumerate(loads):
        target = collector.sides[reads]
        for other in sources:
            source = collector.sides[other]
            wanted = {
                NORMAL: True, RUBBED: rubbing[other // 2], PRESSED: rubbing[reads // 2],
                TANGENTIAL: rubbing[other // 2] and rubbing[reads // 2],
            }  # fmt: skip
            for kind, use in wanted.items():
                if not use or _operator(collector, kind, target, source) is None:
                    numbers[kind].append(NO_TABLE)
                    continue
                key = Key(
                    kind, target, source,
                    reads % 2 == 0 and kind in (NORMAL, RUBBED), other % 2 == 0 and kind in (NORMAL, PRESSED),
                    layers[reads // 2] if kind == NORMAL and other == reads and reads % 2 == 0 else 0.0,
                )  # fmt: skip
                numbers[kind].append(asked.setdefault(key, len(asked)))
                if other != reads:
                    far.add(key)
    fields: dict[str, list[int]] = {
        name: [] for name in ("start", "source_block", "target_block", "source_turn", "source_lines", "target_lines",
                              "reach", "width")
    }  # fmt: skip
    parts = [np.zeros(0)]
    for key in asked:
        table, values = _table(collector, key, m.window, key in far)
        for name, value in {"start": sum(map(len, parts)), **values}.items():
            fields[name].append(value)
        parts.append(table)
    collector.fill(
        m.responses, load_start=np.cumsum([0, *map(len, loads)]), load_side=[n for side in loads for n in side],
        **numbers, **fields, number=np.concatenate(parts),
    )  # fmt: skip
    m.pairs.beside = int(any(len(sources) > 1 for sources in loads) or _condensed_between(collector, m))
    collector.notes.extend(_apart(collector))


def _condensed_between(collector: Collector, m: Model) -> bool:
    """Whether several pairs load a body with condensed modes."""
    loads = Counter(collector.surfaces[s].body.index for s in collector.sides)
    kept = m.bodies.dense_count.numpy()
    return any(
        loads[body.index] > 1 and collector.mode_counts[body.index] > kept[body.index]
        for body in collector.scene.bodies
    )


def _cross(collector: Collector, target: int, source: int) -> CrossCompliance | None:
    """Displacement of one surface of a body by loads on another one; None where they are on different bodies, and where
    local modes have inertia, whose traces end on their own surface.
    """
    (body, name, _), (other, other_name, _) = collector.surfaces[target], collector.surfaces[source]
    if body is not other or isinstance(body, Ground) or body.reduced is None or collector.local.count(body.index):
        return None
    return body.reduced.cross_compliance(name, other_name)


def _operator(collector: Collector, kind: str, target: int, source: int) -> np.ndarray | None:
    """Block-circulant compliance between nodes and cells of two surfaces, None where there is none."""
    if target != source:
        cross = _cross(collector, target, source)
        if cross is None:
            return None
        return {NORMAL: cross.lags, RUBBED: cross.lags_nt, PRESSED: cross.lags_tn, TANGENTIAL: cross.lags_tt}[kind]
    surface = collector.surfaces[target].surface
    if not isinstance(surface, ContactSurface):
        return None
    if kind == NORMAL:
        return surface.lags
    if surface.tangential is None:
        return None
    nt = surface.tangential.lags_nt
    return {RUBBED: nt, PRESSED: transposed(nt), TANGENTIAL: surface.tangential.lags_tt}[kind]


def _table(collector: Collector, key: Key, window: Window, far: bool) -> tuple[np.ndarray, dict[str, int]]:
    """Flat table of a key and the numbers by which kernels index it; `far`: of loads anywhere on the body."""
    operator = _operator(collector, key.kind, key.target, key.source)
    target, source = (collector.surfaces[s].surface for s in (key.target, key.source))
    if operator is None or not isinstance(target, ContactSurface) or not isinstance(source, ContactSurface):
        raise TypeError(f"no operator for {key}")
    sectors = len(operator)
    factors = [operator]
    if key.nodes_read:
        factors.insert(0, node_gram(target, sectors))
    if key.nodes_load:
        factors.append(node_gram(source, sectors))
    blocks = product(*factors)
    if key.layer:
        blocks = blocks + key.layer * node_gram(target, sectors)
    lines = [(1 + (key.kind in of), s.grid.rows)
             for of, s in (((PRESSED, TANGENTIAL), target), ((RUBBED, TANGENTIAL), source))]  # fmt: skip
    blocks = by_column(blocks, *lines)
    turn, source_turn = columns_of_turn(target), columns_of_turn(source)
    reach = window.columns + window.second_columns + window.stencil_columns
    if far and turn:
        reach = max(reach, turn // 2 + blocks.shape[1] + max(window.half, window.second_half) + SPARE)
    table = response_table(blocks, reach, bool(turn))
    return table.ravel(), {
        "source_block": blocks.shape[3], "target_block": blocks.shape[1] if turn else 0, "source_turn": source_turn,
        "source_lines": blocks.shape[4], "target_lines": blocks.shape[2], "reach": reach,
        "width": blocks.shape[1] + 2 * reach,
    }  # fmt: skip


def _apart(collector: Collector) -> list[str]:
    """A note for each body that is loaded on several surfaces which are not coupled by local modes."""
    notes = []
    for body in collector.scene.bodies:
        mine = [i for i, s in enumerate(collector.surfaces)
                if s.body is body and isinstance(s.surface, ContactSurface) and not s.surface.half_space]  # fmt: skip
        if any(_cross(collector, i, j) is None for i in mine for j in mine if i != j):
            names = ", ".join(sorted(collector.surfaces[i].name for i in mine))
            why = "its local modes have inertia" if collector.local.count(body.index) else "reduce it again"
            notes.append(
                f"body {body.name!r}: its contact surfaces {names} are coupled through its {body.mode_count} "
                f"global modes only ({why})"
            )
    return notes
