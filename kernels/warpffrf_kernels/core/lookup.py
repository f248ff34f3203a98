"""Where a value stands in a table."""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def piece_at(table: wp.array2d(dtype=real), first: int, count: int, column: int, value: real) -> int:
    """Of `count` lines from `first` on, along which `column` rises: the last one at or below `value`, but the first one
    at least and the last but one at most."""
    i = int(first)
    last = first + count - 2
    while i < last:
        half = (i + last + 1) / 2
        if value >= table[half, column]:
            i = half
        else:
            last = half - 1
    return i
