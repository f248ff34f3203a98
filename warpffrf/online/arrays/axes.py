"""Lengths of the axes of arrays, and counts of the parts of a scene: one number per name, zero for absent parts."""

from __future__ import annotations

from collections.abc import Mapping

from warpffrf.online.compile.retained_pattern import RetainedPattern
from warpffrf.online.compile.scene import CompiledScene
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import AT_POINTS, LINE_OF_CENTRES, PATCH, Model
from warpffrf_kernels.core.scalars import BLOCK
from warpffrf_kernels.kinematics.at_points import LINE

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
    "joint_friction": "joints with friction",
    "pretension": "pretensions",
    "dense": "retained modes",
    "exact_mode": "modes, if some use the exact step",
    "dynamic_mode": "modes, if local ones are dynamic",
    "retained": "retained unknowns",
    "line": "lines of the energy ledger",
    "residual": "residuals kept for the report of a failure",
    "ring_row": "rows of the ring",
    "pair": "pairs in contact",
    "contact_body": "bodies, in scenes with contact",
    "held_body": "bodies, in scenes with contact or small-sliding contact",
    "contact_mode": "modes, in scenes with contact",
    "contact_retained": "retained unknowns, in scenes with contact",
    "pair_mode": "modes of both bodies of a pair, largest number",
    "coupled": "retained columns on which a gap depends",
    "node": "nodes of the first surface's window",
    "second_node": "nodes of the second surface's window",
    "slot": "active nodes",
    "station": "axial Gauss points of a line of centres",
    "window_point": "Gauss points of a window",
    "column_point": "points of a column of the first grid",
    "point_number": "numbers of the points of a window",
    "held_node": "nodes, in scenes of pairs with gaps at points",
    "stencil": "nodes of the second surface overlapped by one of the first",
    "layer_point": "points of a window at which layers are evaluated",
    "layer_node": "nodes, in scenes with layers of variable compliance",
    "friction_pair": "pairs, in scenes with friction",
    "friction_node": "cells of a window: as many as nodes, in scenes with friction",
    "friction_second_node": "nodes of the second window, in scenes with friction",
    "friction_slot": "active nodes, in scenes with friction",
    "cell": "cells of a pair that may carry friction at once",
    "speed_cell": "cells, in scenes with a coefficient of friction that depends on the slip speed",
    "speed_pair": "pairs, in such scenes",
    "speed_retained": "retained unknowns, in such scenes",
    "square": "squares of the membrane energy of bodies",
    "square_line": "entries of their lines",
    "stiffened_shape": "entries of their modes",
    "mean_mode": "retained modes, if loads stiffen bodies",
    "share": "cells of the second surface overlapped by one of the first",
    "surface_place": "nodes of the larger window",
    "patch_pair": "pairs, in scenes with patches of cells",
    "patch_cell": "cells of a patch: as many as nodes, in scenes with such patches",
    "patch_row": "rows of a patch, largest number",
    "patch_number": "numbers of the place of a patch, see `patch.cells`",
    "far_spline": "splines of a far window",
    "patch_slot": "active cells",
    "matrix_patch": "pairs, if some are patches with a matrix",
    "near_number": "numbers of the near field of a patch",
    "beside_block": "pairs of columns of splines under two patches, largest number",
    "patch_strip_number": "numbers of a product over strips",
    "patch_spectrum_number": "numbers of the blocks by frequency of a patch",
    "beside_patch": "patches, one for each other patch on the same body",
    "between_place": "pairs of rows of two patches",
    "patch_column": "strips of a patch, largest number",
    "patch_place": "positions of the cells of a patch, see `spline_tables`",
    "patch_mode": "modes of both bodies of a pair, in scenes with patches",
    "rolling_pair": "pairs, in scenes with friction on patches of cells",
    "rolling_number": "numbers of the place of a patch, in such scenes",
    "rolling_cell": "cells of a patch, in such scenes",
    "rolling_spline": "splines of a far window, in such scenes",
    "rolling_place": "positions of the cells of a patch, in such scenes",
    "rolling_mode": "modes of both bodies of a pair, in such scenes",
    "ring_cell": "cells of a patch and around it",
    "shear_number": "numbers of the near field along the surface of a patch",
    "strip_pair": "pairs, in scenes whose tractions are solved for by products over strips",
    "strip_retained": "retained unknowns, in such scenes",
    "strip_number": "numbers of such a product",
    "strip_spectrum_number": "numbers of the blocks by frequency of a pair",
    "strip_place_number": "positions of the cells of a patch, in such scenes",
    "block_pair": "pairs, in scenes whose tractions are solved for with blocks of all their cells",
    "block_slot": "active cells or nodes, in such scenes",
    "block_cell": "cells of a pair that may carry friction at once, in such scenes",
    "lumped": "lumped contacts",
    "lumped_place": "points of lumped contacts: one, or one for each lamina",
    "lumped_moment": "such points with rolling or pivoting resistance",
    "film": "oil films",
    "film_node": "nodes of the first surfaces of films",
    "film_function": "functions of the pressures of films",
    "film_unknown": "those with unknown pressure",
    "film_system": "unknowns of films: pressures or cavity fractions, and pressures of asperities",
    "film_point": "points of films",
    "film_heat_node": "nodes of films with a temperature",
    "film_near": "nodes around the points of each function",
    "film_number": "numbers of the linear systems of films",
    "film_column": "retained unknowns coupled to films, film by film",
    "film_square": "pairs of these of a film",
    "film_second_node": "nodes of compliant second surfaces of films",
    "film_seat": "points and nodes located on them",
    "film_press": "points at which films load them",
    "film_place": "places of lines of films in the columns of their grids",
    "film_room": "lines in the columns around each line of films",
    "film_smooth": "smooth functions of the compliance under films, of each as many as the largest number",
    "film_smooth_column": "pairs of these and coupled columns",
    "film_load_number": "pairs of coupled columns and of these and one more",
    "film_station": "stations of films: nodes, or points of profiles",
    "film_moved": "stations of films whose second surface is compliant, each with the smooth functions of that",
    "film_moved_load": "lines of such films, likewise",
    "film_moved_close": "stations of such films, each with the lines in the columns around",
    "film_moved_room": "stations of such films, each with the nodes in the columns around",
    "film_port_number": "three squares of these of each film",
    "matched_group": "groups of small-sliding contacts that are solved together",
    "matched": "small-sliding contacts",
    "matched_cell": "cells of small-sliding contacts",
    "matched_column": "coordinates of the relative motion at small-sliding contacts",
    "matched_line": "lines of the tableaus of small-sliding contacts",
    "matched_number": "numbers of these tableaus",
    "matched_square": "pairs of coordinates of a group of small-sliding contacts",
    "matched_retained": "retained unknowns coupled to small-sliding contacts, group by group",
    "matched_followed": "pairs of these and of coordinates",
    "matched_differing": "lines of cells whose state may differ from that of the tableau",
    "matched_factor_number": "pairs of such lines of a group",
    "matched_update": "pairs of such a line and of a line of its tableau",
    "factor_number": "numbers of the sparse factor",
    "factor_line": "numbers per line of it, of all lanes",
    "friction_factor": "numbers of the sparse factor, in scenes with friction",
    "friction_line": "numbers per line of it, of all lanes",
    "one": "always 1",
    # axes of the model only
    "surface": "contact surfaces",
    "side": "surfaces as pairs load them, two per pair",
    "response": "tables of displacements by loads",
    "far_surface": "far fields of contact surfaces",
    "beside_table": "tables of displacements of patches by others on the same body",
    "between_table": "half-spaces between patches, by surface",
    "marker": "joint frames",
    "signal": "signals",
    "characteristic": "nonlinear forces of springs and dampers",
    "body_load": "loads that are constant in body axes",
    "body_load_mode": "modes of a body, largest number",
    "group_row": "spring rows that share matrices, largest number",
    "film_support": "functions at a point, largest number",
    "film_press_support": "functions that load at a point, largest number",
    "film_entry": "points of each function",
    "film_body": "bodies, in scenes with films",
    "table_interface": "flexible interfaces, at least one",
    "layer_number": "numbers of a law",
    "z_point": "Gauss points along a cell",
    **dict.fromkeys(
        (
            "inertia_entry",
            "membrane_entry",
            "stiffening_entry",
            "signal_entry",
            "held_entry",
            "piece_entry",
            "profile_entry",
            "curve_entry",
            "seed_entry",
            "z_entry",
            "response_entry",
            "trace_entry",
            "shear_entry",
            "load_entry",
            "point_entry",
            "row_of_points_entry",
            "layer_entry",
            "layer_row_entry",
            "layer_point_entry",
            "lumped_entry",
            "lumped_form_entry",
            "lumped_slip_entry",
            "film_compliance_entry",
            "film_shape_entry",
            "film_moment_entry",
            "film_form_entry",
            "film_rough_entry",
            "film_row_entry",
            "film_press_entry",
            "film_second_shape_entry",
            "film_second_entry",
            "film_close_entry",
            "film_smooth_entry",
            "film_smooth_load_entry",
            "film_smooth_square_entry",
            "film_smooth_motion_entry",
            "film_second_smooth_entry",
            "film_second_near_entry",
            "film_second_smooth_motion_entry",
            "film_force_entry",
            "film_table_entry",
            "film_heat_entry",
            "film_factor_entry",
            "matched_compliance_entry",
            "matched_motion_entry",
            "slip_speed_entry",
            "patch_row_entry",
            "patch_end_entry",
            "far_entry",
            "knot_entry",
            "far_mode_entry",
            "beside_entry",
            "near_shear_entry",
            "wave_entry",
            "spectrum_entry",
            "inverse_entry",
            "shear_spectrum_entry",
            "shear_inverse_entry",
            "far_tangent_entry",
            "sheared_entry",
            "turned_entry",
            "beside_number",
            "between_number",
        ),
        "entries of tables that stand one behind the other",
    ),
    # domains of launches, not axes of arrays
    "applied": "forces and torques",
    "row_or_mode": "rows and modes",
    "stiffened_interface": "interfaces of bodies stiffened by their loads",
    "stiffened_row": "rows, if loads stiffen bodies",
    "inertia_mode": "modes that carry inertia",
    "square_mode": "modes that carry inertia, if bodies have membrane energy",
    "free_retained": "retained unknowns, in scenes without contact",
    "projected_row": "rows, if velocities are projected onto them",
    "projected_retained": "retained unknowns, if velocities are projected",
    "layer_slot": "active nodes, in scenes with layers of variable compliance",
    "layer_retained": "retained unknowns there",
    "dense_slot": "active nodes, if pressures are at nodes",
    "matrix_free_slot": "active nodes, if patches have no matrix",
    "krylov_slot": "active nodes, if pairs are coupled by local modes or pressures are on contact-fixed cells",
    "krylov_pair": "pairs there",
    "krylov_retained": "retained unknowns there",
    "friction_retained": "retained unknowns, in scenes with friction",
    "adaptive_world": "worlds, if steps follow an allowed local error",
    "line_pair": "pairs with gaps along the line of centres",
    "point_pair": "pairs with gaps at points",
    "grid_rubbing": "pairs with friction whose cells are those of the first surface's grid",
    "node_pair": "pairs with pressures at nodes of the first grid",
    "patch_beside": "active cells, if several patches are on a body",
    "pair_beside": "pairs, if several load a body and some have pressures at nodes",
}


