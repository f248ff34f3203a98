"""Sums and maxima over the lanes of a block; every lane gets the result, and all lanes must call.

A block of one lane, that of the CPU, returns its own value. The order of a sum is that of the lanes in pairs, and the
same with many lanes on a GPU and on the CPU (`wp.config.enable_cpu_blocks`, one block at a time).
"""

import warp as wp

from warpffrf_kernels.core.scalars import real

values = wp.types.vector(length=8, dtype=real)  # that are combined together

FOLD = """
#if WP_TILE_BLOCK_DIM > 1
#ifdef __CUDA_ARCH__
    __shared__ double shared[ENTRIES][WP_TILE_BLOCK_DIM];
#else
    static double shared[ENTRIES][WP_TILE_BLOCK_DIM];
#endif
    const int lane = WP_TILE_THREAD_IDX;
    for (int c = 0; c < ENTRIES; ++c) shared[c][lane] = x ENTRY;
    WP_TILE_SYNC();
    for (int half = WP_TILE_BLOCK_DIM / 2; half > 0; half /= 2) {
        if (lane < half) for (int c = 0; c < ENTRIES; ++c) {
            double& own = shared[c][lane]; const double other = shared[c][lane + half];
            own = COMBINED;
        }
        WP_TILE_SYNC();
    }
    for (int c = 0; c < ENTRIES; ++c) x ENTRY = shared[c][0];
    WP_TILE_SYNC();
#endif
    return x;
"""


def folded(entries: int, combined: str) -> str:
    """Source of a reduction of one number or a vector, in place."""
    entry = "" if entries == 1 else "[c]"
    return FOLD.replace("ENTRIES", str(entries)).replace("ENTRY", entry).replace("COMBINED", combined)


LARGER = "own > other || other != other ? own : other"  # drops NaN, as `wp.max`


@wp.func_native(folded(1, "own + other"))
def total(x: real) -> real: ...


@wp.func_native(folded(8, "own + other"))
def totals(x: values) -> values: ...


@wp.func_native(folded(1, LARGER))
def most(x: real) -> real: ...


@wp.func_native(folded(8, LARGER))
def mosts(x: values) -> values: ...


BEFORE = """
    int sum = 0;
#if WP_TILE_BLOCK_DIM > 1
#ifdef __CUDA_ARCH__
    __shared__ int counts[WP_TILE_BLOCK_DIM];
#else
    static int counts[WP_TILE_BLOCK_DIM];
#endif
    counts[WP_TILE_THREAD_IDX] = n;
    WP_TILE_SYNC();
    for (int other = 0; other < WP_TILE_THREAD_IDX; ++other) sum += counts[other];
    WP_TILE_SYNC();
#endif
    return sum;
"""


@wp.func_native(BEFORE)
def before(n: int) -> int:
    """Sum over the lanes before this one: where a lane writes the n entries that it appends to a list, if each lane
    goes through `share` of the items."""
    ...


@wp.func
def share(items: int, lane: int) -> int:
    """First of the consecutive items of a lane; those of the next begin where they end."""
    return items * lane / wp.block_dim()
