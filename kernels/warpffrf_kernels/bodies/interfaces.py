"""Flexible interfaces: their motion by the modes, and the modal load due to a load on them.

The motion (u, theta) of an interface, translation and rotation in body axes, is `(Phi + slope) q / 2`: linear in the
modes with slope = Phi, and with the second-order part `-q.K q / 2` in addition if loads stiffen the body, slope = Phi -
K q being its derivative (`inertia.shorten_interfaces`). It is computed once per evaluation; rows and forces read it. A
force and torque (f, t) at the interface's point is the load `slope^T (f, t)` on the modes.

`slope` is stored flat as (worlds, interfaces, 6, interface_width), `interface_modes` as (interfaces, 6,
interface_width), so that every sum over modes is contiguous; only the first `global_count` entries of a line are used.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import exponential, matrix
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, mat33, real, vec3, weighted
from warpffrf_kernels.core.scratch import Residuals, Trial

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def line_of(model: Model, w: int, interface: int) -> int:
    """Start of the six lines of an interface in `slope`."""
    return (w * model.interfaces.count + interface) * 6 * model.interfaces.width


# y[at_y : at_y + n] += sign slope^T (force, torque), `at` from `line_of`; by one lane. Zero components, the majority
# for a joint aligned with its body's axes, cost nothing.
@wp.func_native("""
    double* __restrict out = y.data + at_y;
    for (int c = 0; c < 6; ++c) {
        const double a = sign * (c < 3 ? force[c] : torque[c - 3]);
        if (a == 0.0) continue;
        const double* __restrict line = slope.data + at + (size_t)c * width;
        for (int i = 0; i < n; ++i) out[i] += a * line[i];
    }
""")
def add_load(
    n: int,
    sign: real,
    force: vec3,
    torque: vec3,
    width: int,
    slope: wp.array(dtype=real),
    at: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


@kernel
def move_interfaces(run: Run, trial: Trial):
    """Lanes over the six components of all interfaces: `motion` (W, interfaces, 6), m and rad."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    i = lane
    while i < 6 * model.interfaces.count:
        f = i / 6
        c = i - 6 * f
        b = model.interfaces.body[f]
        n = model.bodies.global_count[b]
        modes = w * model.modes.count + model.bodies.modal_start[b]
        value = dot(n, trial.slope, line_of(model, w, f) + c * model.interfaces.width, trial.q1, modes)
        if model.interfaces.stiffening_start[f] >= 0:
            straight = dot(n, model.interfaces.modes, i * model.interfaces.width, trial.q1, modes)
            value = real(0.5) * (value + straight)
        trial.interface_motion[w, f, c] = value
        i += wp.block_dim()


@wp.func
def translation_of(motion: wp.array3d(dtype=real), w: int, interface: int) -> vec3:
    return vec3(motion[w, interface, 0], motion[w, interface, 1], motion[w, interface, 2])


@wp.func
def rotation_of(motion: wp.array3d(dtype=real), w: int, interface: int) -> vec3:
    return vec3(motion[w, interface, 3], motion[w, interface, 4], motion[w, interface, 5])


@wp.func
def arm_on_interface(model: Model, i: int, motion: wp.array3d(dtype=real), w: int) -> vec3:
    """Position of marker i in its body frame, deformed."""
    X = model.markers.point[i]
    f = model.markers.interface[i]
    if f < 0:
        return X
    return X + translation_of(motion, w, f) + wp.cross(rotation_of(motion, w, f), X - model.interfaces.point[f])


@wp.func
def axes_on_interface(model: Model, i: int, motion: wp.array3d(dtype=real), w: int) -> mat33:
    """Axes of marker i in its body frame, rotated with its interface."""
    f = model.markers.interface[i]
    if f < 0:
        return model.markers.axes[i]
    return matrix(exponential(rotation_of(motion, w, f))) * model.markers.axes[i]


@wp.func
def marker_of(model: Model, row: int, side: int) -> int:
    """Marker a (side 0) or b (1) of a row."""
    if side == 0:
        return model.rows.a[row]
    return model.rows.b[row]


@wp.func
def side_of(model: Model, row: int, side: int) -> int:
    """Body whose modes a row loads on its side a (0) or b (1); -1 for none, and on side b for the body of side a."""
    a = model.rows.a[row]
    b = model.rows.b[row]
    body = model.markers.body[a]
    if model.markers.interface[a] < 0:
        body = -1
    if side == 0:
        return body
    if model.markers.interface[b] < 0 or model.markers.body[b] == body:
        return -1
    return model.markers.body[b]


@wp.func
def modal_line(model: Model, w: int, row: int, b: int) -> int:
    """Start of the entries of body b in a row's line of C_modal, flat."""
    return (w * model.rows.count + row) * model.modes.count + model.bodies.modal_start[b]


@wp.func
def pulled(model: Model, w: int, row: int, residuals: Residuals, load: wp.array(dtype=real)) -> real:
    """C_m sigma^-1 load of a row, over the global modes of the bodies at its ends."""
    total = real(0.0)
    for side in range(2):
        b = side_of(model, row, side)
        if b >= 0:
            at = w * model.modes.count + model.bodies.modal_start[b]
            line = modal_line(model, w, row, b)
            total += weighted(model.bodies.global_count[b], residuals.C_modal, line, residuals.receptance, at, load, at)
    return total


@wp.func
def compliance(model: Model, w: int, row: int, other: int, residuals: Residuals) -> real:
    """C_m sigma^-1 C_m^T of two rows, over the global modes of the bodies at the ends of both."""
    total = real(0.0)
    for side in range(2):
        b = side_of(model, row, side)
        if b >= 0 and (side_of(model, other, 0) == b or side_of(model, other, 1) == b):
            at = w * model.modes.count + model.bodies.modal_start[b]
            line = modal_line(model, w, row, b)
            total += weighted(
                model.bodies.global_count[b], residuals.C_modal, line, residuals.receptance, at, residuals.C_modal,
                modal_line(model, w, other, b),
            )  # fmt: skip
    return total
