"""Precision of the kernels, defined here only."""

import warp as wp

real = wp.float64
vec3 = wp.vec3d
mat33 = wp.mat33d
quat = wp.quatd

BLOCK = 64  # lanes of a block on a GPU; a CPU block has one lane unless wp.config.enable_cpu_blocks is set

MODULE_OPTIONS = {"enable_backward": False, "fast_math": False}


@wp.func_native("WP_TILE_SYNC();")
def sync(): ...


# y[at : at + n] += a * x[start : start + n], lanes over the entries. The only inner loop of the contact kernels:
# contiguous, so that it vectorises. Measured together with `dot` against the same loops in Warp's Python: the whole
# step is 1.55 times faster (2000 sectors, 42 active modes, 32 gap columns).
@wp.func_native("""
    double* __restrict q = y.data + at; const double* __restrict p = x.data + start;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) q[i] += a * p[i];
""")
def axpy(n: int, a: real, x: wp.array(dtype=real), start: int, y: wp.array(dtype=real), at: int): ...


# x[at_x : at_x + n] . y[at_y : at_y + n], by one lane. A compiler may not reorder a sum: sixteen partial sums keep four
# vector units busy, two suffice for short sums. Compared with two only: 231 and 50 ns at n = 1000, 8.9 and 6.5 ns at n
# = 50.
@wp.func_native("""
    const double* a = x.data + at_x; const double* b = y.data + at_y; double even = 0.0, odd = 0.0; int i = 0;
    if (n >= 16) {
        double s[16] = {0.0};
        for (; i + 15 < n; i += 16) for (int c = 0; c < 16; ++c) s[c] += a[i + c] * b[i + c];
        for (int c = 0; c < 16; ++c) even += s[c];
    }
    for (; i + 1 < n; i += 2) { even += a[i] * b[i]; odd += a[i + 1] * b[i + 1]; }
    if (i < n) even += a[i] * b[i];
    return even + odd;
""")
def dot(n: int, x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int) -> real: ...


# sum_i x_i weight_i y_i of n entries, by one lane, as in `dot`.
@wp.func_native("""
    const double* a = x.data + at_x; const double* b = y.data + at_y; const double* p = weight.data + at_weight;
    double even = 0.0, odd = 0.0; int i = 0;
    if (n >= 16) {
        double s[16] = {0.0};
        for (; i + 15 < n; i += 16) for (int c = 0; c < 16; ++c) s[c] += a[i + c] * p[i + c] * b[i + c];
        for (int c = 0; c < 16; ++c) even += s[c];
    }
    for (; i + 1 < n; i += 2) { even += a[i] * p[i] * b[i]; odd += a[i + 1] * p[i + 1] * b[i + 1]; }
    if (i < n) even += a[i] * p[i] * b[i];
    return even + odd;
""")
def weighted(
    n: int,
    x: wp.array(dtype=real),
    at_x: int,
    weight: wp.array(dtype=real),
    at_weight: int,
    y: wp.array(dtype=real),
    at_y: int,
) -> real: ...
