"""How long the axes of arrays are, and what a scene has at all: one number a name, zero for what is not there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from warpffrf_kernels import control as k
from warpffrf_kernels.contact_points import LINE
from warpffrf_kernels.scalars import BLOCK

from warpffrf.online.compile import CompiledScene
from warpffrf.online.compile_shared import serves_several
from warpffrf.online.layer_arrays import layer_points
from warpffrf.online.outer_pattern import OuterPattern

Sizes = Mapping[str, int]
RESIDUALS_KEPT = 32

NAMES = {
    "world": "copies of the scene",
    "body": "bodies",
    "mode": "modes of all bodies",
    "row": "constraints, drives and springs",
    "force": "forces",
    "torque": "torques",
    "load": "torques and body loads",
    "interface": "flexible interfaces",
    "interface_shape": "modes of interfaces, one number each",
    "group": "groups of spring rows",
    "dense": "modes that carry inertia",
    "exact_mode": "modes, where some take the exact step",
    "dynamic_mode": "modes, where local ones are dynamic",
    "outer": "outer unknowns",
    "line": "lines of the energy ledger",
    "integer_word": "control words",
    "real_word": "clock words",
    "residual": "residuals kept for the report of a failure",
    "ring_row": "rows of the ring",
    "ring_number": "numbers of a row",
    "pair": "pairs in contact",
    "contact_body": "bodies, in scenes with contact",
    "contact_mode": "modes, in scenes with contact",
    "contact_outer": "outer unknowns, in scenes with contact",
    "pair_mode": "modes of both bodies of a pair, the most",
    "coupled": "outer columns that a gap depends on",
    "hat": "places of the first surface's window",
    "node": "places of the second surface's window",
    "slot": "hats in play",
    "station": "axial stations of a line of centres",
    "window_point": "Gauss points of a window",
    "column_point": "points of a column of the first grid",
    "point_number": "numbers of the points of a window",
    "held_hat": "hats, in scenes of pairs that touch in points",
    "stencil": "hats of the second surface that one of the first overlaps",
    "layer_point": "points of a window at which layers are evaluated",
    "layer_hat": "hats, in scenes with layers whose yield is no constant",
    "friction_pair": "pairs, in scenes with friction",
    "friction_hat": "cells of a window: as many as hats, in scenes with friction",
    "friction_node": "places of the second window, in scenes with friction",
    "friction_slot": "slots, in scenes with friction",
    "cell": "cells that may carry friction at once",
    "share": "cells of the second surface that one of the first overlaps",
    "surface_place": "places of the larger window",
    "factor_number": "numbers of the sparse factor",
    "factor_line": "numbers of a line of it, of all lanes",
    "one": "always 1",
    # what launches ask for, no axes
    "applied": "forces and torques",
    "row_or_mode": "rows and modes",
    "stiffened_interface": "interfaces of bodies that their loads stiffen",
    "dense_outer": "outer unknowns, where their matrix is inverted",
    "dense_row": "rows of that",
    "sparse_outer": "outer unknowns, where their matrix is factored sparsely",
    "sparse_row": "rows of that",
    "projected_row": "rows, where velocities are projected onto them",
    "adaptive_world": "worlds, where steps follow the wanted accuracy",
    "line_pair": "pairs whose gaps are taken along the line of centres",
    "point_pair": "pairs whose gaps are taken at points",
    "few_pair": "pairs of the line of centres with a list of points",
    "shared_pair": "pairs, where surfaces serve several",
    "shared_friction_pair": "the same, in scenes with friction",
}


def sizes_of(
    compiled: CompiledScene,
    worlds: int,
    ring_rows: int,
    pattern: OuterPattern | None,
    *,
    projected: bool,
    adaptive: bool,
) -> dict[str, int]:
    """Length of each axis of `NAMES`; `pattern`: of the sparse outer matrix, None where it is inverted."""
    m: Any = compiled.model
    P, B, Q, S, rows, outer = m.pair_count, m.body_count, m.modal_count, m.slot_capacity, m.row_count, m.outer_count
    hat, node = m.mode_capacity, m.node_capacity
    families, counts = m.pair_family.numpy()[:P], m.pair_point_count.numpy()[:P]
    stations = (m.max_rows - 1) * m.z_points
    rubbing = bool(m.cell_capacity)
    shared = serves_several(m)
    layer_point = layer_points(m)
    dense = pattern is None
    return {
        "world": worlds, "body": B, "mode": Q, "row": rows, "force": m.force_count, "torque": m.torque_count,
        "load": m.torque_count + m.load_count, "interface": m.interface_count,
        "interface_shape": compiled.interface_modes.size, "group": m.group_count, "dense": m.dense_count,
        "exact_mode": Q if compiled.local.exact else 0, "dynamic_mode": Q if m.dynamic_count else 0, "outer": outer,
        "line": k.LINES, "integer_word": k.CTL, "real_word": k.CLK, "residual": RESIDUALS_KEPT,
        "ring_row": ring_rows, "ring_number": ring_width(m), "pair": P, "contact_body": B if P else 0,
        "contact_mode": Q if P else 0, "contact_outer": outer if P else 0, "pair_mode": m.pair_modes,
        "coupled": m.coupled_capacity, "hat": hat, "node": node, "slot": S, "station": stations,
        "window_point": (m.window_columns + 1) * m.theta_points * max(stations, 1), "column_point": m.most_points,
        "point_number": (m.window_columns + 1) * m.most_points * LINE, "held_hat": hat if m.most_points else 0,
        "stencil": m.stencil_columns * m.stencil_rows, "layer_point": layer_point,
        "layer_hat": hat if layer_point else 0, "friction_pair": P if rubbing else 0,
        "friction_hat": hat if rubbing else 0, "friction_node": node if rubbing else 0,
        "friction_slot": S if rubbing else 0, "cell": m.cell_capacity, "share": m.share_columns * m.share_rows,
        "surface_place": max(hat, node), "factor_number": 0 if dense else pattern.factor_size,
        "factor_line": 0 if dense else BLOCK * pattern.widest, "one": 1,
        "applied": m.force_count + m.torque_count, "row_or_mode": rows + Q,
        "stiffened_interface": m.interface_count if compiled.stiffened else 0,
        "dense_outer": outer if dense else 0, "dense_row": rows if dense else 0,
        "sparse_outer": 0 if dense else outer, "sparse_row": 0 if dense else rows,
        "projected_row": rows if projected else 0, "adaptive_world": worlds if adaptive else 0,
        "line_pair": int((families == 0).sum()), "point_pair": int((families == 1).sum()),
        "few_pair": int(((families == 0) & (counts > 0)).sum()), "shared_pair": P if shared else 0,
        "shared_friction_pair": P if shared and rubbing else 0,
    }  # fmt: skip


def friction_width(m: Any) -> int:
    """Numbers a pair adds to a record in scenes with friction, see `warpffrf_kernels.friction_keep`."""
    return 5 * m.mode_capacity + 5 if m.cell_capacity else 0


def ring_width(m: Any) -> int:
    """Numbers in one record, see `warpffrf_kernels.record.record`."""
    pair = 16 + m.mode_capacity + 1 + m.node_capacity + friction_width(m)
    return 4 + k.LINES + 19 * m.body_count + 3 * m.modal_count + 7 * m.row_count + pair * m.pair_count
