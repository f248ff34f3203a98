"""State changes of cells, and updates of the table of their tableau if too many differ from the states of the table.

See `tableau`.
"""

import warp as wp

from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.state import MatchedState
from warpffrf_kernels.matched.cells import form_of, put_triple, set_form, triple
from warpffrf_kernels.matched.forms import OPEN, Form, after, first_of, from_form, second_of, to_form
from warpffrf_kernels.matched.loops import add_product, mapped_lines, substitute_lines, take_columns
from warpffrf_kernels.matched.passes import pressed_state, requested
from warpffrf_kernels.matched.status_words import (
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
from warpffrf_kernels.matched.tableau import (
    cells_of,
    factor_at,
    factorise,
    line_at,
    lines_of,
    most_of,
    slots_at,
    table_at,
)

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def renew(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """Updates the table to the states for which M is factorised."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    all = lines_of(model, group)
    base = table_at(model, w, group)
    lines = line_at(model, w, group)
    slots = slots_at(model, w, group)
    updates = w * model.elements[0].matched[0].update_start[model.elements[0].matched[0].count]
    updates += model.elements[0].matched[0].update_start[group]
    most = most_of(model, group)
    rank = tableau.matched_words[w, group, RANK]
    differing = tableau.matched_words[w, group, DIFFERING]
    mapped_lines(
        components, rank, all, tableau.matched_active, -1, tableau.matched_table, base, all, tableau.matched_active,
        slots, tableau.matched_rows, tableau.matched_right, updates, all, 1,
    )  # fmt: skip
    sync()
    j = lane
    while j < all:  # -R_A, and 1 in the columns of A
        place = tableau.matched_place[lines + j]
        r = int(0)
        while r < rank:
            at = updates + r * all + j
            tableau.matched_right[at] = -tableau.matched_right[at]
            if place >= 0:
                tableau.matched_right[at] = wp.where(
                    place == r, real(1.0) / tableau.matched_units[2 * (slots + r)], real(0.0)
                )
            r += 1
        j += wp.block_dim()
    sync()
    if lane == 0:
        x = int(0)
        while x < differing:
            own = tableau.matched_owner[slots + x]
            a = tableau.matched_maps[3 * (slots + x)]
            for i in range(3):
                for j in range(3):
                    if i < components and j < components:
                        place = tableau.matched_place[lines + own + i]
                        if place >= 0 and tableau.matched_place[lines + own + j] < 0:
                            at = updates + place * all + own + j
                            tableau.matched_right[at] = tableau.matched_right[at] - a[i, j]
            x += 1
    take_columns(rank, all, tableau.matched_active, slots, tableau.matched_table, base, tableau.matched_left, updates)
    sync()
    substitute_lines(
        rank, all, most, tableau.matched_factor, factor_at(model, w, group), tableau.matched_pivot,
        tableau.matched_units, slots, tableau.matched_right, updates,
    )  # fmt: skip
    sync()
    add_product(all, rank, tableau.matched_left, tableau.matched_right, updates, tableau.matched_table, base)
    sync()
    j = lane
    while j < all:
        x = int(0)
        while x < differing:
            own = tableau.matched_owner[slots + x]
            at = 3 * (slots + x)
            u = vec3(real(0.0))
            for i in range(3):
                if i < components:
                    place = tableau.matched_place[lines + own + i]
                    if place >= 0:
                        u[i] = tableau.matched_right[updates + place * all + j]
                    elif j == own + i:
                        u[i] = real(1.0)
            v = tableau.matched_maps[at + 1] * u + tableau.matched_maps[at + 2] * triple(
                tableau.matched_table, base + j * all + own, components
            )
            put_triple(tableau.matched_table, base + j * all + own, components, v)
            x += 1
        j += wp.block_dim()
    sync()
    if lane == 0:
        c = int(0)
        while c < cells_of(model, group):
            set_form(
                w, first + c, form_of(w, first + c, real(0.0), tableau.matched_mode, tableau.matched_target_form),
                    tableau.matched_base,
                tableau.matched_base_target_form,
            )  # fmt: skip
            c += 1
        tableau.matched_words[w, group, FACTORED] = 0
        tableau.matched_words[w, group, ROOM] = most
    sync()


@wp.func
def make_room(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """Makes room for one more cell that is to change: at the maximum number of differing cells, updates the table."""
    components = model.elements[0].matched[0].components[group]
    if tableau.matched_words[w, group, ROOM] < components:
        sync()
        factorise(model, w, group, lane, tableau)
        if tableau.matched_words[w, group, ROOM] < components:
            renew(model, w, group, lane, tableau)
    sync()
    if lane == 0:
        tableau.matched_words[w, group, ROOM] = tableau.matched_words[w, group, ROOM] - components
        tableau.matched_words[w, group, FACTORED] = 0
    sync()


@wp.func
def press_cells(model: Model, w: int, group: int, lane: int, matched: MatchedState, tableau: MatchedScratch):
    """Cells that were under pressure, and those initially in contact, stick; others are open. The first table of a
    tableau is computed for these states."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    ready = tableau.matched_words[w, group, READY]
    sync()
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        form = Form()
        form.mu = model.elements[0].matched[0].friction[cell]
        form.state = OPEN
        if matched.matched_state[w, cell] != OPEN or model.elements[0].matched[0].gap[cell] == real(0.0):
            form.state = pressed_state(form.mu, components)
        if tableau.matched_mode[w, cell] != form.state:
            make_room(model, w, group, lane, tableau)
            if lane == 0:
                set_form(w, cell, form, tableau.matched_mode, tableau.matched_target_form)
            sync()
        c += 1
    if ready == NONE:
        factorise(model, w, group, lane, tableau)
        renew(model, w, group, lane, tableau)
    if lane == 0:
        tableau.matched_words[w, group, READY] = STANDS
    sync()


@wp.func
def change_cells(model: Model, w: int, group: int, lane: int, both: bool, tableau: MatchedScratch) -> bool:
    """Applies requested state changes: gaps and pressures first; if none of them changes, or with `both`, also stick
    and slip. Returns whether any state has changed."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    lines = line_at(model, w, group)
    along = both or tableau.matched_words[w, group, NORMAL] == 0
    changed = bool(False)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        request = tableau.matched_request[w, cell]
        if request == CLOSES or request == OPENS or (along and (request == RUBS or request == TURNS)):
            make_room(model, w, group, lane, tableau)
            if lane == 0:
                mu = model.elements[0].matched[0].friction[cell]
                form = requested(w, cell, mu, components, tableau)
                map = after(
                    to_form(form), from_form(form_of(w, cell, mu, tableau.matched_mode, tableau.matched_target_form))
                )
                u = triple(tableau.matched_u, lines + components * c, components)
                v = triple(tableau.matched_v, lines + components * c, components)
                put_triple(tableau.matched_u, lines + components * c, components, first_of(map, u, v))
                put_triple(tableau.matched_v, lines + components * c, components, second_of(map, u, v))
                set_form(w, cell, form, tableau.matched_mode, tableau.matched_target_form)
            sync()
            changed = changed or request != TURNS
        c += 1
    return changed
