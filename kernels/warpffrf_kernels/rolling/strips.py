r"""Products of the compliance of tractions by half-spaces, and of its preconditioner, with the tractions of a patch."""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import StripSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.patch.near import first_level, level_shares
from warpffrf_kernels.patch.spline_tables import line_of
from warpffrf_kernels.patch.strips import (
    inverse_waves_of,
    multiply_strips,
    nearest_level,
    sum_levels,
    wave_numbers,
    waves_of,
)

wp.set_module_options(MODULE_OPTIONS)


@kernel
def lay_spectrum(run: Run, patch: PatchScratch, strips: StripSolve):
    """Per (world, pair), lanes over entries: the blocks of K at the W of the attempt, unless they are those of
    `strip_laid`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    width = patch.patch_place[w, pair, 2]
    if strips.strip_laid[w, pair, 0] == width:
        return
    line = line_of(model.surfaces.rows[model.pairs.first[pair]])
    size = waves_of(elements.patches.columns[pair]) * 4 * line * line
    start = elements.rolling.spectrum_start[pair] + first_level(elements, pair, width) * size
    scale = wp.pow(width, elements.patches.near_power[pair])
    sum_levels(
        elements.rolling.spectrum, start, size, wp.min(elements.patches.near_levels[pair], 4),
        scale * level_shares(elements, pair, width), strips.strip_spectrum,
        (w * model.pairs.count + pair) * elements.rolling.spectrum_numbers,
    )  # fmt: skip
    sync()
    if lane == 0:
        strips.strip_laid[w, pair, 0] = width


@wp.func
def multiply_half_spaces(
    model: Model, elements: Elements, w: int, pair: int, strips: StripSolve, x: wp.array(dtype=real), at_x: int,
    y: wp.array(dtype=real), at_y: int,
):  # fmt: skip
    """y = K of the half-spaces times x, both at places, on A."""
    columns = elements.patches.columns[pair]
    here = w * model.pairs.count + pair
    places = elements.patches.places
    multiply_strips(
        2, columns, model.surfaces.rows[model.pairs.first[pair]], places, waves_of(columns), real(1.0),
        elements.patches.wave, elements.patches.wave_start[pair], strips.strip_spectrum,
        here * elements.rolling.spectrum_numbers, x, at_x, strips.strip_work, here * elements.rolling.strip_numbers, y,
        at_y,
    )  # fmt: skip


@wp.func
def inverse_at(model: Model, elements: Elements, pair: int, width: real) -> int:
    """Start of the preconditioner of a pair at W: its diagonal, then its blocks."""
    line = line_of(model.surfaces.rows[model.pairs.first[pair]])
    size = 2 * line + inverse_waves_of(elements.patches.columns[pair]) * 4 * line * line
    return elements.rolling.inverse_start[pair] + nearest_level(elements, pair, width) * size


@wp.func
def multiply_inverse(model: Model, elements: Elements, w: int, pair: int, width: real, strips: StripSolve):
    """strip_out = the preconditioner times strip_place, on A."""
    columns = elements.patches.columns[pair]
    here = w * model.pairs.count + pair
    places = elements.patches.places
    rows = model.surfaces.rows[model.pairs.first[pair]]
    multiply_strips(
        2, columns, rows, places, inverse_waves_of(columns), wp.pow(width, -elements.patches.near_power[pair]),
        elements.patches.wave, elements.patches.wave_start[pair] + wave_numbers(columns, waves_of(columns)),
        elements.rolling.inverse, inverse_at(model, elements, pair, width) + 2 * line_of(rows), strips.strip_place,
        here * 2 * places, strips.strip_work, here * elements.rolling.strip_numbers, strips.strip_out,
        here * 2 * places,
    )  # fmt: skip
