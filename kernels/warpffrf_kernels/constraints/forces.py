"""Springs whose rows share matrices, torques, and loads that are constant in body axes.

A group of spring rows with values c, gradient C and matrices K, D has `lambda = K c + D cdot + preload`. With the
effective stiffness `K_e = K + VEL D` (VEL = d(velocity)/d(displacement) of the step) the linearised law `K_e C dx -
dlam = -(law - lambda)` becomes, multiplied by the flexibility F = K_e^-1, rows of the same form as those of single
springs and constraints,

    C dx - F dlam = -F (law - lambda),

so a full matrix requires a block of F instead of one diagonal entry, and modes and contact are unaffected. Rows without
stiffness are dampers; at rest (VEL = 0, static steps) they carry no force: F = 1 and the defect -lambda. The host has
chosen the rows so that K_e has full rank (`warpffrf.model.forces.laws.split_directions`).

Ledger of a group: `1/2 c^T K_s c` is stored (K_s the symmetric part), `cdot^T D cdot` is dissipated by the dampers, and
the work of the skew part K_a is `-1/2 (K_a (c_0 + c_1)) . (c_1 - c_0)` per step.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import add_load, line_of
from warpffrf_kernels.constraints.rows import evaluate_signal
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Residuals, Trial
from warpffrf_kernels.core.state import LoadState

wp.set_module_options(MODULE_OPTIONS)

MOST_COUPLED = 6  # rows of a group; also the size of the buffers in `flexibility_of`


# F = K_e^-1 of one group by Gauss-Jordan elimination with row pivoting, into flexibility[w, g]; damper rows from `size`
# on are unit rows. Returns 1 if a pivot vanishes.
@wp.func_native("""
    double a[36], b[36]; double* out = flexibility.data + ((size_t)w * groups + g) * 36;
    const double* K = stiffness.data + (size_t)g * 36; const double* D = damping.data + (size_t)g * 36;
    for (int i = 0; i < 6; ++i) for (int j = 0; j < 6; ++j) {
        const int inside = i < size && j < size;
        a[6 * i + j] = inside ? K[6 * i + j] + slope * D[6 * i + j] : (i == j ? 1.0 : 0.0);
        b[6 * i + j] = i == j ? 1.0 : 0.0;
    }
    int bad = 0;
    for (int p = 0; p < 6; ++p) {
        int best = p;
        for (int i = p + 1; i < 6; ++i) if (::fabs(a[6 * i + p]) > ::fabs(a[6 * best + p])) best = i;
        if (best != p) for (int j = 0; j < 6; ++j) {
            double t = a[6 * p + j]; a[6 * p + j] = a[6 * best + j]; a[6 * best + j] = t;
            t = b[6 * p + j]; b[6 * p + j] = b[6 * best + j]; b[6 * best + j] = t;
        }
        double pivot = a[6 * p + p];
        if (!(::fabs(pivot) > 0.0)) { bad = 1; pivot = 1.0; }
        const double r = 1.0 / pivot;
        for (int j = 0; j < 6; ++j) { a[6 * p + j] *= r; b[6 * p + j] *= r; }
        for (int i = 0; i < 6; ++i) {
            const double m = a[6 * i + p];
            if (i == p || m == 0.0) continue;
            for (int j = 0; j < 6; ++j) { a[6 * i + j] -= m * a[6 * p + j]; b[6 * i + j] -= m * b[6 * p + j]; }
        }
    }
    for (int e = 0; e < 36; ++e) out[e] = b[e];
    return bad;
""")
def flexibility_of(
    w: int,
    g: int,
    groups: int,
    size: int,
    slope: real,
    stiffness: wp.array3d(dtype=real),
    damping: wp.array3d(dtype=real),
    flexibility: wp.array(dtype=real),
) -> int: ...


@kernel
def couple_springs(run: Run, loads: LoadState, residuals: Residuals):
    """Lanes over groups: their flexibility, and the defects of their rows; `softness` gets its diagonal."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    g = lane
    while g < model.groups.count:
        first = model.groups.start[g]
        n = model.groups.size[g]
        size = n
        slope = run.clk[w].retained.vel
        if slope == real(0.0):
            size = model.groups.sprung[g]
        at = (w * model.groups.count + g) * 36
        stiffness = model.groups.stiffness
        damping = model.groups.damping
        bad = flexibility_of(w, g, model.groups.count, size, slope, stiffness, damping, residuals.flexibility)
        if bad != 0:
            run.ctl[w].failure = run.ctl[w].failure | k.SINGULAR
        i = int(0)
        while i < n:
            row = first + i
            value = -loads.lam[w, row]
            if i < size:
                value = real(0.0)
                j = int(0)
                while j < size:
                    value += residuals.flexibility[at + 6 * i + j] * (
                        law(model, w, g, j, residuals, loads) - loads.lam[w, first + j]
                    )
                    j += 1
            residuals.defect[w, row] = value
            residuals.softness[w, row] = wp.abs(residuals.flexibility[at + 6 * i + i])
            i += 1
        g += wp.block_dim()


