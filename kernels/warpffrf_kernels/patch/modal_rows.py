"""Gradients of the weak gaps of cells with respect to the global modes of both bodies: loads of unit pressures on
these, by the splines of the far field (`spline_tables`)."""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.normal.compliance_reuse import OLDER
from warpffrf_kernels.patch.spline_tables import line_of, real_side, trace_at

wp.set_module_options(MODULE_OPTIONS)


# out[at_out:] = sum of f[at:], a number per spline of one side, times the loads of unit pressures at all places on it.
# Strips that load the same columns of splines are treated together. Native for contiguous inner loops along places.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int columns = elements.patches.columns.data[pair], stride = elements.patches.places;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const int* const strip = far_strip.data + 2 * p * model.window.columns;
    const double* const factor = f.data + at;
    const double* const share = far_share.data + p * elements.patches.far_nodes * stride;
    double* const sum = out.data + at_out;
    WP_TILE_SYNC();
    for (int c = 0, end = 1; c < columns; c = end) {
        const int* const here = strip + 2 * c;
        for (end = c + 1; end < columns && strip[2 * end] == here[0] && strip[2 * end + 1] == here[1];) ++end;
        const int high = (here[0] + here[1]) * rows;
        for (int e = c * line + lane; e < end * line; e += lanes) sum[e] = 0.0;
        int k = here[0] * rows;
        for (; k + 3 < high; k += 4) {
            const double f0 = factor[k], f1 = factor[k + 1], f2 = factor[k + 2], f3 = factor[k + 3];
            const double* const x = share + (size_t)k * stride;
            for (int e = c * line + lane; e < end * line; e += lanes)
                sum[e] += f0 * x[e] + f1 * x[stride + e] + f2 * x[2 * stride + e] + f3 * x[3 * stride + e];
        }
        for (; k < high; ++k)
            for (int e = c * line + lane; e < end * line; e += lanes)
                sum[e] += factor[k] * share[(size_t)k * stride + e];
    }
    WP_TILE_SYNC();
""")
def weigh_loads(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    rows: int,
    line: int,
    f: wp.array(dtype=real),
    at: int,
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    out: wp.array(dtype=real),
    at_out: int,
): ...


@wp.func
def first_new(run: Run, w: int, normal: ContactSolve) -> int:
    """First slot whose row is new: all if G is of an earlier attempt, and the retained matrix is not."""
    if normal.lasting[w, OLDER] != 0 and run.ctl[w].refresh != 0 and run.ctl[w].moved != 0:
        return 0
    return run.ctl[w].fresh


@kernel
def load_modes_of_cells(run: Run, geometry: ContactGeometry, normal: ContactSolve, patch: PatchScratch):
    """Per (world, pair of family 2), if there are new rows: loads of unit pressures on the modes of A, then of B."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or first_new(run, w, normal) == run.ctl[w].slots:
        return
    if not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    line = line_of(model.surfaces.rows[model.pairs.first[pair]])
    modes = (w * model.pairs.count + pair) * model.pairs.most_modes
    first_mode = int(0)
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            for n in range(model.surfaces.modal_count[s]):
                weigh_loads(
                    model, elements, w, pair, side, model.surfaces.rows[s], line, patch.far_trace,
                    trace_at(model, elements, w, pair, side) + n * elements.patches.far_nodes, patch.far_strip,
                    patch.far_share, patch.far_gradient, (modes + first_mode + n) * elements.patches.places,
                )  # fmt: skip
        first_mode += model.surfaces.modal_count[model.pairs.first[pair]]


# The line of J of a slot: minus `weight` times the loads of its cell, at place `at`, on the modes.
@wp.func_native("""
    const int modes = model.pairs.most_modes, stride = elements.patches.places;
    const size_t p = (size_t)w * model.pairs.count + pair;
    const double* const gradient = far_gradient.data + p * modes * stride + at;
    double* const j = J.data + ((size_t)w * model.capacity.slots + slot) * modes;
    for (int m = WP_TILE_THREAD_IDX; m < modes; m += WP_TILE_BLOCK_DIM) j[m] = -weight * gradient[(size_t)m * stride];
""")
def lay_line(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    slot: int,
    at: int,
    weight: real,
    far_gradient: wp.array(dtype=real),
    J: wp.array(dtype=real),
): ...


@kernel
def modal_rows_of_cells(run: Run, normal: ContactSolve, patch: PatchScratch, impulses: ImpulsiveContact):
    """Per world, for new slots of patches: the gradient of the weak gap with respect to the modes of A, then of B,
    times the weight of the pair."""
    w, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    slot = first_new(run, w, normal)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            m = normal.slot_node[w, slot, 1]
            lay_line(
                model, model.elements[0], w, pair, slot, m / rows * line_of(rows) + m % rows, impulses.weight[w, pair],
                patch.far_gradient, normal.J,
            )  # fmt: skip
        slot += 1
