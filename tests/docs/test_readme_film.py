"""The page's example of an oil film runs as it stands, and finds what the page says of it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from printed import python_blocks

ROOT = Path(__file__).parents[2]
EXAMPLES = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
QUOTED = 0.003  # of a number: three digits


def test_the_film_is_as_thin_as_it_says(tmp_path: Path) -> None:
    (code,) = (c for c in python_blocks(EXAMPLES) if "wf.Film(" in c)
    script = tmp_path / "example.py"
    script.write_text(code.replace("0.02, step=2e-4", "6e-4, step=2e-4"), encoding="utf-8")
    path = os.pathsep.join([str(ROOT), str(ROOT / "kernels")])
    environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg"}
    done = subprocess.run([sys.executable, script], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    thin, peak = (float(x) for x in done.stdout.split()[:2])
    said = re.search(r"a smallest film of ([\d.]+) µm under ([\d.]+) MPa", EXAMPLES.replace("\n", " "))
    assert said is not None
    assert 1e6 * thin == pytest.approx(float(said.group(1)), rel=QUOTED)
    assert 1e-6 * peak == pytest.approx(float(said.group(2)), rel=QUOTED)
    assert (tmp_path / "bearing.rrd").stat().st_size > 0
