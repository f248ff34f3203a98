"""Parallel-axes kinematics: gap of two bodies of revolution along the line of centres, weak gaps, gradient.

Contact frame. At an axial station z of the first surface A, let `a = O_A + z e_A` be its axis point, and b the point
where the axis of the second surface B intersects the plane of the section. With `v = b - a`, `d = |v|`, `c = v/d`,
`t = e_A x c`, the point of A at the angle xi from the line of centres is `a + R_A (cos xi c + sin xi t)`. With
`y = R_A sin xi` the gap is measured *along c*:

    g(xi, z) = d - sqrt(R_B^2 - y^2) - R_A cos xi,          R_B at the axial station of the opposite point of B.

(Terms of the order of the tilt squared, from the elliptical oblique section of B, are neglected.) Small xi: d - R_A -
R_B + y^2/2 (1/R_A + 1/R_B), Hertz's gap. The pressure acts along c, so that dg/dd = 1, the weights of forces, moments
and elastic displacements are the same, and the wrench is

    on B: force f at b,  on A: -f at b,          f = N + R_B'/(e_A.e_B) e_A,

N the gradient of d, the second term that of the radius of a crowned B (for B moved by w the axial station of contact is
smaller by w.e_A/(e_A.e_B)): action equals reaction exactly; the line of action intersects both axes, so that the torque
about either axis is exactly zero. The gradient is taken at fixed (xi, z): the *material* angles at which the line of
centres intersects the two grids (their phases) are parameters, not coordinates, of the contact energy. The change of
its energy with a phase is the grid defect of the ledger.

Gradient of d. A displacement field w of B's axis relative to A moves b by w + sigma e_B with e_A.(w + sigma e_B) = 0,
hence `dd = N.w`, `N = c - e_A (c.e_B)/(e_A.e_B)`.

The phases of a step are those of its first evaluation, the predicted state, until an iteration moves the grids by more
than FREEZE: the ripple of the force is a fraction of a percent per column, so that is below the residual tolerance. At
fixed phases the gap of two cylinders is linear in d, and an evaluation only shifts the weak gaps instead of sampling
them again. `line_of_centres_points` samples gap and opposite point on B's grid (column, row), and sums them to weak
gaps.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import LINE_OF_CENTRES, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.surfaces.smooth import TWO_PI

wp.set_module_options(MODULE_OPTIONS)

PHASE_TOLERANCE = wp.constant(
    wp.float64(1.0e-4)
)  # columns: G changes by about this fraction; sufficient for a tangent, see contact_solve
SERIES = wp.constant(wp.float64(5.0e-6))  # rad: third-order terms are then below round-off
FREEZE = wp.constant(wp.float64(2.0e-7))  # columns: phases are kept if an iteration changes them by less, see above
DRIFT = wp.constant(wp.float64(0.75))  # columns off the centre column, beyond which the windows are moved
FARTHEST = wp.constant(wp.float64(1.0e6))  # columns: a larger phase belongs to a state that has left the scene
GUARD = wp.constant(2)  # outermost columns of a full window that must be inactive at the end


@wp.func
def radius_at(R: real, crown: real, z: real) -> real:
    if crown == real(0.0):
        return R
    return R - (crown - wp.sqrt(crown * crown - z * z))


@wp.func
def slope_at(crown: real, z: real) -> real:
    if crown == real(0.0):
        return real(0.0)
    return -z / wp.sqrt(crown * crown - z * z)


@wp.func
def wrap(x: real, turn: real, middle: real) -> real:
    """x modulo a full revolution, nearest to `middle`."""
    return x - turn * wp.floor((x - middle) / turn + real(0.5))


@kernel
def locate(run: Run, trial: Trial, geometry: ContactGeometry):
    """Per (world, pair): contact frame and grid phases of every axial station.

    station: d, column on A, column on B, axial position on B, t.e_B, c.e_B, weight int dz R_A, sense of B's angle, d
    where the gaps were sampled, columns of this evaluation.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != LINE_OF_CENTRES:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[B]
    O_A = trial.r1[w, body_a] + trial.axes[w, body_a] * model.surfaces.origin[A]
    O_B = trial.r1[w, body_b] + trial.axes[w, body_b] * model.surfaces.origin[B]
    F_A = trial.axes[w, body_a] * model.surfaces.frame[A]
    F_B = trial.axes[w, body_b] * model.surfaces.frame[B]
    e_A = vec3(F_A[0, 2], F_A[1, 2], F_A[2, 2])
    e_B = vec3(F_B[0, 2], F_B[1, 2], F_B[2, 2])
    cosine = wp.dot(e_A, e_B)
    turn_a = TWO_PI / model.surfaces.pitch[A]
    turn_b = TWO_PI / model.surfaces.pitch[B]
    middle_a = real(0.5) * real(model.surfaces.columns[A] - 1)
    middle_b = real(0.5) * real(model.surfaces.columns[B] - 1)
    rows = model.surfaces.rows[A]
    z0 = model.surfaces.z_start[A]
    zb0 = model.surfaces.z_start[B]
    zb_low = model.surfaces.z[zb0]
    zb_high = model.surfaces.z[zb0 + model.surfaces.rows[B] - 1]
    count = (rows - 1) * model.quadrature.z_points
    column_a = real(0.0)
    column_b = real(0.0)
    largest = real(0.0)
    moved = real(0.0)
    s = int(0)
    while s < count:
        cell = s / model.quadrature.z_points
        g = s - cell * model.quadrature.z_points
        low = model.surfaces.z[z0 + cell]
        dz = model.surfaces.z[z0 + cell + 1] - low
        z = low + model.quadrature.z_abscissa[g] * dz
        a = O_A + z * e_A
        axial = wp.dot(e_A, a - O_B) / cosine
        b = O_B + axial * e_B
        v = b - a
        d = wp.length(v)
        c = v / d
        t = wp.cross(e_A, c)
        u = wp.transpose(F_A) * c
        x_a = (wp.atan2(u[1], u[0]) - model.surfaces.theta[A]) / model.surfaces.pitch[A]
        u = wp.transpose(F_B) * c
        x_b = (wp.atan2(-u[1], -u[0]) - model.surfaces.theta[B]) / model.surfaces.pitch[B]
        if s == 0:
            x_a = wrap(x_a, turn_a, middle_a)
            x_b = wrap(x_b, turn_b, middle_b)
            if run.ctl[w].iteration > 0:  # stay on the branch of the window
                x_a = wrap(x_a, turn_a, real(geometry.center[w, pair, 0]))
                x_b = wrap(x_b, turn_b, real(geometry.center[w, pair, 1]))
            column_a = x_a
            column_b = x_b
        x_a = wrap(x_a, turn_a, column_a)
        x_b = wrap(x_b, turn_b, column_b)
        N = c - e_A * (wp.dot(c, e_B) / cosine)
        f = N + e_A * (slope_at(model.surfaces.crown[B], axial) / cosine)
        m = wp.cross(b - trial.r1[w, body_a], f)
        slope = slope_at(model.surfaces.crown[A], z)
        weight = model.quadrature.z_weight[g] * dz * radius_at(model.surfaces.radius[A], model.surfaces.crown[A], z)
        weight *= wp.sqrt(real(1.0) + slope * slope)
        if axial < zb_low or axial > zb_high:
            weight = real(0.0)  # no opposite surface here
        geometry.station[w, pair, s, 0] = d
        moved = wp.max(
            moved, wp.max(wp.abs(x_a - geometry.station[w, pair, s, 1]), wp.abs(x_b - geometry.station[w, pair, s, 2]))
        )
        geometry.station[w, pair, s, 9] = x_a
        geometry.station[w, pair, s, 10] = x_b
        geometry.station[w, pair, s, 3] = axial
        geometry.station[w, pair, s, 4] = wp.dot(t, e_B)
        geometry.station[w, pair, s, 5] = wp.dot(c, e_B)
        geometry.station[w, pair, s, 6] = weight
        geometry.station[w, pair, s, 7] = -wp.sign(cosine)
        for i in range(3):
            geometry.station_wrench[w, pair, s, i] = -f[i]
            geometry.station_wrench[w, pair, s, 3 + i] = -m[i]
        if s == 0:
            largest = wp.max(wp.abs(x_a - geometry.phase[w, pair, 0]), wp.abs(x_b - geometry.phase[w, pair, 1]))
            geometry.phase[w, pair, 4] = x_a
            geometry.phase[w, pair, 5] = x_b
        if s == count - 1:
            largest = wp.max(
                largest, wp.max(wp.abs(x_a - geometry.phase[w, pair, 2]), wp.abs(x_b - geometry.phase[w, pair, 3]))
            )
            geometry.phase[w, pair, 6] = x_a
            geometry.phase[w, pair, 7] = x_b
        s += 1
    if largest > PHASE_TOLERANCE:
        run.ctl[w].reassemble = 1
    mid_a = real(0.5) * (geometry.phase[w, pair, 4] + geometry.phase[w, pair, 6])
    mid_b = real(0.5) * (geometry.phase[w, pair, 5] + geometry.phase[w, pair, 7])
    if not (wp.abs(mid_a) < FARTHEST and wp.abs(mid_b) < FARTHEST):  # also if they are NaN
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_FINITE
        run.ctl[w].run = 0
        return
    geometry.center[w, pair, 2] = 0
    drift = wp.max(wp.abs(mid_a - real(geometry.center[w, pair, 0])), wp.abs(mid_b - real(geometry.center[w, pair, 1])))
    if run.ctl[w].iteration == 0 or drift > DRIFT:
        geometry.center[w, pair, 0] = int(wp.floor(mid_a + real(0.5)))
        geometry.center[w, pair, 1] = int(wp.floor(mid_b + real(0.5)))
        run.ctl[w].reassemble = 1
        run.ctl[w].recenter = 1
    elif moved <= FREEZE and run.ctl[w].reassemble == 0 and model.surfaces.crown[B] == real(0.0):
        geometry.center[w, pair, 2] = 1
    if geometry.center[w, pair, 2] == 0:
        s = int(0)
        while s < count:
            geometry.station[w, pair, s, 1] = geometry.station[w, pair, s, 9]
            geometry.station[w, pair, s, 2] = geometry.station[w, pair, s, 10]
            geometry.station[w, pair, s, 8] = geometry.station[w, pair, s, 0]
            s += 1


@wp.func
def row_below(model: Model, B: int, z: real) -> int:
    """Row of B's grid at or below z, limited to the grid."""
    z0 = model.surfaces.z_start[B]
    last = model.surfaces.rows[B] - 2
    i = int(0)
    while i < last and z >= model.surfaces.z[z0 + i + 1]:
        i += 1
    return i
