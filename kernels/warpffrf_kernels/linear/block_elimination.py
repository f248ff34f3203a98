"""Elimination of symmetric blocks that are coupled to the rest of a system through few of its columns.

For a block with the matrix G, positive definite, and the rows L of the columns that it is coupled to,

    U^T U = G,      W = U^-T L,      G x + L z = b   <=>   x = U^-1 (U^-T b - W z),

so that the rest of the system requires only W^T W and W^T U^-T b. Blocks lie in the lines and columns of larger arrays:
`at` is the start of one, `stride` the length of a line. Native for contiguous inner loops like `axpy`.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# U in place of the upper triangle of G, n lines. Returns 1 if G is not definite.
@wp.func_native("""
    const int L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    double* U = a.data + at;
    int bad = 0;
    for (int p = 0; p < n; p += 8) {
        const int kb = n - p < 8 ? n - p : 8;
        for (int q = 0; q < kb; ++q) {
            double* u = U + (size_t)(p + q) * stride;
            double pivot = u[p + q];
            WP_TILE_SYNC();
            if (!(pivot > 0.0)) { bad = 1; pivot = 1.0; }
            const double root = ::sqrt(pivot), scale = 1.0 / root;
            for (int j = p + q + L; j < n; j += NL) u[j] = j == p + q ? root : u[j] * scale;
            WP_TILE_SYNC();
            for (int r = q + 1; r < kb; ++r) { double* x = U + (size_t)(p + r) * stride; const double m = u[p + r];
                for (int j = p + r + L; j < n; j += NL) x[j] -= m * u[j]; }
            WP_TILE_SYNC();
        }
        if (kb == 8) {
            const double *u0 = U + (size_t)p * stride, *u1 = u0 + stride, *u2 = u1 + stride, *u3 = u2 + stride;
            const double *u4 = u3 + stride, *u5 = u4 + stride, *u6 = u5 + stride, *u7 = u6 + stride;
            for (int i = p + 8; i < n; ++i) { double* __restrict x = U + (size_t)i * stride;
                const double m0 = u0[i], m1 = u1[i], m2 = u2[i], m3 = u3[i];
                const double m4 = u4[i], m5 = u5[i], m6 = u6[i], m7 = u7[i];
                for (int j = i + L; j < n; j += NL)
                    x[j] -= ((m0 * u0[j] + m1 * u1[j]) + (m2 * u2[j] + m3 * u3[j]))
                        + ((m4 * u4[j] + m5 * u5[j]) + (m6 * u6[j] + m7 * u7[j])); }
        }
        WP_TILE_SYNC();
    }
    return bad;
""")
def factor(a: wp.array(dtype=real), at: int, stride: int, n: int) -> int: ...


# X <- U^-T X, n lines of `count` columns. Lanes over the columns.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* U = a.data + at;
    double* X = x.data + at_x;
    for (int i = 0; i < n; ++i) {
        double* __restrict y = X + (size_t)i * stride_x; int j = 0;
        for (; j + 3 < i; j += 4) {
            const double m0 = U[(size_t)j * stride + i], m1 = U[(size_t)(j + 1) * stride + i];
            const double m2 = U[(size_t)(j + 2) * stride + i], m3 = U[(size_t)(j + 3) * stride + i];
            const double *b = X + (size_t)j * stride_x, *c = b + stride_x, *d = c + stride_x, *e = d + stride_x;
            for (int q = lane; q < count; q += lanes) y[q] -= m0 * b[q] + m1 * c[q] + m2 * d[q] + m3 * e[q];
        }
        for (; j < i; ++j) { const double m = U[(size_t)j * stride + i]; const double* b = X + (size_t)j * stride_x;
            for (int q = lane; q < count; q += lanes) y[q] -= m * b[q]; }
        const double scale = 1.0 / U[(size_t)i * stride + i];
        for (int q = lane; q < count; q += lanes) y[q] *= scale;
    }
    WP_TILE_SYNC();
""")
def forward_lines(
    a: wp.array(dtype=real), at: int, stride: int, n: int, x: wp.array(dtype=real), at_x: int, stride_x: int, count: int
): ...


# S = W^T W of n lines of `count` columns, which is also the stride of S's lines. Lanes over the columns.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* X = x.data + at_x;
    for (int c = 0; c < count; ++c) {
        double* __restrict s = square.data + at_square + (size_t)c * stride_x; int i = 0;
        for (int q = lane; q < count; q += lanes) s[q] = 0.0;
        for (; i + 3 < n; i += 4) {
            const double *a = X + (size_t)i * stride_x, *b = a + stride_x, *d = b + stride_x, *e = d + stride_x;
            const double m0 = a[c], m1 = b[c], m2 = d[c], m3 = e[c];
            for (int q = lane; q < count; q += lanes) s[q] += m0 * a[q] + m1 * b[q] + m2 * d[q] + m3 * e[q];
        }
        for (; i < n; ++i) { const double* a = X + (size_t)i * stride_x; const double m = a[c];
            for (int q = lane; q < count; q += lanes) s[q] += m * a[q]; }
    }
    WP_TILE_SYNC();
""")
def square_of(
    n: int, x: wp.array(dtype=real), at_x: int, stride_x: int, count: int, square: wp.array(dtype=real), at_square: int
): ...


# x <- U^-T x of n numbers.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    double* v = x.data + at_x;
    WP_TILE_SYNC();
    for (int i = 0; i < n; ++i) {
        const double* u = a.data + at + (size_t)i * stride; const double y = v[i] / u[i];
        WP_TILE_SYNC();
        if (lane == 0) v[i] = y;
        for (int j = i + 1 + lane; j < n; j += lanes) v[j] -= u[j] * y;
        WP_TILE_SYNC();
    }
""")
def forward(a: wp.array(dtype=real), at: int, stride: int, n: int, x: wp.array(dtype=real), at_x: int): ...


