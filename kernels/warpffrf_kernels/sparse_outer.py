"""The outer system of a scene without contact, by a sparse factorisation whose pattern and order are known beforehand.

Contact needs the inverse of the outer matrix (`outer`), other scenes only z in [[S, C^T], [C, -E]] z = rhs. Only the
entries that can differ from zero are assembled, in their places of the dense matrix, where `stiffen` and `inertia` add
theirs. They are factored by blocks, in an order found when the scene was compiled (`sparse_factor`;
`warpffrf.online.outer_pattern` says why no pivot is sought outside a block).

A new factor is trusted only if it solves: |A z - rhs| is measured in the equilibrated system, corrected once where it
exceeds CORRECT_ABOVE of |z| + |rhs|, and where a pivot is too small or the residual stays above REFUSE_ABOVE the dense
inverse is taken until the matrix is renewed, and counted. Step times of both: bench/README.md.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.outer import PIVOT_TOLERANCE, invert
from warpffrf_kernels.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.sparse_factor import Pattern, factorise, residual_of, solve_factored

wp.set_module_options(MODULE_OPTIONS)

CORRECT_ABOVE = wp.constant(wp.float64(1.0e-13))  # some hundred times round-off: usual with pivots inside blocks
REFUSE_ABOVE = wp.constant(wp.float64(1.0e-10))  # below the tolerance of the Newton iteration, 1e-9
DENSE = wp.constant(0)  # column of `fallback`: 1 while the dense inverse serves
COUNT = wp.constant(1)  # how often it had to


@wp.kernel
def pull(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array2d(dtype=int),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array(dtype=real),
):
    """Per world, lanes over bodies, then over modes: r += C^T lambda, over the rows of each body."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    b = lane
    while b < model.body_count:
        at = p.row_start[b]
        while at < p.row_start[b + 1]:
            row = p.row[at]
            for i in range(6):
                residual[w, 6 * b + i] = residual[w, 6 * b + i] + C[w, row, 6 * b + i] * lam[w, row]
            at += 1
        b += wp.block_dim()
    b = int(0)
    while b < model.body_count:  # lanes over the modes of each body, which are contiguous
        at = p.row_start[b]
        first = model.modal_start[b]
        count = model.modal_start[b + 1] - first
        while at < p.row_start[b + 1]:
            if p.row_flexible[at] != 0:
                row = p.row[at]
                line = (w * model.row_count + row) * model.modal_count + first
                axpy(count, lam[w, row], C_modal, line, modal_residual, w * model.modal_count + first)
            at += 1
        b += 1


# sum_n x_n r_n y_n of one lane, contiguous.
@wp.func_native("""
    const double* a = x.data + at_x; const double* b = x.data + at_y; const double* s = weight.data + at_weight;
    double even = 0.0, odd = 0.0; int i = 0;
    for (; i + 1 < n; i += 2) { even += a[i] * s[i] * b[i]; odd += a[i + 1] * s[i + 1] * b[i + 1]; }
    if (i < n) even += a[i] * s[i] * b[i];
    return even + odd;
""")
def weighted(
    n: int, x: wp.array(dtype=real), at_x: int, at_y: int, weight: wp.array(dtype=real), at_weight: int
) -> real: ...


@wp.func
def compliance(
    model: Model,
    p: Pattern,
    w: int,
    row: int,
    other: int,
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
) -> real:
    """C_m sigma^-1 C_m^T of two rows, over the modes of the bodies that both end on."""
    total = real(0.0)
    for side in range(2):
        marker = model.row_a[row]
        if side == 1:
            marker = model.row_b[row]
        b = model.marker_body[marker]
        if b >= 0 and model.marker_interface[marker] >= 0:
            a_other = model.row_a[other]
            b_other = model.row_b[other]
            shared = int(0)
            if model.marker_body[a_other] == b and model.marker_interface[a_other] >= 0:
                shared = 1
            if model.marker_body[b_other] == b and model.marker_interface[b_other] >= 0:
                shared = 1
            if shared != 0:
                first = model.modal_start[b]
                count = model.modal_start[b + 1] - first
                line = (w * model.row_count + row) * model.modal_count + first
                line_other = (w * model.row_count + other) * model.modal_count + first
                total += weighted(count, C_modal, line, line_other, receptance, w * model.modal_count + first)
    return total


