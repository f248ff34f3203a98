r"""The tableau of a group of small-sliding contacts: all dependent numbers as a function of the independent ones.

With s the forces of all cells, y the gaps and slips due to them and to the motion z of the bodies, f their generalised
forces on this motion,

    y = G s + J z + y_0,      f = J^T s,            begins as      (y, f) = T (s, z) + const,   T = [[G, J], [J^T, 0]].

A cell that changes its state has other independent numbers u', v' of its old ones, u' = a u + b v, v' = c u + d v
(`forms`). The table remains that of its original states; cells that have left these are stored separately.
With A their lines in which u' is not u, R = a + b T the lines of b applied to the table, M = R_AA, o all others,

    u_A = M^-1 (u'_A - R_Ao u'_o),       v = T_:A u_A + T_:o u'_o,       v' = c u + d v  of the cells themselves.

M is as large as the number of differing lines. A change only requires its factors, in units in which forces and the
corresponding displacements are of equal size: a cell that alternates, or slips in another direction, leaves the table
unchanged. When A has its maximum number of lines, the table is updated to the present states,

    T'_:o = T_:o - T_:A M^-1 R_Ao,       T'_:A = T_:A M^-1,              and c u + d v of these in the cells' own lines,

at the speed of a matrix product. The table is stored by columns.
"""

import warp as wp

from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.matched.cells import form_of, put_triple, triple
from warpffrf_kernels.matched.forms import SLIP, Form, after, from_form, to_form, unit_of
from warpffrf_kernels.matched.loops import (
    add_columns,
    choose_pivot,
    eliminate,
    mapped_lines,
    scale_columns,
    substitute,
    take_followed,
)
from warpffrf_kernels.matched.status_words import COUNT, DIFFERING, FACTORED, RANK, ROOM

wp.set_module_options(MODULE_OPTIONS)

MOST = 512  # lines of differing cells, and half of all lines if these are fewer


# --- start of a group's numbers


@wp.func
def cells_of(model: Model, group: int) -> int:
    return model.elements[0].matched[0].cell_start[group + 1] - model.elements[0].matched[0].cell_start[group]


@wp.func
def columns_of(model: Model, group: int) -> int:
    """Coordinates z of the motion."""
    return model.elements[0].matched[0].column_start[group + 1] - model.elements[0].matched[0].column_start[group]


@wp.func
def unknowns_of(model: Model, group: int) -> int:
    return model.elements[0].matched[0].components[group] * cells_of(model, group)


@wp.func
def line_at(model: Model, w: int, group: int) -> int:
    """Flat start of the numbers with one entry per line of the tableau."""
    total = model.elements[0].matched[0].line_start[model.elements[0].matched[0].count]
    return w * total + model.elements[0].matched[0].line_start[group]


@wp.func
def lines_of(model: Model, group: int) -> int:
    return model.elements[0].matched[0].line_start[group + 1] - model.elements[0].matched[0].line_start[group]


@wp.func
def table_at(model: Model, w: int, group: int) -> int:
    total = model.elements[0].matched[0].table_start[model.elements[0].matched[0].count]
    return w * total + model.elements[0].matched[0].table_start[group]


@wp.func
def most_of(model: Model, group: int) -> int:
    """Maximum number of lines of differing cells."""
    return model.elements[0].matched[0].differing_start[group + 1] - model.elements[0].matched[0].differing_start[group]


@wp.func
def slots_at(model: Model, w: int, group: int) -> int:
    """Flat start of the numbers with one entry per line of A."""
    total = model.elements[0].matched[0].differing_start[model.elements[0].matched[0].count]
    return w * total + model.elements[0].matched[0].differing_start[group]


@wp.func
def factor_at(model: Model, w: int, group: int) -> int:
    total = model.elements[0].matched[0].factor_start[model.elements[0].matched[0].count]
    return w * total + model.elements[0].matched[0].factor_start[group]


# --- cells that differ from the states of the table


