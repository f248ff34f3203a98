"""Stress below a patch: Hertz's closed forms compared with the half-space, independent ones and the numbers of the
books; the pressure of runs compared with Hertz."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from patch_rubbing_run import make_patch_history, patch_contact
from synthetic_run import make_history

from references.closed_forms import LineContact, PointContact
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Plane
from warpffrf.output.bodies.half_space_stress import under_cells
from warpffrf.output.bodies.stress_below import stress_below
from warpffrf.output.contact.hertz import (
    HertzLine,
    HertzPoint,
    hertz_line,
    hertz_point,
    largest_below,
    largest_of,
    stress_on_axis,
)
from warpffrf.output.result import Result

NU, MODULUS = 0.3, 1.1e11
DEPTH = np.linspace(0.0, 3.0, 31)


def ellipse(ratio: float) -> HertzPoint:
    """Semi-axes (ratio, 1), peak pressure 1."""
    return HertzPoint((ratio, 1.0), 0.0, 1.0, 2.0 / 3.0 * np.pi * ratio, 1.0, (1.0, 1.0), 1.0)


def test_numbers_of_the_books() -> None:
    """Johnson: 0.300 p0 at 0.786 a and 0.558 p0 at 0.704 a under a line, 0.310 p0 (0.620 von Mises) at 0.481 a under a
    ball, nu = 0.3."""
    line, ball = HertzLine(1.0, 1.0, 1.0, 1.0, 1.0), ellipse(1.0)
    mises, shear = largest_below(line, NU)
    assert mises == pytest.approx((0.558, 0.704), abs=6e-4) and shear == pytest.approx((0.300, 0.786), abs=6e-4)
    mises, shear = largest_below(ball, NU)
    assert mises == pytest.approx((0.620, 0.481), abs=6e-4) and shear == pytest.approx((0.310, 0.481), abs=6e-4)


def test_lines_and_balls_are_those_of_the_verification() -> None:
    load, R = 4e5, 0.025
    line, exact = hertz_line(load, 1.0 / R, MODULUS), LineContact(load, R, MODULUS)
    z = DEPTH * line.half_width
    x, down = exact.on_axis(z)
    assert stress_on_axis(line, z, NU)[:, [0, 2]] == pytest.approx(np.stack([x, down], axis=1), rel=1e-12)
    assert largest_below(line, NU)[1] == pytest.approx(exact.largest_shear(), rel=1e-6)
    ball, exact = hertz_point(load * R, np.eye(2) / R, MODULUS), PointContact(load * R, R, MODULUS)
    x, down = exact.on_axis(DEPTH * ball.half_width, NU)
    assert stress_on_axis(ball, DEPTH * ball.half_width, NU)[:, :3] == pytest.approx(
        np.stack([x, x, down], axis=1), rel=1e-12
    )


@pytest.mark.parametrize("ratio", [1.6, 8.0])
def test_an_ellipse_is_the_half_space_under_its_pressure(ratio: float) -> None:
    """Constants on 160 x 160 rectangles of a pressure that falls like a root at its rim: 1e-4 of p0."""
    lines = np.linspace(-1.0, 1.0, 161)
    mid = 0.5 * (lines[1:] + lines[:-1])
    p = np.sqrt(np.maximum(1.0 - mid[:, None] ** 2 - mid**2, 0.0))
    z = DEPTH[1:]
    found = under_cells(np.stack([0.0 * z, 0.0 * z, z], axis=1), ratio * lines, lines, p, NU)
    assert stress_on_axis(ellipse(ratio), z, NU) == pytest.approx(found, abs=1e-4)


def test_a_line_that_slides() -> None:
    """By integrals of Flamant's forces over pressure and traction; the largest shear is at 0.786 a without friction,
    and at the surface with much of it (Johnson, section 7.1)."""
    line, mu = HertzLine(1.0, 1.0, 1.0, 1.0, 1.0), 0.3
    t, weight = np.polynomial.legendre.leggauss(400)
    t, weight = 0.5 * np.pi * t, 0.5 * np.pi * weight
    for x, z in ((0.0, 0.786), (0.3, 0.4), (-0.8, 0.3), (1.5, 0.6), (-2.0, 1.0)):
        d = x - np.sin(t)
        force = -2.0 / np.pi * weight * np.cos(t) ** 2 * (z + mu * d) / (d**2 + z**2) ** 2
        exact = np.array([np.sum(force * d**2), np.sum(force * z**2), np.sum(force * z * d)])
        assert line.stress(x, z, friction=mu)[[0, 2, 5]] == pytest.approx(exact, abs=1e-9)
    assert line.stress(0.0, DEPTH) == pytest.approx(stress_on_axis(line, DEPTH, NU), abs=1e-12)
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(1e-6, 1.5, 151))
    for friction, deepest in ((0.0, 0.786), (0.5, 0.0)):
        found = line.stress(x, z, friction=friction)
        shear = np.hypot(0.5 * (found[..., 0] - found[..., 2]), found[..., 5])
        assert z.ravel()[shear.argmax()] == pytest.approx(deepest, abs=0.011)


def test_ellipses_go_over_into_circles_and_lines() -> None:
    round_one = stress_on_axis(ellipse(1.0), DEPTH, NU)
    assert stress_on_axis(ellipse(1.0 + 1e-6), DEPTH, NU) == pytest.approx(round_one, abs=3e-6)  # of m = 2e-6
    line = stress_on_axis(HertzLine(1.0, 1.0, 1.0, 1.0, 1.0), DEPTH, NU)[:, [1, 0, 2]]
    assert stress_on_axis(ellipse(1e3), DEPTH, NU)[:, :3] == pytest.approx(line, abs=5e-4)  # of the order of b/a


def test_a_ball_s_pressure_on_cells_has_its_largest_stress_where_hertz_has_it() -> None:
    """Twenty strips and fourteen rows over a patch of 0.45 mm: von Mises and its depth to 1 %."""
    a, p0 = 0.45e-3, 2e9

    def fields(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        p = p0 * np.sqrt(np.maximum(1.0 - (x**2 + y**2) / a**2, 0.0))
        return p, 0.0 * np.stack([p, p]), 0.0 * np.stack([p, p])

    contact = patch_contact(Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(1.0, 0.0, 0.0)), fields)
    steel = {"youngs_modulus": 2.1e11, "poisson_ratio": NU}
    reduced: Any = contact.view.first_body.reduced
    reduced.provenance["contact_materials"] = {"face": steel}
    (below,) = stress_below(contact, 0)
    exact = largest_below(HertzPoint((a, a), 0.0, p0, 1.0, 1.0, (1.0, 1.0), 1.0), NU)
    for values, expected in zip((below.von_mises, below.max_shear), exact, strict=True):
        assert largest_of(below.depth, values) == pytest.approx(expected, rel=0.01)
    assert below.bodies == ("a",) and below.poisson_ratio == NU
    del reduced.provenance["contact_materials"]
    with pytest.raises(InputError, match="body 'a' has no material data"):
        stress_below(contact, 0)


def test_nodes_and_cells_of_one_pressure_have_one_stress(body: ReducedBody) -> None:
    """The same patch of rollers on four nodes, and on three cells and a half in the half-width: bilinear and constant
    pressures, by other closed forms, differ by their own second moments, some 1 %."""
    z = np.linspace(2e-3, 2e-2, 10)
    grid_nodes, cells = (
        Result(make(body)).stress_below(row=4, depth=z)[0] for make in (make_history, make_patch_history)
    )
    assert grid_nodes.bodies == ("lower", "upper")
    assert grid_nodes.tensor[:, :3] == pytest.approx(cells.tensor[:, :3], abs=0.015 * np.abs(cells.tensor).max())
    assert np.abs(grid_nodes.tensor[:, 3:5]).max() < 1e-9 * np.abs(grid_nodes.tensor).max()  # at mid-width


def test_the_plot_marks_hertz_or_says_why_not(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    contact = result.contact("lower-upper")
    ax = result.plot("stress_depth", Figure().add_subplot())
    (mises, _, mark, line), (ends, top) = (np.asarray(c.get_xydata()) for c in ax.get_lines()[:4]), ax.get_ylim()
    assert mises[5, 0] == pytest.approx(result.stress_below()[0].von_mises[5] * 1e-6)
    expected = largest_below(contact.hertz(-1), NU)[0]
    assert mark[0] == pytest.approx((expected.stress * 1e-6, expected.depth * 1e3))
    assert line[0, 1] == mark[0, 1] and ends > top == 0.0
    monkeypatch.setattr(contact, "patch_kind", "flat")
    ax = result.plot("stress_depth", Figure().add_subplot())
    assert len(ax.get_lines()) == 2 and "the faces are flat" in " ".join(ax.texts[0].get_text().split())


def test_wrong_arguments_are_named(result: Result) -> None:
    result.history.contacts["lower-upper"].pressure[3] = 0.0
    with pytest.raises(InputError, match="row is 99; the run has the saved rows 0 to 8"):
        result.stress_below(row=99)
    with pytest.raises(InputError, match=r"depth must be numbers \(n,\) \[m\], not negative"):
        result.stress_below(depth=np.array([-1.0]))
    with pytest.raises(InputError, match="nothing touches in saved step 3"):
        result.stress_below("lower-upper", 3)
