"""Cells change their states, and the table of their tableau follows where too many differ from those of its making.

See `tableau`.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.laps.cells import form_of, put_triple, set_form, triple
from warpffrf_kernels.laps.forms import OPEN, Form, after, first_of, from_form, second_of, to_form
from warpffrf_kernels.laps.loops import add_product, mapped_lines, substitute_lines, take_columns
from warpffrf_kernels.laps.passes import pressed_state, wished
from warpffrf_kernels.laps.tableau import (
    cells_of,
    factor_at,
    factorise,
    line_at,
    lines_of,
    most_of,
    slots_at,
    table_at,
)
from warpffrf_kernels.laps.words import (
    CLOSES,
    DIFFERING,
    FACTORED,
    NONE,
    NORMAL,
    OPENS,
    RANK,
    READY,
    ROOM,
    RUBS,
    STANDS,
    TURNS,
)

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def renew(
    model: Model,
    w: int,
    group: int,
    lane: int,
    lap_mode: wp.array2d(dtype=int),
    lap_aim: wp.array3d(dtype=real),
    lap_base: wp.array2d(dtype=int),
    lap_base_aim: wp.array3d(dtype=real),
    lap_table: wp.array(dtype=real),
    lap_words: wp.array3d(dtype=int),
    lap_place: wp.array(dtype=int),
    lap_owner: wp.array(dtype=int),
    lap_active: wp.array(dtype=int),
    lap_rows: wp.array(dtype=real),
    lap_units: wp.array(dtype=real),
    lap_maps: wp.array(dtype=mat33),
    lap_factor: wp.array(dtype=real),
    lap_pivot: wp.array(dtype=int),
    lap_left: wp.array(dtype=real),
    lap_right: wp.array(dtype=real),
):
    """The table becomes that of the states that M has its factors for."""
    components = model.elements[0].laps[0].components[group]
    first = model.elements[0].laps[0].cell_start[group]
    all = lines_of(model, group)
    base = table_at(model, w, group)
    lines = line_at(model, w, group)
    slots = slots_at(model, w, group)
    updates = w * model.elements[0].laps[0].update_start[model.elements[0].laps[0].count]
    updates += model.elements[0].laps[0].update_start[group]
    most = most_of(model, group)
    rank = lap_words[w, group, RANK]
    differing = lap_words[w, group, DIFFERING]
    mapped_lines(
        components, rank, all, lap_active, -1, lap_table, base, all, lap_active, slots, lap_rows, lap_right, updates,
        all, 1,
    )  # fmt: skip
    sync()
    j = lane
    while j < all:  # -R_A, and 1 in the columns of A
        place = lap_place[lines + j]
        r = int(0)
        while r < rank:
            at = updates + r * all + j
            lap_right[at] = -lap_right[at]
            if place >= 0:
                lap_right[at] = wp.where(place == r, real(1.0) / lap_units[2 * (slots + r)], real(0.0))
            r += 1
        j += wp.block_dim()
    sync()
    if lane == 0:
        x = int(0)
        while x < differing:
            own = lap_owner[slots + x]
            a = lap_maps[3 * (slots + x)]
            for i in range(3):
                for j in range(3):
                    if i < components and j < components:
                        place = lap_place[lines + own + i]
                        if place >= 0 and lap_place[lines + own + j] < 0:
                            at = updates + place * all + own + j
                            lap_right[at] = lap_right[at] - a[i, j]
            x += 1
    take_columns(rank, all, lap_active, slots, lap_table, base, lap_left, updates)
    sync()
    substitute_lines(
        rank, all, most, lap_factor, factor_at(model, w, group), lap_pivot, lap_units, slots, lap_right, updates
    )
    sync()
    add_product(all, rank, lap_left, lap_right, updates, lap_table, base)
    sync()
    j = lane
    while j < all:
        x = int(0)
        while x < differing:
            own = lap_owner[slots + x]
            at = 3 * (slots + x)
            u = vec3(real(0.0))
            for i in range(3):
                if i < components:
                    place = lap_place[lines + own + i]
                    if place >= 0:
                        u[i] = lap_right[updates + place * all + j]
                    elif j == own + i:
                        u[i] = real(1.0)
            v = lap_maps[at + 1] * u + lap_maps[at + 2] * triple(lap_table, base + j * all + own, components)
            put_triple(lap_table, base + j * all + own, components, v)
            x += 1
        j += wp.block_dim()
    sync()
    if lane == 0:
        c = int(0)
        while c < cells_of(model, group):
            set_form(w, first + c, form_of(w, first + c, real(0.0), lap_mode, lap_aim), lap_base, lap_base_aim)
            c += 1
        lap_words[w, group, FACTORED] = 0
        lap_words[w, group, ROOM] = most
    sync()


@wp.func
def make_room(
    model: Model,
    w: int,
    group: int,
    lane: int,
    lap_mode: wp.array2d(dtype=int),
    lap_aim: wp.array3d(dtype=real),
    lap_base: wp.array2d(dtype=int),
    lap_base_aim: wp.array3d(dtype=real),
    lap_table: wp.array(dtype=real),
    lap_words: wp.array3d(dtype=int),
    lap_slot: wp.array2d(dtype=int),
    lap_place: wp.array(dtype=int),
    lap_owner: wp.array(dtype=int),
    lap_active: wp.array(dtype=int),
    lap_rows: wp.array(dtype=real),
    lap_units: wp.array(dtype=real),
    lap_maps: wp.array(dtype=mat33),
    lap_factor: wp.array(dtype=real),
    lap_pivot: wp.array(dtype=int),
    lap_left: wp.array(dtype=real),
    lap_right: wp.array(dtype=real),
):
    """For one more cell that is to change: where as many as there may be differ, the table is made anew."""
    components = model.elements[0].laps[0].components[group]
    if lap_words[w, group, ROOM] < components:
        sync()
        factorise(
            model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
            lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot,
        )  # fmt: skip
        if lap_words[w, group, ROOM] < components:
            renew(
                model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words,
                lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_left,
                lap_right,
            )  # fmt: skip
    sync()
    if lane == 0:
        lap_words[w, group, ROOM] = lap_words[w, group, ROOM] - components
        lap_words[w, group, FACTORED] = 0
    sync()


@wp.func
def press_cells(
    model: Model,
    w: int,
    group: int,
    lane: int,
    lap_state: wp.array2d(dtype=int),
    lap_mode: wp.array2d(dtype=int),
    lap_aim: wp.array3d(dtype=real),
    lap_base: wp.array2d(dtype=int),
    lap_base_aim: wp.array3d(dtype=real),
    lap_table: wp.array(dtype=real),
    lap_words: wp.array3d(dtype=int),
    lap_slot: wp.array2d(dtype=int),
    lap_place: wp.array(dtype=int),
    lap_owner: wp.array(dtype=int),
    lap_active: wp.array(dtype=int),
    lap_rows: wp.array(dtype=real),
    lap_units: wp.array(dtype=real),
    lap_maps: wp.array(dtype=mat33),
    lap_factor: wp.array(dtype=real),
    lap_pivot: wp.array(dtype=int),
    lap_left: wp.array(dtype=real),
    lap_right: wp.array(dtype=real),
):
    """Cells that have been under pressure, and those that lie on each other to begin with, stick; others are open. The
    first table of a tableau is made for these states."""
    components = model.elements[0].laps[0].components[group]
    first = model.elements[0].laps[0].cell_start[group]
    ready = lap_words[w, group, READY]
    sync()
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        form = Form()
        form.mu = model.elements[0].laps[0].friction[cell]
        form.state = OPEN
        if lap_state[w, cell] != OPEN or model.elements[0].laps[0].gap[cell] == real(0.0):
            form.state = pressed_state(form.mu, components)
        if lap_mode[w, cell] != form.state:
            make_room(
                model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
                lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_left,
                lap_right,
            )  # fmt: skip
            if lane == 0:
                set_form(w, cell, form, lap_mode, lap_aim)
            sync()
        c += 1
    if ready == NONE:
        factorise(
            model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
            lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot,
        )  # fmt: skip
        renew(
            model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_place,
            lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_left, lap_right,
        )  # fmt: skip
    if lane == 0:
        lap_words[w, group, READY] = STANDS
    sync()


@wp.func
def change_cells(
    model: Model,
    w: int,
    group: int,
    lane: int,
    both: bool,
    lap_wish: wp.array2d(dtype=int),
    lap_next: wp.array3d(dtype=real),
    lap_mode: wp.array2d(dtype=int),
    lap_aim: wp.array3d(dtype=real),
    lap_u: wp.array(dtype=real),
    lap_v: wp.array(dtype=real),
    lap_base: wp.array2d(dtype=int),
    lap_base_aim: wp.array3d(dtype=real),
    lap_table: wp.array(dtype=real),
    lap_words: wp.array3d(dtype=int),
    lap_slot: wp.array2d(dtype=int),
    lap_place: wp.array(dtype=int),
    lap_owner: wp.array(dtype=int),
    lap_active: wp.array(dtype=int),
    lap_rows: wp.array(dtype=real),
    lap_units: wp.array(dtype=real),
    lap_maps: wp.array(dtype=mat33),
    lap_factor: wp.array(dtype=real),
    lap_pivot: wp.array(dtype=int),
    lap_left: wp.array(dtype=real),
    lap_right: wp.array(dtype=real),
) -> bool:
    """Cells become what they are asked to: gaps and pressures first, and where none of them changes or with `both`,
    what sticks and slips. Whether any has another state then."""
    components = model.elements[0].laps[0].components[group]
    first = model.elements[0].laps[0].cell_start[group]
    lines = line_at(model, w, group)
    along = both or lap_words[w, group, NORMAL] == 0
    changed = bool(False)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        wish = lap_wish[w, cell]
        if wish == CLOSES or wish == OPENS or (along and (wish == RUBS or wish == TURNS)):
            make_room(
                model, w, group, lane, lap_mode, lap_aim, lap_base, lap_base_aim, lap_table, lap_words, lap_slot,
                lap_place, lap_owner, lap_active, lap_rows, lap_units, lap_maps, lap_factor, lap_pivot, lap_left,
                lap_right,
            )  # fmt: skip
            if lane == 0:
                mu = model.elements[0].laps[0].friction[cell]
                form = wished(w, cell, mu, components, lap_wish, lap_next)
                map = after(to_form(form), from_form(form_of(w, cell, mu, lap_mode, lap_aim)))
                u = triple(lap_u, lines + components * c, components)
                v = triple(lap_v, lines + components * c, components)
                put_triple(lap_u, lines + components * c, components, first_of(map, u, v))
                put_triple(lap_v, lines + components * c, components, second_of(map, u, v))
                set_form(w, cell, form, lap_mode, lap_aim)
            sync()
            changed = changed or wish != TURNS
        c += 1
    return changed
