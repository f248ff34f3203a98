"""Surface velocity by orders: motions in closed form, power of a piston, varying speed, universal files, refusals."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.unv import read_unv
from warpffrf.online.history.history import BodyHistory
from warpffrf.output.surface_velocity import SurfaceVelocity, surface_velocity

Array = np.ndarray
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
TURNS, PER_TURN = 4, 60
SIZE = np.array([0.2, 0.1, 0.06])
TILT = np.array([0.0, 0.0, np.sin(0.3), np.cos(0.3)])  # of the housing, 0.6 rad about z
PLACE = np.array([0.5, -0.2, 0.1])


@pytest.fixture(scope="module")
def housing() -> Any:
    mesh = wf.mesh.box(tuple(SIZE), (4, 2, 2), order=1)
    return wf.reduce(mesh, STEEL, modes=5, cache=False, progress=False)


def tilt() -> Array:
    c, s = np.cos(0.6), np.sin(0.6)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class Run:
    """A run with a rotor, and a housing whose rates are given by complex amplitudes per order."""

    def __init__(
        self, housing: Any, rates: dict[float, Array], *, per_turn: int = PER_TURN, swell: float = 0.0
    ) -> None:
        rows, m = TURNS * per_turn + 1, len(housing.frequencies)
        alpha = np.linspace(0.0, TURNS, rows)
        # the speed rises from 20 (1 - swell) to 20 (1 + swell) turns per second
        self.time = alpha / 20.0 if not swell else _times(alpha, swell)
        speed = 20.0 * (1.0 - swell) + 100.0 * swell * self.time
        spin = -2.0 * np.pi * np.outer(speed, [0.0, 0.6, 0.8])
        values = sum(np.real(np.outer(np.exp(2.0j * np.pi * n * alpha), a)) for n, a in rates.items())
        values = np.broadcast_to(values, (rows, 6 + m))
        still = np.zeros((rows, 3))
        self.bodies = {
            "housing": BodyHistory(
                still + PLACE, np.tile(TILT, (rows, 1)), values[:, :3], values[:, 3:6], np.zeros((rows, m)),
                modal_velocity=values[:, 6:],
            ),
            "shaft": BodyHistory(still, np.tile(TILT, (rows, 1)), still, spin, np.zeros((rows, 0))),
        }  # fmt: skip
        self.view = SimpleNamespace(
            bodies={"housing": SimpleNamespace(reduced=housing), "shaft": SimpleNamespace(reduced=None)}
        )

    def body(self, name: str) -> BodyHistory:
        return self.bodies[name]

    def at(self, *orders: float) -> SurfaceVelocity:
        return surface_velocity(self, "housing", "shaft", orders)


def _times(alpha: Array, swell: float) -> Array:
    """alpha(t) = v t + b t^2/2 with v = 20 (1 - swell), b = 100 swell."""
    v, b = 20.0 * (1.0 - swell), 100.0 * swell
    return (np.sqrt(v * v + 2.0 * b * alpha) - v) / b


def amplitudes(rng: np.random.Generator, housing: Any) -> Array:
    k = 6 + len(housing.frequencies)
    return 1e-3 * (rng.standard_normal(k) + 1j * rng.standard_normal(k))


def closed_form(housing: Any, a: Array) -> Array:
    A, X = tilt(), np.asarray(housing.surface.points, float)
    elastic = np.einsum("m,mnc->nc", a[6:], np.asarray(housing.surface.modes, float))
    return a[:3] + np.cross(a[3:6], X @ A.T) + elastic @ A.T


def test_motions_of_all_kinds_at_two_orders(housing: Any) -> None:
    rng = np.random.default_rng(6)
    rates = {2.0: amplitudes(rng, housing), 7.25: amplitudes(rng, housing)}
    found = Run(housing, rates).at(2.0, 7.25, 3.0)
    for k, a in enumerate(rates.values()):
        wanted = closed_form(housing, a)
        assert np.abs(found.velocity[k] - wanted).max() < 1e-12 * np.abs(wanted).max()
    assert np.abs(found.velocity[2]).max() < 1e-15  # an order that is not excited
    assert np.allclose(found.frequencies, [40.0, 145.0, 60.0], rtol=1e-12)
    assert np.allclose(found.points, PLACE + np.asarray(housing.surface.points) @ tilt().T, atol=1e-15)


def test_orders_hold_while_the_speed_rises(housing: Any) -> None:
    """From 16 to 24 turns per second, linear interpolation between rows: to its error (2 pi/m)^2/12, here 0.02 %."""
    a = amplitudes(np.random.default_rng(7), housing)
    found = Run(housing, {3.0: a}, per_turn=400, swell=0.2).at(3.0)
    wanted = closed_form(housing, a)
    assert np.abs(found.velocity[0] - wanted).max() < 1e-3 * np.abs(wanted).max()


def test_normal_velocity_and_power_of_a_piston(housing: Any) -> None:
    """A box that moves to and fro along its own x: rho c/2 V^2 on its two ends, nothing on the other faces."""
    V = 2e-3
    a = np.zeros(6 + len(housing.frequencies), complex)
    a[:3] = 1j * V * tilt()[:, 0]
    found = Run(housing, {1.0: a}).at(1.0)
    wanted = 0.5 * 1.204 * 343.2 * V**2 * 2.0 * SIZE[1] * SIZE[2]
    assert found.radiated_power()[0] == pytest.approx(wanted, rel=1e-12)
    assert found.radiated_power(1000.0, 1500.0)[0] == pytest.approx(wanted * 1.5e6 / (1.204 * 343.2), rel=1e-12)
    X = np.asarray(housing.surface.points)
    inner = np.all(np.abs(X[:, 1:]) < 0.49 * SIZE[1:], axis=1)  # of the ends, away from their edges
    end = np.sign(X[inner, 0])
    assert set(end) == {-1.0, 1.0} and np.allclose(found.normal[0, inner], 1j * V * end, rtol=1e-12)
    side = np.all(np.abs(X[:, [0, 2]]) < 0.49 * SIZE[[0, 2]], axis=1)
    assert np.any(side) and np.abs(found.normal[0, side]).max() < 1e-15


def test_breathing_has_no_net_sign(housing: Any) -> None:
    """Normals point outward: their areas give the volume of the box by the divergence theorem."""
    found = Run(housing, {1.0: np.zeros(6 + len(housing.frequencies))}).at(1.0)
    flux = np.einsum("tc,tc->", found._areas(), found.points[found.triangles].mean(axis=1))
    assert flux / 3.0 == pytest.approx(np.prod(SIZE), rel=1e-12)


def test_universal_file(housing: Any, tmp_path: Path) -> None:
    rates = {2.0: amplitudes(np.random.default_rng(8), housing)}
    found = Run(housing, rates).at(2.0, 4.0)
    path = found.to_uff(tmp_path / "orders.uff")
    mesh = read_unv(path)
    assert np.abs(mesh.points - found.points).max() < 1e-15
    assert np.array_equal(mesh.blocks[0][1], found.triangles)
    with pytest.raises(InputError, match="exists"):
        found.to_uff(path)
    with pytest.raises(InputError, match="no mode shapes"):  # velocities at a frequency are no modes
        housing.compare_modes(path, length_unit="m")
    pyuff = pytest.importorskip("pyuff")
    shapes = [s for s in pyuff.UFF(str(path)).read_sets() if s["type"] == 55]
    assert [(s["analysis_type"], s["spec_data_type"], s["data_type"], s["freq"]) for s in shapes] == [
        (5, 11, 5, 40.0), (5, 11, 5, 80.0),
    ]  # fmt: skip
    read = np.stack([shapes[0][f"r{axis}"] for axis in (1, 2, 3)], axis=1)
    assert np.abs(read - found.velocity[0]).max() < 5e-6 * np.abs(found.velocity[0]).max()


def test_refusals(housing: Any) -> None:
    run = Run(housing, {1.0: amplitudes(np.random.default_rng(9), housing)})
    for orders, said in (
        ((0.0,), "positive multiples of 1/4"),
        ((1.1,), "positive multiples of 1/4"),
        ((), "positive multiples"),
        ((30.0,), "needs more than 60 rows per turn"),
    ):
        with pytest.raises(InputError, match=said):
            run.at(*orders)
    with pytest.raises(InputError, match="'shaft' is rigid"):
        surface_velocity(run, "shaft", "shaft", [1.0])
    with pytest.raises(InputError, match="body 'housing' turns"):
        surface_velocity(run, "housing", "housing", [1.0])
    run.bodies["housing"].rotation[-1] = [0.0, 0.0, 0.0, 1.0]
    with pytest.raises(InputError, match="turns by 0.6 rad"):
        run.at(1.0)
    run.bodies["housing"].rotation[-1] = TILT
    run.bodies["housing"].modal_velocity = np.full((len(run.time), len(housing.frequencies)), np.nan)
    with pytest.raises(InputError, match="were not recorded"):
        run.at(1.0)
