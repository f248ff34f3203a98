"""The walk-throughs of CONTRIBUTING.md: their files and lines, put into a copy of the package, pass their own tests."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
WALKS = dict(re.findall(r"^### (.*?)\n(.*?)(?=^##|\Z)", PAGE, re.MULTILINE | re.DOTALL))
KERNEL = "A contact law that needs a kernel"  # compiles, so that it is slow
FENCE = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def follow(walk: str, folder: Path) -> list[Path]:
    """Do in `folder` what the walk-through says; returns the tests that it has written."""
    tests = []
    for kind, text in FENCE.findall(walk):
        if kind == "diff":
            for file, change in re.findall(r"^--- (.*)\n((?:[ +-](?!-- ).*\n)+)", text, re.MULTILINE):
                change_lines(folder / file, change)
            continue
        name, content = re.fullmatch(r"# (\S+)\n(.*)", text, re.DOTALL).groups()  # type: ignore[union-attr]
        path = folder / name
        assert not path.exists(), f"{name} exists"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
        tests += [path] if name.startswith("tests/") else []
    return tests


def change_lines(file: Path, change: str) -> None:
    """Put the lines with " " and "+" in the place of those with " " and "-", which stand in the file once."""
    lines = change.splitlines()
    old, new = ("\n".join(line[1:] for line in lines if line[0] != sign) for sign in "+-")
    text = file.read_text(encoding="utf-8")
    assert text.count(old) == 1, f"{file.name} has {text.count(old)} times what CONTRIBUTING.md changes: {old!r}"
    file.write_text(text.replace(old, new), encoding="utf-8")


def run_walks(walks: list[str], folder: Path) -> None:
    for package in ("warpffrf", "kernels"):
        ignored = shutil.ignore_patterns("__pycache__", "*.png", "*.msh")
        shutil.copytree(ROOT / package, folder / package, ignore=ignored)
    tests = [path for walk in walks for path in follow(walk, folder)]
    assert len(tests) == len(walks)
    path = os.pathsep.join([str(folder), str(folder / "kernels")])
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", f"--rootdir={folder}"]
    done = subprocess.run(
        [*words, *map(str, tests)], cwd=folder, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_walk_throughs_work(tmp_path: Path) -> None:
    walks = [walk for name, walk in WALKS.items() if name != KERNEL]
    assert len(walks) == 4
    run_walks(walks, tmp_path)


@pytest.mark.slow
def test_the_walk_through_with_a_kernel_works(tmp_path: Path) -> None:
    run_walks([WALKS[KERNEL]], tmp_path)


def test_their_code_is_in_the_style_of_the_rest(tmp_path: Path) -> None:
    """But for the groups of imports, which depend on the folder."""
    for number, (_, text) in enumerate(f for f in FENCE.findall(PAGE) if f[0] == "python"):
        (tmp_path / f"block_{number}.py").write_text(text.split("\n", 1)[1], encoding="utf-8")
    configuration = ["--config", str(ROOT / "pyproject.toml")]
    for command in (["check", "--ignore=I001"], ["format", "--check"]):
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *command, *configuration, str(tmp_path)], capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout
