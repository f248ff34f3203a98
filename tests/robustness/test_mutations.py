"""Damaged files of every format: refused with a word, or read; no crash, no hang, no library's traceback.

`campaign.py` does it, in a process of its own, as it forks; more of it by hand, see there.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

CAMPAIGN = Path(__file__).with_name("campaign.py")
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs fork and limits of Linux")


def run(tmp_path: Path, count: int, seed: int) -> None:
    told = tmp_path / "told.json"
    command = [sys.executable, str(CAMPAIGN), "--count", str(count), "--seed", str(seed), "--json", str(told)]
    done = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ))
    assert told.is_file(), done.stdout + done.stderr
    found = json.loads(told.read_text())
    assert sum(sum(counts.values()) for counts in found["counts"].values()) == count
    assert not found["faults"], "\n".join(map(str, found["faults"]))
    assert all(counts.get("refused") for counts in found["counts"].values()), found["counts"]


def test_some_damaged_files(tmp_path: Path) -> None:
    run(tmp_path, 225, seed=7)


@pytest.mark.slow
def test_thousands_of_damaged_files(tmp_path: Path) -> None:
    run(tmp_path, 5000, seed=1)
