"""The clamped plate, whole; what membrane energy is for; cycles of a swing that is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import plate as demo
from demos.plate import (
    A_PERIOD,
    BENDING,
    FREQUENCY,
    FULL,
    SIDE,
    STEEL,
    THICKNESS,
    UNIT,
    Size,
    deflection,
    half_lines,
    plate_mesh,
    pressed_area,
)
from references.closed_forms import LEVY_CLAMPED_SQUARE
from references.closed_forms.large_deflections import LEVY_POISSON, clamped_plate_frequency
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.motion import released
from references.large_deflections.statics import by_load

Array = np.ndarray
ALONE = 0.00126 * UNIT * SIDE**4 / BENDING / THICKNESS  # w/t of a unit load, if it only bends (Timoshenko)
SHOWN = (0.3, 0.6, 1.0)  # A/t of the checks
SERIES, FULL_MODEL = 0.028, 4e-3  # the error of his series and of the mesh, that of 20 modes
CLAMPED = 0.015  # of the first frequency: a solid plate, and its cells
ONE_TERM = 0.01  # of f/f0 up to A = t
LET_GO = (134.9, 402.0)  # q a^4/(E t^4) of the runs without damping
SWING = 0.015, 0.03  # rms over the amplitude, in the first period


@dataclass(frozen=True, eq=False)
class Swing:
    """A run that is let go at t = 0: times t (T,) [s] and w/t (T,) of the middle."""

    t: Array
    w: Array

    @property
    def cycles(self) -> tuple[Array, Array]:
        """Amplitudes A/t (n,) and frequencies (n,) [Hz] of the cycles from one upward crossing of zero to the next."""
        return demo.cycles(self.t, self.w)

    def frequency(self, amplitude: float) -> float:
        """Hz at an amplitude A/t."""
        A, f = self.cycles
        return float(np.interp(amplitude, A[::-1], f[::-1]))


@dataclass(frozen=True, eq=False)
class FullModel:
    """A quarter of the plate in full finite elements: w/t (n,) under the loads, and swings by the load let go."""

    w: Array
    swings: dict[float, Swing] = field(default_factory=dict)


def full_model(size: Size = FULL, let_go: Sequence[float] = ()) -> FullModel:
    """Statics, and motion over one linear period, by symmetry."""
    mesh = plate_mesh(half_lines(size), size)
    body = StVenantKirchhoffBody(mesh, STEEL)
    mirrors = [3 * np.flatnonzero(np.isclose(mesh.points[:, c], 0.0)) + c for c in (0, 1)]
    held = np.unique(np.concatenate([*mirrors, body.held("rim")]))
    load = body.spread("face", (0.0, 0.0, 0.25 * UNIT * pressed_area(size)))
    middle = 3 * body.nearest_node((0.0, 0.0, 0.5 * THICKNESS)) + 2
    states = by_load(body, held, load, size.loads)
    swings = {}
    for chosen in let_go:
        begin = states[size.loads.index(chosen)].u
        motion = released(body, held, begin, 1.0 / FREQUENCY, A_PERIOD)
        swings[chosen] = Swing(motion.t, motion.u[:, middle] / THICKNESS)
    return FullModel(np.array([s.u[middle] for s in states]) / THICKNESS, swings)


@dataclass(frozen=True, eq=False)
class Runs:
    """All runs: the static one and the one that dies out, those without damping by the load let go from, and f0 [Hz]
    of the scene's eigenmodes."""

    pressed: wf.Result
    dying: wf.Result
    swing: Swing
    free: dict[float, tuple[wf.Result, Swing]]
    linear: float


def released_at(load: float, size: Size) -> tuple[wf.Result, Swing]:
    """A plate without damping, released from a load, for two periods of the linear first mode."""
    loads = [q for q in size.loads if q <= load]
    pressed = demo.press(demo.build(size, loads=loads, damped=False, progress=False), loads, progress=False)
    run = demo.release(pressed, 2.0, progress=False)
    return run, swing_of(run, pressed)


def swing_of(run: wf.Result, pressed: wf.Result) -> Swing:
    """Its time is zero in the middle of the step in which the pressure vanishes."""
    return Swing(run.time - pressed.time[-1] - 0.5 * demo.STEP, deflection(run))


def off(mine: Swing, full: Swing) -> float:
    """rms of the difference over that of the full model, in its time."""
    return float(np.sqrt(np.mean((np.interp(full.t, mine.t, mine.w) - full.w) ** 2) / np.mean(full.w**2)))


