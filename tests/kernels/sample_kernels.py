"""Kernels whose signatures are right, and some whose signatures are not, for the check of signatures."""
# pyright: reportInvalidTypeForm=false

import warp as wp

from warpffrf_kernels.core.access import inout, out

real = wp.float64


@wp.func_native("""double* q = y.data + at; q[0] = x.data[1]; z.data[0] += 1.0; const double* p = x.data;""")
def native(x: wp.array(dtype=real), y: wp.array(dtype=real), z: wp.array(dtype=real), at: int): ...


@wp.func
def through(a: wp.array(dtype=real), b: wp.array(dtype=real), c: wp.array(dtype=real)):
    native(a, b, c, 0)


@wp.kernel
def right(x: wp.array(dtype=real), y: out(wp.array(dtype=real))):
    y[0] = x[0]


@wp.kernel
def unmarked(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    y[0] = x[0]


@wp.kernel
def not_read(x: wp.array(dtype=real), y: inout(wp.array(dtype=real))):
    y[0] = x[0]


@wp.kernel
def early(y: inout(wp.array(dtype=real)), x: wp.array(dtype=real)):
    y[0] += x[0]


@wp.kernel
def indirect(x: wp.array(dtype=real), y: out(wp.array(dtype=real)), z: inout(wp.array(dtype=real))):
    through(x, y, z)


@wp.kernel
def atomic(x: wp.array(dtype=real), y: inout(wp.array(dtype=real))):
    wp.atomic_add(y, 0, x[0])
