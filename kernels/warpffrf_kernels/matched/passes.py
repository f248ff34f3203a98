"""A pass over the cells of a group: new values of their independent numbers, and required state changes."""

import warp as wp

from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.matched.cells import NO_PRESSURE, aim_of, form_of, put_triple, triple
from warpffrf_kernels.matched.forms import OPEN, SLIP, SMOOTH, STICK, Form
from warpffrf_kernels.matched.status_words import (
    CLOSES,
    COUNT,
    KNOWN,
    NORMAL,
    OPENS,
    RUBS,
    STAYS,
    TANGENTIAL,
    TURNING,
    TURNS,
)
from warpffrf_kernels.matched.tableau import cells_of, line_at, own_block, unknowns_of

wp.set_module_options(MODULE_OPTIONS)

MIXED = 3  # differences in Anderson's method
RIDGE = wp.constant(wp.float64(1.0e-14))  # of their squares


@wp.func
def largest_force(model: Model, w: int, group: int, lines: int, tableau: MatchedScratch) -> real:
    """Largest force of the cells that are not open [N]."""
    components = model.elements[0].matched[0].components[group]
    first = model.elements[0].matched[0].cell_start[group]
    largest = real(0.0)
    c = int(0)
    while c < cells_of(model, group):
        if tableau.matched_mode[w, first + c] != OPEN:
            largest = wp.max(largest, wp.abs(tableau.matched_v[lines + components * c]))
        c += 1
    return largest


@wp.func
def pressed_state(mu: real, components: int) -> int:
    """State of a cell under pressure before slip is known."""
    if components == 3 and mu == real(0.0):
        return SMOOTH
    return STICK


@wp.func
def product(many: int, n: int, start: int, r: int, c: int, scale: real, matched_rest: wp.array(dtype=real)) -> real:
    """Inner product of differences r and c of the stored steps, or of r and the newest step if c is -1; `scale`
    converts lengths, every second number, to forces."""
    sum = real(0.0)
    i = int(0)
    while i < many:
        weight = real(1.0)
        if i % 2 == 1:
            weight = scale * scale
        other = matched_rest[start + i]
        if c >= 0:
            other = matched_rest[start + c * n + i] - matched_rest[start + (c + 1) * n + i]
        sum += weight * (matched_rest[start + r * n + i] - matched_rest[start + (r + 1) * n + i]) * other
        i += 1
    return sum


@wp.func
def mix(slipping: int, n: int, lines: int, known: int, scale: real, tableau: MatchedScratch) -> int:
    """Anderson's method: the step target - u minus its part explained by the last differences of steps and of u.

    Stored are `known` earlier u and steps, n apart, the newest first; returns their new number. They contain the
    tangential lines of the `slipping` listed cells, given by first lines; `scale` converts lengths to forces.
    """
    start = 4 * lines
    many = 2 * slipping
    slot = wp.min(known, MIXED)
    while slot > 0:
        i = int(0)
        while i < many:
            tableau.matched_guess[start + slot * n + i] = tableau.matched_guess[start + (slot - 1) * n + i]
            tableau.matched_rest[start + slot * n + i] = tableau.matched_rest[start + (slot - 1) * n + i]
            i += 1
        slot -= 1
    i = int(0)
    while i < many:
        line = lines + tableau.matched_list[lines + i / 2] + 1 + i % 2
        tableau.matched_guess[start + i] = tableau.matched_u[line]
        tableau.matched_rest[start + i] = tableau.matched_target[line] - tableau.matched_u[line]
        i += 1
    used = wp.min(known, MIXED)
    A = wp.identity(n=3, dtype=real)
    b = vec3(real(0.0))
    for r in range(MIXED):
        if r < used:
            for c in range(MIXED):
                if c < used:
                    A[r, c] = product(many, n, start, r, c, scale, tableau.matched_rest)
            b[r] = product(many, n, start, r, -1, scale, tableau.matched_rest)
    ridge = RIDGE * wp.trace(A)
    for r in range(MIXED):
        A[r, r] = A[r, r] + ridge
    x = wp.inverse(A) * b
    for r in range(MIXED):
        if r < used and wp.isfinite(x[r]):
            i = int(0)
            while i < many:
                line = lines + tableau.matched_list[lines + i / 2] + 1 + i % 2
                step = tableau.matched_guess[start + r * n + i] - tableau.matched_guess[start + (r + 1) * n + i]
                step += tableau.matched_rest[start + r * n + i] - tableau.matched_rest[start + (r + 1) * n + i]
                tableau.matched_target[line] = tableau.matched_target[line] - x[r] * step
                i += 1
    return wp.min(known + 1, MIXED)


