"""Characteristics of springs and dampers: their pieces against formulas written out, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.forces.notes import characteristic_notes
from warpffrf.model.scene import Scene

ROUND_OFF = 1e-13  # of the largest value: a handful of operations
POINTS = [(-2.0, -5.0), (-0.7, -1.0), (0.3, 0.5), (1.0, 0.4), (3.0, 9.0)]
X = np.linspace(-4.0, 5.0, 181)


def continued(points: list[tuple[float, float]], inner: Callable, slopes: tuple[float, float]) -> Callable:
    """A table's function, straight beyond its ends."""
    (x_0, F_0), (x_1, F_1) = points[0], points[-1]

    def force(x: np.ndarray) -> np.ndarray:
        below, above = F_0 + slopes[0] * (x - x_0), F_1 + slopes[1] * (x - x_1)
        return np.where(x < x_0, below, np.where(x > x_1, above, inner(np.clip(x, x_0, x_1))))

    return force


CUBIC = PchipInterpolator(*np.array(POINTS).T)
CASES: dict[str, tuple[forces.Characteristic, Callable]] = {
    "polynomial": (forces.ForcePolynomial([3.0, -1.0, 2.0]), lambda x: 3.0 * x - x**2 + 2.0 * x**3),
    "power": (forces.PowerLaw(4.0, 1.5), lambda x: 4.0 * np.sign(x) * np.abs(x) ** 1.5),
    "drag": (forces.PowerLaw(4.0, 2), lambda x: 4.0 * x * np.abs(x)),
    "linear": (forces.PowerLaw(4.0, 1), lambda x: 4.0 * x),
    "table": (
        forces.ForceTable(POINTS),
        continued(POINTS, lambda x: np.interp(x, *np.array(POINTS).T), (4.0 / 1.3, 8.6 / 2.0)),
    ),
    "smooth table": (
        forces.ForceTable(POINTS, smooth=True),
        continued(POINTS, CUBIC, (float(CUBIC(-2.0, 1)), float(CUBIC(3.0, 1)))),
    ),
    "table off zero": (forces.ForceTable([(1.0, 2.0), (2.0, 6.0)]), lambda x: 2.0 + 4.0 * (x - 1.0)),
}  # fmt: skip


def test_every_kind_is_here() -> None:
    assert {curve.kind for curve, _ in CASES.values()} == set(forces.CHARACTERISTICS)


@pytest.mark.parametrize("case", CASES)
def test_force_slope_and_energy(case: str) -> None:
    """The slope against central differences, the energy against quadrature of the formula from zero."""
    curve, formula = CASES[case]
    exact = formula(X)
    assert np.abs(curve.force(X) - exact).max() < ROUND_OFF * np.abs(exact).max()
    h = 1e-6
    away = np.abs(X[:, None] - np.array([0.0, *(x for x, _ in POINTS)])).min(axis=1) > 2.0 * h  # of kinks
    slope = (formula(X + h) - formula(X - h)) / (2.0 * h)
    assert np.abs(curve.slope(X) - slope)[away].max() < 1e-7 * np.abs(slope).max()
    marks = sorted({0.0, *(x for x, _ in POINTS)})
    for x in (-3.5, -1.0, 0.2, 0.9, 4.4):
        ends = [min(x, 0.0), *(m for m in marks if min(x, 0.0) < m < max(x, 0.0)), max(x, 0.0)]
        area = sum(quad(formula, a, b, epsabs=1e-12)[0] for a, b in zip(ends[:-1], ends[1:], strict=True))
        assert curve.energy(x) == pytest.approx(np.sign(x) * area, abs=1e-10 * np.abs(exact).max())
    assert curve.energy(0.0) == 0.0


def test_a_smooth_table_rises_where_its_points_do() -> None:
    points = [(-1.0, -1.0), (-0.1, -0.99), (0.0, 0.0), (0.1, 0.01), (0.2, 5.0), (2.0, 5.0)]
    curve = forces.ForceTable(points, smooth=True)
    assert curve.slope(np.linspace(-2.0, 3.0, 5001)).min() >= 0.0
    assert curve.force([x for x, _ in points]) == pytest.approx([F for _, F in points], abs=1e-14)


def test_kinks() -> None:
    stop = forces.ForceTable([(-2.0, -1.0), (-1.0, 0.0), (1.0, 0.0), (2.0, 1.0)])
    assert stop.has_kink(1.0, 1e-9) and stop.has_kink(-1.0 + 1e-10, 1e-9) and not stop.has_kink(0.9, 1e-9)
    smooth = forces.ForceTable(stop.points, smooth=True)
    assert not smooth.has_kink(1.0, 1e-9)
    assert not forces.PowerLaw(1.0, 2.0).has_kink(0.0, 1e-9)


def ends() -> tuple[Any, Any]:
    scene = Scene()
    return scene.ground.at((0, 0, 0)), scene.add_rigid_body(1.0, (1, 1, 1), name="b").at((0, 0, 0))


def spring(stiffness: Any, damping: Any = 0.0) -> forces.SpringDamper:
    scene = Scene()
    b = scene.add_rigid_body(1.0, (1, 1, 1), name="b", position=(1.0, 0.0, 0.0))
    return scene.add(forces.SpringDamper(scene.ground.at((0, 0, 0)), b.at((0, 0, 0)), stiffness, damping, name="s"))


CURVE: Any = forces.PowerLaw(1.0, 2.0)
WORD: Any = "yes"
REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "folds": (lambda: forces.ForceTable([(0, 0), (2, 1), (1, 3)]), r"is not monotonic.*got 2 and then 1 \(points 1"),
    "jumps": (lambda: forces.ForceTable([(0, 0), (1, 1), (1, 3)]), "give a jump a little width"),
    "one point": (lambda: forces.ForceTable([(0, 0)]), "at least two points"),
    "no points": (lambda: forces.ForceTable([[0, 1, 2], [3, 4, 5]]), r"must have shape \(n, 2\)"),
    "NaN": (lambda: forces.ForceTable([(0, 0), (1, np.nan)]), "NaN or infinite"),
    "smooth": (lambda: forces.ForceTable([(0, 0), (1, 1)], smooth=WORD), "smooth must be True or False"),
    "steep": (lambda: forces.PowerLaw(1.0, 0.5), "at least 1, got 0.5.*ForceTable"),
    "negative": (lambda: forces.PowerLaw(-1.0, 2.0), "greater than zero"),
    "infinite": (lambda: forces.ForcePolynomial([1.0, np.inf]), "NaN or infinite"),
    "empty": (lambda: forces.ForcePolynomial([]), "1 to 7 coefficients"),
    "too many": (lambda: forces.ForcePolynomial([1.0] * 8), "1 to 7 coefficients"),
    "bare points": (lambda: spring([(0, 0), (1, 1)]), r"'s': stiffness must be a number, or one of .*ForceTable\("),
    "no number": (lambda: spring("soft"), "'s': stiffness must be a number"),
    "damper with a force": (
        lambda: spring(1.0, forces.ForceTable([(-1.0, -1.0), (1.0, 3.0)])), "zero where the rate is zero.*is 1; a force"
    ),
    "nothing": (lambda: spring(forces.ForcePolynomial([0.0]), 0.0).law(), "both zero"),
    "joint spring": (
        lambda: forces.JointSpringDamper(
            joints.Prismatic(*ends(), axis=(1, 0, 0)), 1.0, forces.ForceTable([(1.0, 1.0), (2.0, 1.0)])
        ),
        "zero where the rate is zero",
    ),
    "five directions": (lambda: forces.Bushing(*ends(), [CURVE, 1, 1, 1, 1]), "six values"),
    "bushing, a direction": (lambda: forces.Bushing(*ends(), [CURVE, -1, 1, 1, 1, 1]), r"stiffness\[1\] must not"),
    "coupled": (
        lambda: forces.Bushing(*ends(), [CURVE] * 6, np.ones((6, 6)) + np.eye(6)), "characteristics are not coupled"
    ),
    "bushing of nothing": (lambda: forces.Bushing(*ends(), [forces.ForcePolynomial([0.0])] * 6), "both zero"),
    "bearing": (lambda: forces.BearingSpring(*ends(), axis=(0, 0, 1), radial=CURVE), "radial must be a number"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case: str) -> None:
    make, message = REFUSED[case]
    with pytest.raises(InputError, match=message):
        make()


def test_a_law_with_the_numbers_of_a_linear_one_is_that() -> None:
    """Of a bushing too, whose directions without a law are left out."""
    k, d = 3.0, 0.5
    e, rate = np.array([1.7]), np.array([-0.4])
    linear, curved = spring(k, d).law(), spring(forces.ForcePolynomial([k]), forces.PowerLaw(d, 1)).law()
    assert curved.force(e, rate) == pytest.approx(linear.force(e, rate), rel=1e-15)
    assert curved.potential(e) == pytest.approx(linear.potential(e), rel=1e-15)
    assert curved.slopes(e, rate) == (pytest.approx([k]), pytest.approx([d]))
    preload = [0, 1, 0, 2, 0, 0]
    law, other = (
        forces.Bushing(*ends(), [0.0, k_y, 0.0, 2.0, 0.0, 0.0], [0.0, d, d_z, 0.0, 0.0, 0.0], preload=preload).law()
        for k_y, d_z in ((k, 0.3), (forces.ForcePolynomial([k]), forces.PowerLaw(0.3, 1)))
    )
    assert other.sprung == law.sprung == 2
    e, rate = np.array([0.3, -0.2, 0.1]), np.array([1.0, 2.0, 3.0])
    assert other.expand == pytest.approx(law.expand)
    assert other.force(e, rate) == pytest.approx(law.force(e, rate), rel=1e-15)
    assert other.potential(e) == pytest.approx(law.potential(e), rel=1e-15)


def test_other_numbers_make_another_scene() -> None:
    hashes = set()
    tables = [forces.ForceTable(POINTS, smooth=smooth) for smooth in (False, True)]
    for stiffness in (1.0, CURVE, forces.PowerLaw(1.0, 3.0), *tables):
        for damping in (1.0, CURVE):
            scene = Scene()
            b = scene.add_rigid_body(1.0, (1, 1, 1), name="b", position=(1.0, 0.0, 0.0))
            ports = scene.ground.at((0, 0, 0)), b.at((0, 0, 0))
            scene.add(forces.SpringDamper(*ports, stiffness, damping, name="s"))
            scene.add(forces.Bushing(*ports, [stiffness] + [1.0] * 5, [damping] * 6, point=(0, 0, 0), name="m"))
            hashes.add(scene.content_hash())
    assert len(hashes) == 10


def notes_of(stiffness: Any, damping: Any, length: np.ndarray) -> list[str]:
    """Notes of a spring of free length 1 m that was `length` long at the times 0, 1, 2, ..."""
    item = spring(stiffness, damping)
    return characteristic_notes({"s": item.law()}, {"s": length[:, None]}, np.arange(float(len(length))))


def test_tables_that_are_left_are_noted() -> None:
    table = forces.ForceTable([(-0.1, -1.0), (0.2, 2.0)])
    length = np.array([1.0, 1.15, 0.95])
    assert notes_of(table, 0.0, length) == []
    (note,) = notes_of(table, 0.0, length + 0.1)
    assert "'s': the table of its stiffness covers -0.1 to 0.2 m, the run had 0.05 to 0.25" in note
    (note,) = notes_of(1.0, table, length)
    assert "the table of its damping covers -0.1 to 0.2 m/s, the run had -0.2 to 0.15" in note
    assert notes_of(forces.ForcePolynomial([1.0]), CURVE, 100.0 * length) == []


@pytest.mark.parametrize(
    ("damping", "fed"),
    [
        (forces.PowerLaw(2.0, 2.0), None),
        (forces.ForcePolynomial([1.0, 0.0, -0.25]), "-6"),  # beyond |v| = 2
        (forces.ForcePolynomial([0.0, 1.0]), "-1"),
        (forces.ForceTable([(-1.0, -5.0), (1.0, 5.0)]), None),
        (forces.ForceTable([(-1.0, -1.0), (0.0, 0.0), (1.0, -0.1), (2.0, 3.0)]), "0.5"),
        (forces.ForceTable([(-3.0, -0.1), (-1.0, -1e-9), (1.0, 1e-9), (3.0, 0.1)], smooth=True), None),
    ],
)
def test_dampers_that_feed_energy_are_noted(damping: forces.Characteristic, fed: str | None) -> None:
    notes = notes_of(1.0, damping, np.array([1.0, 1.0]))
    assert len(notes) == (fed is not None)
    assert all(f"acts in the direction of motion, for example at {fed}" in note for note in notes)