def sizes_of(
    compiled: CompiledScene, worlds: int, ring_rows: int, pattern: RetainedPattern, *, projected: bool, adaptive: bool
) -> dict[str, int]:
    """Length of each axis in `NAMES`; `pattern`: of the retained matrix."""
    m: Model = compiled.model
    P, B, Q, S, rows, retained = (
        m.pairs.count,
        m.bodies.count,
        m.modes.count,
        m.capacity.slots,
        m.rows.count,
        m.retained.count,
    )
    grid_node, node = m.window.grid_nodes, m.window.nodes
    families = m.pairs.family.numpy()[:P]
    matrices = bool(((families == PATCH) & (m.pairs.matrix.numpy()[:P] > 0)).any())
    rubs = m.pairs.friction.numpy()[:P] > 0.0
    stations = (m.window.rows - 1) * m.quadrature.z_points
    rubbing = bool(m.capacity.cells)
    elements, external = compiled.elements, compiled.external
    layer_point = layer_points(compiled)
    beside, layered = bool(m.pairs.beside), bool(elements.layers.count)
    by_speed = bool(elements.slip_speeds.count)
    patched, rolls = bool(elements.patches.count), bool(elements.rolling.count)
    strips = bool(elements.rolling.strips)
    return {
        "world": worlds, "body": B, "mode": Q, "row": rows, "force": external.forces.count,
        "torque": external.torques.count, "load": external.torques.count + external.body_loads.count,
        "interface": m.interfaces.count,
        "interface_shape": compiled.interface_modes.size, "group": m.groups.count, "dense": m.dense.count,
        "joint_friction": elements.joint_frictions.count, "pretension": elements.pretensions.count,
        "exact_mode": Q if compiled.local.exact else 0, "dynamic_mode": Q if m.modes.dynamic_count else 0,
        "retained": retained, "line": k.LINES, "residual": RESIDUALS_KEPT,
        "ring_row": ring_rows, "pair": P, "contact_body": B if P else 0,
        "held_body": B if P or compiled.matched.count else 0,
        "contact_mode": Q if P else 0, "contact_retained": retained if P else 0, "pair_mode": m.pairs.most_modes,
        "coupled": m.pairs.coupled_capacity, "node": grid_node, "second_node": node, "slot": S, "station": stations,
        "window_point": (m.window.columns + 1) * m.points.most,
        "column_point": m.points.most,
        "point_number": (m.window.columns + 1) * m.points.most * LINE,
        "held_node": grid_node if m.points.most or patched else 0,
        "stencil": m.window.stencil_columns * m.window.stencil_rows, "layer_point": layer_point,
        "layer_node": grid_node if layer_point else 0, "friction_pair": P if rubbing else 0,
        "friction_node": grid_node if rubbing else 0, "friction_second_node": node if rubbing else 0,
        "friction_slot": S if rubbing else 0, "cell": m.capacity.cells,
        "speed_cell": m.capacity.cells if by_speed else 0, "speed_pair": P if by_speed else 0,
        "speed_retained": retained if by_speed else 0,
        "friction_factor": pattern.factor_size if rubbing else 0,
        "friction_line": BLOCK * pattern.widest if rubbing else 0,
        "share": m.window.share_columns * m.window.share_rows,
        "patch_pair": P if patched else 0, "patch_cell": grid_node if patched else 0,
        "patch_beside": S if elements.patches.touching else 0,
        "beside_patch": elements.patches.touching, "beside_block": elements.patches.far_columns_most**2,
        "between_place": m.window.rows**2 if patched else 0,
        "patch_row": m.window.rows if patched else 0, "patch_slot": S if patched else 0,
        "patch_number": 4 + m.window.rows if patched else 0,
        "far_spline": elements.patches.far_nodes if patched else 0,
        "matrix_patch": P if matrices else 0, "near_number": elements.patches.places * m.window.rows if matrices else 0,
        "patch_strip_number": elements.patches.strip_numbers,
        "patch_spectrum_number": elements.patches.spectrum_numbers,
        "patch_column": m.window.columns if patched else 0, "patch_place": elements.patches.places,
        "patch_mode": m.pairs.most_modes if patched else 0,
        "rolling_number": 4 + m.window.rows if rolls else 0,
        "rolling_pair": P if rolls else 0, "rolling_cell": grid_node if rolls else 0,
        "rolling_spline": elements.patches.far_nodes if rolls else 0,
        "rolling_place": elements.patches.places if rolls else 0,
        "rolling_mode": m.pairs.most_modes if rolls else 0, "ring_cell": elements.rolling.ring_cells,
        "shear_number": elements.rolling.shear_numbers,
        "strip_pair": P if strips else 0,
        "strip_retained": retained if strips else 0,
        "strip_number": elements.rolling.strip_numbers, "strip_spectrum_number": elements.rolling.spectrum_numbers,
        "strip_place_number": elements.patches.places if strips else 0,
        "block_pair": P if rubbing and not strips else 0, "block_slot": S if rubbing and not strips else 0,
        "block_cell": m.capacity.cells if rubbing and not strips else 0,
        "surface_place": max(grid_node, node), "lumped": elements.lumped.count, "lumped_place": elements.lumped.places,
        "lumped_moment": elements.moments.count,
        **film_sizes(compiled), **matched_sizes(compiled),
        "factor_number": pattern.factor_size, "factor_line": BLOCK * pattern.widest, "one": 1,
        "applied": external.forces.count + external.torques.count, "row_or_mode": rows + Q,
        "stiffened_interface": m.interfaces.count if compiled.stiffened else 0,
        "inertia_mode": int(m.bodies.inertia_count.numpy().sum()), "free_retained": 0 if P else retained,
        "stiffened_shape": compiled.interface_modes.size if compiled.stiffened else 0,
        "square": m.membrane.count, "square_line": m.membrane.lines,
        "square_mode": m.dense.count if m.membrane.count else 0,
        "mean_mode": m.dense.count if compiled.stiffened or m.membrane.count else 0,
        "stiffened_row": rows if compiled.stiffened else 0,
        "projected_row": rows if projected else 0, "projected_retained": retained if projected else 0,
        "layer_slot": S if layered else 0, "layer_retained": retained if layered else 0,
        "matrix_free_slot": S if m.pairs.matrix_free else 0,
        "krylov_slot": S if beside or patched else 0, "krylov_pair": P if beside or patched else 0,
        "krylov_retained": retained if beside or patched else 0,
        "dense_slot": S if m.pairs.dense else 0,
        "friction_retained": retained if rubbing else 0, "adaptive_world": worlds if adaptive else 0,
        "line_pair": int((families == LINE_OF_CENTRES).sum()), "point_pair": int((families == AT_POINTS).sum()),
        "node_pair": int((families != PATCH).sum()), "grid_rubbing": int(((families != PATCH) & rubs).sum()),
        "pair_beside": P if beside and (families != PATCH).any() else 0,
    }  # fmt: skip


