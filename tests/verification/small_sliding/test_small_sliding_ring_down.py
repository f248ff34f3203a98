"""Case A8 in full finite elements: what bolted sheets lose in a cycle of free vibration is what the static loop at that
amplitude encloses, and the logarithmic decrement is that of the equivalent damping."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from references.closed_forms import equivalent_damping
from references.small_sliding.dynamics import Scheme, peaks, released
from references.small_sliding.quasi_static import StaticSmallSliding
from studies.small_sliding.joint_spaces import FRICTION, two_sheets

STEPS = 60  # a period
CYCLES = 8
SETTLED = 3  # cycles after release, in which higher modes die out
TIED = 1e12  # N/m, of springs in the cells that the preload shuts: the frequency of small vibration


@pytest.mark.slow
def test_loss_in_free_vibration_is_that_of_the_static_loop() -> None:
    joint = two_sheets((40, 1, 1))
    model, cells = joint.lap.model, joint.cells
    lap = StaticSmallSliding(model, cells, FRICTION)
    preload = joint.loads[:, :1]
    shut = np.repeat(lap.follow(preload, np.array([[1.0]])).force[0, :, 0] > 0.0, 3)
    B = cells.loads[:, shut]
    K, M = (sp.csc_matrix(A[model.free][:, model.free]) for A in (model.K + TIED * B @ B.T, model.M))
    squares, modes = eigsh(K, k=3, M=M, sigma=0.0)
    tip = model.spread(1, "x_max", (0.0, 0.0, 1.0))
    chosen = int(np.argmax(np.abs(tip[model.free] @ modes)))
    shape = np.zeros(model.size)
    shape[model.free] = modes[:, chosen] / (tip[model.free] @ modes[:, chosen])
    inertia = model.M @ shape
    loads = np.concatenate([preload, inertia[:, None] / (inertia @ shape)], axis=1)
    period = float(2.0 * np.pi / np.sqrt(squares[chosen]))

    amplitudes, losses, damping = [], [], []
    for force in (40.0, 60.0, 70.0, 80.0, 90.0, 100.0):
        P = force * np.concatenate([np.linspace(0, 1, 7)[1:], np.linspace(1, -1, 13)[1:], np.linspace(-1, 1, 13)[1:]])
        found = lap.follow(loads, np.stack([np.ones(len(P)), P], axis=1), loads[:, 1:])
        amplitudes.append(0.5 * np.ptp(found.observed[5:]))
        losses.append(found.loss(5, len(P) - 1))
        damping.append(equivalent_damping(losses[-1], 0.5 * force * amplitudes[-1]))
    rise = np.linspace(0.0, 100.0, 21)[1:]
    motion = released(
        lap,
        loads,
        np.stack([np.ones(20), rise], axis=1),
        np.array([1.0, 0.0]),
        steps=STEPS * CYCLES,
        step=period / STEPS,
        scheme=Scheme.damped(0.95),
        observed=loads[:, 1:],
    )
    moved = motion.observed[:, 0]
    at = peaks(moved, 0.3)
    low = np.array([moved[a:b].min() for a, b in zip(at, at[1:], strict=False)])  # slip leaves the middle aside of zero
    lost = np.diff(motion.dissipated[at])
    middle = 0.5 * (0.5 * (moved[at[1:]] + moved[at[:-1]]) - low)
    decrement = np.log(moved[at[:-1]] / moved[at[1:]])
    known = np.log(amplitudes)
    wanted, zeta = (np.exp(np.interp(np.log(middle), known, np.log(v)))[SETTLED:] for v in (losses, damping))
    assert len(wanted) >= 3
    assert lost[SETTLED:] == pytest.approx(wanted, rel=0.1)
    assert lost[SETTLED:].sum() == pytest.approx(wanted.sum(), rel=0.05)
    assert decrement[SETTLED:].mean() == pytest.approx(2.0 * np.pi * zeta.mean(), rel=0.1)  # with the scheme's damping
