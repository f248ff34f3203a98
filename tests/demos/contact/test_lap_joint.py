"""The bolted lap joint, whole; its meshes, the numbers of its loops and swings, its full finite elements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import lap_loops
import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed
from lap_loops import Bolt, Full, LoadPath, Loops, Swing

import warpffrf as wf
from demos import lap_joint as demo
from demos.lap_joint import BOLTS, FRICTION, JOINT, SHANK, STEEL, THICKNESS, TIGHTENED, Size, machine, strip

SLIDES = 30e-6  # m, amplitude of the loop of full slip
SMALLER = (3e-6, 6.5e-6)  # m, amplitudes of the first loops
TOUCH = 60.0  # N: a force that hardly a cell slips under
SHOWN = (1, 2, 3, 5, 8)  # cycles of the vibration at whose amplitudes loops are made
CLAMP, PULLED, COULOMB = 1e-4, 1e-4, 1e-3  # held ends carry the rest; linear full FE; some cells slip a little aside
PRESSURE, LOSS = 0.01, 3e-3  # full FE are linear: strips of the engine rotate as a force through both bends them
AREA, FULL_SLIP = 0.01, 0.03  # trapezoids of 16 chords; of pressures that change a little
DAMPING, TAKEN = 0.05, 0.03  # first order in what a cycle takes; loops about the place at rest, cycles drift off it
FREQUENCY = 5e-3  # the integrator's, with 60 steps a cycle
LEDGER = 0.01  # of the work of friction: what the integrator damps


def followed(
    strips: tuple[wf.ReducedBody, wf.ReducedBody], path: LoadPath, rest: float, *, progress: bool = True
) -> tuple[wf.Result, Loops]:
    """The engine through a path about the place `rest` [m]."""
    times = np.arange(len(path.places), dtype=float)
    scene = machine(strips, place=wf.signals.Table(times, rest + path.places))
    result = wf.static(scene, times[-1], step=1.0, progress=progress)
    rows = len(result.time)
    lost = np.append(result.contact(JOINT).loss, np.full(len(times) - rows, np.nan))
    force = np.append(result.joint("guide").force[:, 0], np.full(len(times) - rows, np.nan))
    return result, Loops(path, force, lost[path.loops[:, 1]] - lost[path.loops[:, 0]])


def tensions(result: wf.Result) -> np.ndarray:
    """Of both bolts (T, 2) [N]."""
    return np.stack([np.linalg.norm(result.force(f"bolt{i}").force, axis=1) for i in range(2)], axis=1)


def full_elements(size: Size, path: LoadPath, rest: float, tension: float) -> Full:
    """Full finite elements of the same meshes; `tension` [N] of a bolt at rest, by which it resists leaning."""
    bolt = Bolt(TIGHTENED, SHANK, 2.0 * THICKNESS, tension)
    meshes = strip(size), strip(size, upper=True)
    return Full.of(meshes, STEEL, FRICTION, bolt, len(BOLTS), path, rest)


def static_checks(result: wf.Result, loops: Loops, full: Full) -> list[Check]:
    """Clamp force, slip, and every loop compared with full finite elements."""
    lap, pulls = result.contact(JOINT), tensions(result)
    clamp = lap.normal_force
    top = int(loops.path.loops[-1, 0])  # the strips slide
    lean = float(result.force("bolt0").force[top, 0] + result.force("bolt1").force[top, 0])
    peak = full.cells.pressure.max()
    off = float(np.abs(lap.pressure - full.cells.pressure).max())
    source = "full FE model"
    checks = [
        Check("tightened: clamp force", float(clamp[0]), float(pulls[0].sum()), "pull of both bolts", CLAMP, "kN",
              1e-3),
        Check("tightened: pull of a bolt", float(pulls[0, 0]), float(full.tension[0, 0]), source, PULLED, "kN", 1e-3),
        Check("tightened: peak pressure", float(lap.pressure[0].max()), float(full.cells.pressure[0].max()), source,
              PRESSURE, "MPa", 1e-6),
        Check("all loops: pressures differ by", off, 0.0, f"{source}, over the peak", PRESSURE, "MPa", 1e-6,
              scale=float(peak)),
        Check("sliding: force of friction", float(abs(lap.force[top, 0])), FRICTION * float(clamp[top]), "Coulomb",
              COULOMB, "kN", 1e-3),
        Check("sliding: force on the carriage", float(loops.force[top]), FRICTION * float(clamp[top]) + abs(lean),
              "Coulomb, bolts that lean", COULOMB, "kN", 1e-3),
    ]  # fmt: skip
    for a, loss, exact in zip(loops.path.amplitudes, loops.loss, full.loops.loss, strict=True):
        name = f"loss of a loop of {a * 1e6:.1f} um"
        checks.append(Check(name, float(loss), float(exact), source, LOSS, "mJ", 1e3))
    last = loops.all[-1]
    return [
        *checks,
        Check("its area, full slip", last.loss, float(loops.loss[-1]), "loss by friction", AREA, "mJ", 1e3),
        Check("its loss from the first loading", float(loops.masing[-1]), float(loops.loss[-1]), "Masing's rule",
              FULL_SLIP, "mJ", 1e3),
    ]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Vibration:
    """The swing `large`, with its `result`, and the one `small` that hardly rubs, the first eigenmode about rest:
    frequency [Hz], modal mass [kg] at the carriage, `equivalent` damping of some amplitudes."""

    result: wf.Result
    large: Swing
    small: Swing
    frequency: float
    mass: float
    equivalent: Any


def small_frequency(vibration: Vibration) -> float:
    """Mean [Hz] of the cycles after the first, which begins with a jump of the force."""
    return float(vibration.small.frequency[1:].mean())


def swing_damping(swung: Swing, loops: Loops) -> np.ndarray:
    """2 zeta (n,) of the cycles by the amplitude of the force, that of the first loading."""
    rows = loops.path.first_loading
    force = np.interp(swung.turns()[1], loops.path.places[rows], loops.force[rows])
    return (np.log(force[:-1] / force[1:]) / np.pi)[: len(swung.amplitude)]


def loop_frequency(loops: Loops, mass: float) -> np.ndarray:
    """By the secant stiffness of each loop (k,) [Hz]."""
    return np.sqrt(loops.stiffness / mass) / (2.0 * np.pi)


def energies(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """What a vibration has lost (T,) [J] and the work of friction (T,) [J] so far."""
    energy = result.energy
    kept = np.sum([energy[line] for line in ("kinetic", "strain", "contact", "potential", "contact_grid")], axis=0)
    return kept[0] - kept, energy["friction"][0] - energy["friction"]


def swing_checks(vibration: Vibration, loops: Loops) -> list[Check]:
    """Cycles of the vibration compared with loops at their amplitudes, eigenmodes and the ledger."""
    swung, found = vibration.large, swing_damping(vibration.large, loops)
    nearest = {n: loops.nearest(swung.amplitude[n - 1]) for n in SHOWN}
    checks = [
        Check(f"cycle {n}: 2 zeta of the force", float(found[n - 1]), float(loops.damping[k]), "loop, D/(2 pi U)",
              DAMPING)
        for n, k in nearest.items()
    ]  # fmt: skip
    checks += [
        Check(
            f"cycle {n}: taken by friction", float(swung.taken[n - 1]), float(loops.loss[k]), "loop", TAKEN, "mJ", 1e3
        )
        for n, k in nearest.items()
    ]
    mode = vibration.equivalent
    for zeta, a in zip(mode.damping_ratio, mode.amplitude, strict=True):
        exact = float(loops.damping[loops.nearest(a)])
        checks.append(Check(f"mode at {a * 1e6:.1f} um: 2 zeta", 2.0 * float(zeta), exact, "loop, D/(2 pi U)", DAMPING))
    n = SHOWN[1]
    secant = float(loop_frequency(loops, vibration.mass)[nearest[n]])
    lost, rubbed = energies(vibration.result)
    return [
        *checks,
        Check("small motion: frequency", small_frequency(vibration), vibration.frequency, "eigenmode, cells stick",
              FREQUENCY, "Hz"),
        Check(f"cycle {n}: frequency", float(swung.frequency[n - 1]), secant, "secant of the loop", FREQUENCY, "Hz"),
        Check("energy that the vibration loses", float(lost[-1]), float(rubbed[-1]), "work of friction", LEDGER, "mJ",
              1e3),
    ]  # fmt: skip


SLIDER, STIFF = 3.0, 2.0  # of an element that sticks until it slides: force, stiffness


def swing(strips: demo.Strips, force: float, frequency: float, size: Size) -> tuple[wf.Result, Swing]:
    """The ring-down of the demo, and its motion about the position at rest."""
    result, rest = demo.ring_down(strips, force, frequency, size, progress=False)
    place = result.body("carriage").position[:, 0] - rest
    return result, Swing(result.time - result.time[0], place, result.contact(JOINT).loss, rest - demo.END)


@both_sizes
def test_vibration_loops_and_full_elements_agree(quick: bool) -> None:
    size = demo.QUICK if quick else demo.FULL
    strips = demo.bodies(size, progress=False)
    scene = machine(strips)
    modes = wf.eigenmodes(scene)
    frequency, moves = float(modes.frequencies[0]), float(np.real(modes.shape(0, "carriage").translation[0]))
    ringing, large = swing(strips, demo.PULL, frequency, size)
    _, small = swing(strips, TOUCH, frequency, replace(size, cycles=3))
    path = LoadPath.of(np.concatenate([SMALLER, np.sort(large.amplitude[[n - 1 for n in SHOWN]]), [SLIDES]]))
    result, loops = followed(strips, path, large.rest, progress=False)
    full = full_elements(size, path, large.rest, float(tensions(result)[0].mean()))
    equivalent = modes.equivalent_damping(
        0, path.amplitudes[[len(SMALLER) - 1, -2]], at=scene.body("carriage").at((0, 0, 0)), steps=size.mode_steps
    )
    vibration = Vibration(ringing, large, small, frequency, moves**-2, equivalent)
    found = [*static_checks(result, loops, full), *swing_checks(vibration, loops)]
    assert len(found) == 31 and not missed(found)
    damping = [check.computed for check in found if "2 zeta of the force" in check.name]
    assert damping == sorted(damping, reverse=True)  # it falls with the amplitude
    assert damping[0] > 2.0 * damping[-1]


@pytest.mark.slow
def test_the_whole_demo(tmp_path: Path) -> None:
    """Friction takes in a cycle of the vibration what it takes in the loop of its amplitude."""
    result, loop = demo.main(tmp_path, quick=True, progress=False)
    left_behind(tmp_path, "lap_joint", "loop")
    place, loss = result.body("carriage").position[:, 0], result.contact(JOINT).loss
    tops = np.append(0, 1 + np.flatnonzero((place[1:-1] > place[:-2]) & (place[1:-1] >= place[2:])))
    taken = float(np.diff(loss[tops])[demo.CYCLE - 1])
    assert taken == pytest.approx(loop.contact(JOINT).loss_between(float(demo.HALF), 3.0 * demo.HALF), rel=TAKEN)


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
    """A spring in series with friction, in parallel with a spring of stiffness one."""
    slip, force, lost = 0.0, [], [0.0]
    for x in path.places:
        held = np.clip(STIFF * (x - slip), -SLIDER, SLIDER)
        new = x - held / STIFF
        lost.append(lost[-1] + held * (new - slip))
        slip = new
        force.append(x + held)
    loss = np.array(lost[1:])
    return lap_loops.Loops(path, np.array(force), loss[path.loops[:, 1]] - loss[path.loops[:, 0]])


def test_loops_of_a_sliding_element_are_those_of_its_closed_form() -> None:
    """It slides from SLIDER/STIFF on and takes 4 SLIDER (a - SLIDER/STIFF)."""
    loops = slider(lap_loops.LoadPath.of(np.array([1.0, 3.0, 6.0])))
    a = loops.path.amplitudes
    exact = 4.0 * SLIDER * np.maximum(a - SLIDER / STIFF, 0.0)
    assert loops.loss == pytest.approx(exact, abs=1e-12)
    assert [loop.loss for loop in loops.all] == pytest.approx(exact, rel=0.02, abs=1e-12)  # chords cut corners
    assert loops.masing == pytest.approx(exact, rel=0.02, abs=1e-12)
    assert loops.stuck == pytest.approx(1.0 + STIFF)
    force = a + np.minimum(STIFF * a, SLIDER)
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_other_friction_and_bolts_are_distinguished_from_those_of_the_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    strips = demo.bodies(COARSE, progress=False)
    path = lap_loops.LoadPath.of(np.array([10e-6, SLIDES]))
    rest = 1e-6
    result, loops = followed(strips, path, rest, progress=False)
    full = full_elements(COARSE, path, rest, float(tensions(result)[0].mean()))
    assert [c.name for c in static_checks(result, loops, full) if not c.passed] == []

    def failed(name: str, value: float) -> str:
        with monkeypatch.context() as changed:
            changed.setattr(demo, name, value)
            other = followed(strips, path, rest, progress=False)
        return ", ".join(c.name for c in static_checks(*other, full) if not c.passed)

    friction = failed("FRICTION", 1.02 * demo.FRICTION)
    assert "sliding: force of friction" in friction and "loss of a loop of 30.0 um" in friction
    bolts = failed("TIGHTENED", 1.01 * demo.TIGHTENED)
    assert "pull of a bolt" in bolts and "loss of a loop of 30.0 um" in bolts
