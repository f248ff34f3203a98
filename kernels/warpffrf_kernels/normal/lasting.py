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
from warpffrf_kernels.core.contact_scratch import ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.core.state import ContactState

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


@kernel
def begin_rows(run: Run, normal: ContactSolve):
    """Per world: an attempt begins, with the rows of G of the one before where it may."""
    w = wp.tid()
    if run.ctl[w].run == 0:
        return
    normal.lasting[w, BEGUN] = 1
    normal.lasting[w, OLDER] = 0
    if run.ctl[w].mode != k.DYNAMIC or run.models[w].elements[0].patches.lasting == 0:
        normal.lasting[w, ROWS] = 0
    if normal.lasting[w, RESTS] > 0:
        normal.lasting[w, RESTS] = normal.lasting[w, RESTS] - 1
        normal.lasting[w, ROWS] = 0
    if normal.lasting[w, ROWS] != 0:
        normal.lasting[w, OLDER] = 1
        normal.lasting[w, AGE] = normal.lasting[w, AGE] + 1
        run.ctl[w].slots = normal.lasting[w, COUNT]
        run.ctl[w].fresh = normal.lasting[w, COUNT]
        run.ctl[w].reassemble = 0


@wp.func
def are_near(run: Run, w: int, pair: int, width: real, impulses: ImpulsiveContact, patch: PatchScratch) -> bool:
    """Whether rows of a pair that were made at `patch_made` serve where W is `width`."""
    made = patch.patch_made[w, pair, WIDTH]
    same = (
        patch.patch_made[w, pair, TANGENT] == run.clk[w].outer.acc
        and patch.patch_made[w, pair, WEIGHT] == impulses.weight[w, pair]
    )
    return same and wp.abs(width - made) <= NEAR * made


@kernel
def note_rows(run: Run, normal: ContactSolve, contact: ContactState, impulses: ImpulsiveContact, patch: PatchScratch):
    """Per (world, pair): for which W, step and weight rows are being made."""
    w, pair = wp.tid()
    if run.ctl[w].run == 0 or normal.lasting[w, OLDER] != 0:
        return
    patch.patch_made[w, pair, WIDTH] = contact.patch_width[w, pair]
    patch.patch_made[w, pair, TANGENT] = run.clk[w].outer.acc
    patch.patch_made[w, pair, WEIGHT] = impulses.weight[w, pair]


@kernel
def keep_rows(run: Run, normal: ContactSolve):
    """Per world: of an attempt that was not accepted no rows stand."""
    w = wp.tid()
    if run.ctl[w].attempt != 0 and run.ctl[w].accept == 0:
        normal.lasting[w, ROWS] = 0
