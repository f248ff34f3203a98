"""The list of slow tests names tests that there are, and the choice by times does what it says."""

from __future__ import annotations

from pathlib import Path

from slow_tests import EACH, LIST, MOST, ROOT, slow_tests


def test_every_listed_test_is_there() -> None:
    for line in LIST.read_text(encoding="utf-8").splitlines():
        file, _, name = line.partition("::")
        source = (ROOT / Path(file)).read_text(encoding="utf-8")
        assert f"def {name.split('[')[0].split('::')[-1]}(" in source, line


def test_the_quickest_parameters_of_a_test_stay() -> None:
    times = {"a[1]": 1.1 * EACH, "a[2]": 1.2 * EACH, "a[3]": 0.1, "b": 0.9 * MOST, "c": 1.1 * MOST, "d[1]": 1.1 * EACH}
    assert slow_tests(times) == ["a[1]", "a[2]", "c"]
