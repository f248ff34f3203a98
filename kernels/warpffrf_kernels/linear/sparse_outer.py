"""The outer system of a scene without contact, by a sparse factorisation whose pattern and order are known beforehand.

Contact needs the inverse of the outer matrix (`outer`), other scenes only z in [[S, C^T], [C, -E]] z = rhs. Only the
entries that can differ from zero are assembled, in their places of the dense matrix, where `geometric_stiffness` and
`inertia` add theirs. They are factored by blocks, in an order found when the scene was compiled (`sparse_factor`;
`warpffrf.online.compile.outer_pattern` says why no pivot is sought outside a block).

A new factor is trusted only if it solves: |A z - rhs| is measured in the equilibrated system, corrected once where it
exceeds CORRECT_ABOVE of |z| + |rhs|, and where a pivot is too small or the residual stays above REFUSE_ABOVE the dense
inverse is taken until the matrix is renewed, and counted. Step times of both: bench/README.md.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import pulled
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.linear.outer import PIVOT_TOLERANCE, apply_inverse, entry_of_rows, invert
from warpffrf_kernels.linear.sparse_factor import Pattern, factorise, residual_of, solve_factored

wp.set_module_options(MODULE_OPTIONS)

CORRECT_ABOVE = wp.constant(wp.float64(1.0e-13))  # some hundred times round-off: usual with pivots inside blocks
REFUSE_ABOVE = wp.constant(wp.float64(1.0e-10))  # below the tolerance of the Newton iteration, 1e-9
DENSE = wp.constant(0)  # column of `fallback`: 1 while the dense inverse serves
COUNT = wp.constant(1)  # how often it had to


@wp.kernel
def pull(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    residual: changed(wp.array2d(dtype=real)),
    modal_residual: changed(wp.array(dtype=real)),
):
    """Per world, lanes over bodies, then over modes: r += C^T lambda, over the rows of each body."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    b = lane
    while b < model.bodies.count:
        at = p.row_start[b]
        while at < p.row_start[b + 1]:
            row = p.row[at]
            for i in range(6):
                residual[w, 6 * b + i] = residual[w, 6 * b + i] + C[w, row, 6 * b + i] * lam[w, row]
            at += 1
        b += wp.block_dim()
    b = int(0)
    while b < model.bodies.count:  # lanes over the modes of each body, which are contiguous
        at = p.row_start[b]
        first = model.bodies.modal_start[b]
        count = model.bodies.global_count[b]
        while at < p.row_start[b + 1]:
            if p.row_flexible[at] != 0:
                row = p.row[at]
                line = (w * model.rows.count + row) * model.modes.count + first
                axpy(count, lam[w, row], C_modal, line, modal_residual, w * model.modes.count + first)
            at += 1
        b += 1


@wp.kernel
def condense_sparse(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array(dtype=real),
    tangent: out(wp.array3d(dtype=real)),
    rhs: out(wp.array2d(dtype=real)),
):
    """Lanes over outer unknowns: what `outer.condense` does, entries of the pattern only."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    rigid = 6 * model.bodies.count
    i = lane
    while i < model.outer.count:
        row = i - model.outer.row_offset
        if i < rigid:
            rhs[w, i] = -residual[w, i]
        elif row < 0:
            rhs[w, i] = -modal_residual[w * model.modes.count + model.dense.mode[i - rigid]]
        else:
            rhs[w, i] = -defect[w, row] + pulled(model, w, row, C_modal, receptance, modal_residual)
        if ctl[w].refresh != 0:
            at = p.entry_start[i]
            while at < p.entry_start[i + 1]:
                j = p.entry_column[at]
                other = j - model.outer.row_offset
                if row < 0 and other < 0:
                    if i < rigid and j < rigid and i / 6 != j / 6:  # geometric stiffness comes later
                        tangent[w, i, j] = real(0.0)
                elif row < 0 or other < 0:
                    line = wp.max(row, other)
                    column = wp.min(i, j)
                    if column < rigid:
                        tangent[w, i, j] = C[w, line, column]
                    else:
                        mode = model.dense.mode[column - rigid]
                        tangent[w, i, j] = C_modal[(w * model.rows.count + line) * model.modes.count + mode]
                else:
                    entry = entry_of_rows(model, w, row, other, C_modal, receptance, softness, flexibility)
                    tangent[w, i, j] = entry
                at += 1
        i += wp.block_dim()


@wp.kernel
def solve_outer(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    factor: inout(wp.array(dtype=real)),
    vector: inout(wp.array(dtype=real)),
    lines: inout(wp.array(dtype=real)),
    fallback: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    z: inout(wp.array(dtype=real)),
):
    """Per world: a new factor where the matrix is to be renewed, then z; by the dense inverse where that fails."""
    w, lane = wp.tid()
    model = models[0]
    p = patterns[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    N = model.outer.count
    i = lane
    while i < N:
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    renew = ctl[w].refresh
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
                ctl[w].failure = ctl[w].failure | k.SINGULAR
        if lane == 0:
            fallback[w, DENSE] = dense
            fallback[w, COUNT] = fallback[w, COUNT] + dense
    if dense != 0:
        apply_inverse(model, w, lane, 0, rhs, w * N, inverse_transposed, z)
