"""States of the cells for trial tractions and their slips r, and the defect of the tractions from the friction law.

The defect of a cell is the distance of its traction from the point of its disc that corresponds to its slip,

    tau = P(tau - r/c),      P: the nearest point of the disc, c: the mean of the diagonal of its block of K.
"""

import warp as wp

from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.friction.cell_blocks import COUNT

wp.set_module_options(MODULE_OPTIONS)

DEFECT = wp.constant(0)  # columns of `outcome`: the largest defect,
LARGEST = wp.constant(1)  # the largest bound,
CHANGED = wp.constant(2)  # 1 if the kind of a cell differs from that of the present factorisation,
JUMPED = wp.constant(3)  # 1 if sliding cells are not on their circles yet


# Sticking (1), sliding (2) and unloaded (0) cells of a pair, and the points to which sliding ones are moved; by one
# lane. With `carry` cells keep their kinds, and sliding ones the direction of their traction.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *x = tau.data + here * 2 * cap, *r = slip.data + here * 2 * cap;
    const double *b = radius.data + here * cap, *soft = softness.data + here * cap, *k = diagonal.data + here * cap * 3;
    double *dir = direction.data + here * 2 * cap, *jump = jumps.data + here * 2 * cap;
    double* report = outcome.data + (size_t)w * 4;
    int *kind = sliding.data + here * 2 * cap, *factored = kind + cap;  // present, then of the factorisation
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) for (int i = 0; i < count; ++i) {
        const int p = 2 * i;
        const int known = carry ? kind[i] : 0;
        int found = 0; jump[p] = jump[p + 1] = 0.0;
        if (b[i] > 0.0) {
            const double c = 0.5 * (k[3 * i] + k[3 * i + 2]) + soft[i];
            const double y0 = x[p] - r[p] / c, y1 = x[p + 1] - r[p + 1] / c, size = ::sqrt(y0 * y0 + y1 * y1);
            double v0 = y0, v1 = y1; found = 1;
            if (size > b[i]) {
                found = 2; dir[p] = y0 / size; dir[p + 1] = y1 / size;
                v0 = b[i] * dir[p]; v1 = b[i] * dir[p + 1];
                jump[p] = v0 - x[p]; jump[p + 1] = v1 - x[p + 1];
                if (jump[p] != 0.0 || jump[p + 1] != 0.0) report[3] = 1.0;
                const double lambda = -(r[p] * dir[p] + r[p + 1] * dir[p + 1]) / b[i];
                if (known != 2) curvature.data[here * cap + i] = lambda > 0.0 ? lambda : 0.0;
            }
            const double e = ::sqrt((v0 - x[p]) * (v0 - x[p]) + (v1 - x[p + 1]) * (v1 - x[p + 1]));
            if (!(e <= report[0])) report[0] = e;
            if (b[i] > report[1]) report[1] = b[i];
            const double was = ::sqrt(x[p] * x[p] + x[p + 1] * x[p + 1]);
            if (known == 1) { found = 1; jump[p] = jump[p + 1] = 0.0; }
            if (known == 2 && was > 0.0) {
                found = 2; dir[p] = x[p] / was; dir[p + 1] = x[p + 1] / was;
                jump[p] = b[i] * dir[p] - x[p]; jump[p + 1] = b[i] * dir[p + 1] - x[p + 1];
                if (jump[p] != 0.0 || jump[p + 1] != 0.0) report[3] = 1.0;
            }
        }
        if (found != factored[i]) report[2] = 1.0;
        kind[i] = found;
    }
    WP_TILE_SYNC();
""")
def sort_pair(
    model: Model,
    w: int,
    pair: int,
    count: int,
    carry: int,
    diagonal: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slip: wp.array(dtype=real),
    jumps: wp.array(dtype=real),
    direction: wp.array(dtype=real),
    curvature: wp.array(dtype=real),
    sliding: wp.array(dtype=int),
    outcome: wp.array2d(dtype=real),
): ...


@wp.func
def sort_cells(
    model: Model, w: int, lane: int, carry: int, tangential: FrictionSolve, slopes: SlipSpeedSolve,
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> real:  # fmt: skip
    """Kinds of the cells of all pairs; returns the defect of the tractions, as a fraction of the largest bound."""
    sync()
    if lane == 0:
        for column in range(4):
            tangential.cell_outcome[w, column] = real(0.0)
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        count = tangential.cell_block[w, pair, COUNT]
        if count > 0:
            sort_pair(
                model, w, pair, count, carry, slopes.speed_diagonal, radius, softness, slopes.speed_tau,
                tangential.cell_slip, tangential.cell_jump, tangential.cell_direction, tangential.cell_curvature,
                tangential.cell_sliding, tangential.cell_outcome,
            )  # fmt: skip
        pair += 1
    if tangential.cell_outcome[w, LARGEST] > real(0.0):
        return tangential.cell_outcome[w, DEFECT] / tangential.cell_outcome[w, LARGEST]
    return real(0.0)
