r"""Free motion M u'' + f(u) = 0 of a body from a state of rest, by the trapezoidal rule (N. M. Newmark, J. Eng. Mech.
85 (1959) 67, with beta = 1/4, gamma = 1/2),

    u_1 = u_0 + h v_0 + h^2 (a_0 + a_1)/4,        v_1 = v_0 + h (a_0 + a_1)/2,        M a_1 + f(u_1) = 0,

of second order: its periods are longer by (omega h)^2/12. Newton's matrix 4 M/h^2 + K(u) is factored once per step, at
its beginning, and again if that does not converge fast.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from references.large_deflections.body import StVenantKirchhoffBody
from warpffrf.model.errors import InputError, require_count, require_number

Array = np.ndarray
BALANCED = 1e-8  # of the internal forces at the beginning: tolerance of the residual
SLOW = 0.3  # of the previous residual: the matrix is renewed
ITERATIONS = 30


@dataclass(frozen=True, eq=False)
class Motion:
    """Times t (T,) [s], displacements u (T, 3 n) [m] and the energy (T,) [J], kinetic and strain."""

    t: Array
    u: Array
    energy: Array


def released(body: StVenantKirchhoffBody, held: Array, u: Array, duration: float, steps: int) -> Motion:
    """The motion of `body`, its dofs `held` fixed, that begins at rest at `u` (3 n,) [m], in `steps` steps.

    Raises `InputError` for wrong input, and if a step does not converge.
    """
    steps = require_count(steps, "released: steps", 1)
    h = require_number(duration, "released: duration", positive=True) / steps
    free = body.free(held)
    M = csc_matrix(body.M[free][:, free])
    whole = np.array(u, dtype=float)
    v, inside = np.zeros(len(free)), body.forces(whole)[free]
    mass = splu(M)
    a = -mass.solve(inside)
    states, energies = [whole.copy()], [body.energy(whole)]
    scale = float(np.linalg.norm(inside))
    for step in range(steps):
        begin = whole[free].copy()
        a_1, solver, last = -a, None, np.inf  # u_0 + h v_0: stiff motions would make a large u_1 of a_1 = a_0
        for _ in range(ITERATIONS):
            whole[free] = begin + h * v + 0.25 * h**2 * (a + a_1)
            f = body.forces(whole)[free]
            rest = -(M @ a_1 + f)
            size = float(np.linalg.norm(rest))
            if size <= BALANCED * scale:
                break
            if solver is None or size > SLOW * last:
                solver = splu(
                    csc_matrix(M + 0.25 * h**2 * body.tangent(whole)[free][:, free]),
                    permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True},
                )  # fmt: skip
            a_1 = a_1 + solver.solve(rest)
            last = size
        else:
            raise InputError(f"released: step {step + 1} does not converge, residual {size / scale:.2g}; more steps")
        v = v + 0.5 * h * (a + a_1)
        a, inside = a_1, f
        states.append(whole.copy())
        energies.append(float(0.5 * v @ (M @ v)) + body.energy(whole))
    return Motion(h * np.arange(steps + 1), np.array(states), np.array(energies))
