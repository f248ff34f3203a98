"""Time-integration formulas: generalized-alpha with the coefficients of bodies and of local modes (`motion`)."""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Clock, Coefficients, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)

UNRESOLVED = wp.constant(wp.float64(9.869604401089358))  # pi^2, for (omega h)^2

# --- integration rule of a coordinate
OUTER = wp.constant(0)
LOCAL = wp.constant(1)
EXACT = wp.constant(2)


@wp.func
def coefficients_from(am: real, af: real, beta: real, gamma: real, h: real) -> Coefficients:
    """Coefficients of a step of length h."""
    c = Coefficients()
    c.alpha_m = am
    c.alpha_f = af
    c.beta = beta
    c.gamma = gamma
    c.acc = (real(1.0) - am) / (beta * h * h * (real(1.0) - af))
    c.vel = gamma / (beta * h)
    return c


@wp.func
def forgetful(h: real) -> Coefficients:
    """The implicit Euler method, which uses no old acceleration: d = h v_1, v_1 = v_0 + h a_1, vdot_1 = a_1."""
    c = coefficients_from(real(0.0), real(0.0), real(1.0), real(1.0), h)
    c.restart = real(1.0)
    return c


@wp.func
def of_old(c: Coefficients) -> real:
    """Weight of a_0 in the increment, 1/2 - beta, or 0."""
    return (real(0.5) - c.beta) * (real(1.0) - c.restart)


@wp.func
def coefficients_of(clk: wp.array(dtype=Clock), w: int, rule: int) -> Coefficients:
    """Coefficients of the coordinates integrated by `rule`; EXACT requires none."""
    if rule == LOCAL:
        return clk[w].local
    return clk[w].retained


@wp.func
def predicted(h: real, c: Coefficients, v0: vec3, rate0: vec3, a0: vec3) -> vec3:
    """Increment for a constant rate of the old state."""
    a1 = (rate0 - c.alpha_m * a0) / (real(1.0) - c.alpha_m)
    return h * v0 + h * h * (of_old(c) * a0 + c.beta * a1)


@wp.func
def algorithmic(h: real, c: Coefficients, d: vec3, v0: vec3, a0: vec3) -> vec3:
    return (d - h * v0 - h * h * of_old(c) * a0) / (c.beta * h * h)


@wp.func
def is_static(ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether an attempt seeks an equilibrium."""
    return ctl[w].mode == k.STATIC or ctl[w].mode == k.LOADING


@wp.func
def is_whole(ctl: wp.array(dtype=Control), w: int) -> bool:
    """Whether an attempt is a step in time or a load step, with slip measured between accepted states."""
    return ctl[w].mode == k.DYNAMIC or ctl[w].mode == k.LOADING


@wp.func
def acceleration_of(mode: int, h: real, c: Coefficients, d: vec3, centre: vec3, v0: vec3, a0: vec3) -> vec3:
    """Algorithmic acceleration of the increment d; in a load step that of the proximal step from `centre`."""
    if mode == k.LOADING:
        return c.acc * (d - centre)
    return algorithmic(h, c, d, v0, a0)


@wp.func
def velocity_of(h: real, c: Coefficients, v0: vec3, a0: vec3, a1: vec3) -> vec3:
    return v0 + h * ((real(1.0) - c.gamma) * a0 + c.gamma * a1)


@wp.func
def rate_of(c: Coefficients, rate0: vec3, a0: vec3, a1: vec3) -> vec3:
    am = c.alpha_m
    af = c.alpha_f
    return ((real(1.0) - am) * a1 + am * a0 - af * rate0) / (real(1.0) - af)


@wp.func
def share_of_miss(run: Run, w: int) -> real:
    """Change of a force at the end of a step with its mean over the step, for forces whose mean is given (`mean_work`).
    It is 0 except in time steps that use old accelerations, and in evaluations without a step, whose velocities do not
    contain the accelerations (gamma = 0, `linearise`)."""
    c = run.clk[w].retained
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC or run.ctl[w].restart != 0 or c.gamma == real(0.0):
        return real(0.0)
    return (real(1.0) - c.alpha_m) / (c.gamma * (real(1.0) - c.alpha_f))


@wp.func
def rule_of(model: Model, run: Run, w: int, m: int) -> int:
    """Integration rule of mode m: OUTER, as for bodies; LOCAL, by HHT; or EXACT for a linear load.

    The exact step is for modes that the step does not resolve, omega h >= pi. Contact requires the load f1 that moves
    the surface to a given position; with the previous load this is a recursion f1 = -(C/D) f0, and |C/D| is 2 for small
    omega h and at most 1 from pi on.
    """
    if run.ctl[w].mode != k.DYNAMIC or model.modes.kind[m] == 0:
        return OUTER
    h = run.clk[w].h
    if model.modes.kind[m] == 2 and model.modes.stiffness[m] * h * h >= UNRESOLVED:
        return EXACT
    return LOCAL