# x <- U^-1 x of n numbers, by one lane.
@wp.func_native("""
    double* v = x.data + at_x;
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) for (int i = n - 1; i >= 0; --i) {
        const double* u = a.data + at + (size_t)i * stride; double sum = 0.0, part[8] = {0.0}; int j = i + 1;
        for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) part[c] += u[j + c] * v[j + c];
        for (; j < n; ++j) sum += u[j] * v[j];
        for (int c = 0; c < 8; ++c) sum += part[c];
        v[i] = (v[i] - sum) / u[i];
    }
    WP_TILE_SYNC();
""")
def backward(a: wp.array(dtype=real), at: int, stride: int, n: int, x: wp.array(dtype=real), at_x: int): ...


# right += W^T x, n lines of W over the coupled columns of a pair, `right` over the retained columns.
@wp.func_native("""
    const int width = model.pairs.coupled_capacity, count = model.pairs.coupled_count.data[pair];
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    double* r = right.data + (size_t)w * model.retained.count;
    double sum[512];  // MOST_COUPLED_COLUMNS
    WP_TILE_SYNC();
    for (int c = lane; c < count; c += lanes) sum[c] = 0.0;
    for (int i = 0; i < n; ++i) {
        const double* b = W.data + at_w + (size_t)i * width;
        const double value = x.data[at_x + i];
        for (int c = lane; c < count; c += lanes) sum[c] += b[c] * value;
    }
    // columns may be named twice, by a pair with the ground, with zeros
    for (int c = lane; c < count; c += lanes) if (sum[c] != 0.0) r[column[c]] += sum[c];
    WP_TILE_SYNC();
""")
def push_columns(
    model: Model,
    w: int,
    pair: int,
    n: int,
    W: wp.array(dtype=real),
    at_w: int,
    x: wp.array(dtype=real),
    at_x: int,
    right: wp.array(dtype=real),
): ...


# x += part W z, n lines of W over the coupled columns of a pair. Lanes over the lines.
@wp.func_native("""
    const int width = model.pairs.coupled_capacity, count = model.pairs.coupled_count.data[pair];
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    const double* v = z.data + (size_t)w * model.retained.count;
    double picked[512];  // MOST_COUPLED_COLUMNS
    for (int c = 0; c < count; ++c) picked[c] = part * v[column[c]];
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const double* b = W.data + at_w + (size_t)i * width;
        double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0; int c = 0;
        for (; c + 3 < count; c += 4) {
            s0 += b[c] * picked[c]; s1 += b[c + 1] * picked[c + 1];
            s2 += b[c + 2] * picked[c + 2]; s3 += b[c + 3] * picked[c + 3];
        }
        for (; c < count; ++c) s0 += b[c] * picked[c];
        x.data[at_x + i] += (s0 + s1) + (s2 + s3);
    }
    WP_TILE_SYNC();
""")
def follow_columns(
    model: Model,
    w: int,
    pair: int,
    n: int,
    part: real,
    W: wp.array(dtype=real),
    at_w: int,
    z: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at_x: int,
): ...


# y += sum of p_n times line n of x, `count` numbers each; four lines at a time. Lanes over the numbers.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double *f = p.data + at_p, *q = x.data + at_x;
    double* __restrict out = y.data + at_y; int n = 0;
    WP_TILE_SYNC();
    for (; n + 3 < lines; n += 4) {
        const double *a = q + (size_t)n * stride, *b = a + stride, *c = b + stride, *d = c + stride;
        const double f0 = f[n], f1 = f[n + 1], f2 = f[n + 2], f3 = f[n + 3];
        for (int j = lane; j < count; j += lanes) out[j] += f0 * a[j] + f1 * b[j] + f2 * c[j] + f3 * d[j];
    }
    for (; n < lines; ++n) { const double* a = q + (size_t)n * stride; const double f0 = f[n];
        for (int j = lane; j < count; j += lanes) out[j] += f0 * a[j]; }
    WP_TILE_SYNC();
""")
def add_lines(
    lines: int,
    count: int,
    p: wp.array(dtype=real),
    at_p: int,
    x: wp.array(dtype=real),
    at_x: int,
    stride: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


# Whether a column of L is not zero; n lines.
@wp.func_native("""
    for (int i = 0; i < n; ++i) if (L.data[at + (size_t)i * width] != 0.0) return 1;  // every lane for itself
    return 0;
""")
def is_loaded(n: int, width: int, L: wp.array(dtype=real), at: int) -> int: ...


# square = L^T Z of n lines of `count` columns, made symmetric to the last bit. Lanes over its lines.
@wp.func_native("""
    const double *a = L.data + at, *b = Z.data + at;
    double* s = square.data + at_square;
    WP_TILE_SYNC();
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) {
        double* __restrict line = s + (size_t)c * width;
        for (int q = 0; q <= c; ++q) line[q] = 0.0;
        for (int i = 0; i < n; ++i) {
            const double f = b[(size_t)i * width + c];
            const double* l = a + (size_t)i * width;
            for (int q = 0; q <= c; ++q) line[q] += f * l[q];
        }
    }
    WP_TILE_SYNC();
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM)
        for (int q = c + 1; q < count; ++q) s[(size_t)c * width + q] = s[(size_t)q * width + c];
    WP_TILE_SYNC();
""")
def product_of_borders(
    n: int,
    width: int,
    count: int,
    at: int,
    L: wp.array(dtype=real),
    Z: wp.array(dtype=real),
    at_square: int,
    square: wp.array(dtype=real),
): ...
