r"""What patches do to one another by the local compliance of a body that they share: in the matrix, or lagged.

Weak gaps of pair i hold sum_j F_ij p_j of all pairs j on the same bodies. Times the weights w of impulsive pairs the
rows of the linearised system read

    w_i (gap_i + sum_j F_ij dp_j) = 0,      dp_j = ds_j / w_j      (`contact_solve`),

with blocks F_ij w_i / w_j, which are symmetric only where the weights are equal. Conjugate gradients need symmetric
ones, min(w_i, w_j) / max(w_i, w_j) of F_ij on both sides; the correction of the active set sees true gaps. Where the
weights differ, as of an idle roller that touches beside loaded ones, the two disagree, and cells at the edge of a patch
enter and leave the set for ever.

In dynamic steps of scenes in which nothing but patches is coupled so, F_ij dp_j is therefore left out of both, matrix
and correction, and taken from the pressures of the evaluation. Residuals stay exact, so that what is converged to is
the same; an iteration contracts by |F| / |G|, 0.01 of steel rings. Where it contracts less well, as where patches of
soft bodies lie close, the blocks are assembled after LAGS iterations of a round.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS

wp.set_module_options(MODULE_OPTIONS)

PATCHES_ALONE = wp.constant(2)  # value of `Pairs.beside`: pairs answer to each other by patches of one body alone
LAGS = wp.constant(8)  # iterations of a round


@wp.func
def lags(model: Model, ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether what patches do to one another is that of the evaluation in this iteration."""
    patient = ctl[w].iteration < LAGS * (1 + ctl[w].round)
    return model.pairs.beside == PATCHES_ALONE and ctl[w].mode == k.DYNAMIC and patient


@wp.func
def ends_lag(model: Model, ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether this is the first iteration that has the blocks in its matrix."""
    last = ctl[w].iteration == LAGS * (1 + ctl[w].round)
    return model.pairs.beside == PATCHES_ALONE and ctl[w].mode == k.DYNAMIC and last
