r"""Rows of G, and their factor, that are kept from step to step.

Cells move and grow with the patch, so G, the opening of the gaps of cells due to pressures on them, is nearly the same
in every step: it changes with W, and slightly with the position of the patch on the splines and on the modes. It is
used for increments only, never for a residual (`contact_solve`). A solution with a G of relative error e leaves a
fraction e of the residual, and costs no assembly and no factorisation.

An attempt therefore starts with the rows of the previous one. They are computed anew

- if its step differs, or the impulsive state of a pair: the modes' part of G depends on both;
- if W differs by more than `NEAR` from that at which they were computed;
- if a cell without a row becomes active;
- after `PATIENCE` solutions: what these have not achieved needs a better G;
- after an attempt that was not accepted;
- in every one of the next `REST` attempts, if rows were useful only in the attempt in which they were computed: a patch
  whose edge changes from step to step would otherwise have them recomputed each time, after solutions in vain.

Only in scenes in which all pairs are patches that are coupled to their own pressures by constants (`patches.lasting`).

    lasting[w, ROWS]    1: rows of G may be used by the next attempt
    lasting[w, OLDER]   1: those in use are of an earlier attempt
    lasting[w, BEGUN]   1: the attempt has begun, and nothing of it has been solved
    lasting[w, COUNT]   number of rows
    lasting[w, AGE]     number of attempts in which they were used
    lasting[w, RESTS]   number of further attempts without them
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
NEAR = wp.constant(wp.float64(0.05))  # relative change of W: changes G by a tenth, apart from the factor W^2
PATIENCE = wp.constant(2)  # solutions of an attempt with rows of an earlier one
REST = wp.constant(32)

WIDTH = wp.constant(0)  # columns of `patch_made`
TANGENT = wp.constant(1)
WEIGHT = wp.constant(2)


@kernel
def begin_rows(run: Run, normal: ContactSolve):
    """Per world: starts an attempt, with the rows of G of the previous one if permitted."""
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
    """Whether rows of a pair that were computed at `patch_made` are accurate enough at W = `width`."""
    made = patch.patch_made[w, pair, WIDTH]
    same = (
        patch.patch_made[w, pair, TANGENT] == run.clk[w].retained.acc
        and patch.patch_made[w, pair, WEIGHT] == impulses.weight[w, pair]
    )
    return same and wp.abs(width - made) <= NEAR * made


@kernel
def note_rows(run: Run, normal: ContactSolve, contact: ContactState, impulses: ImpulsiveContact, patch: PatchScratch):
    """Per (world, pair): stores the W, step and weight for which rows are computed."""
    w, pair = wp.tid()
    if run.ctl[w].run == 0 or normal.lasting[w, OLDER] != 0:
        return
    patch.patch_made[w, pair, WIDTH] = contact.patch_width[w, pair]
    patch.patch_made[w, pair, TANGENT] = run.clk[w].retained.acc
    patch.patch_made[w, pair, WEIGHT] = impulses.weight[w, pair]


@kernel
def keep_rows(run: Run, normal: ContactSolve):
    """Per world: discards the rows of an attempt that was not accepted."""
    w = wp.tid()
    if run.ctl[w].attempt != 0 and run.ctl[w].accept == 0:
        normal.lasting[w, ROWS] = 0
