"""The one place that fixes the precision of the kernels."""

import warp as wp

real = wp.float64
vec3 = wp.vec3d
mat33 = wp.mat33d
quat = wp.quatd

BLOCK = 64  # lanes of a block on a GPU; a CPU block has one lane unless wp.config.enable_cpu_blocks is set

MODULE_OPTIONS = {"enable_backward": False, "fast_math": False}


@wp.func_native("WP_TILE_SYNC();")
def sync(): ...


# y[at : at + n] += a * x[start : start + n], lanes over the entries. The one inner loop of the contact kernels:
# contiguous, so that it vectorises. Measured together with `dot` against the same loops in Warp's Python: the whole
# step 1.55 times faster (2000 sectors, 42 active modes, 32 gap columns).
@wp.func_native("""
    double* __restrict q = y.data + at; const double* __restrict p = x.data + start;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) q[i] += a * p[i];
""")
def axpy(n: int, a: real, x: wp.array(dtype=real), start: int, y: wp.array(dtype=real), at: int): ...


# x[at_x : at_x + n] . y[at_y : at_y + n], by one lane; measured together with `axpy`.
@wp.func_native("""
    const double* a = x.data + at_x; const double* b = y.data + at_y; double s = 0.0, t = 0.0; int i = 0;
    for (; i + 1 < n; i += 2) { s += a[i] * b[i]; t += a[i + 1] * b[i + 1]; }
    if (i < n) s += a[i] * b[i];
    return s + t;
""")
def dot(n: int, x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int) -> real: ...
