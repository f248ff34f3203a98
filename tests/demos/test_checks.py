"""Checks of demos, and the registry: every demo has a command, a script and both functions."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

import warpffrf as wf
from demos.checks import Check, table, writable_folder
from warpffrf import cli
from warpffrf.cli.info import names

ROOT = Path(__file__).resolve().parents[2]


def test_a_check_passes_within_its_tolerance_only() -> None:
    assert Check("a", 1.01, 1.0, "exact", 0.02).passed
    assert not Check("a", 1.03, 1.0, "exact", 0.02).passed
    assert Check("a", 0.01, 0.0, "balance", 0.02, scale=1.0).passed
    assert not Check("a", float("nan"), 1.0, "exact", 1e9).passed
    assert Check("a", -2.2, -2.0, "exact", 0.2).error == pytest.approx(0.1)


def test_the_table_shows_units_and_what_failed() -> None:
    text = table([Check("force", 1500.0, 1000.0, "statics", 0.1, "kN", 1e-3), Check("b", 1.0, 1.0, "exact", 0.1)])
    first, second = text.splitlines()[1:]
    assert "force [kN]" in first and "1.5" in first and "FAILED" in first
    assert "FAILED" not in second


@pytest.mark.parametrize("module", sorted(path.stem for path in names().values()))
def test_every_demo_is_whole(module: str, capsys: pytest.CaptureFixture) -> None:
    demo = importlib.import_module(f"demos.{module}")
    assert callable(demo.build) and callable(demo.main) and demo.__doc__
    assert (ROOT / "demos" / f"{module}.py").is_file()
    assert cli.main(["demo", module.replace("_", "-"), "--help"]) == 0
    said = capsys.readouterr().out
    assert "--quick" in said and f"{module}.rrd" in " ".join(said.split())
    assert module.replace("_", "-") in (ROOT / "docs" / "demos.md").read_text(encoding="utf-8")


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(wf.InputError, match="cannot write"):
        writable_folder(tmp_path / "file" / "out")
