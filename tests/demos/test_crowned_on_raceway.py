"""The crowned roller on a raceway: the whole demo, quick."""

from __future__ import annotations

from pathlib import Path

from demo_files import left_behind

from demos import crowned_on_raceway as demo


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    left_behind(tmp_path / "out", "crowned_on_raceway", "straight")
