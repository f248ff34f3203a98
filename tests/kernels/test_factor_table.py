"""Flow factors on the device: those of the table, and their own slopes."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportIndexIssue=false
from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp
from scipy.interpolate import CubicHermiteSpline

from warpffrf.model.films import Roughness
from warpffrf.model.films.roughness import factor_table, flow_factors
from warpffrf_kernels.core.model import Elements, Films, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.films.roughness import factors_at

wp.set_module_options(MODULE_OPTIONS)

FIRST, SECOND = Roughness(1e-6, 1 / 3), Roughness(0.5e-6, 6.0)


@wp.kernel
def evaluate(models: wp.array(dtype=Model), film: int, h: wp.array(dtype=real), found: wp.array2d(dtype=real)):
    i = wp.tid()
    f = factors_at(models[0], film, h[i])
    for c in range(2):
        found[i, c] = f.flow[c]
        found[i, 2 + c] = f.lag[c]
        found[i, 4 + c] = f.drag[c]
        found[i, 6 + c] = f.flow_slope[c]
        found[i, 8 + c] = f.lag_slope[c]


def factors(film: int, gap: np.ndarray) -> np.ndarray:
    """Columns of `evaluate`: film 0 is smooth, film 1 has another table before its own."""
    other, table = factor_table(SECOND, None), factor_table(FIRST, SECOND)
    films, elements, model = Films(), Elements(), Model()
    films.count = 2
    films.factor_start = wp.array([0, len(other)], dtype=int, device="cpu")
    films.factor_count = wp.array([0, len(table)], dtype=int, device="cpu")
    films.factor = wp.array(np.vstack([other, table]), dtype=wp.float64, device="cpu")
    held: Any = wp.array([films], dtype=Films, device="cpu")
    elements.films = held
    model.elements = wp.array([elements], dtype=Elements, device="cpu")
    found = wp.zeros((len(gap), 10), dtype=wp.float64, device="cpu")
    models = wp.array([model], dtype=Model, device="cpu")
    wp.launch(evaluate, len(gap), [models, film, wp.array(gap, dtype=wp.float64, device="cpu")], [found], device="cpu")
    return found.numpy()


def test_smooth_walls_have_none() -> None:
    found = factors(0, np.array([1e-9, 1e-6, 1.0]))
    np.testing.assert_array_equal(found, np.tile([1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0], (3, 1)))


def test_factors_are_those_of_the_table() -> None:
    gap, table = np.geomspace(1e-9, 1e-2, 3001), factor_table(FIRST, SECOND)
    found, inside = factors(1, gap), gap < table[-1, 0]
    for k, column in enumerate((1, 3, 5, 7, 9, 11)):
        exact = CubicHermiteSpline(table[:, 0], table[:, column], table[:, column + 1])(gap[inside])
        np.testing.assert_allclose(found[inside, k], exact, rtol=1e-12, atol=1e-12 * np.abs(exact).max())
    np.testing.assert_array_equal(found[~inside, :6], np.tile([1.0, 1.0, 0.0, 0.0, 1.0, 1.0], (sum(~inside), 1)))
    exact = flow_factors(FIRST, SECOND, gap)
    assert np.abs(found[:, :2] - exact.flow).max() < 4e-3  # where kinks are rounded


def test_slopes_are_those_of_the_factors() -> None:
    """Central differences, as exact as Newton's method needs them."""
    gap = np.geomspace(1e-8, 1e-4, 400) * 1.000123
    step = 1e-5 * gap
    found = factors(1, gap)
    slope = (factors(1, gap + step) - factors(1, gap - step))[:, :4] / (2.0 * step)[:, None]
    assert np.abs((found[:, 6:8] - slope[:, :2]) * gap[:, None]).max() < 1e-6
    assert np.abs(found[:, 8:10] - slope[:, 2:]).max() < 1e-6
