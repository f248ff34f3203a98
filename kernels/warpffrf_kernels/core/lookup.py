"""Search in a table."""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def piece_at(table: wp.array2d(dtype=real), first: int, count: int, column: int, value: real) -> int:
    """Last of `count` lines from `first` on whose entry in `column`, which increases, is at or below `value`, limited
    to the range from the first line to the last but one."""
    i = int(first)
    last = first + count - 2
    while i < last:
        half = (i + last + 1) / 2
        if value >= table[half, column]:
            i = half
        else:
            last = half - 1
    return i