@wp.func
def is_same(a: Form, b: Form) -> bool:
    if a.state != b.state:
        return False
    return a.state != SLIP or (a.d[0] == b.d[0] and a.d[1] == b.d[1] and a.kappa == b.kappa)


@wp.func
def differs(b: mat33, a: mat33, i: int) -> bool:
    """Whether u' differs from u in line i."""
    own = wp.abs(a[i, i] - real(1.0)) + wp.abs(a[i, (i + 1) % 3]) + wp.abs(a[i, (i + 2) % 3])
    return own + wp.abs(b[i, 0]) + wp.abs(b[i, 1]) + wp.abs(b[i, 2]) > real(0.0)


@wp.func
def gather_differing(model: Model, w: int, group: int, tableau: MatchedScratch):
    """Numbers the differing cells (`matched_slot`, -1 for others) and their lines (`matched_place`), stores their
    maps; by one lane."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    lines = line_at(model, w, group)
    slots = slots_at(model, w, group)
    yields = model.elements[0].matched[0].yields[group]
    x = int(0)
    r = int(0)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        mu = model.elements[0].matched[0].friction[cell]
        before = form_of(w, cell, mu, tableau.matched_base, tableau.matched_base_target_form)
        now = form_of(w, cell, mu, tableau.matched_mode, tableau.matched_target_form)
        tableau.matched_slot[w, cell] = -1
        for i in range(3):
            if i < components:
                tableau.matched_place[lines + components * c + i] = -1
        if not is_same(before, now):
            map = after(to_form(now), from_form(before))
            a = map.a
            tableau.matched_slot[w, cell] = x
            at = 3 * (slots + x)
            tableau.matched_maps[at + 1] = map.c
            tableau.matched_maps[at + 2] = map.d
            tableau.matched_owner[slots + x] = components * c
            x += 1
            for i in range(3):
                if i < components and differs(map.b, map.a, i):
                    tableau.matched_place[lines + components * c + i] = r
                    tableau.matched_active[slots + r] = components * c + i
                    unit = unit_of(now, i, yields)
                    tableau.matched_units[2 * (slots + r)] = unit
                    tableau.matched_units[2 * (slots + r) + 1] = unit_of(before, i, yields)
                    for j in range(3):
                        a[i, j] = a[i, j] / unit
                        tableau.matched_rows[3 * (slots + r) + j] = map.b[i, j] / unit
                    r += 1
            tableau.matched_maps[at] = a
        c += 1
    c = int(0)
    while c < columns_of(model, group):
        tableau.matched_place[lines + unknowns_of(model, group) + c] = -1
        c += 1
    tableau.matched_words[w, group, DIFFERING] = x
    tableau.matched_words[w, group, RANK] = r


@wp.func
def factorise(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """Factors of M for the present states, unless they are up to date."""
    stands = tableau.matched_words[w, group, FACTORED]
    sync()
    if stands != 0:
        return
    components = model.elements[0].matched[0].components[group]
    all = lines_of(model, group)
    slots = slots_at(model, w, group)
    factor = factor_at(model, w, group)
    most = most_of(model, group)
    if lane == 0:
        gather_differing(model, w, group, tableau)
        tableau.matched_words[w, group, FACTORED] = 1
        tableau.matched_words[w, group, ROOM] = most - tableau.matched_words[w, group, RANK]
    sync()
    rank = tableau.matched_words[w, group, RANK]
    mapped_lines(
        components, rank, rank, tableau.matched_active, slots, tableau.matched_table, table_at(model, w, group), all,
        tableau.matched_active, slots, tableau.matched_rows, tableau.matched_factor, factor, 1, most,
    )  # fmt: skip
    sync()
    if lane == 0:
        x = int(0)
        while x < tableau.matched_words[w, group, DIFFERING]:
            a = tableau.matched_maps[3 * (slots + x)]
            own = line_at(model, w, group) + tableau.matched_owner[slots + x]
            for i in range(3):
                for j in range(3):
                    if i < components and j < components:
                        r = tableau.matched_place[own + i]
                        s = tableau.matched_place[own + j]
                        if r >= 0 and s >= 0:
                            tableau.matched_factor[factor + s * most + r] = (
                                tableau.matched_factor[factor + s * most + r] + a[i, j]
                            )
            x += 1
    sync()
    scale_columns(rank, most, tableau.matched_units, slots, tableau.matched_factor, factor)
    sync()
    k = int(0)
    while k < rank:
        if lane == 0:
            choose_pivot(rank, k, most, tableau.matched_factor, factor, tableau.matched_pivot, slots)
        sync()
        eliminate(rank, k, most, tableau.matched_factor, factor)
        sync()
        k += 1


@wp.func
def slot_of(model: Model, w: int, group: int, line: int, matched_slot: wp.array2d(dtype=int)) -> int:
    """Slot of the cell of a line, -1 if it does not differ and for lines of the motion."""
    if line >= unknowns_of(model, group):
        return -1
    cell = model.elements[0].matched[0].cell_start[group] + line / model.elements[0].matched[0].components[group]
    return matched_slot[w, cell]


@wp.func
def ask(model: Model, w: int, group: int, line: int, by: real, tableau: MatchedScratch):
    """M u_A (`matched_weight`) for a change `by` of u' of `line`; by one lane."""
    components = model.elements[0].matched[0].components[group]
    all = lines_of(model, group)
    lines = line_at(model, w, group)
    slots = slots_at(model, w, group)
    place = tableau.matched_place[lines + line]
    if place >= 0:
        tableau.matched_weight[slots + place] = (
            tableau.matched_weight[slots + place] + by / tableau.matched_units[2 * (slots + place)]
        )
    else:
        take_followed(
            components, tableau.matched_words[w, group, RANK], by, tableau.matched_table,
            table_at(model, w, group) + line * all, tableau.matched_active, slots, tableau.matched_rows,
            tableau.matched_weight,
        )  # fmt: skip
        slot = slot_of(model, w, group, line, tableau.matched_slot)
        if slot >= 0:
            a = tableau.matched_maps[3 * (slots + slot)]
            for i in range(3):
                if i < components:
                    own = tableau.matched_place[lines + line - line % components + i]
                    if own >= 0:
                        tableau.matched_weight[slots + own] = (
                            tableau.matched_weight[slots + own] - a[i, line % components] * by
                        )