@wp.func
def law(model: Model, w: int, g: int, i: int, residuals: Residuals, loads: LoadState) -> real:
    """lambda of row i of group g from its law."""
    first = model.groups.start[g]
    total = model.rows.preload[first + i]
    j = int(0)
    while j < model.groups.size[g]:
        row = first + j
        total += model.groups.stiffness[g, i, j] * (residuals.coordinate[w, row] - model.rows.reference[row])
        total += model.groups.damping[g, i, j] * loads.drive_rate[w, 1, row]
        j += 1
    return total


@wp.func
def group_energy(model: Model, w: int, g: int, h: real, residuals: Residuals, loads: LoadState) -> vec3:
    """Stored energy of a group, dissipation of its dampers in the step, and work of its skew part."""
    half = real(0.5)
    stored = real(0.0)
    taken = real(0.0)
    worked = real(0.0)
    first = model.groups.start[g]
    n = model.groups.size[g]
    i = int(0)
    while i < n:
        c = residuals.coordinate[w, first + i] - model.rows.reference[first + i]
        step = residuals.coordinate[w, first + i] - loads.stretch[w, first + i]
        j = int(0)
        while j < n:
            K = model.groups.stiffness[g, i, j]
            D = model.groups.damping[g, i, j]
            other = residuals.coordinate[w, first + j] - model.rows.reference[first + j]
            before = loads.stretch[w, first + j] - model.rows.reference[first + j]
            stored += half * K * c * other
            taken += D * step * (residuals.coordinate[w, first + j] - loads.stretch[w, first + j]) / h
            skew = half * (K - model.groups.stiffness[g, j, i])
            worked -= half * skew * (before + other) * step
            j += 1
        i += 1
    return vec3(stored, taken, worked)


@kernel
def apply_loads(
    run: Run, trial: Trial, residuals: Residuals, loads: LoadState, modal_residual: wp.array(dtype=real),
    load_on_modes: wp.array(dtype=real),
):  # fmt: skip
    """Per world: point torques and body loads as generalised forces (force in world axes, torque in body axes, modal),
    subtracted from the residuals and stored for the ledger; `applied_torque`: each separately, body axes.
    """
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    i = int(0)
    while i < 6 * model.bodies.count:
        loads.load[w, 1, i] = real(0.0)
        i += 1
    kept = (2 * w + 1) * model.modes.count  # of the trial state
    i = int(0)
    while i < model.modes.count:
        load_on_modes[kept + i] = real(0.0)
        i += 1
    t = run.clk[w].next_time
    i = int(0)
    while i < model.external[0].torques.count:
        b = model.external[0].torques.body[i]
        torque = vec3(
            evaluate_signal(model, model.external[0].torques.signal[i, 0], t, 0),
            evaluate_signal(model, model.external[0].torques.signal[i, 1], t, 0),
            evaluate_signal(model, model.external[0].torques.signal[i, 2], t, 0),
        )
        if model.external[0].torques.in_body[i] == 0:
            torque = wp.transpose(trial.axes[w, b]) * torque
        residuals.applied_torque[w, i] = torque
        for c in range(3):
            loads.load[w, 1, 6 * b + 3 + c] = loads.load[w, 1, 6 * b + 3 + c] + torque[c]
        interface = model.external[0].torques.interface[i]
        if interface >= 0:
            modes = kept + model.bodies.modal_start[b]
            line = line_of(model, w, interface)
            n = model.bodies.global_count[b]
            none = vec3(real(0.0))
            add_load(n, real(1.0), none, torque, model.interfaces.width, trial.slope, line, load_on_modes, modes)
        i += 1
    i = int(0)
    while i < model.external[0].body_loads.count:
        b = model.external[0].body_loads.body[i]
        s = evaluate_signal(model, model.external[0].body_loads.signal[i], t, 0)
        force = trial.axes[w, b] * (s * model.external[0].body_loads.force[i])
        torque = s * model.external[0].body_loads.torque[i]
        for c in range(3):
            loads.load[w, 1, 6 * b + c] = loads.load[w, 1, 6 * b + c] + force[c]
            loads.load[w, 1, 6 * b + 3 + c] = loads.load[w, 1, 6 * b + 3 + c] + torque[c]
        m = model.bodies.modal_start[b]
        o = m
        while m < model.bodies.modal_start[b + 1]:
            load_on_modes[kept + m] = load_on_modes[kept + m] + s * model.external[0].body_loads.modal[i, m - o]
            m += 1
        i += 1
    i = int(0)
    while i < 6 * model.bodies.count:
        residuals.residual[w, i] = residuals.residual[w, i] - loads.load[w, 1, i]
        i += 1
    i = int(0)
    while i < model.modes.count:
        modal_residual[w * model.modes.count + i] = modal_residual[w * model.modes.count + i] - load_on_modes[kept + i]
        i += 1