FILM_STARTS = (
    "node", "function", "unknown", "point", "column", "square", "second_node", "moved", "moved_load", "moved_close",
    "moved_room", "station",
)  # fmt: skip


def film_sizes(compiled: CompiledScene) -> dict[str, int]:
    """Axes of oil films."""
    films = compiled.films
    if not films.count:
        more = (
            "", "_near", "_place", "_number", "_system", "_seat", "_press", "_room", "_smooth",
            "_smooth_column", "_port_number", "_load_number", "_heat_node",
        )  # fmt: skip
        return dict.fromkeys((*(f"film{name}" for name in more), *(f"film_{name}" for name in FILM_STARTS)), 0)
    found = {f"film_{name}": int(getattr(films, f"{name}_start").numpy()[-1]) for name in FILM_STARTS}
    found["film_heat_node"] = int(films.heat_start.numpy()[-1])
    for name in ("system", "seat", "press"):
        found[f"film_{name}"] = int(getattr(films, f"{name}_start").numpy()[-1])
    smooth = films.count * films.most_smooth
    return found | {
        "film": films.count, "film_near": films.near.shape[0], "film_place": films.line_at.shape[0],
        "film_number": int(films.matrix_start.numpy()[-1]),
        "film_room": found["film_system"] * films.most_room, "film_smooth": smooth,
        "film_smooth_column": smooth * films.most_columns,
        "film_load_number": films.count * (films.most_smooth + 1) * films.most_columns,
        "film_port_number": 3 * smooth * films.most_smooth,
    }  # fmt: skip


MATCHED_STARTS = {
    "matched": "matched", "cell": "matched_cell", "column": "matched_column", "line": "matched_line",
    "table": "matched_number",
    "square": "matched_square", "retained": "matched_retained", "followed": "matched_followed",
    "differing": "matched_differing", "factor": "matched_factor_number", "update": "matched_update",
}  # fmt: skip


def matched_sizes(compiled: CompiledScene) -> dict[str, int]:
    """Axes of small-sliding contacts."""
    matched = compiled.matched
    found = {axis: 0 for axis in MATCHED_STARTS.values()}
    if matched.count:
        found = {axis: int(getattr(matched, f"{name}_start").numpy()[-1]) for name, axis in MATCHED_STARTS.items()}
    return found | {"matched_group": matched.count}


def layer_points(compiled: CompiledScene) -> int:
    """Points of a pair's window at which the laws of layers are evaluated, maximum over all pairs."""
    layers = compiled.elements.layers
    if not layers.count:
        return 0
    return (compiled.model.window.columns + 1) * int(layers.point_count.numpy().max())
