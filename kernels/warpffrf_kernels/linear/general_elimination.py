"""Dense systems of any matrix, with row pivoting, their right-hand sides in the columns behind it.

    P A = L U,      x = U^-1 L^-1 P b,

A of n lines in the first n columns of lines `stride` long; `at` is where it begins. The first `thin` columns have next
to nothing below their diagonal, which is their pivot; the others are taken eight at a time, so that the rest of the
matrix is gone through once for eight. Native for contiguous inner loops like `axpy`.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# L and U in place of A, and x in place of the `more` columns behind it. Returns 1 where a pivot vanishes. Lanes over
# lines in the panel, over columns in the rest.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, all = n + more;
    double* A = a.data + at;
    int* swapped = pivots.data + at_pivots;
    int bad = 0;
    for (int c = 0; c < thin; ++c) {
        const double* u = A + (size_t)c * stride; double pivot = u[c];
        if (!(::fabs(pivot) > 0.0)) { bad = 1; pivot = 1.0; }
        if (lane == 0) swapped[c] = c;
        for (int i = c + 1; i < n; ++i) {
            double* __restrict x = A + (size_t)i * stride; const double m = x[c] / pivot;
            WP_TILE_SYNC();
            if (m == 0.0) continue;
            if (lane == 0) x[c] = m;
            for (int j = c + 1 + lane; j < all; j += lanes) x[j] -= m * u[j];
        }
        WP_TILE_SYNC();
    }
    for (int p = thin; p < n; p += 8) {
        const int kb = n - p < 8 ? n - p : 8, end = p + kb;
        for (int c = p; c < end; ++c) {
            int best = c; double largest = ::fabs(A[(size_t)c * stride + c]);
            for (int i = c + 1; i < n; ++i) {
                const double size = ::fabs(A[(size_t)i * stride + c]);
                if (size > largest) { largest = size; best = i; }
            }
            WP_TILE_SYNC();
            if (lane == 0) swapped[c] = best;
            double* u = A + (size_t)c * stride;
            if (best != c) { double* x = A + (size_t)best * stride;
                for (int j = lane; j < all; j += lanes) { const double t = u[j]; u[j] = x[j]; x[j] = t; } }
            WP_TILE_SYNC();
            double pivot = u[c];
            if (!(::fabs(pivot) > 0.0)) { bad = 1; pivot = 1.0; }
            const double r = 1.0 / pivot;
            for (int i = c + 1 + lane; i < n; i += lanes) {
                double* x = A + (size_t)i * stride; const double m = x[c] * r;
                x[c] = m;
                for (int j = c + 1; j < end; ++j) x[j] -= m * u[j];
            }
            WP_TILE_SYNC();
        }
        for (int q = p + 1; q < end; ++q) { double* __restrict x = A + (size_t)q * stride;
            for (int r = p; r < q; ++r) { const double* u = A + (size_t)r * stride; const double m = x[r];
                for (int j = end + lane; j < all; j += lanes) x[j] -= m * u[j]; } }
        WP_TILE_SYNC();
        if (kb == 8) {
            const double *u0 = A + (size_t)p * stride, *u1 = u0 + stride, *u2 = u1 + stride, *u3 = u2 + stride;
            const double *u4 = u3 + stride, *u5 = u4 + stride, *u6 = u5 + stride, *u7 = u6 + stride;
            int i = end;
            for (; i + 1 < n; i += 2) {
                double* __restrict x = A + (size_t)i * stride; double* __restrict y = x + stride;
                const double m0 = x[p], m1 = x[p + 1], m2 = x[p + 2], m3 = x[p + 3];
                const double m4 = x[p + 4], m5 = x[p + 5], m6 = x[p + 6], m7 = x[p + 7];
                const double l0 = y[p], l1 = y[p + 1], l2 = y[p + 2], l3 = y[p + 3];
                const double l4 = y[p + 4], l5 = y[p + 5], l6 = y[p + 6], l7 = y[p + 7];
                for (int j = end + lane; j < all; j += lanes) {
                    const double v0 = u0[j], v1 = u1[j], v2 = u2[j], v3 = u3[j];
                    const double v4 = u4[j], v5 = u5[j], v6 = u6[j], v7 = u7[j];
                    x[j] -= ((m0 * v0 + m1 * v1) + (m2 * v2 + m3 * v3)) + ((m4 * v4 + m5 * v5) + (m6 * v6 + m7 * v7));
                    y[j] -= ((l0 * v0 + l1 * v1) + (l2 * v2 + l3 * v3)) + ((l4 * v4 + l5 * v5) + (l6 * v6 + l7 * v7));
                }
            }
            for (; i < n; ++i) { double* __restrict x = A + (size_t)i * stride;
                const double m0 = x[p], m1 = x[p + 1], m2 = x[p + 2], m3 = x[p + 3];
                const double m4 = x[p + 4], m5 = x[p + 5], m6 = x[p + 6], m7 = x[p + 7];
                for (int j = end + lane; j < all; j += lanes)
                    x[j] -= ((m0 * u0[j] + m1 * u1[j]) + (m2 * u2[j] + m3 * u3[j]))
                        + ((m4 * u4[j] + m5 * u5[j]) + (m6 * u6[j] + m7 * u7[j])); }
        } else {
            for (int q = p; q < end; ++q) { const double* u = A + (size_t)q * stride;
                for (int i = end; i < n; ++i) { double* __restrict x = A + (size_t)i * stride; const double m = x[q];
                    for (int j = end + lane; j < all; j += lanes) x[j] -= m * u[j]; } }
        }
        WP_TILE_SYNC();
    }
    for (int i = n - 1; i >= 0; --i) {
        double* __restrict x = A + (size_t)i * stride; const double r = 1.0 / (bad ? 1.0 : x[i]);
        int q = i + 1;
        for (; q + 3 < n; q += 4) {
            const double *b = A + (size_t)q * stride, *c = b + stride, *d = c + stride, *e = d + stride;
            const double m0 = x[q], m1 = x[q + 1], m2 = x[q + 2], m3 = x[q + 3];
            for (int j = n + lane; j < all; j += lanes) x[j] -= (m0 * b[j] + m1 * c[j]) + (m2 * d[j] + m3 * e[j]);
        }
        for (; q < n; ++q) { const double* b = A + (size_t)q * stride; const double m = x[q];
            for (int j = n + lane; j < all; j += lanes) x[j] -= m * b[j]; }
        for (int j = n + lane; j < all; j += lanes) x[j] *= r;
    }
    WP_TILE_SYNC();
    return bad;
""")
def eliminate(
    a: wp.array(dtype=real),
    at: int,
    stride: int,
    n: int,
    more: int,
    thin: int,
    pivots: wp.array(dtype=int),
    at_pivots: int,
) -> int: ...


