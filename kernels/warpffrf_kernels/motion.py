"""Start of a step, and the motion of bodies and global modes as a function of the step's displacement increments.

Unknowns of a step are the increments `dx = r_1 - r_0` (m), `psi` with `R_1 = R_0 exp(psi^)` (rad) and `dq` (modes).
With the algorithmic acceleration `a` of generalized-alpha (Arnold and Bruels 2007, eq. 17 to 19), for any of the three
kinds of coordinates

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),      v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
    (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) vdot_1 + alpha_f vdot_0,

so that `a_1`, `v_1`, `vdot_1` are affine in `d` with slopes `1/(beta h^2)`, `VEL = gamma/(beta h)` and
`ACC = (1 - alpha_m)/(beta h^2 (1 - alpha_f))`. Three other uses of the same formulas:

* STATIC (beta = 1, gamma = 0, alphas 0, all rates zero): `vdot_1 = d/h^2`, a proximal step towards the static state.
* PROJECT (beta = gamma = 1, alphas 0): one tiny implicit Euler step; its velocity is the given one made consistent with
  joints and drives, in the mass metric.
* START (beta = 1/2, gamma = 1, alphas 0): one tiny step of constant acceleration gives consistent `vdot` and `lambda`.

Balance of a body in the floating frame with origin in its centre of mass and constant inertia (linear momentum in world
axes, angular in body axes): `m rddot = F`, `J wdot + w x J w = M`; a mode of unit mass: `qddot + 2 zeta omega qdot +
omega^2 q = f`.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.rotation import exponential, hat, matrix, tangent_inverse
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, quat, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def begin_step(
    rho_inf: wp.array(dtype=real),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
):
    """Per world: step size, end time and coefficients of this attempt."""
    w = wp.tid()
    ctl[w, k.RUN] = 0
    ctl[w, k.ATTEMPT] = 0
    ctl[w, k.ACCEPT] = 0
    ctl[w, k.RECORD] = 0
    if ctl[w, k.STATUS] != 0 or ctl[w, k.STEP] >= ctl[w, k.TARGET]:
        return
    ctl[w, k.RUN] = 1
    ctl[w, k.ATTEMPT] = 1
    ctl[w, k.MOVED] = 1
    ctl[w, k.REASSEMBLE] = 1
    ctl[w, k.REFRESH] = 1
    ctl[w, k.RECENTER] = 0
    ctl[w, k.ITERATION] = 0
    ctl[w, k.INNER] = 0
    ctl[w, k.CHANGES] = 0
    ctl[w, k.FAILURE] = 0
    ctl[w, k.SLOTS] = 0
    ctl[w, k.FRESH] = 0
    ctl[w, k.TOUCHED] = ctl[w, k.ACTIVE]
    h_user = clk[w, k.USER_STEP]
    fraction = wp.pow(real(0.5), real(ctl[w, k.LEVEL]))
    h = h_user * fraction
    am = real(0.0)
    af = real(0.0)
    beta = real(1.0)
    gamma = real(0.0)
    clk[w, k.NEXT_TIME] = clk[w, k.TIME]
    if ctl[w, k.MODE] == k.DYNAMIC:
        rho = rho_inf[w]
        am = (real(2.0) * rho - real(1.0)) / (rho + real(1.0))
        af = rho / (rho + real(1.0))
        gamma = real(0.5) - am + af
        beta = real(0.25) * (gamma + real(0.5)) * (gamma + real(0.5))
        clk[w, k.NEXT_TIME] = clk[w, k.START_TIME] + h_user * (
            real(ctl[w, k.STEP]) + real(ctl[w, k.SUB] + 1) * fraction
        )
    if ctl[w, k.MODE] == k.START or ctl[w, k.MODE] == k.PROJECT:
        gamma = real(1.0)
        clk[w, k.NEXT_TIME] = clk[w, k.TIME] + h
        if ctl[w, k.MODE] == k.START:
            beta = real(0.5)
    clk[w, k.H] = h
    clk[w, k.ALPHA_M] = am
    clk[w, k.ALPHA_F] = af
    clk[w, k.BETA] = beta
    clk[w, k.GAMMA] = gamma
    clk[w, k.ACC] = (real(1.0) - am) / (beta * h * h * (real(1.0) - af))
    clk[w, k.VEL] = gamma / (beta * h)


@wp.func
def predicted(c: wp.array2d(dtype=real), w: int, v0: vec3, rate0: vec3, a0: vec3) -> vec3:
    """Increment that keeps the rate of the old state."""
    h = c[w, k.H]
    a1 = (rate0 - c[w, k.ALPHA_M] * a0) / (real(1.0) - c[w, k.ALPHA_M])
    return h * v0 + h * h * ((real(0.5) - c[w, k.BETA]) * a0 + c[w, k.BETA] * a1)


@wp.func
def algorithmic(c: wp.array2d(dtype=real), w: int, d: vec3, v0: vec3, a0: vec3) -> vec3:
    h = c[w, k.H]
    return (d - h * v0 - h * h * (real(0.5) - c[w, k.BETA]) * a0) / (c[w, k.BETA] * h * h)


@wp.func
def velocity_of(c: wp.array2d(dtype=real), w: int, v0: vec3, a0: vec3, a1: vec3) -> vec3:
    return v0 + c[w, k.H] * ((real(1.0) - c[w, k.GAMMA]) * a0 + c[w, k.GAMMA] * a1)


@wp.func
def rate_of(c: wp.array2d(dtype=real), w: int, rate0: vec3, a0: vec3, a1: vec3) -> vec3:
    am = c[w, k.ALPHA_M]
    af = c[w, k.ALPHA_F]
    return ((real(1.0) - am) * a1 + am * a0 - af * rate0) / (real(1.0) - af)


@wp.kernel
def predict_bodies(
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    v: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
):
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    b = lane
    while b < v.shape[1]:
        dx[w, b] = predicted(clk, w, v[w, b], v_rate[w, b], v_alg[w, b])
        psi[w, b] = predicted(clk, w, omega[w, b], omega_rate[w, b], omega_alg[w, b])
        b += wp.block_dim()


@wp.kernel
def predict_modes(
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
):
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0:
        return
    m = lane
    while m < qd.shape[1]:
        p = predicted(clk, w, vec3(qd[w, m]), vec3(qd_rate[w, m]), vec3(qd_alg[w, m]))
        dq[w, m] = p[0]
        m += wp.block_dim()


@wp.kernel
def move_bodies(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    r: wp.array2d(dtype=vec3),
    p: wp.array2d(dtype=quat),
    v: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    r1: wp.array2d(dtype=vec3),
    p1: wp.array2d(dtype=quat),
    axes: wp.array2d(dtype=mat33),
    v1: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    residual: wp.array2d(dtype=real),
    tangent: wp.array3d(dtype=real),
    psi_inverse: wp.array2d(dtype=mat33),
):
    """Trial state of each body, its unbalanced inertia and gravity forces, and their tangent (blocks of `tangent`)."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    b = lane
    while b < model.body_count:
        a_t = algorithmic(clk, w, dx[w, b], v[w, b], v_alg[w, b])
        a_r = algorithmic(clk, w, psi[w, b], omega[w, b], omega_alg[w, b])
        vel = velocity_of(clk, w, v[w, b], v_alg[w, b], a_t)
        spin = velocity_of(clk, w, omega[w, b], omega_alg[w, b], a_r)
        acc = rate_of(clk, w, v_rate[w, b], v_alg[w, b], a_t)
        spin_rate = rate_of(clk, w, omega_rate[w, b], omega_alg[w, b], a_r)
        q1 = wp.normalize(p[w, b] * exponential(psi[w, b]))
        r1[w, b] = r[w, b] + dx[w, b]
        p1[w, b] = q1
        axes[w, b] = matrix(q1)
        v1[w, b] = vel
        v1_rate[w, b] = acc
        omega1[w, b] = spin
        omega1_rate[w, b] = spin_rate
        m = model.mass[b]
        J = model.inertia[b]
        f = m * acc - m * model.gravity
        t = J * spin_rate + wp.cross(spin, J * spin)
        Ti = tangent_inverse(psi[w, b])
        psi_inverse[w, b] = Ti
        S = (clk[w, k.ACC] * J + clk[w, k.VEL] * (hat(spin) * J - hat(J * spin))) * Ti
        o = 6 * b
        for i in range(3):
            residual[w, o + i] = f[i]
            residual[w, o + 3 + i] = t[i]
            for j in range(3):
                tangent[w, o + i, o + j] = real(0.0)
                tangent[w, o + i, o + 3 + j] = real(0.0)
                tangent[w, o + 3 + i, o + j] = real(0.0)
                tangent[w, o + 3 + i, o + 3 + j] = S[i, j]
            tangent[w, o + i, o + i] = m * clk[w, k.ACC]
        b += wp.block_dim()


@wp.kernel
def move_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    q1: wp.array2d(dtype=real),
    qd1: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    receptance: wp.array2d(dtype=real),
):
    """Trial state of each global mode, its unbalanced force, and the inverse of its (diagonal) tangent."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    m = lane
    while m < model.modal_count:
        a = algorithmic(clk, w, vec3(dq[w, m]), vec3(qd[w, m]), vec3(qd_alg[w, m]))
        vel = velocity_of(clk, w, vec3(qd[w, m]), vec3(qd_alg[w, m]), a)
        rate = rate_of(clk, w, vec3(qd_rate[w, m]), vec3(qd_alg[w, m]), a)
        q1[w, m] = q[w, m] + dq[w, m]
        qd1[w, m] = vel[0]
        qd1_rate[w, m] = rate[0]
        c = model.damping[m]
        stiffness = model.stiffness[m]
        modal_residual[w, m] = rate[0] + c * vel[0] + stiffness * q1[w, m]
        receptance[w, m] = real(1.0) / (clk[w, k.ACC] + c * clk[w, k.VEL] + stiffness)
        m += wp.block_dim()