@wp.func
def part_of(components: int, own: int, lines: int, slots: int, tableau: MatchedScratch) -> vec3:
    """u_A of a cell whose lines begin at `own`, 0 in its other lines."""
    u = vec3(real(0.0))
    for i in range(3):
        if i < components:
            place = tableau.matched_place[lines + own + i]
            if place >= 0:
                u[i] = tableau.matched_weight[slots + place]
    return u


@wp.func
def go_ahead(model: Model, w: int, group: int, lane: int, tableau: MatchedScratch):
    """v' += T' du', du' the COUNT listed changes of independent numbers; M is factorised."""
    components = model.elements[0].matched[0].components[group]
    n = unknowns_of(model, group)
    all = lines_of(model, group)
    lines = line_at(model, w, group)
    base = table_at(model, w, group)
    slots = slots_at(model, w, group)
    rank = tableau.matched_words[w, group, RANK]
    differing = tableau.matched_words[w, group, DIFFERING]
    count = tableau.matched_words[w, group, COUNT]
    sync()
    if count == 0:
        return
    if lane == 0:
        r = int(0)
        while r < rank:
            tableau.matched_weight[slots + r] = real(0.0)
            r += 1
        others = int(0)
        k = int(0)
        while k < count:
            line = tableau.matched_list[lines + k]
            by = tableau.matched_given[lines + k]
            ask(model, w, group, line, by, tableau)
            if tableau.matched_place[lines + line] < 0:
                tableau.matched_list[lines + others] = line
                tableau.matched_given[lines + others] = by
                others += 1
            k += 1
        tableau.matched_words[w, group, COUNT] = others
        substitute(
            rank, most_of(model, group), tableau.matched_factor, factor_at(model, w, group), tableau.matched_pivot,
            tableau.matched_units, tableau.matched_weight, slots,
        )  # fmt: skip
        x = int(0)
        while x < differing:  # stores these cells' numbers separately while their lines contain v
            own = lines + tableau.matched_owner[slots + x]
            put_triple(tableau.matched_before, 3 * (slots + x), 3, triple(tableau.matched_v, own, components))
            put_triple(tableau.matched_v, own, components, vec3(real(0.0)))
            x += 1
    sync()
    others = tableau.matched_words[w, group, COUNT]
    add_columns(
        n,
        others,
        tableau.matched_list,
        lines,
        tableau.matched_given,
        lines,
        tableau.matched_table,
        base,
        all,
        tableau.matched_v,
        lines,
    )
    add_columns(
        n, rank, tableau.matched_active, slots, tableau.matched_weight, slots, tableau.matched_table, base, all,
        tableau.matched_v, lines,
    )  # fmt: skip
    sync()
    if lane == 0:
        x = int(0)
        while x < differing:
            own = tableau.matched_owner[slots + x]
            u = part_of(components, own, lines, slots, tableau)
            v = triple(tableau.matched_v, lines + own, components)
            v = tableau.matched_maps[3 * (slots + x) + 1] * u + tableau.matched_maps[3 * (slots + x) + 2] * v
            put_triple(
                tableau.matched_v, lines + own, components, v + triple(tableau.matched_before, 3 * (slots + x), 3)
            )
            x += 1
        k = int(0)
        while k < others:  # u' equal to u, of cells that differ in other lines
            line = tableau.matched_list[lines + k]
            slot = slot_of(model, w, group, line, tableau.matched_slot)
            if slot >= 0:
                c = tableau.matched_maps[3 * (slots + slot) + 1]
                own = lines + line - line % components
                for i in range(3):
                    if i < components:
                        tableau.matched_v[own + i] = (
                            tableau.matched_v[own + i] + c[i, line % components] * tableau.matched_given[lines + k]
                        )
            k += 1
    sync()


