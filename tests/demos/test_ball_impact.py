"""The impact of a ball on a coarser mesh, whole; Hertz's figures from an integration of his force."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind
from scipy.integrate import solve_ivp

from demos import ball_impact as demo


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "ball_impact")
    E, nu, R, v = 210e9, 0.3, 0.01, 0.1
    K, m = 4 / 3 * E / (2 * (1 - nu**2)) * np.sqrt(R), 7800 * 4 / 3 * np.pi * R**3

    def motion(_, y):
        return [y[1], -K / m * max(y[0], 0.0) ** 1.5]

    def leaves(_, y):
        return y[0]

    leaves.terminal, leaves.direction = True, -1.0
    path = solve_ivp(motion, (0.0, 1e-3), [1e-12, v], events=leaves, rtol=1e-10, atol=1e-14, max_step=1e-6)
    assert checks["time of contact"]["computed"] == pytest.approx(path.t_events[0][0], rel=demo.HERTZ)
    assert checks["largest force"]["computed"] == pytest.approx(K * path.y[0].max() ** 1.5, rel=demo.HERTZ)


def test_the_time_of_contact_is_that_of_its_closed_form() -> None:
    """On the force of Hertz's own motion, sampled: the ends are found between the samples."""
    from types import SimpleNamespace

    t = np.linspace(0.0, 1e-4, 101)
    touch, leave = 1.23e-5, 8.71e-5
    approach = np.maximum(np.sin(np.pi * (t - touch) / (leave - touch)), 0.0) * ((t > touch) & (t < leave))
    pair = SimpleNamespace(normal_load=approach**1.5)
    result = SimpleNamespace(time=t, contact=lambda _: pair)
    assert demo.contact_time(result) == pytest.approx(leave - touch, rel=1e-3)  # pyright: ignore[reportArgumentType]
