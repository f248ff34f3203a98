"""Rows of a sweep: grids, ranges, distributions and samples; closed forms of their quantiles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.stats

from warpffrf.model.errors import InputError
from warpffrf.study.sweeps.design import design_of

ROUND_OFF = 1e-12


def column(given: Any, sample: str | None = None) -> list[Any]:
    return [row["x"] for row in design_of({"x": given}, sample).rows]


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("1:5:5", [1, 2, 3, 4, 5]),
        ("1:2:3", [1.0, 1.5, 2.0]),
        ("1.0:3.0:3", [1.0, 2.0, 3.0]),
        ("5:1:3", [5, 3, 1]),
        ("log:1e-3:1:4", [1e-3, 1e-2, 1e-1, 1.0]),
        ("0.1,0.2", [0.1, 0.2]),
        ("hht, auto", ["hht", "auto"]),
        ("a:b, c:1", ["a:b", "c:1"]),
        ("'lin:1', '0.1;0.2'", ["lin:1", "0.1;0.2"]),
        ("true,false", [True, False]),
        (np.array([1.0, 2.0]), [1.0, 2.0]),
    ],
)
def test_values_of_a_grid(given: Any, values: list[Any]) -> None:
    found = column(given)
    assert [type(v) for v in found] == [type(v) for v in values]
    assert found == (pytest.approx(values, rel=ROUND_OFF) if isinstance(values[0], float) else values)


def test_a_latin_hypercube_has_one_point_in_each_stratum_of_every_parameter() -> None:
    """Of distributions too: their cumulative probabilities are spread, F(x) = 1 - exp(-x) and 1 - (1 - x)^2."""
    given = {"a": "10:20", "b": scipy.stats.expon(), "c": "triangular(0, 0, 1)", "d": ["p", "q"]}
    rows = design_of(given, "latin:16:3").rows
    probabilities = [
        [(row["a"] - 10.0) / 10.0 for row in rows],
        [1.0 - np.exp(-row["b"]) for row in rows],
        [1.0 - (1.0 - row["c"]) ** 2 for row in rows],
    ]
    for found in probabilities:
        assert sorted(np.floor(16.0 * np.array(found)).astype(int)) == list(range(16))
    assert sorted(row["d"] for row in rows) == ["p"] * 8 + ["q"] * 8
    assert rows == design_of(given, "latin:16:3").rows != design_of(given, "latin:16:4").rows


@pytest.mark.parametrize(
    ("text", "mean", "deviation"),
    [
        ("normal(3, 0.5)", 3.0, 0.5),
        ("uniform(1, 3)", 2.0, 2.0 / np.sqrt(12.0)),
        ("triangular(0, 1, 2)", 1.0, 1.0 / np.sqrt(6.0)),
        ("lognormal(2, 0.1)", 2.0 * np.exp(0.005), 2.0 * np.exp(0.005) * np.sqrt(np.expm1(0.01))),
    ],
)
def test_distributions_have_their_moments(text: str, mean: float, deviation: float) -> None:
    """Of a Sobol sample of 1024 points, to 2 %: its error goes with 1/N, tails beyond 1/N are not seen."""
    found = np.array(column(text, "sobol:1024"))
    assert np.mean(found) == pytest.approx(mean, rel=2e-2) and np.std(found) == pytest.approx(deviation, rel=2e-2)


def test_saltelli_rows_are_a_b_and_a_with_each_column_of_b() -> None:
    design = design_of({"x": "0.0:1.0", "y": "0.0:1.0", "z": "0.0:1.0"}, "saltelli:8")
    points = np.array([[row[name] for name in design.names] for row in design.rows]).reshape(5, 8, 3)
    A, B, *mixed = points
    for n, AB in enumerate(mixed):
        assert np.array_equal(AB[:, n], B[:, n])
        assert np.array_equal(np.delete(AB, n, axis=1), np.delete(A, n, axis=1))


def test_rows_as_given() -> None:
    pandas = pytest.importorskip("pandas")
    rows = [{"a": 1, "b": "x"}, {"a": 2, "b": "y"}]
    assert design_of(rows, None).rows == rows == design_of(pandas.DataFrame(rows), None).rows
    for wrong, words in (
        ([{"a": 1}, {"b": 1}], "row 1 must have"), ([], "rows"), ([{"a": [1]}], "finite number"),
        ([{"a": np.nan}], "finite"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            design_of(wrong, None)
    with pytest.raises(InputError, match="run as they are"):
        design_of(rows, "latin:4")
    with pytest.raises(InputError, match="the seed must be a whole number; write latin:4:7"):
        design_of({"x": "0:1"}, "latin:4:x")


@pytest.mark.parametrize(
    ("given", "sample", "words"),
    [
        ("1:2:1", None, "at least 2"),
        ("1:2:2.5", None, "whole number"),
        ("1:1:3", None, "has equal ends"),
        ("log:0:1:3", None, "greater than zero"),
        ("normal(1)", "latin:4", "normal.mean, deviation."),
        ("normal(1, -1)", "latin:4", "greater than zero"),
        ("normal(1, a)", "latin:4", "no number"),
        ("uniform(2, 1)", "latin:4", "greater than zero"),
        ("triangular(0, 3, 1)", "latin:4", "not between"),
        ([1.0, np.inf], None, "finite"),
        ([[1.0]], None, "must be a number"),
        (3.0, None, "list of values"),
        ("1:2", "latin:0", "latin:64"),
        ("1:2", "latine:4", "did you mean 'latin'"),
        ("1:2", "latin:99999999", "several sweeps"),
        ("1:2", "saltelli:48", "power of two; write saltelli:64"),
        ("1:2", f"saltelli:{1 << 19}", f"has {3 << 19} rows"),
        ("1000:5000:5:2", None, "first:last:count"),
        ("1000:5000,5", None, "first:last:count"),
        ("1:2:a", None, "must be a number"),
        ("a:2:3", None, "first:last:count"),
        ("lin:1:5:3", None, "first:last:count"),
        ("log:1:a:3", None, "first:last:count"),
        ("log:1", None, "first:last:count"),
        ("0.1;0.2", None, "a comma between"),
        ("0.1 0.2, 0.3", None, "a comma between"),
        ("1,,2", None, "an empty value between commas"),
        (", oil", None, "an empty value between commas"),
        (scipy.stats.cauchy(), "latin:4", ""),
    ],
)
def test_what_is_no_parameter_is_refused(given: Any, sample: str | None, words: str) -> None:
    if not words:  # a distribution without moments still has values
        assert np.isfinite(column(given, sample)).all()
        return
    with pytest.raises(InputError, match=words):
        column(given, sample)


def test_too_many_combinations_are_refused() -> None:
    with pytest.raises(InputError, match="1001 x 1001 combinations"):
        design_of({"x": "0:1:1001", "y": "0:1:1001"}, None)
