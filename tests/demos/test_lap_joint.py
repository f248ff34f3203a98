"""The bolted lap joint, whole; its meshes, the numbers of its loops and swings, its full finite elements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import lap_joint as demo
from demos import lap_loops

SLIDES, STIFF = 3.0, 2.0  # of an element that sticks until it slides: force, stiffness


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "lap_joint", "swing", "small")
    assert len(checks) == 31
    damping = [check["computed"] for name, check in checks.items() if "2 zeta of the force" in name]
    assert damping == sorted(damping, reverse=True)  # it falls with the amplitude
    assert damping[0] > 2.0 * damping[-1]


def test_strips_have_their_volume_and_cells_that_lie_on_each_other() -> None:
    for size in (demo.FULL, demo.QUICK):
        lower, upper = demo.strip(size).check(), demo.strip(size, upper=True).check()
        holes = len(demo.BOLTS) * (2.0 * demo.HOLE) ** 2
        area = (demo.FREE + demo.OVERLAP) * demo.WIDTH - holes
        for mesh in (lower, upper):
            assert mesh.volume() == pytest.approx(demo.THICKNESS * area, rel=1e-9)
            for name in ("head0", "head1"):
                x = mesh.points[mesh.facets(name).node_set]
                assert np.ptp(x, axis=0) == pytest.approx([2.0 * demo.HEAD, 2.0 * demo.HEAD, 0.0], abs=1e-12)
                assert np.abs(x - x.mean(axis=0)).max(axis=1).min() == pytest.approx(demo.HOLE)
        centers = [mesh.facets("overlap").centers(mesh.points) for mesh in (lower, upper)]
        order = [np.lexsort(np.round(c, 9).T) for c in centers]
        assert centers[0][order[0]] == pytest.approx(centers[1][order[1]], abs=1e-12)


def test_a_path_goes_up_once_with_loops_on_its_way() -> None:
    path = lap_loops.LoadPath.of(np.array([1.0, 1.5, 4.0]))
    up = path.places[path.first_loading]
    assert np.all(np.diff(up) > 0.0)
    assert up[[0, -1]] == pytest.approx([0.0, 4.0])
    for a, (first, last) in zip(path.amplitudes, path.loops, strict=True):
        loop = path.places[first : last + 1]
        assert loop[[0, lap_loops.HALF, -1]] == pytest.approx([a, -a, a])
        assert last - first == 2 * lap_loops.HALF


def slider(path: lap_loops.LoadPath) -> lap_loops.Loops:
    """A spring in series with friction, beside a spring of stiffness one."""
    slip, force, lost = 0.0, [], [0.0]
    for x in path.places:
        held = np.clip(STIFF * (x - slip), -SLIDES, SLIDES)
        new = x - held / STIFF
        lost.append(lost[-1] + held * (new - slip))
        slip = new
        force.append(x + held)
    loss = np.array(lost[1:])
    return lap_loops.Loops(path, np.array(force), loss[path.loops[:, 1]] - loss[path.loops[:, 0]])


def test_loops_of_a_sliding_element_are_those_of_its_closed_form() -> None:
    """It slides from SLIDES/STIFF on and takes 4 SLIDES (a - SLIDES/STIFF)."""
    loops = slider(lap_loops.LoadPath.of(np.array([1.0, 3.0, 6.0])))
    a = loops.path.amplitudes
    exact = 4.0 * SLIDES * np.maximum(a - SLIDES / STIFF, 0.0)
    assert loops.loss == pytest.approx(exact, abs=1e-12)
    assert [loop.loss for loop in loops.all] == pytest.approx(exact, rel=0.02, abs=1e-12)  # chords cut corners
    assert loops.masing == pytest.approx(exact, rel=0.02, abs=1e-12)
    assert loops.stuck == pytest.approx(1.0 + STIFF)
    force = a + np.minimum(STIFF * a, SLIDES)
    assert loops.damping == pytest.approx(exact / (2.0 * np.pi * 0.5 * a * force))
    assert loops.stiffness == pytest.approx(force / a)
    assert loops.nearest(2.9) == 1


def test_the_amplitude_of_the_force_falls_by_the_damping_of_the_loop() -> None:
    """With the first loading g = x - c x^3 and Masing's loops the next reversal is where the force has done no work,
    2 m g(m + e) = 4 G(m). D/(2 U) is right to what a cycle takes, for the force; for the place it is not."""
    c = 0.1

    def g(x: float) -> float:
        return x - c * x**3

    def below(m: float) -> float:
        """Where a half loop of amplitude m begins."""
        mean = 2.0 * (m**2 / 2.0 - c * m**4 / 4.0) / m
        return float(np.sort(np.roots([-c, 0.0, 1.0, -mean]).real)[1])

    tops = [0.9]
    for _ in range(2):
        m = tops[-1]
        for _ in range(60):  # m of the half loop that begins at the last top
            m += tops[-1] - below(m)
        tops.append(2.0 * m - tops[-1])
    a = 0.5 * (0.5 * (tops[0] + tops[2]) + tops[1])
    loss = 8.0 * (a**2 / 2.0 - c * a**4 / 4.0) - 4.0 * a * g(a)
    falls = loss / (a * g(a))
    assert np.log(g(tops[0]) / g(tops[2])) == pytest.approx(falls, rel=0.03)
    assert np.log(tops[0] / tops[2]) > 1.15 * falls


def test_a_swing_has_the_tops_of_its_oscillation() -> None:
    rate, omega = 8.0, 400.0
    t = 5e-5 * np.arange(2000)
    x = np.exp(-rate * t) * (np.cos(omega * t) + rate / omega * np.sin(omega * t))  # from rest
    swing = lap_loops.Swing(t, x, 1.0 - np.exp(-2.0 * rate * t))
    period = 2.0 * np.pi / omega
    at, top = swing.turns()
    n = np.arange(len(top))
    assert at == pytest.approx(period * n, abs=1e-6)
    assert top == pytest.approx(np.exp(-rate * period * n), rel=1e-5)
    assert swing.frequency == pytest.approx(1.0 / period, rel=1e-4)
    full = n[: len(swing.amplitude)]
    assert swing.amplitude == pytest.approx(np.exp(-rate * period * (full + 0.5)), rel=2e-3)
    assert swing.taken == pytest.approx(
        np.exp(-2.0 * rate * period * full) * (1.0 - np.exp(-2.0 * rate * period)), rel=1e-3
    )


COARSE = replace(demo.QUICK, along=(0.0, 0.007, 0.011, 0.019, 0.023, 0.03), beside=2)


def test_full_elements_without_friction_hold_the_carriage_by_leaning_bolts_alone() -> None:
    path = lap_loops.LoadPath.of(np.array([5e-6]))
    tension = 7e3
    bolt = lap_loops.Bolt(demo.TIGHTENED, demo.SHANK, 2.0 * demo.THICKNESS, tension)
    meshes = demo.strip(COARSE), demo.strip(COARSE, upper=True)
    full = lap_loops.Full.of(meshes, demo.STEEL, 0.0, bolt, len(demo.BOLTS), path, 0.0)
    force = full.loops.force - full.loops.force[0]
    lean = len(demo.BOLTS) * tension / (2.0 * demo.THICKNESS)
    assert force == pytest.approx(lean * path.places, abs=0.02 * lean * 5e-6)  # strips yield, too
    assert full.loops.loss == pytest.approx([0.0], abs=1e-15)
    pull = full.tension.sum(axis=1)
    assert full.cells.force[:, :, 0].sum(axis=1) == pytest.approx(pull, rel=1e-2)


def test_other_friction_and_other_bolts_are_told_from_those_of_the_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    strips = demo.bodies(COARSE, progress=False)
    path = lap_loops.LoadPath.of(np.array([10e-6, demo.SLIDES]))
    rest = 1e-6
    result, loops = demo.followed(strips, path, rest, progress=False)
    full = demo.full_elements(COARSE, path, rest, float(demo.tensions(result)[0].mean()))
    assert [c.name for c in demo.static_checks(result, loops, full) if not c.passed] == []

    def failed(name: str, value: float) -> str:
        with monkeypatch.context() as changed:
            changed.setattr(demo, name, value)
            other = demo.followed(strips, path, rest, progress=False)
        return ", ".join(c.name for c in demo.static_checks(*other, full) if not c.passed)

    friction = failed("FRICTION", 1.02 * demo.FRICTION)
    assert "sliding: force of friction" in friction and "loss of a loop of 30.0 um" in friction
    bolts = failed("TIGHTENED", 1.01 * demo.TIGHTENED)
    assert "pull of a bolt" in bolts and "loss of a loop of 30.0 um" in bolts
