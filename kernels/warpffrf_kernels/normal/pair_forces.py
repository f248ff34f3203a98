"""Generalised forces of a pair: on both bodies (12,), force (world axes) and torque (body axes) on A, then those on B;
and on the modes of A, then of B. Normal forces and friction are stored separately; entry 0 is the accepted state, 1 the
trial state."""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Trial

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def surface_of(model: Model, pair: int, side: int) -> int:
    """The first (0) or the second (1) surface of a pair."""
    if side == 0:
        return model.pairs.first[pair]
    return model.pairs.second[pair]


@wp.func
def force_on(model: Model, force: wp.array4d(dtype=real), w: int, pair: int, side: int, b: int):
    """Force (world axes) and torque (body axes) of a pair on body b, entry `side` of `force` (W, P, sides, 12)."""
    f = vec3(real(0.0), real(0.0), real(0.0))
    t = vec3(real(0.0), real(0.0), real(0.0))
    for i in range(2):
        if model.surfaces.body[surface_of(model, pair, i)] == b:
            for c in range(3):
                f[c] = f[c] + force[w, pair, side, 6 * i + c]
                t[c] = t[c] + force[w, pair, side, 6 * i + 3 + c]
    return f, t


@wp.func
def modal_place(model: Model, pair: int, n: int) -> int:
    """Index of mode n of all modes among those of a pair's two bodies; -1 if it belongs to neither."""
    A = model.pairs.first[pair]
    count = model.surfaces.modal_count[A]
    at = n - model.surfaces.modal_start[A]
    if at >= 0 and at < count:
        return at
    B = model.pairs.second[pair]
    at = n - model.surfaces.modal_start[B]
    if at >= 0 and at < model.surfaces.modal_count[B]:
        return count + at
    return -1


@wp.func
def is_closed(pair_force: wp.array4d(dtype=real), w: int, pair: int, side: int) -> bool:
    """Whether a pair has a normal force at the start (0) or the end (1) of the attempt."""
    size = real(0.0)
    for c in range(3):
        size += wp.abs(pair_force[w, pair, side, c])
    return size > real(0.0)


@wp.func
def modal_line(model: Model, w: int, pair: int) -> int:
    """Flat start of the trial loads of a pair on the modes of its bodies."""
    return ((w * model.pairs.count + pair) * 2 + 1) * model.pairs.most_modes


@wp.func
def load_before(w: int, pair: int, pair_force: wp.array4d(dtype=real)) -> real:
    """Normal force [N] of a pair at the end of the last step."""
    return wp.length(vec3(pair_force[w, pair, 0, 0], pair_force[w, pair, 0, 1], pair_force[w, pair, 0, 2]))


@wp.func
def load_share(model: Model, w: int, pair: int, pair_force: wp.array4d(dtype=real)) -> real:
    """That force over the largest of all pairs; 1 without any."""
    largest = real(0.0)
    p = int(0)
    while p < model.pairs.count:
        largest = wp.max(largest, load_before(w, p, pair_force))
        p += 1
    if largest == real(0.0):
        return real(1.0)
    return load_before(w, pair, pair_force) / largest


@wp.func
def whole(
    model: Model,
    normal: wp.array4d(dtype=real),
    friction: wp.array4d(dtype=real),
    w: int,
    pair: int,
    entry: int,
    i: int,
) -> real:
    """Component i of the sum of a pair's normal force and friction."""
    total = normal[w, pair, entry, i]
    if model.capacity.cells > 0:
        total += friction[w, pair, entry, i]
    return total


@wp.func
def mean_of(theta: real, before: real, after: real) -> real:
    return before + theta * (after - before)


@wp.func
def pair_work(
    model: Model, w: int, pair: int, side: int, force: wp.array4d(dtype=real), modal: wp.array4d(dtype=real),
    trial: Trial,
) -> real:  # fmt: skip
    """f.d of a pair: work [J] on increments, or power on rates."""
    return body_work(model, w, pair, side, force, trial.dx, trial.psi) + modal_work(
        model, w, pair, side, modal, trial.dq
    )


@wp.func
def body_work(
    model: Model,
    w: int,
    pair: int,
    side: int,
    force: wp.array4d(dtype=real),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
) -> real:
    total = real(0.0)
    for i in range(2):
        surface = surface_of(model, pair, i)
        b = model.surfaces.body[surface]
        if b >= 0:
            for c in range(3):
                total += force[w, pair, side, 6 * i + c] * dx[w, b][c]
                total += force[w, pair, side, 6 * i + 3 + c] * psi[w, b][c]
    return total


@wp.func
def modal_work(
    model: Model, w: int, pair: int, side: int, modal: wp.array4d(dtype=real), dq: wp.array2d(dtype=real)
) -> real:
    total = real(0.0)
    at = int(0)
    for i in range(2):
        surface = surface_of(model, pair, i)
        n = int(0)
        while n < model.surfaces.modal_count[surface]:
            total += modal[w, pair, side, at + n] * dq[w, model.surfaces.modal_start[surface] + n]
            n += 1
        at += model.surfaces.modal_count[surface]
    return total


@wp.func
def body_mobility(model: Model, w: int, pair: int, side: int, force: wp.array4d(dtype=real)) -> real:
    """f.M^-1 f of a pair on rigid bodies [N2/kg]."""
    total = real(0.0)
    for i in range(2):
        surface = surface_of(model, pair, i)
        b = model.surfaces.body[surface]
        if b >= 0:
            o = 6 * i
            f = vec3(force[w, pair, side, o], force[w, pair, side, o + 1], force[w, pair, side, o + 2])
            t = vec3(force[w, pair, side, o + 3], force[w, pair, side, o + 4], force[w, pair, side, o + 5])
            total += wp.dot(f, f) / model.bodies.mass[b] + wp.dot(t, wp.inverse(model.bodies.inertia[b]) * t)
    return total


@wp.func
def modal_mobility(model: Model, w: int, pair: int, side: int, modal: wp.array4d(dtype=real)) -> real:
    """f.M^-1 f of a pair on the modes, whose mass is 1 [N2/kg]."""
    count = model.surfaces.modal_count[model.pairs.first[pair]] + model.surfaces.modal_count[model.pairs.second[pair]]
    total = real(0.0)
    n = int(0)
    while n < count:
        total += modal[w, pair, side, n] * modal[w, pair, side, n]
        n += 1
    return total
