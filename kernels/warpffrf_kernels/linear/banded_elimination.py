r"""Banded general systems, with row pivoting; right-hand sides are stored behind the band.

    P A = L U,      x = U^-1 L^-1 P b,

A of n lines with entries up to `half` columns from the diagonal. Line i begins at at + i stride with its columns
i - half to i + 2 half, of which those beyond i + half are room for lines that change places, and continues with `more`
right-hand sides. Lines are skipped where their multiplier is zero. Native for contiguous inner loops like `axpy`.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# L and U overwrite A, and x the `more` columns behind it. Returns 1 if a pivot vanishes. Lanes over lines, then over
# right-hand sides.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, behind = 3 * half + 1;
    double* A = a.data + at;
    int* swapped = pivots.data + at_pivots;
    int bad = 0, reach = 0;
    for (int c = 0; c < n; ++c) {
        const int last = c + half < n - 1 ? c + half : n - 1;
        double* u = A + (size_t)c * stride;
        int best = c; double largest = ::fabs(u[half]);
        for (int i = c + 1; i <= last; ++i) {
            const double size = ::fabs(A[(size_t)i * stride + c - i + half]);
            if (size > largest) { largest = size; best = i; }
        }
        const int end = best + half < n - 1 ? best + half : n - 1;
        if (end > reach) reach = end;
        const int wide = half + reach - c;  // of the last column that is not zero, counted as in line c
        WP_TILE_SYNC();
        if (lane == 0) swapped[c] = best;
        if (best != c) {
            double* x = A + (size_t)best * stride;
            for (int j = half + lane; j <= wide; j += lanes) {
                const double t = u[j]; u[j] = x[j + c - best]; x[j + c - best] = t; }
            for (int j = behind + lane; j < behind + more; j += lanes) { const double t = u[j]; u[j] = x[j]; x[j] = t; }
        }
        WP_TILE_SYNC();
        double pivot = u[half];
        if (!(::fabs(pivot) > 0.0)) { bad = 1; pivot = 1.0; }
        const double r = 1.0 / pivot;
        for (int i = c + 1 + lane; i <= last; i += lanes) {
            double* line = A + (size_t)i * stride;
            double* __restrict x = line + (c - i);
            const double m = x[half] * r;
            if (m == 0.0) continue;
            x[half] = m;
            for (int j = half + 1; j <= wide; ++j) x[j] -= m * u[j];
            double* __restrict y = line + behind;
            for (int j = 0; j < more; ++j) y[j] -= m * u[behind + j];
        }
        WP_TILE_SYNC();
    }
    for (int i = n - 1; i >= 0; --i) {
        double* line = A + (size_t)i * stride; const double r = 1.0 / (bad ? 1.0 : line[half]);
        double* __restrict x = line + behind;
        const int end = i + 2 * half < n - 1 ? i + 2 * half : n - 1;
        for (int q = i + 1; q <= end; q += 4) {
            const int some = end - q < 3 ? end - q : 3;
            const double* b0 = A + (size_t)q * stride + behind; const double* m = line + q - i + half;
            if (some == 3 && (m[0] != 0.0 || m[1] != 0.0 || m[2] != 0.0 || m[3] != 0.0)) {
                const double *b1 = b0 + stride, *b2 = b1 + stride, *b3 = b2 + stride;
                for (int j = lane; j < more; j += lanes)
                    x[j] -= (m[0] * b0[j] + m[1] * b1[j]) + (m[2] * b2[j] + m[3] * b3[j]);
            } else if (some < 3)
                for (int k = 0; k <= some; ++k)
                    for (int j = lane; j < more; j += lanes) x[j] -= m[k] * b0[(size_t)k * stride + j];
        }
        for (int j = lane; j < more; j += lanes) x[j] *= r;
    }
    WP_TILE_SYNC();
    return bad;
""")
def eliminate_band(
    a: wp.array(dtype=real),
    at: int,
    stride: int,
    n: int,
    half: int,
    more: int,
    pivots: wp.array(dtype=int),
    at_pivots: int,
) -> int: ...


# x <- A^-1 x of n numbers, with L and U from `eliminate_band`. One lane.
@wp.func_native("""
    const double* A = a.data + at;
    const int* swapped = pivots.data + at_pivots;
    double* v = x.data + at_x;
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) {
        for (int c = 0; c < n; ++c) {
            const double t = v[c]; v[c] = v[swapped[c]]; v[swapped[c]] = t;
            const int last = c + half < n - 1 ? c + half : n - 1;
            for (int i = c + 1; i <= last; ++i) v[i] -= A[(size_t)i * stride + c - i + half] * v[c];
        }
        for (int i = n - 1; i >= 0; --i) {
            const double* u = A + (size_t)i * stride - i + half;
            const int end = i + 2 * half < n - 1 ? i + 2 * half : n - 1;
            double even = 0.0, odd = 0.0; int j = i + 1;
            for (; j + 1 <= end; j += 2) { even += u[j] * v[j]; odd += u[j + 1] * v[j + 1]; }
            if (j <= end) even += u[j] * v[j];
            v[i] = (v[i] - even - odd) / u[i];
        }
    }
    WP_TILE_SYNC();
""")
def solve_band_again(
    a: wp.array(dtype=real),
    at: int,
    stride: int,
    n: int,
    half: int,
    pivots: wp.array(dtype=int),
    at_pivots: int,
    x: wp.array(dtype=real),
    at_x: int,
): ...
