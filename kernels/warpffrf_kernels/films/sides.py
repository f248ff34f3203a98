"""Position and motion of both bodies of a film: sliding velocities, and gaps with their gradients.

The gap at a point x of A is d_B(x), the signed distance from the second surface, plus the form and the deformation of
that (`seats`), which are functions of its chart; the gradient includes their slopes.
"""

import warp as wp

from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import exponential, matrix
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import MotionState
from warpffrf_kernels.films.seats import opened_at_seat
from warpffrf_kernels.surfaces.smooth import slope_of, smooth_foot
from warpffrf_kernels.surfaces.surface import axes_of, origin_of

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Sides:
    """Both bodies, seen from A: positions x and vectors in A's axes, from its centre of mass."""

    turn_a: mat33  # axes of both bodies in the world
    turn_b: mat33
    from_b: vec3  # centre of mass of A from that of B, world
    turn: mat33  # turn x + shift: a point in the frame of the second surface
    shift: vec3
    slide: vec3  # slide + slide_turn x x: u_B - u_A
    slide_turn: vec3
    carry: vec3  # carry + carry_turn x x: U
    carry_turn: vec3


@wp.func
def looked_at(model: Model, film: int, turn_a: mat33, turn_b: mat33, from_b: vec3) -> Sides:
    """Both bodies in these axes, at rest; from_b: A's centre of mass from B's."""
    s = model.elements[0].films[0].second[film]
    into = wp.transpose(turn_b * model.surfaces.frame[s])
    found = Sides()
    found.turn_a = turn_a
    found.turn_b = turn_b
    found.from_b = from_b
    found.turn = into * turn_a
    found.shift = into * (from_b - turn_b * model.surfaces.origin[s])
    return found


@wp.func
def sides_of(model: Model, w: int, film: int, static: int, trial: Trial) -> Sides:
    """In static steps with the velocities at the start, and A's rotation about its own axis in U."""
    first = model.elements[0].films[0].first[film]
    a = model.surfaces.body[first]
    b = model.surfaces.body[model.elements[0].films[0].second[film]]
    from_b = origin_of(trial.r1, w, a) - origin_of(trial.r1, w, b)
    found = looked_at(model, film, axes_of(trial.axes, w, a), axes_of(trial.axes, w, b), from_b)
    v = vec3(real(0.0))
    omega_a = vec3(real(0.0))
    omega_b = vec3(real(0.0))
    if a >= 0:
        v = -trial.v1[w, a]
        omega_a = trial.omega1[w, a]
        if static != 0:
            v = -model.elements[0].films[0].rest_v[a]
            omega_a = model.elements[0].films[0].rest_omega[a]
    if b >= 0:
        omega_b = found.turn_b * trial.omega1[w, b]
        v += trial.v1[w, b]
        if static != 0:
            omega_b = found.turn_b * model.elements[0].films[0].rest_omega[b]
            v += model.elements[0].films[0].rest_v[b] - trial.v1[w, b]
    back = wp.transpose(found.turn_a)
    found.slide = back * (v + wp.cross(omega_b, from_b))
    found.slide_turn = back * omega_b - omega_a
    found.carry = real(0.5) * found.slide
    found.carry_turn = real(0.5) * found.slide_turn
    if static != 0 and model.surfaces.planar[first] == 0:
        axis = model.surfaces.frame[first] * vec3(real(0.0), real(0.0), real(1.0))
        spin = wp.dot(omega_a, axis) * axis
        found.carry -= wp.cross(spin, model.surfaces.origin[first])
        found.carry_turn += spin
    return found


@wp.func
def sliding_at(sides: Sides, x: vec3) -> vec3:
    """u_B - u_A [m/s]."""
    return sides.slide + wp.cross(sides.slide_turn, x)


@wp.func
def carried_at(sides: Sides, x: vec3) -> vec3:
    """U [m/s]."""
    return sides.carry + wp.cross(sides.carry_turn, x)


