"""Scratch arrays of contact pairs and lumped contacts, by topic."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic
from warpffrf_kernels.core.scratch import FORCE


@topic
class ContactGeometry:
    """Windows, gaps at points and weak gaps."""

    pair_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE)
    phase: DeviceArray = reals("world", "pair", 12, unit="columns", note="on both grids: in use, new")
    center: DeviceArray = integers("world", "pair", 3, note="centre columns and B's row")
    nearest: DeviceArray = reals("world", "pair", 2, note="column, and z [m] of the nearest place", zero_without=True)
    touched: DeviceArray = integers("world", "pair", 2, zero_without=True)
    station: DeviceArray = reals("world", "pair", "station", 11, note="line of centres")
    station_wrench: DeviceArray = reals("world", "pair", "station", 6, zero_without=True)
    window: DeviceArray = integers("world", "pair", 2)
    second_window: DeviceArray = integers("world", "pair", 2)
    point_gap: DeviceArray = reals("world", "pair", "window_point", unit="m")
    point_place: DeviceArray = reals("world", "pair", "window_point", 2, note="column and row on B")
    point_line: DeviceArray = reals("world", "pair", "point_number", note="see `at_points`")
    held_ball: DeviceArray = matrices("world", "pair")
    weak_gap: DeviceArray = reals("world", "pair", "node", unit="m")
    shifted_gap: DeviceArray = reals("world", "pair", "node", unit="m")
    area: DeviceArray = reals("world", "pair", "node", unit="m2")
    wrench: DeviceArray = reals("world", "pair", "node", 6, note="per unit pressure")
    more_wrench: DeviceArray = reals(
        "world", "pair", "held_node", 6, note="what the true one has beside", zero_without=True
    )
    stencil: DeviceArray = reals("world", "pair", "node", "stencil", unit="m2", zero_without=True)
    stencil_at: DeviceArray = integers("world", "pair", "node", 2, note="column and row on B", zero_without=True)


@topic
class PatchScratch:
    """Contact-fixed cells, see the kernels of `patch`."""

    patch_place: DeviceArray = reals(
        "world", "patch_pair", "patch_number", note="column and z [m] of A, W [m], column of B; column of A by rows"
    )
    patch_buffer: DeviceArray = reals("world", "patch_pair", "patch_cell", unit="Pa")
    patch_made: DeviceArray = reals(
        "world", "patch_pair", 3, note="W, tangent of the step and weight for which rows of G were made", carried=True
    )
    patch_steady: DeviceArray = integers(
        "world", "patch_pair", note="1: the next one does not undo the one before it", carried=True
    )
    patch_change: DeviceArray = reals(
        "world", "patch_pair", "patch_cell", unit="Pa", note="of pressures in the last accepted step", carried=True
    )
    patch_ball: DeviceArray = matrices("world", "patch_pair")
    patch_laid: DeviceArray = reals("world", "patch_pair", unit="m", note="W of the next", carried=True)
    patch_spectrum: DeviceArray = reals(
        "world", "patch_pair", "patch_spectrum_number", unit="m3/Pa", carried=True, flat=True
    )
    patch_ends: DeviceArray = reals("world", "patch_pair", unit="m3/Pa", note="by distant ends, per row lengths")
    patch_work: DeviceArray = reals("world", "patch_pair", "patch_strip_number", note="of a product", flat=True)
    far_at: DeviceArray = integers("world", "patch_pair", "2*patch_cell", 2, note="first column and row of splines")
    far_weight: DeviceArray = reals("world", "patch_pair", "2*patch_cell", 9, unit="m2")
    far_window: DeviceArray = integers("world", "patch_pair", 2, 2, note="first column and columns, by side")
    far_load: DeviceArray = reals("world", "patch_pair", "2*far_spline", unit="N", flat=True)
    far_field: DeviceArray = reals("world", "patch_pair", "2*far_spline", unit="m", flat=True)
    far_modes: DeviceArray = reals("world", "patch_pair", "2*far_spline", unit="m", flat=True)
    patch_near: DeviceArray = reals("world", "matrix_patch", "near_number", unit="m3/Pa", note="by distance and rows")
    far_soft: DeviceArray = reals("world", "matrix_patch", "2*far_spline", unit="m/N", note="a line", run=True)
    far_answer: DeviceArray = reals("world", "matrix_patch", "2*far_spline", "patch_place", unit="m/Pa", run=True)
    far_line: DeviceArray = reals("world", "patch_place", unit="m/Pa", note="a row of G")
    slot_reach: DeviceArray = integers("world", "patch_slot", note="last place of its pair, of the slots so far")
    far_gradient: DeviceArray = reals(
        "world", "patch_pair", "patch_mode", "patch_place", note="loads of unit pressures on modes", run=True
    )
    far_strip: DeviceArray = integers("world", "patch_pair", "2*patch_column", 2, note="columns of splines of a strip")
    far_share: DeviceArray = reals("world", "patch_pair", "2*far_spline", "patch_place", unit="m2", run=True)
    far_laid: DeviceArray = integers("world", "patch_pair", 2, 2, note="the window of the next two", carried=True)
    far_table: DeviceArray = reals(
        "world", "patch_pair", "2*far_spline", "far_spline", unit="m/N", run=True, carried=True
    )
    far_trace: DeviceArray = reals("world", "patch_pair", "patch_mode", "far_spline", run=True, carried=True)
    patch_pressure: DeviceArray = reals("world", "patch_pair", "patch_place", unit="Pa", flat=True)
    patch_shift: DeviceArray = reals("world", "patch_pair", "patch_place", unit="m3", note="by half-spaces", flat=True)
    patch_between: DeviceArray = reals("world", "beside_patch", "between_place", unit="m3/Pa", note="over both strips")
    beside_at: DeviceArray = integers(
        "world", "beside_patch", "beside_block", note="start of a block between columns of splines"
    )
    solve_pressure: DeviceArray = reals("world", "patch_pair", "patch_place", unit="Pa", note="changes", flat=True)
    solve_load: DeviceArray = reals("world", "patch_pair", "2*far_spline", unit="N", note="by these", flat=True)
    solve_field: DeviceArray = reals("world", "patch_pair", "2*far_spline", unit="m", flat=True)
    solve_place: DeviceArray = reals("world", "patch_pair", "patch_place", unit="m3", flat=True)
    solve_opening: DeviceArray = reals("world", "patch_pair", "patch_place", unit="m3", note="by modes", flat=True)
    solve_shift: DeviceArray = reals("world", "patch_pair", "patch_cell", unit="m3", flat=True)


@topic
class RollingScratch:
    """Friction on contact-fixed cells, see the kernels of `rolling`; [A, B] are the sides, [1, 2] the directions of
    each."""

    traction_change: DeviceArray = reals(
        "world", "rolling_pair", "2*rolling_cell", unit="Pa", note="as patch_change", carried=True
    )
    traction_steady: DeviceArray = integers("world", "rolling_pair", note="as patch_steady", carried=True)
    shear_laid: DeviceArray = reals("world", "rolling_pair", 1, unit="m", note="W of the next", carried=True)
    shear_near: DeviceArray = reals("world", "rolling_pair", "shear_number", unit="m3/Pa", carried=True, flat=True)
    place_traction: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_place", unit="Pa", note="on A, on B, by place", run=True
    )
    place_change: DeviceArray = reals(
        "world", "rolling_pair", "rolling_place", unit="Pa", note="of pressures, by place", run=True
    )
    place_none: DeviceArray = reals("world", "rolling_pair", "4*rolling_place", unit="Pa", note="zeros", run=True)
    rub_laid: DeviceArray = integers("world", "rolling_pair", 2, 2, note="the window of the next two", carried=True)
    rub_table: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_spline", "3*rolling_spline", unit="m/N",
        note="by a force along: displacement along, outward", run=True, carried=True,
    )  # fmt: skip
    rub_trace: DeviceArray = reals("world", "rolling_pair", "rolling_mode", "2*rolling_spline", run=True, carried=True)
    rub_load: DeviceArray = reals("world", "rolling_pair", "4*rolling_spline", unit="N", run=True)
    press_load: DeviceArray = reals("world", "rolling_pair", "2*rolling_spline", unit="N", note="of changes", run=True)
    rub_field: DeviceArray = reals("world", "rolling_pair", "4*rolling_spline", unit="m", note="local modes", run=True)
    rub_modes: DeviceArray = reals("world", "rolling_pair", "4*rolling_spline", unit="m", note="global modes", run=True)
    rub_push: DeviceArray = reals("world", "rolling_pair", "2*rolling_spline", unit="m", note="outward", run=True)
    grown: DeviceArray = reals("world", "rolling_pair", "2*rolling_spline", note="outward over the radius", run=True)
    gap_change: DeviceArray = reals("world", "rolling_pair", "rolling_cell", unit="m3", note="by a round", run=True)
    near_shift: DeviceArray = reals(
        "world", "rolling_pair", "2*rolling_cell", unit="m3", note="by the half-spaces", run=True
    )
    weak_shift: DeviceArray = reals("world", "rolling_pair", "4*rolling_cell", unit="m3", note="A, B", run=True)
    weak_modes: DeviceArray = reals("world", "rolling_pair", "4*rolling_cell", unit="m3", note="A, B", run=True)
    weak_grown: DeviceArray = reals(
        "world", "rolling_pair", "rolling_cell", unit="m2", note="growth, A less B", run=True
    )
    rub_line: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_spline", note="of a cell's two directions", run=True
    )
    rub_soft: DeviceArray = reals(
        "world", "rolling_pair", "4*rolling_spline", "2*rolling_spline", unit="m/N", note="S_tt and modes", run=True
    )


@topic
class ContactFields:
    """Displacements that open gaps, and loads on the grids of the second surfaces."""

    gap: DeviceArray = reals("world", "pair", "node", unit="m")
    opened: DeviceArray = reals("world", "pair", "node", unit="m", note="the gap without the pressures")
    base: DeviceArray = reals("world", "pair", "node", unit="Pa", note="pressures of the evaluation")
    first_field: DeviceArray = reals("world", "pair", "node", unit="m", note="by the modes of A")
    second_field: DeviceArray = reals(
        "world", "pair", "second_node", unit="m", note="by those of B", run=True, zero_without=True
    )
    first_step: DeviceArray = reals("world", "pair", "node", unit="m", note="the same, of increments")
    second_step: DeviceArray = reals("world", "pair", "second_node", unit="m", run=True, zero_without=True)
    first_local: DeviceArray = reals("world", "pair", "node", unit="m", note="by the local modes of A", run=True)
    second_local: DeviceArray = reals(
        "world", "pair", "second_node", unit="m", note="by those of B", run=True, zero_without=True
    )
    second_load: DeviceArray = reals("world", "pair", "second_node", unit="N", zero_without=True, flat=True)
    second_wrench: DeviceArray = reals("world", "pair", 6, unit=FORCE)
    proposed: DeviceArray = integers("world", "pair", "node", note="active set after a solve")


@topic
class ContactSolve:
    """The system of the active nodes."""

    lasting: DeviceArray = integers("world", 6, note="see `normal.compliance_reuse`", carried=True)
    slot_of: DeviceArray = integers("world", "pair", "node", carried=True)
    slot_node: DeviceArray = integers("world", "slot", 2, note="pair, node or cell", zero_without=True, carried=True)
    T: DeviceArray = reals("world", "dense_slot", "second_node", note="response of the second surface", run=True)
    J: DeviceArray = reals(
        "world", "slot", "pair_mode", note="d(gap)/d(modes)", run=True, zero_without=True, carried=True
    )
    G: DeviceArray = reals(
        "world", "dense_slot", "dense_slot", unit="m/Pa", note="gaps by pressures, of pairs with a matrix", carried=True
    )
    L: DeviceArray = reals("world", "slot", "coupled", note="d(gap)/d(retained)")
    soft: DeviceArray = reals("world", "layer_slot", "layer_slot", note="G with the yield of layers", instead="G")
    scaled_modes: DeviceArray = reals("world", "pair_mode", run=True)
    field_beside: DeviceArray = reals("world", "surface_place", run=True)
    right: DeviceArray = reals("world", "slot", unit="m", flat=True)
    order: DeviceArray = integers(
        "world", "slot", note="slots under pressure, pair by pair, then those that left", carried=True
    )
    block: DeviceArray = integers(
        "world", "pair", 4, note="where a pair's begin and how many; of those that left", carried=True
    )
    row_scale: DeviceArray = reals("world", "pair", note="W of a patch where its rows were made over W; 1 of others")
    slot_place: DeviceArray = integers("world", "patch_slot", note="of cells, in their order")
    slot_yield: DeviceArray = reals("world", "patch_slot", unit="m3/Pa", note="of nonlinear layers")
    slot_scale: DeviceArray = reals("world", "patch_slot", note="see `patch.preconditioner`")
    uniform: DeviceArray = reals(
        "world", 2, "matrix_free_slot", note="z and y of `patch.preconditioner`", carried=True, flat=True
    )
    kept: DeviceArray = integers("world", note="what of the next four is that of the solve before")
    factor: DeviceArray = reals(
        "world", "dense_slot", "dense_slot", note="U of each pair's block of G", carried=True, flat=True
    )
    borders: DeviceArray = reals("world", "slot", "coupled", note="L in their order", flat=True)
    W: DeviceArray = reals("world", "slot", "coupled", note="U^-T L of nodes, Z of cells, in their order", flat=True)
    square: DeviceArray = reals("world", "pair", "coupled", "coupled", note="W^T W, L^T Z", flat=True)
    bordered: DeviceArray = reals(
        "world", "contact_retained", "contact_retained", note="retained matrix with the pressures"
    )
    bordered_rhs: DeviceArray = reals("world", "contact_retained")
    solution: DeviceArray = reals("world", "slot", unit="Pa", flat=True)
    krylov: DeviceArray = reals("world", 7, "krylov_slot", note="see `pressure_solve`", run=True)
    krylov_least: DeviceArray = reals("world", "krylov_pair", unit="m2", note="square of the residual to reach")
    krylov_rhs: DeviceArray = reals("world", "krylov_retained", run=True)
    krylov_z: DeviceArray = reals("world", "krylov_retained", run=True)
    mode_load: DeviceArray = reals("world", 2, "contact_mode", note="by pressures of cells, of nodes", flat=True)
    pair_line: DeviceArray = reals("world", "pair", "pair_mode", note="of a pair's modes", flat=True)


@topic
class LayerScratch:
    """Layers whose compliance is not constant, see `weak_layer`."""

    layer_past: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_past_drag: DeviceArray = reals("world", "pair", "layer_point", unit="Pa")
    layer_at: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_flexibility: DeviceArray = reals("world", "pair", "layer_point", unit="m/Pa")
    layer_beginning: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_now: DeviceArray = reals("world", "pair", "layer_point", unit="m")
    layer_drag_now: DeviceArray = reals("world", "pair", "layer_point", unit="Pa")
    layer_support: DeviceArray = reals("world", "pair", "layer_node")
    layer_offset: DeviceArray = reals("world", "pair", "layer_node", unit="m")
    layer_tangent: DeviceArray = reals("world", "pair", "layer_node", 9, unit="m/Pa")
    layer_rhs: DeviceArray = reals("world", "layer_retained", run=True)
    layer_moved: DeviceArray = reals("world", "layer_retained", note="retained increments by pressures", run=True)


@topic
class LumpedContacts:
    """Contact points of lumped contacts, see `lumped.forces`."""

    lumped_taken: DeviceArray = reals(
        "world", "lumped_place", 4, unit="J", note="damped, rubbed, given by the step; of a bounce", zero_without=True
    )
