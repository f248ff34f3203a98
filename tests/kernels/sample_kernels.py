"""Kernels for the check of what kernels read, write and change."""
# pyright: reportInvalidTypeForm=false, reportIndexIssue=false, reportArgumentType=false

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.state import MotionState

real = wp.float64


@wp.func_native("""double* q = y.data + at; q[0] = x.data[1]; z.data[0] += 1.0; const double* p = x.data;""")
def native(x: wp.array(dtype=real), y: wp.array(dtype=real), z: wp.array(dtype=real), at: int): ...


@wp.func
def through(a: wp.array(dtype=real), b: wp.array(dtype=real), c: wp.array(dtype=real)):
    native(a, b, c, 0)


@wp.func
def by_topic(motion: MotionState, w: int) -> real:
    return motion.q[w, 0] + motion.qd[w, 0]


@kernel
def direct(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    y[0] = x[0]


@kernel
def kept(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    y[0] = x[0]
    y[1] = y[0]


@kernel
def idle(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    pass


@kernel
def indirect(x: wp.array(dtype=real), y: wp.array(dtype=real), z: wp.array(dtype=real)):
    through(x, y, z)


@kernel
def atomic(x: wp.array(dtype=real), y: wp.array(dtype=real)):
    wp.atomic_add(y, 0, x[0])


@kernel
def of_topics(state: MotionState):
    w = wp.tid()
    state.qd_rate[w, 0] = by_topic(state, w)
    state.v[w, 0] += state.v_rate[w, 0]