@wp.func
def second_form_at(model: Model, film: int, theta: real, z: real) -> vec3:
    """Contribution of the form of the second surface to the gap [m], interpolated in its table, and its slopes with
    respect to theta and z."""
    columns = model.elements[0].films[0].second_counts[film, 0]
    rows = model.elements[0].films[0].second_counts[film, 1]
    x = (theta - model.elements[0].films[0].second_range[film, 0]) / model.elements[0].films[0].second_range[film, 1]
    x -= real(columns) * wp.floor(x / real(columns))
    y = (z - model.elements[0].films[0].second_range[film, 2]) / model.elements[0].films[0].second_range[film, 3]
    inside = real(1.0)
    if y < real(0.0) or y > real(rows - 1):
        inside = real(0.0)
    y = wp.clamp(y, real(0.0), real(rows - 1))
    i = wp.min(int(x), columns - 1)
    j = wp.min(int(y), rows - 2)
    u = x - real(i)
    v = y - real(j)
    start = model.elements[0].films[0].second_start[film]
    left = start + i * rows + j
    right = start + ((i + 1) % columns) * rows + j
    before = model.elements[0].films[0].second_form[left]
    before_up = model.elements[0].films[0].second_form[left + 1]
    after = model.elements[0].films[0].second_form[right]
    after_up = model.elements[0].films[0].second_form[right + 1]
    low = (real(1.0) - v) * before + v * before_up
    high = (real(1.0) - v) * after + v * after_up
    along = (real(1.0) - u) * (before_up - before) + u * (after_up - after)
    by_theta = (high - low) / model.elements[0].films[0].second_range[film, 1]
    by_z = inside * along / model.elements[0].films[0].second_range[film, 3]
    return vec3((real(1.0) - u) * low + u * high, by_theta, by_z)


@wp.func
def tilted(model: Model, film: int, sides: Sides, y: vec3, by_theta: real, by_z: real) -> vec3:
    """Gradient of a contribution to the gap at a point y of the second surface's frame, with these slopes on its
    chart."""
    s = model.elements[0].films[0].second[film]
    rise = vec3(real(0.0), by_theta, by_z)
    if model.surfaces.planar[s] == 0:
        rho = wp.sqrt(y[0] * y[0] + y[1] * y[1])
        slope = slope_of(model, s, y[2])
        part = by_z / (real(1.0) + slope * slope)
        x = slope * part
        around = by_theta / rho
        rise = vec3((x * y[0] - around * y[1]) / rho, (x * y[1] + around * y[0]) / rho, part)
    return wp.transpose(sides.turn) * rise


@wp.func
def opened_by_motion(model: Model, film: int, sides: Sides, x: vec3) -> wp.vec4d:
    """d_B with the form of B [m] at a point of A, and its gradient."""
    s = model.elements[0].films[0].second[film]
    y = sides.turn * x + sides.shift
    seen = smooth_foot(model, s, y)
    n = wp.transpose(sides.turn) * seen.normal
    gap = seen.distance
    if model.elements[0].films[0].second_start[film] >= 0:
        form = second_form_at(model, film, seen.theta, seen.z)
        gap += form[0]
        n += tilted(model, film, sides, y, form[1], form[2])
    return wp.vec4d(gap, n[0], n[1], n[2])


@wp.func
def opened_with_second(model: Model, w: int, film: int, sides: Sides, x: vec3, seat: int, oil: FilmScratch) -> wp.vec4d:
    """`opened_by_motion` plus the opening by a deformable second surface; seat: of the point, within the film."""
    found = opened_by_motion(model, film, sides, x)
    if model.elements[0].films[0].second_nodes[film] == 0:
        return found
    at = model.elements[0].films[0].seat_start[film] + seat
    more = opened_at_seat(model, film, w, at, oil, oil.film_second_opened)
    turn = tilted(model, film, sides, sides.turn * x + sides.shift, more[1], more[2])
    return found + wp.vec4d(more[0], turn[0], turn[1], turn[2])


@wp.func
def posed(model: Model, w: int, film: int, ahead: int, state: MotionState, trial: Trial) -> Sides:
    """Both bodies at the start of the step, or `ahead` at the end of their increments, without velocities."""
    a = model.surfaces.body[model.elements[0].films[0].first[film]]
    b = model.surfaces.body[model.elements[0].films[0].second[film]]
    turn_a = wp.identity(n=3, dtype=real)
    turn_b = wp.identity(n=3, dtype=real)
    from_b = vec3(real(0.0))
    if a >= 0:
        turn_a = matrix(state.p[w, a])
        from_b = state.r[w, a]
        if ahead != 0:
            turn_a = matrix(wp.normalize(state.p[w, a] * exponential(trial.psi[w, a])))
            from_b += trial.dx[w, a]
    if b >= 0:
        turn_b = matrix(state.p[w, b])
        from_b -= state.r[w, b]
        if ahead != 0:
            turn_b = matrix(wp.normalize(state.p[w, b] * exponential(trial.psi[w, b])))
            from_b -= trial.dx[w, b]
    return looked_at(model, film, turn_a, turn_b, from_b)
