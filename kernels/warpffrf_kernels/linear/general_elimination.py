"""Dense general systems, with row pivoting; right-hand sides are stored in the columns after the matrix.

    P A = L U,      x = U^-1 L^-1 P b,

A of n lines in the first n columns of lines `stride` long; `at` is its start. Columns are eliminated eight at a time,
so that the rest of the matrix is traversed once per eight columns, four lines at a time. Native for contiguous inner
loops like `axpy`.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# L and U overwrite A, and x the `more` columns after it. Returns 1 if a pivot vanishes. Lanes over lines in the panel,
# over columns in the rest.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, all = n + more;
    double* A = a.data + at;
    int* swapped = pivots.data + at_pivots;
    int bad = 0;
    for (int p = 0; p < n; p += 8) {
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
            for (int i = end; i < n; i += 4) {  // four lines at a time, by fused products
                const int count = n - i < 4 ? n - i : 4;
                double m[4][8];
                for (int q = 0; q < count; ++q)
                    for (int c = 0; c < 8; ++c) m[q][c] = -A[(size_t)(i + q) * stride + p + c];
                double* __restrict x0 = A + (size_t)i * stride; double* __restrict x1 = x0 + stride;
                double* __restrict x2 = x1 + stride; double* __restrict x3 = x2 + stride;
                if (count == 4)
                    for (int j = end + lane; j < all; j += lanes) {
                        const double v[8] = {u0[j], u1[j], u2[j], u3[j], u4[j], u5[j], u6[j], u7[j]};
                        double s0 = x0[j], s1 = x1[j], s2 = x2[j], s3 = x3[j];
                        for (int c = 0; c < 8; ++c) {
                            s0 = ::fma(m[0][c], v[c], s0); s1 = ::fma(m[1][c], v[c], s1);
                            s2 = ::fma(m[2][c], v[c], s2); s3 = ::fma(m[3][c], v[c], s3);
                        }
                        x0[j] = s0; x1[j] = s1; x2[j] = s2; x3[j] = s3;
                    }
                else
                    for (int q = 0; q < count; ++q) {
                        double* __restrict x = A + (size_t)(i + q) * stride;
                        for (int j = end + lane; j < all; j += lanes) {
                            const double v[8] = {u0[j], u1[j], u2[j], u3[j], u4[j], u5[j], u6[j], u7[j]};
                            double s = x[j];
                            for (int c = 0; c < 8; ++c) s = ::fma(m[q][c], v[c], s);
                            x[j] = s;
                        }
                    }
            }
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
    a: wp.array(dtype=real), at: int, stride: int, n: int, more: int, pivots: wp.array(dtype=int), at_pivots: int
) -> int: ...


# x <- A^-1 x of n numbers, with L and U from `eliminate`. One lane.
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
