"""Blocks of the cells that may carry friction, one per pair, and their coupling.

With all other unknowns condensed, weak slips depend on tractions through

    K = D + L M L^T,

D with a block for each pair, and L M L^T from the retained coordinates: L the gradients of the slips with respect to
the columns that their pair is coupled to, M the receptance, the inverse of the retained matrix B (`pressure_response`).
K is never formed, so n pairs cost n times as much as one. A pair's cells are the lines 2 i + d of its own block, with i
the slot and d the direction.
"""

import warp as wp

from warpffrf_kernels.core.friction_scratch import FrictionSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.linear.block_elimination import follow_columns, push_columns

wp.set_module_options(MODULE_OPTIONS)

FRESH = wp.constant(0)  # columns of `cell_block`: first slot of a pair that is not assembled yet
COUNT = wp.constant(1)  # slots in use, in the column where `pair_elimination.add_borders` reads it
FREE = wp.constant(2)  # free coordinates of the present factor


@wp.func
def is_fresh(model: Model, w: int, block: wp.array3d(dtype=int)) -> bool:
    """Whether any pair has slots that are not assembled yet."""
    pair = int(0)
    while pair < model.pairs.count and block[w, pair, FRESH] == block[w, pair, COUNT]:
        pair += 1
    return pair < model.pairs.count


@wp.func
def first_line(model: Model, w: int, pair: int) -> int:
    """First line of a pair's cells, counted over all worlds and pairs."""
    return (w * model.pairs.count + pair) * 2 * model.capacity.cells


@wp.func
def block_of(model: Model, w: int, pair: int) -> int:
    """Start of the block of a pair, lines of 2 model.capacity.cells numbers."""
    return first_line(model, w, pair) * 2 * model.capacity.cells


@wp.func
def borders_of(model: Model, w: int, pair: int) -> int:
    """Start of the lines of a pair over its coupled columns."""
    return first_line(model, w, pair) * model.pairs.coupled_capacity


@wp.func
def square_at(model: Model, w: int, pair: int) -> int:
    """Start of the matrix of a pair over its coupled columns."""
    return (w * model.pairs.count + pair) * model.pairs.coupled_capacity * model.pairs.coupled_capacity


# y += part D x of a block of n lines, lanes over the lines; contiguous runs, as in `dot`.
@wp.func_native("""
    const double* v = x.data + at_x;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const double* a = D.data + at + (size_t)i * stride; double s[8] = {0.0}, sum = 0.0; int j = 0;
        for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) s[c] += a[j + c] * v[j + c];
        for (; j < n; ++j) sum += a[j] * v[j];
        for (int c = 0; c < 8; ++c) sum += s[c];
        y.data[at_x + i] += part * sum;
    }
    WP_TILE_SYNC();
""")
def add_block(
    n: int,
    part: real,
    D: wp.array(dtype=real),
    at: int,
    stride: int,
    x: wp.array(dtype=real),
    at_x: int,
    y: wp.array(dtype=real),
): ...


@wp.func
def move_retained(
    model: Model, w: int, lane: int, tangential: FrictionSolve, L: wp.array(dtype=real), M: wp.array(dtype=real),
    x: wp.array(dtype=real), z: wp.array(dtype=real),
):  # fmt: skip
    """z = M L^T x: the retained increments due to tractions."""
    N = model.retained.count
    i = lane
    while i < N:
        tangential.cell_load[w * N + i] = real(0.0)
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        n = 2 * tangential.cell_block[w, pair, COUNT]
        if n > 0:
            push_columns(
                model, w, pair, n, L, borders_of(model, w, pair), x, first_line(model, w, pair), tangential.cell_load
            )
        pair += 1
    i = int(0)
    while i < N:
        if tangential.cell_load[w * N + i] != real(0.0):
            axpy(N, tangential.cell_load[w * N + i], M, (w * N + i) * N, z, w * N)
        i += 1
    sync()


@wp.func
def add_slips(
    model: Model, w: int, lane: int, part: real, tangential: FrictionSolve, D: wp.array(dtype=real),
    L: wp.array(dtype=real), M: wp.array(dtype=real), x: wp.array(dtype=real), y: wp.array(dtype=real),
):  # fmt: skip
    """y += part K x over the lines of all pairs; returns z = M L^T x in its array."""
    move_retained(model, w, lane, tangential, L, M, x, tangential.cell_moved_retained)
    pair = int(0)
    while pair < model.pairs.count:
        n = 2 * tangential.cell_block[w, pair, COUNT]
        if n > 0:
            at = first_line(model, w, pair)
            add_block(n, part, D, block_of(model, w, pair), 2 * model.capacity.cells, x, at, y)
            follow_columns(
                model, w, pair, n, part, L, borders_of(model, w, pair), tangential.cell_moved_retained, y, at
            )
        pair += 1