# x <- A^-1 x of n numbers, with the L and U that `eliminate` has left. One lane.
@wp.func_native("""
    const double* A = a.data + at;
    const int* swapped = pivots.data + at_pivots;
    double* v = x.data + at_x;
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) {
        for (int i = 0; i < n; ++i) { const double t = v[i]; v[i] = v[swapped[i]]; v[swapped[i]] = t; }
        for (int i = 1; i < n; ++i) {
            const double* l = A + (size_t)i * stride; double part[8] = {0.0}, sum = 0.0; int j = 0;
            for (; j + 7 < i; j += 8) for (int c = 0; c < 8; ++c) part[c] += l[j + c] * v[j + c];
            for (; j < i; ++j) sum += l[j] * v[j];
            for (int c = 0; c < 8; ++c) sum += part[c];
            v[i] -= sum;
        }
        for (int i = n - 1; i >= 0; --i) {
            const double* u = A + (size_t)i * stride; double part[8] = {0.0}, sum = 0.0; int j = i + 1;
            for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) part[c] += u[j + c] * v[j + c];
            for (; j < n; ++j) sum += u[j] * v[j];
            for (int c = 0; c < 8; ++c) sum += part[c];
            v[i] = (v[i] - sum) / u[i];
        }
    }
    WP_TILE_SYNC();
""")
def solve_again(
    a: wp.array(dtype=real),
    at: int,
    stride: int,
    n: int,
    pivots: wp.array(dtype=int),
    at_pivots: int,
    x: wp.array(dtype=real),
    at_x: int,
): ...