@wp.func
def aim_cells(model: Model, w: int, group: int, tableau: MatchedScratch) -> real:
    """Lists and applies the changes of independent numbers of a pass; returns the largest, over the largest force."""
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    n = unknowns_of(model, group)
    first = model.elements[0].matched[0].cell_start[group]
    yields = model.elements[0].matched[0].yields[group]
    largest = largest_force(model, w, group, lines, tableau)
    turning = int(0)
    slipping = int(0)
    worst = real(0.0)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        at = lines + components * c
        tableau.matched_request[w, cell] = STAYS
        target = vec3(real(0.0))
        if tableau.matched_mode[w, cell] == SLIP:
            form = form_of(
                w, cell, model.elements[0].matched[0].friction[cell], tableau.matched_mode, tableau.matched_target_form
            )
            aim = aim_of(
                form, triple(tableau.matched_u, at, components), triple(tableau.matched_v, at, components), largest,
                model.elements[0].matched[0].own[cell],
            )  # fmt: skip
            target = aim.target
            tableau.matched_list[lines + slipping] = components * c
            slipping += 1
            if aim.far != 0:
                turning += 1
                tableau.matched_request[w, cell] = TURNS
                tableau.matched_next[w, cell, 0] = aim.d[0]
                tableau.matched_next[w, cell, 1] = aim.d[1]
                tableau.matched_next[w, cell, 2] = aim.kappa
            worst = wp.max(worst, wp.abs(target[1] - tableau.matched_u[at + 1]))
            worst = wp.max(worst, wp.abs(target[2] - tableau.matched_u[at + 2]) / yields)
        put_triple(tableau.matched_target, at, components, target)
        c += 1
    tableau.matched_words[w, group, TURNING] = turning
    if tableau.matched_words[w, group, KNOWN] >= 0 and components == 3 and worst > real(0.0):
        tableau.matched_words[w, group, KNOWN] = mix(
            slipping, n, lines, tableau.matched_words[w, group, KNOWN], real(1.0) / yields, tableau
        )
    count = int(0)
    i = int(0)
    while i < n:
        change = tableau.matched_target[lines + i] - tableau.matched_u[lines + i]
        if change != real(0.0):
            tableau.matched_list[lines + count] = i
            tableau.matched_given[lines + count] = change
            tableau.matched_u[lines + i] = tableau.matched_target[lines + i]
            count += 1
        i += 1
    tableau.matched_words[w, group, COUNT] = count
    if largest == real(0.0):
        return worst
    return worst / largest


@wp.func
def judge_cells(model: Model, w: int, group: int, tableau: MatchedScratch, least: real):
    """Cells that must change their state, and the new states; by one lane. Forces below `least` [N] count as zero."""
    components = model.elements[0].matched[0].components[group]
    lines = line_at(model, w, group)
    first = model.elements[0].matched[0].cell_start[group]
    yields = model.elements[0].matched[0].yields[group]
    none = wp.max(NO_PRESSURE * largest_force(model, w, group, lines, tableau), least)
    normal = int(0)
    tangential = int(0)
    c = int(0)
    while c < cells_of(model, group):
        cell = first + c
        at = lines + components * c
        mu = model.elements[0].matched[0].friction[cell]
        v = triple(tableau.matched_v, at, components)
        state = tableau.matched_mode[w, cell]
        if state == OPEN:
            if v[0] < -none * yields:
                normal += 1
                tableau.matched_request[w, cell] = CLOSES
                tableau.matched_next[w, cell, 0] = real(0.0)
                tableau.matched_next[w, cell, 1] = real(0.0)
                if components == 3 and mu > real(0.0):
                    own = own_block(model, w, group, c, tableau)
                    f = -(wp.inverse(own) * v)  # brings it to rest with all others unchanged
                    size = wp.sqrt(f[1] * f[1] + f[2] * f[2])
                    tableau.matched_reversals[w, cell] = tableau.matched_reversals[w, cell] + 1
                    rubs = size > mu * wp.max(f[0], real(0.0))
                    if tableau.matched_reversals[w, cell] % 4 == 3:
                        rubs = not rubs
                    if rubs and size > real(0.0):
                        tableau.matched_next[w, cell, 0] = f[1] / size
                        tableau.matched_next[w, cell, 1] = f[2] / size
        elif v[0] < -none:
            normal += 1
            tableau.matched_request[w, cell] = OPENS
        elif state == STICK and components == 3:
            size = wp.sqrt(v[1] * v[1] + v[2] * v[2])
            if size > mu * v[0] + none and size > real(0.0):
                tangential += 1
                tableau.matched_request[w, cell] = RUBS
                tableau.matched_next[w, cell, 0] = v[1] / size
                tableau.matched_next[w, cell, 1] = v[2] / size
        elif state == SLIP and v[1] > none * yields:
            tangential += 1
            tableau.matched_request[w, cell] = RUBS
            tableau.matched_next[w, cell, 0] = real(0.0)
            tableau.matched_next[w, cell, 1] = real(0.0)
        c += 1
    tableau.matched_words[w, group, NORMAL] = normal
    tableau.matched_words[w, group, TANGENTIAL] = tangential


@wp.func
def requested(w: int, cell: int, mu: real, components: int, tableau: MatchedScratch) -> Form:
    """The state that a cell is to change to."""
    form = Form()
    form.mu = mu
    form.d = wp.vec2d(tableau.matched_next[w, cell, 0], tableau.matched_next[w, cell, 1])
    if tableau.matched_request[w, cell] == TURNS:
        form.state = SLIP
        form.kappa = tableau.matched_next[w, cell, 2]
    elif tableau.matched_request[w, cell] == OPENS:
        form.state = OPEN
        form.d = wp.vec2d(real(0.0), real(0.0))
    elif form.d[0] != real(0.0) or form.d[1] != real(0.0):
        form.state = SLIP
    else:
        form.state = pressed_state(mu, components)
    return form
