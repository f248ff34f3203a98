"""Kernels that reach outside of their arrays, each in another way, for the check of indices."""
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportAssignmentType=false

import warp as wp

real = wp.float64


@wp.func_native("""double* p = x.data + at; p[1] = 1.0;""")
def shift(x: wp.array(dtype=real), at: int): ...


@wp.struct
class Held:
    x: wp.array(dtype=real)


@wp.func_native("""const double *p = held.x.data, *q = p + at; y.data[0] = q[0];""")
def take(held: Held, y: wp.array(dtype=real), at: int): ...


@wp.kernel
def count_lanes(x: wp.array(dtype=real), at: int):
    i, lane = wp.tid()
    wp.atomic_add(x, 0, real(1.0))


@wp.kernel
def write(x: wp.array(dtype=real), at: int):
    x[at] = real(1.0)


@wp.kernel
def write_line(x: wp.array2d(dtype=real), at: int):
    x[0, at] = real(1.0)


@wp.kernel
def add(x: wp.array(dtype=real), at: int):
    wp.atomic_add(x, at, real(1.0))


@wp.kernel
def write_natively(x: wp.array(dtype=real), at: int):
    shift(x, at - 1)


@wp.kernel
def read_natively(helds: wp.array(dtype=Held), x: wp.array(dtype=real), at: int):
    take(helds[0], x, at)
