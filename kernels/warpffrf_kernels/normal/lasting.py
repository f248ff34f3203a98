r"""Rows of G, and their factor, that stand from step to step.

Cells travel and grow with the patch, so that G, how the gaps of cells open under pressures on them, is nearly the same
in every step: it changes with W, and a little with where the patch lies on the splines and on the modes. It is read for
increments alone, never for a residual (`contact_solve`). A solve with a G that errs by a fraction e leaves e of what it
was to take away, and costs no row and no factor.

An attempt therefore begins with the rows of the one before. They are made anew

- where its step is another, or a pair is impulsive otherwise: the modes' part of G depends on both;
- where W is off by more than `NEAR` from where they were made;
- where a cell comes under pressure that has no row;
- after `PATIENCE` solves: what these have not brought about needs a better G;
- after an attempt that was not accepted;
- in every one of the next `REST` attempts where rows have served for none but the one they were made in: a patch whose
  edge changes from step to step would have them made anew each time, after solves in vain.

Only in scenes all of whose pairs are patches that answer to their own pressures, by constants (`patches.lasting`).

    lasting[w, ROWS]    1: rows of G may be used by the next attempt
    lasting[w, OLDER]   1: those in use are of an earlier attempt
    lasting[w, BEGUN]   1: the attempt has begun, and nothing of it has been solved
    lasting[w, COUNT]   how many rows there are
    lasting[w, AGE]     attempts that they have served for
    lasting[w, RESTS]   attempts to come that do without
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

ROWS = wp.constant(0)
OLDER = wp.constant(1)
BEGUN = wp.constant(2)
COUNT = wp.constant(3)
AGE = wp.constant(4)
RESTS = wp.constant(5)
NEAR = wp.constant(wp.float64(0.05))  # relative change of W: G by a tenth of it, beside a factor that is W^2
PATIENCE = wp.constant(2)  # solves of an attempt by rows of an earlier one
REST = wp.constant(32)

WIDTH = wp.constant(0)  # columns of `patch_made`
TANGENT = wp.constant(1)
WEIGHT = wp.constant(2)


@wp.kernel
def begin_rows(
    models: wp.array(dtype=Model),
    ctl: inout(wp.array(dtype=Control)),
    lasting: inout(wp.array2d(dtype=int)),
):
    """Per world: an attempt begins, with the rows of G of the one before where it may."""
    w = wp.tid()
    if ctl[w].run == 0:
        return
    lasting[w, BEGUN] = 1
    lasting[w, OLDER] = 0
    if ctl[w].mode != k.DYNAMIC or models[w].elements[0].patches.lasting == 0:
        lasting[w, ROWS] = 0
    if lasting[w, RESTS] > 0:
        lasting[w, RESTS] = lasting[w, RESTS] - 1
        lasting[w, ROWS] = 0
    if lasting[w, ROWS] != 0:
        lasting[w, OLDER] = 1
        lasting[w, AGE] = lasting[w, AGE] + 1
        ctl[w].slots = lasting[w, COUNT]
        ctl[w].fresh = lasting[w, COUNT]
        ctl[w].reassemble = 0


@wp.func
def are_near(
    clk: wp.array(dtype=Clock), w: int, pair: int, width: real, weight: wp.array2d(dtype=real),
    patch_made: wp.array3d(dtype=real),
) -> bool:  # fmt: skip
    """Whether rows of a pair that were made at `patch_made` serve where W is `width`."""
    made = patch_made[w, pair, WIDTH]
    same = patch_made[w, pair, TANGENT] == clk[w].outer.acc and patch_made[w, pair, WEIGHT] == weight[w, pair]
    return same and wp.abs(width - made) <= NEAR * made


@wp.kernel
def note_rows(
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    lasting: wp.array2d(dtype=int),
    patch_width: wp.array2d(dtype=real),
    weight: wp.array2d(dtype=real),
    patch_made: out(wp.array3d(dtype=real)),
):
    """Per (world, pair): for which W, step and weight rows are being made."""
    w, pair = wp.tid()
    if ctl[w].run == 0 or lasting[w, OLDER] != 0:
        return
    patch_made[w, pair, WIDTH] = patch_width[w, pair]
    patch_made[w, pair, TANGENT] = clk[w].outer.acc
    patch_made[w, pair, WEIGHT] = weight[w, pair]


@wp.kernel
def keep_rows(ctl: wp.array(dtype=Control), lasting: out(wp.array2d(dtype=int))):
    """Per world: of an attempt that was not accepted no rows stand."""
    w = wp.tid()
    if ctl[w].attempt != 0 and ctl[w].accept == 0:
        lasting[w, ROWS] = 0
