"""Measures which tests are slow, and lists them in tests/slow_tests.txt: they get the marker `slow`.

    python tests/slow_tests.py                 runs the suite, half an hour on two cores
    python tests/slow_tests.py --times FILE    chooses again from the times of an earlier run

Times are CPU times, with those of child processes, so that other programs do not count. Of each test function the
quickest set of parameters stays in the suite unless it takes more than MOST seconds, the others up to EACH seconds.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LIST = ROOT / "tests" / "slow_tests.txt"
TIMES = "WARPFFRF_TEST_TIMES"  # a file; while it is set the list marks nothing
MOST, EACH = 2.5, 0.7  # s


def _used() -> float:
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Write the time of each test; this file is the plugin of its own run."""
    before = _used()
    yield
    with open(os.environ[TIMES], "a", encoding="utf-8") as file:
        file.write(f"{_used() - before:.3f} {item.nodeid}\n")


def slow_tests(times: dict[str, float]) -> list[str]:
    """The tests with `times` [s] that are slow, see the module."""
    functions: dict[str, list[tuple[float, str]]] = defaultdict(list)
    for name, seconds in times.items():
        functions[name.split("[")[0]].append((seconds, name))
    found = []
    for each in functions.values():
        for i, (seconds, name) in enumerate(sorted(each)):
            if seconds > (MOST if i == 0 else EACH):
                found.append(name)
    return sorted(found)


def main() -> None:
    """Measure, if no times are given, and write the list."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=Path, help="times of an earlier run: seconds and test on each line")
    file = parser.parse_args().times
    if file is None:
        file = ROOT / "out" / "test_times.txt"
        file.parent.mkdir(exist_ok=True)
        file.unlink(missing_ok=True)
        path = os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
        subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", Path(__file__).stem], cwd=ROOT, check=True,
            env={**os.environ, TIMES: str(file), "PYTHONPATH": path},
        )  # fmt: skip
    lines = [line.split(" ", 1) for line in file.read_text(encoding="utf-8").splitlines()]
    times = {name: float(seconds) for seconds, name in lines}
    slow = slow_tests(times)
    LIST.write_text("".join(f"{name}\n" for name in slow), encoding="utf-8")
    whole, rest = sum(times.values()), sum(times.values()) - sum(times[name] for name in slow)
    print(f"{len(slow)} of {len(times)} tests are slow; without them {rest / 60:.0f} of {whole / 60:.0f} CPU minutes")


if __name__ == "__main__":
    main()