@wp.func
def respond(model: Model, w: int, group: int, line: int, tableau: MatchedScratch):
    """u_A (`matched_weight`) for a unit of u' of `line`; by one lane."""
    slots = slots_at(model, w, group)
    rank = tableau.matched_words[w, group, RANK]
    r = int(0)
    while r < rank:
        tableau.matched_weight[slots + r] = real(0.0)
        r += 1
    ask(model, w, group, line, real(1.0), tableau)
    substitute(
        rank, most_of(model, group), tableau.matched_factor, factor_at(model, w, group), tableau.matched_pivot,
        tableau.matched_units, tableau.matched_weight, slots,
    )  # fmt: skip


@wp.func
def own_block(model: Model, w: int, group: int, c: int, tableau: MatchedScratch) -> mat33:
    """T'_cc of cell c of a group; for cells without friction its single number, the others being isolated. By one
    lane."""
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    slots = slots_at(model, w, group)
    all = lines_of(model, group)
    own = components * c
    base = table_at(model, w, group) + own
    slot = slot_of(model, w, group, own, tableau.matched_slot)
    block = wp.identity(n=3, dtype=real)
    for j in range(3):
        if j < components:
            respond(model, w, group, own + j, tableau)
            u = part_of(components, own, lines, slots, tableau)
            v = vec3(real(0.0))
            if tableau.matched_place[lines + own + j] < 0:
                u[j] = real(1.0)
                v = triple(tableau.matched_table, base + (own + j) * all, components)
            r = int(0)
            while r < tableau.matched_words[w, group, RANK]:
                v += tableau.matched_weight[slots + r] * triple(
                    tableau.matched_table, base + tableau.matched_active[slots + r] * all, components
                )
                r += 1
            if slot >= 0:
                v = tableau.matched_maps[3 * (slots + slot) + 1] * u + tableau.matched_maps[3 * (slots + slot) + 2] * v
            for i in range(3):
                if i < components:
                    block[i, j] = v[i]
    return block
