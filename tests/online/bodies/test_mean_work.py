"""Forces through quadratic coordinates do the work of their potential: energy of a plate and of a pinned beam at large
amplitude, and the beam's frequency (Woinowsky-Krieger)."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from references.closed_forms import pinned_beam_frequency
from warpffrf.model import joints
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.stages import Stage
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate

MATERIAL = Material(210e9, 0.3, 7850.0)
SIDE, THICK = 0.4, 4e-3  # m, of the plate
PRESSURE = 500.0  # q a^4/(E t^4): w/t 1.9, membrane energy two thirds of that of bending
LENGTH, DEPTH = 1.0, 5e-3  # m, of the beam
RADIUS = DEPTH / np.sqrt(12.0)
EXACT = 1e-6  # of the energy: what the tolerance of the iteration, 1e-9 of the forces, leaves in all steps
# of the energy: what the error of an oscillator's energy goes to and fro by where a method dissipates
SWINGS = 2e-3


@functools.cache
def plate() -> ReducedBody:
    plain = box((SIDE, SIDE, THICK), (6, 6, 1))
    sides = [plain.facets(name) for name in ("x_min", "x_max", "y_min", "y_max")]
    rim = FacetSet({kind: np.concatenate([s.blocks[kind] for s in sides]) for kind in sides[0].blocks})
    mesh = Mesh(plain.points, plain.cells, {"rim": rim})
    return reduce(
        mesh,
        MATERIAL,
        interfaces={"rim": "rigid"},
        modes=14,
        options=ReductionOptions(stiffening="membrane"),
        progress=False,
    )


@functools.cache
def beam() -> ReducedBody:
    return reduce(
        box((LENGTH, 0.02, DEPTH), (16, 1, 1), order=2), MATERIAL, interfaces={"x_min": "rigid", "x_max": "rigid"},
        modes=8, options=ReductionOptions(stiffening="membrane"), progress=False,
    )  # fmt: skip


def held_plate() -> Scene:
    """The plate with its rim held under a pressure."""
    unit = MATERIAL.youngs_modulus * THICK**3 / (SIDE**4 * MATERIAL.density)
    scene = Scene(gravity=(0.0, 0.0, -PRESSURE * unit))
    body = scene.add_body(plate(), name="body", damping=0.0, stiffening=True, inertia="constant")
    scene.add(joints.Fixed(scene.ground, body["rim"], name="rim"))
    return scene


def pinned(amplitude: float) -> Scene:
    """The beam between pins that stay where they are, bent by about `amplitude` times the radius of gyration of its
    section: by uniform load, whose part along sin is 4/pi of it, against bending and stretching."""
    a, E = amplitude * RADIUS, MATERIAL.youngs_modulus
    load = np.pi / 4.0 * E * RADIUS**2 * (np.pi / LENGTH) ** 4 * a * (1.0 + 0.25 * amplitude**2)
    scene = Scene(gravity=(0.0, 0.0, -load / MATERIAL.density))
    body = scene.add_body(beam(), name="body", damping=0.0, stiffening=True, inertia="constant")
    for end in ("x_min", "x_max"):
        scene.add(joints.Revolute(scene.ground, body[end], axis=(0.0, 1.0, 0.0), name=end))
    return scene


def first_frequency() -> float:
    """Of the beam, small [Hz]."""
    E = MATERIAL.youngs_modulus
    return 0.5 * np.pi / LENGTH**2 * RADIUS * np.sqrt(E / MATERIAL.density)


def released(scene: Scene, period: float, periods: float, steps: int, integrator):
    """What the scene does from its equilibrium on, without gravity, in `steps` steps a period."""
    rest = equilibrium(scene)
    assert rest.status == "completed", rest.message
    free = Stage("free", round(periods * steps) * period / steps, period / steps, {"gravity": (0.0, 0.0, 0.0)})
    result = simulate(scene, [free], start=rest, options=RunOptions(integrator=integrator), progress=False)
    assert result.status == "completed", result.message
    return result


def energies(result) -> tuple[np.ndarray, np.ndarray]:
    """Energy over that at the start, and what the integrator has made of it so far."""
    lines = {name: np.asarray(values) for name, values in result.energy.items()}
    total = lines["kinetic"] + lines["strain"]
    return total / total[0], lines["numerical"] / total[0]


PLATE_PERIOD = 1.0 / 240.0  # s, small amplitudes; at this one it is two thirds


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(1.0), Newmark(), HHT(0.0)])
def test_energy_of_a_plate_is_kept(integrator) -> None:
    """By all that dissipate nothing, with ten steps a period as well."""
    total, numerical = energies(released(held_plate(), PLATE_PERIOD, 20.0, 10, integrator))
    np.testing.assert_allclose(total, 1.0, atol=EXACT)
    np.testing.assert_allclose(numerical, total - 1.0, atol=1e-3 * EXACT)


@pytest.mark.parametrize(("rho_inf", "least"), [(1.0, 1.0 - EXACT), (0.95, 0.97), (0.8, 0.45)])
def test_energy_over_two_hundred_periods(rho_inf, least) -> None:
    """Thirty steps a period: kept, or lost as of a linear vibration, and no gain."""
    total, _ = energies(released(held_plate(), PLATE_PERIOD, 200.0, 30, GeneralizedAlpha(rho_inf)))
    assert total.min() > least
    assert total.max() < 1.0 + (EXACT if rho_inf == 1.0 else SWINGS)


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(), GeneralizedAlpha(0.5), HHT()])
def test_dissipation_is_no_gain(integrator) -> None:
    total, numerical = energies(released(held_plate(), PLATE_PERIOD, 10.0, 50, integrator))
    assert total.max() < 1.0 + SWINGS and total[-1] < 1.0
    np.testing.assert_allclose(numerical, total - 1.0, atol=EXACT)


def test_energy_of_a_pinned_beam_is_kept() -> None:
    """Its ends draw near by -q.K q/2, against the pins."""
    total, _ = energies(released(pinned(5.0), 1.0 / first_frequency(), 10.0, 30, GeneralizedAlpha(1.0)))
    np.testing.assert_allclose(total, 1.0, atol=EXACT)


@pytest.mark.parametrize("amplitude", [1.0, 2.0, 3.0, 5.0])
def test_frequency_of_a_pinned_beam(amplitude) -> None:
    """Within half a per cent, at the amplitude of the sine that it is released with."""
    scene, body = pinned(amplitude), beam()
    result = released(scene, 1.0 / first_frequency(), 4.0, 120, GeneralizedAlpha())
    sine = np.sin(np.pi * (body.surface.points[:, 0] / LENGTH + 0.5))
    motion = result.history.bodies["body"]
    w = motion.position[:, 2, None] + motion.modal @ body.surface.modes[:, :, 2]
    a = w @ sine / (sine @ sine)
    found = np.abs(a[0]) / RADIUS
    t = np.asarray(result.time)
    up = np.flatnonzero((a[:-1] < 0.0) & (a[1:] >= 0.0))
    crossing = t[up] - a[up] * (t[up + 1] - t[up]) / (a[up + 1] - a[up])
    ratio = (len(crossing) - 1) / (crossing[-1] - crossing[0]) / first_frequency()
    assert found == pytest.approx(amplitude, rel=0.05)
    assert ratio == pytest.approx(pinned_beam_frequency(found), rel=5e-3)