def checks(runs: Runs, full: FullModel, size: Size) -> list[Check]:
    """The figures of all runs."""
    found = []
    w = deflection(runs.pressed)[1:]
    for i, load in enumerate(size.loads):
        name = f"qa4/Et4 = {load:g}: w/t"
        found.append(Check(name, float(w[i]), LEVY_CLAMPED_SQUARE[load], "Levy", SERIES))
        found.append(Check(f"{name}, same cells", float(w[i]), float(full.w[i]), "full FE model", FULL_MODEL))
    found.append(Check("first frequency", runs.linear, FREQUENCY, "thin plate", CLAMPED, "Hz"))
    for A in SHOWN:
        exact = clamped_plate_frequency(A, LEVY_POISSON)
        ratio = runs.swing.frequency(A) / runs.linear
        found.append(Check(f"A/t = {A:g}: frequency over the first", ratio, exact, "one term, Duffing", ONE_TERM))
    for (load, (_, swing)), bound in zip(runs.free.items(), SWING, strict=False):
        reference = full.swings[load]
        name = f"let go at w/t = {reference.w[0]:.2f}: w off by"
        found.append(Check(name, off(swing, reference), 0.0, "full FE model, a period, rms over rms", bound, scale=1.0))
    return found


SMALL = demo.Size(cells=4, loads=(402.0,))


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    size, let_go = (demo.QUICK, LET_GO[:1]) if quick else (demo.FULL, LET_GO)
    dying, pressed = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "plate", "pressed")
    free = {load: released_at(load, size) for load in let_go}
    linear = float(wf.eigenmodes(pressed.scene, 1, about="initial").frequencies[0])
    runs = Runs(pressed, dying, swing_of(dying, pressed), free, linear)
    found = checks(runs, full_model(size, let_go), size)
    assert len(found) == (11 if quick else 24) and not missed(found)
    assert {check.name: check.computed for check in found}["A/t = 1: frequency over the first"] > 1.1
    assert demo.LEVY == LEVY_CLAMPED_SQUARE and STEEL.poisson_ratio == LEVY_POISSON


def test_without_membrane_energy_the_plate_goes_nearly_three_times_as_far() -> None:
    """The closed form of a plate that bends alone, and 4 % of coarse cells."""
    scene = demo.build(SMALL, progress=False)
    scene.body("plate").stiffening = False
    bent = float(demo.deflection(demo.press(scene, SMALL.loads, progress=False))[-1])
    assert bent == pytest.approx(402.0 * ALONE, rel=0.08)
    full = full_model(SMALL).w[-1]
    assert 2.7 < bent / full < 3.0


def test_cycles_of_a_known_swing() -> None:
    """A cosine that dies out by a hundredth a cycle."""
    t = np.linspace(0.0, 20.0, 1201)
    swing = Swing(t, np.exp(-0.01 * t) * np.cos(2.0 * np.pi * t))
    A, f = swing.cycles
    np.testing.assert_allclose(f, 1.0, rtol=1e-4)
    np.testing.assert_allclose(A, np.exp(-0.01 * (np.arange(len(A)) + 1.25)), rtol=5e-3)
    assert swing.frequency(0.9) == pytest.approx(1.0, rel=1e-4)


def test_one_term_by_fourier_series() -> None:
    """V_m/V_b of w = (A/4)(1 + cos kx)(1 + cos ky): Airy's function solved on a grid, mean strains by mean slopes."""
    nu, n = 0.3, 32
    x = np.arange(n) / n
    X, Y = np.meshgrid(2.0 * np.pi * x, 2.0 * np.pi * x, indexing="ij")
    k = 2.0 * np.pi  # a = E = t = A = 1
    wx = -0.25 * k * np.sin(X) * (1.0 + np.cos(Y))
    wxx = -0.25 * k**2 * np.cos(X) * (1.0 + np.cos(Y))
    wxy = 0.25 * k**2 * np.sin(X) * np.sin(Y)
    load = np.fft.fft2(wxy**2 - wxx * wxx.T)
    m = k * np.fft.fftfreq(n, 1.0 / n)
    square = m[:, None] ** 2 + m[None] ** 2
    square[0, 0] = np.inf
    lap = np.fft.ifft2(load / -square).real
    strain = 0.5 * np.mean(wx**2)
    stretched = 0.5 * np.mean(lap**2) + strain**2 / (1.0 - nu)
    bent = np.pi**4 / (12.0 * (1.0 - nu**2))
    amplitude = 1e-2
    expected = 1.0 + 0.375 * 2.0 * stretched / bent * amplitude**2
    assert clamped_plate_frequency(amplitude, nu) - 1.0 == pytest.approx(expected - 1.0, rel=1e-3)
