"""The scripts of CONTRIBUTING.md, each of which has a part of its own, run outside the package."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SCRIPTS = dict(re.findall(r"^```python\n# (own_\w+\.py)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
RUN_ALL = """
import pathlib, runpy, traceback
failed = False
for script in sorted(pathlib.Path().glob("own_*.py")):
    try:
        runpy.run_path(str(script))
    except BaseException:
        failed = True
        print(script.name)
        traceback.print_exc()
raise SystemExit(failed)
"""


def written(folder: Path) -> Path:
    for name, text in SCRIPTS.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def test_the_scripts_work(tmp_path: Path) -> None:
    assert len(SCRIPTS) == PAGE.count("```python") == 15
    done = subprocess.run([sys.executable, "-c", RUN_ALL], cwd=written(tmp_path), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_they_are_in_the_style_of_the_rest(tmp_path: Path) -> None:
    """But for the groups of imports, which depend on the folder."""
    configuration = ["--config", str(ROOT / "pyproject.toml")]
    for command in (["check", "--ignore=I001"], ["format", "--check"]):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, *configuration, str(written(tmp_path))],
            capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout
