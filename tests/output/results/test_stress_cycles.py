"""Cycles of stress histories: the example of ASTM E1049-85, closed forms, directions, files, refusals."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.output.bodies.stress import StressResult

STANDARD = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)  # ASTM E1049-85 (2011), figure 6, points A to I
COUNTED = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}  # its table
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")


def uniaxial(values: Any, direction: Any = (1.0, 0.0, 0.0), points: int = 1) -> StressResult:
    """Tension `values` (T,) along a direction, at the last of the points; at the others none."""
    n = np.array(direction) / np.linalg.norm(direction)
    tensor = np.zeros((len(values), points, 6))
    unit = np.outer(n, n)
    tensor[:, -1] = np.asarray(values)[:, None] * unit[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    return StressResult(0.5 * np.arange(len(values)), np.arange(3.0 * points).reshape(points, 3), tensor)


def test_example_of_the_standard() -> None:
    pytest.importorskip("rainflow")
    for of, scale in (("xx", 1.0), ("signed_von_mises", 1.0), ((2.0, 0.0, 0.0), 1.0), ((1.0, 1.0, 0.0), 0.5)):
        found = uniaxial(STANDARD).rainflow(of=of)
        counts: dict[float, float] = {}
        for size, n in zip(found.range / scale, found.count, strict=True):
            counts[round(size, 9)] = counts.get(round(size, 9), 0.0) + n
        assert counts == COUNTED
    first = uniaxial(STANDARD).rainflow(of="xx")
    assert (first.range[0], first.mean[0], first.count[0]) == (3.0, -0.5, 0.5)  # A-B, from 0 to 0.5 s
    assert (first.start[0], first.end[0]) == (0.0, 0.5)
    (closed,) = np.flatnonzero(first.count == 1.0)  # E-F, the one whole cycle: -1 to 3
    assert (first.range[closed], first.mean[closed], first.start[closed], first.end[closed]) == (4.0, 1.0, 2.0, 2.5)


def test_signed_von_mises_has_the_sign_of_the_largest_principal_stress() -> None:
    pytest.importorskip("rainflow")
    wave = 1e8 * np.sin(np.linspace(0.0, 20.0 * np.pi, 2001))
    found = uniaxial(wave, (1.0, 2.0, -0.5), points=3).rainflow(2)
    assert found.range.max() == pytest.approx(2e8, rel=1e-4)  # without the sign it would be 1e8, twice as often
    assert found.count.sum() == pytest.approx(10.5, abs=0.5)


def test_equivalent_range() -> None:
    """k equal cycles are k^(1/m) of one; of two sizes by their sum of powers."""
    pytest.importorskip("rainflow")
    wave = np.tile([0.0, 1e8], 51)  # 101 halves of a range of 1e8
    found = uniaxial(wave).rainflow(of="xx")
    assert found.count.sum() == 50.5
    assert found.equivalent_range(5.0, 50.5) == pytest.approx(1e8, rel=1e-12)
    assert found.equivalent_range(3.0) == pytest.approx(1e8 * 50.5 ** (1.0 / 3.0), rel=1e-12)
    standard = uniaxial(STANDARD).rainflow(of="xx")
    damage = sum(n * size**3 for size, n in COUNTED.items())
    assert standard.equivalent_range(3.0, 10.0) == pytest.approx((damage / 10.0) ** (1.0 / 3.0), rel=1e-12)
    for wrong in ({"exponent": 0.0}, {"exponent": 3.0, "cycles": -1.0}):
        with pytest.raises(InputError, match="equivalent_range"):
            standard.equivalent_range(**wrong)


@pytest.mark.parametrize("values", [(), (1.0,), (2.0, 2.0, 2.0)])
def test_histories_without_cycles(values: tuple[float, ...]) -> None:
    pytest.importorskip("rainflow")
    found = uniaxial(values).rainflow(of="xx")
    assert not found.range.any() and found.equivalent_range(3.0) == 0.0


def rows_of(path: Path) -> tuple[list[str], np.ndarray]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.reader(lines))
    return rows[0], np.array(rows[1:], dtype=float)


def test_files_have_all_digits(tmp_path: Path) -> None:
    pytest.importorskip("rainflow")
    rng = np.random.default_rng(4)
    stress = StressResult(np.cumsum(rng.random(20)), rng.random((2, 3)), 1e8 * rng.standard_normal((20, 2, 6)))
    names, table = rows_of(stress.to_csv(tmp_path / "stress.csv"))
    assert names == ["time [s]", *(f"{c}[{k}] [Pa]" for k in range(2) for c in COMPONENTS)]
    assert np.array_equal(table[:, 0], stress.time) and np.array_equal(table[:, 1:], stress.tensor.reshape(20, 12))
    cycles = stress.rainflow(1, of="zx")
    names, table = rows_of(cycles.to_csv(tmp_path / "cycles.csv"))
    assert names == ["range [Pa]", "mean [Pa]", "count [1]", "start [s]", "end [s]"]
    assert np.array_equal(table, np.stack([cycles.range, cycles.mean, cycles.count, cycles.start, cycles.end], axis=1))
    with pytest.raises(InputError, match="exists"):
        stress.to_csv(tmp_path / "stress.csv")
    assert stress.to_csv(tmp_path / "stress.csv", overwrite=True).is_file()
    with pytest.raises(InputError, match="csv"):
        stress.to_csv(tmp_path / "stress.txt")


def test_wrong_input(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rainflow")
    stress = uniaxial(STANDARD)
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"point": 1}, "point"),
        ({"point": -1}, "point"),
        ({"of": "von_mises"}, "signed_von_mises"),
        ({"of": (0.0, 0.0, 0.0)}, "rainflow: of"),
    ]
    for options, said in wrong:
        with pytest.raises(InputError, match=said):
            stress.rainflow(**options)
    monkeypatch.setitem(sys.modules, "rainflow", None)
    with pytest.raises(InputError, match=r"pip install 'warpffrf\[fatigue\]'"):
        stress.rainflow()
