"""The same flexible body, modes and joint in EXUDYN: an independent program's equations and integrator.

`make verify` installs it (extra `verify`); elsewhere these tests are skipped.
"""

from __future__ import annotations

import numpy as np
import pytest

from studies.speed import against_exudyn as study
from warpffrf.offline.fe import assemble, assign

pytestmark = pytest.mark.slow
pytest.importorskip("exudyn", reason='EXUDYN is not installed: pip install -e ".[verify]", or make verify')

DURATION, SAVED = 0.4, 0.02  # s: compared 20 times on the way
CLOSE = 1e-4  # of the bar's length: the promise
ORDER = 0.3  # by which the order observed may miss 2
SEEN = 1e-3  # of the bar's length: what the inertia terms do here at least, ten times what is asked for
SINGLE = 1e-6  # rounding of modes that are kept in single precision
FULL_NEWTON = 50.0  # at 50 modes, the promise


def paths(modes: int, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tip in ours, in EXUDYN, and in ours without inertia terms, all (T, 3) [m]."""
    mesh = study.bar()
    body = study.reduced_bar(mesh, modes)
    phi = study.nodal_modes(mesh, body)
    steps, every = round(DURATION / step), round(SAVED / step)
    found = []
    for level in ("full", "constant"):
        history = study.our_run(study.our_scene(body, level), steps, step, every)
        assert history.status == "completed", history.message
        found.append(study.our_tip(history, mesh, phi))
    theirs, _ = study.rival(mesh, body, phi).solve(steps, step, save=every)
    assert found[0].shape == theirs.shape == (round(DURATION / SAVED) + 1, 3)
    return found[0], theirs, found[1]


def test_both_programs_get_the_same_body() -> None:
    """The modes at all nodes are orthonormal in M and carry the frequencies in K, to their own rounding."""
    mesh = study.bar()
    body = study.reduced_bar(mesh, 50)
    phi = study.nodal_modes(mesh, body)
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, study.SOFT))
    squares = (2.0 * np.pi * body.frequencies) ** 2
    assert np.abs(phi.T @ (M @ phi) - np.eye(50)).max() < SINGLE
    assert np.abs(phi.T @ (K @ phi) - np.diag(squares)).max() < SINGLE * squares.max()


@pytest.mark.parametrize("modes", [10, 20, 50])
def test_trajectories_agree(modes: int) -> None:
    """To 1e-4 of the length, over a fall in which the inertia terms move the tip by more than ten times that."""
    ours, theirs, constant = paths(modes, 5e-4)
    worst = np.abs(ours - theirs).max() / study.LENGTH
    print(f"{modes} modes: {worst:.2e} of the length; without inertia terms "
          f"{np.abs(constant - theirs).max() / study.LENGTH:.2e}")  # fmt: skip
    assert worst < CLOSE
    assert np.abs(constant - theirs).max() > SEEN * study.LENGTH


def test_the_difference_is_that_of_the_steps() -> None:
    """Both methods are of order 2, with errors of their own: the difference falls with h^2 and leaves no rest."""
    worst = [np.abs(np.subtract(*paths(10, step)[:2])).max() for step in (1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(worst[:-1]) / worst[1:])
    print(f"differences {np.array(worst) / study.LENGTH}, orders {orders}")
    assert np.all(np.abs(orders - 2.0) < ORDER)


def test_a_step_with_50_modes_is_50_times_faster_than_full_newton() -> None:
    """Timed side by side, one thread; the fastest of three each. The table is bench/against_exudyn.py."""
    mesh = study.bar()
    body = study.reduced_bar(mesh, 50)
    rival = study.rival(mesh, body, study.nodal_modes(mesh, body))
    step, few, many = 5e-4, 12, 400
    theirs, ours = [], []
    for _ in range(3):
        start = rival.solve(2, step)[1]
        theirs.append((rival.solve(2 + few, step)[1] - start) / few)
        counters = study.our_run(study.our_scene(body), many, step, many).counters
        ours.append(counters["seconds_in_graph"] / counters["steps"])
    print(f"EXUDYN {min(theirs) * 1e6:.0f} us, ours {min(ours) * 1e6:.0f} us: {min(theirs) / min(ours):.0f} times")
    assert min(theirs) > FULL_NEWTON * min(ours)
