r"""Coupling of patches by the local compliance of a body that they share: in the matrix, or lagged.

Weak gaps of pair i contain sum_j F_ij p_j of all pairs j on the same bodies. Multiplied by the weights w of impulsive
pairs, the rows of the linearised system read

    w_i (gap_i + sum_j F_ij dp_j) = 0,      dp_j = ds_j / w_j      (`contact_solve`),

with blocks F_ij w_i / w_j (`between_pairs`). They are as many as the pairs squared. In dynamic steps of scenes in which
only patches are coupled in this way, F_ij dp_j is omitted from both, matrix and correction of the active set, and taken
from the pressures of the evaluation. Residuals stay exact, so the converged solution is the same; an iteration
contracts by |F| / |G|, 0.01 for steel rings. Where it contracts more slowly, for example if patches of soft bodies lie
close together, the blocks are assembled after LAGS iterations of a round.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS

wp.set_module_options(MODULE_OPTIONS)

PATCHES_ALONE = wp.constant(2)  # value of `Pairs.beside`: pairs are coupled only by patches of one body
LAGS = wp.constant(8)  # iterations of a round


@wp.func
def lags(model: Model, ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether the coupling of patches is that of the evaluation in this iteration."""
    patient = ctl[w].iteration < LAGS * (1 + ctl[w].round)
    return model.pairs.beside == PATCHES_ALONE and ctl[w].mode == k.DYNAMIC and patient


@wp.func
def ends_lag(model: Model, ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether this is the first iteration whose matrix contains the blocks."""
    last = ctl[w].iteration == LAGS * (1 + ctl[w].round)
    return model.pairs.beside == PATCHES_ALONE and ctl[w].mode == k.DYNAMIC and last