@wp.kernel
def condense_sparse(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array2d(dtype=int),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array(dtype=real),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
):
    """Lanes over outer unknowns: what `outer.condense` does, entries of the pattern only."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    rigid = 6 * model.body_count
    i = lane
    while i < model.outer_count:
        row = i - model.row_offset
        if i < rigid:
            rhs[w, i] = -residual[w, i]
        elif row < 0:
            rhs[w, i] = -modal_residual[w * model.modal_count + model.dense_mode[i - rigid]]
        else:
            value = -defect[w, row]
            for side in range(2):
                marker = model.row_a[row]
                if side == 1:
                    marker = model.row_b[row]
                b = model.marker_body[marker]
                if b >= 0 and model.marker_interface[marker] >= 0:
                    first = model.modal_start[b]
                    count = model.modal_start[b + 1] - first
                    line = (w * model.row_count + row) * model.modal_count + first
                    n = int(0)
                    while n < count:
                        m = w * model.modal_count + first + n
                        value += C_modal[line + n] * receptance[m] * modal_residual[m]
                        n += 1
            rhs[w, i] = value
        if ctl[w, k.REFRESH] != 0:
            at = p.entry_start[i]
            while at < p.entry_start[i + 1]:
                j = p.entry_column[at]
                other = j - model.row_offset
                if row < 0 and other < 0:
                    if i < rigid and j < rigid and i / 6 != j / 6:  # geometric stiffness comes later
                        tangent[w, i, j] = real(0.0)
                elif row < 0 or other < 0:
                    line = wp.max(row, other)
                    column = wp.min(i, j)
                    if column < rigid:
                        tangent[w, i, j] = C[w, line, column]
                    else:
                        mode = model.dense_mode[column - rigid]
                        tangent[w, i, j] = C_modal[(w * model.row_count + line) * model.modal_count + mode]
                else:
                    total = -compliance(model, p, w, row, other, C_modal, receptance)
                    group = model.row_group[row]
                    if group >= 0 and group == model.row_group[other]:
                        begin = model.group_start[group]
                        entry = 6 * (row - begin) + other - begin
                        total -= flexibility[(w * model.group_count + group) * 36 + entry]
                    elif other == row:
                        total -= softness[w, row]
                    tangent[w, i, j] = total
                at += 1
        i += wp.block_dim()


@wp.kernel
def solve_outer(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array(dtype=real),
    ctl: wp.array2d(dtype=int),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    factor: wp.array(dtype=real),
    vector: wp.array(dtype=real),
    lines: wp.array(dtype=real),
    fallback: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    z: wp.array(dtype=real),
):
    """Per world: a new factor where the matrix is to be renewed, then z; by the dense inverse where that fails."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    N = model.outer_count
    i = lane
    while i < N:
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    renew = ctl[w, k.REFRESH]
    dense = fallback[w, DENSE]
    if renew != 0:
        dense = factorise(model, p, w, wp.block_dim(), PIVOT_TOLERANCE, tangent, scaling, pivots, factor, lines)
    if dense == 0:
        solve_factored(p, w, factor, scaling, pivots, rhs, w * N, vector, z)
        if renew != 0:
            off = residual_of(p, w, tangent, scaling, rhs, z, vector)
            if off > CORRECT_ABOVE:
                solve_factored(p, w, factor, scaling, pivots, vector, (2 * w + 1) * N, vector, z)
                off = residual_of(p, w, tangent, scaling, rhs, z, vector)
            if not (off <= REFUSE_ABOVE):
                dense = 1
    sync()
    if renew != 0:
        if dense != 0:
            bad = invert(model, w, PIVOT_TOLERANCE, tangent, scaling, pivots, work, inverse_transposed)
            if bad != 0 and lane == 0:
                ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.SINGULAR
        if lane == 0:
            fallback[w, DENSE] = dense
            fallback[w, COUNT] = fallback[w, COUNT] + dense
    if dense != 0:
        i = lane
        while i < N:
            z[w * N + i] = real(0.0)
            i += wp.block_dim()
        sync()
        j = int(0)
        while j < N:
            axpy(N, rhs[w * N + j], inverse_transposed, (w * N + j) * N, z, w * N)
            j += 1
