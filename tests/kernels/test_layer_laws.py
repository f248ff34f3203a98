"""Curves of layers on the device: pressures and energies of the laws they stand for, their own slopes and inverses."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportIndexIssue=false
from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
import warp as wp

from warpffrf.model import laws
from warpffrf.model.laws import curves
from warpffrf.online.compile.constants import Constants
from warpffrf.online.compile.layers import fill_layers
from warpffrf.online.settings import Settings
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.layers import layer_laws

wp.set_module_options(MODULE_OPTIONS)

ROUND_OFF = 1e-12


@dataclass(frozen=True)
class DampedAsperities(laws.Law):
    """Asperities that lose energy: a law of one's own, made of a curve and a damping that there are."""

    kind: ClassVar[str] = "damped_asperities"

    @property
    def curve(self) -> curves.Exponential:
        return curves.Exponential(1e7, 1e-6, 1e-5)

    @property
    def chi(self) -> float:
        return 2.0


LAWS: list[Any] = [
    laws.NonlinearLayer(1e15, 1.5),
    laws.NonlinearLayer(1e12, 1.0),
    laws.TabulatedLayer((-4e-6, -2e-6, -1e-6, 0.5e-6), (9e6, 3e6, 1e6, 0.0)),
    laws.ExponentialAsperities(1e7, 1e-6),
    laws.HuntCrossley(1e15, 1.5, damping=2.0),
    DampedAsperities(),
    laws.GreenwoodTripp(1e-6, 1e9, 5e-5, 1e11),
]


@wp.kernel
def evaluate(
    models: wp.array(dtype=Model),
    pair: int,
    depth: wp.array(dtype=real),
    past: real,
    rate: real,
    found: wp.array2d(dtype=real),
):
    i = wp.tid()
    model = models[0]
    at = layer_laws.layer_pressure(model, pair, depth[i], past, rate)
    found[i, 0] = at[0]
    found[i, 1] = at[1]
    found[i, 2] = layer_laws.layer_depth(model, pair, at[0], past, rate)
    found[i, 3] = layer_laws.layer_energy(model, pair, depth[i])
    found[i, 4] = layer_laws.least_depth(model, pair, past, rate)


@cache
def device_model() -> tuple[wp.array, Any]:
    """A model that holds nothing but the laws, as the kernels take it, and itself, which owns its arrays."""
    shape = SimpleNamespace(measure_at=np.ones_like)
    grid = SimpleNamespace(z=np.array([0.0, 1.0]), rows=2, pitch=1.0)
    port = SimpleNamespace(surface=SimpleNamespace(grid=grid, shape=shape))
    contacts = [SimpleNamespace(name="pair", law=law, a=port, quadrature="full") for law in LAWS]
    scene, fill = SimpleNamespace(finite_sliding=contacts), Constants("cpu").fill
    elements = Elements()
    collector: Any = SimpleNamespace(
        scene=scene, settings=Settings(), notes=[], fill=fill, elements=elements, patches={}
    )
    model = Model()
    fill_layers(collector)
    model.elements = wp.array([elements], dtype=Elements, device="cpu")
    assert elements.layers.count == len(LAWS)
    assert any("ends at" in note for note in collector.notes)
    return wp.array([model], dtype=Model), (model, elements)


def curve(index: int, depth: np.ndarray, past: float = 0.0, rate: float = 0.0) -> np.ndarray:
    """Columns of `evaluate` at the depths."""
    found = wp.zeros((len(depth), 5), dtype=wp.float64)
    wp.launch(evaluate, len(depth), [device_model()[0], index, wp.array(depth, dtype=wp.float64), past, rate], [found])
    return found.numpy()


@pytest.mark.parametrize("index", range(len(LAWS)), ids=lambda i: LAWS[i].kind)
def test_curves_are_those_of_the_laws(index: int) -> None:
    law = LAWS[index]
    least = curve(index, np.zeros(1))[0, 4]
    depth = np.concatenate([least + np.geomspace(1e-10, 5e-6, 40), np.linspace(max(least, 0.0) + 1e-9, 8e-6, 40)])
    p, slope, inverse, energy, _ = curve(index, depth).T
    np.testing.assert_allclose(p, law.pressure(-depth), rtol=1e-9, atol=ROUND_OFF * p.max())
    np.testing.assert_allclose(energy, law.energy(-depth), rtol=1e-9, atol=ROUND_OFF * energy.max())
    np.testing.assert_allclose(inverse, depth, rtol=1e-9, atol=1e-15)
    step = 1e-6 * (depth - least)
    difference = (curve(index, depth + step)[:, 0] - curve(index, depth - step)[:, 0]) / (2.0 * step)
    kinks = law.curve.table[:, 0]
    smooth = np.array([np.all(np.abs(d - kinks) > 2.0 * s) for d, s in zip(depth, step, strict=True)])
    np.testing.assert_allclose(slope[smooth], difference[smooth], rtol=1e-5)


@pytest.mark.parametrize("index", [4, 5], ids=lambda i: LAWS[i].kind)
def test_a_step_of_a_damped_law(index: int) -> None:
    """p = P(d) (1 + chi (d - past)/h), zero up to the larger of P's beginning and past - h/chi; slope and inverse."""
    law, past, h = LAWS[index], 2e-6, 1e-6
    rate = law.chi / h
    least = curve(index, np.zeros(1), past, rate)[0, 4]
    assert least == pytest.approx(past - h / law.chi)
    depth = least + np.geomspace(1e-10, 5e-6, 50)
    p, slope, inverse = curve(index, depth, past, rate)[:, :3].T
    np.testing.assert_allclose(p, law.pressure(-depth, (depth - past) / h), rtol=1e-8)
    np.testing.assert_allclose(inverse, depth, rtol=1e-9)
    step = 1e-6 * (depth - least)
    higher, lower = (curve(index, depth + sign * step, past, rate)[:, 0] for sign in (1.0, -1.0))
    np.testing.assert_allclose(slope, (higher - lower) / (2.0 * step), rtol=1e-5)
    early = law.curve.begins + 0.5e-7
    assert curve(index, np.zeros(1), early, rate)[0, 4] == law.curve.begins


@pytest.mark.parametrize("index", range(4), ids=lambda i: LAWS[i].kind)
def test_the_yield_on_the_host_is_the_inverse_on_the_device(index: int) -> None:
    """Also its derivative, against the slope of the curve."""
    depth = np.linspace(1e-9, 8e-6, 60)
    p, slope = curve(index, depth).T[:2]
    given = LAWS[index].curve
    assert given is not None
    y, derivative = given.yielding(p)
    np.testing.assert_allclose(y, depth, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(derivative, 1.0 / slope, rtol=1e-8)
    least = curve(index, np.zeros(1))[0, 4]
    np.testing.assert_allclose(given.yielding(np.array([0.0, -1.0]))[0], least, rtol=1e-9, atol=1e-11)
