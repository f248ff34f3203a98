"""Scratch arrays, recomputed in each step. Those that are `carried` keep values of an earlier attempt or of the
set-up of the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from warpffrf.online.arrays.axes import Sizes
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.arrays.state import State
from warpffrf.online.compile.scene import CompiledScene
from warpffrf_kernels.core.contact_scratch import (
    ContactFields,
    ContactGeometry,
    ContactSolve,
    LayerScratch,
    LumpedContacts,
    PatchScratch,
    RollingScratch,
)  # fmt: skip
from warpffrf_kernels.core.declaration import DeviceArray, declared_in, structs
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem, RunWords, Trial
from warpffrf_kernels.kinematics.contact_wrench import Held
from warpffrf_kernels.lumped.forces import Load
from warpffrf_kernels.lumped.moments import Moment
from warpffrf_kernels.patch.cells import Row

RESTORED = {name: declaration for name, declaration in State.declarations.items() if declaration.restored}


class Before(Arrays):
    """What a rejected attempt restores: arrays of the state as they were before the attempt."""

    declarations = {
        f"{name}_before": replace(d, carried=False, restored=False, note="before the attempt")
        for name, d in RESTORED.items()
    }


class Frames(Arrays):
    """Arrays of structs that kernels define and take as separate arguments."""

    held: DeviceArray = structs(Held, "world", "pair", "column_point", note="contact frames, see `contact_wrench`")
    patch_row: DeviceArray = structs(Row, "world", "patch_pair", "patch_row", note="what its cells have in common")
    lumped_load: DeviceArray = structs(Load, "world", "lumped_place", note="force on the first body, what moves it")
    lumped_moment: DeviceArray = structs(Moment, "world", "lumped_moment", note="on the first body, see `moments`")


class Scratch(
    RunWords, Trial, Residuals, RetainedSystem, ImpulsiveContact, ContactGeometry, PatchScratch, RollingScratch,
    ContactFields, ContactSolve, LayerScratch, FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve, LumpedContacts,
    FilmScratch, MatchedScratch, Frames, Before, Arrays,
):  # fmt: skip
    """Scratch arrays of a step."""


KEPT = tuple(
    name
    for part in (PatchScratch, RollingScratch, FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve)
    for name, declaration in declared_in(part).items()
    if declaration.carried
)
"""With friction on contact-fixed cells: their compliances and factors, which are reused from step to step while they
are accurate enough."""
KEPT_OF_PATCHES = (
    "patch_change", "patch_steady", "patch_made", "lasting", "slot_of", "slot_node", "J", "G", "order", "block",
    "factor",
)  # fmt: skip
"""Without it: what an attempt starts from, and rows of G that are kept from step to step. (Tables that are carried as
well are bitwise the same whenever they are computed.)"""


def scratch_for(worlds: Sequence[CompiledScene], sizes: Sizes, state: State) -> Scratch:
    """Scratch arrays of a run of `worlds`, with the constants of interfaces set."""
    scratch = Scratch(sizes, worlds[0].device, state)
    scratch.film_stretch.fill_(1.0)
    scratch.slope.assign(np.concatenate([compiled.interface_modes.ravel() for compiled in worlds]))
    return scratch
