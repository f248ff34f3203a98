"""Names that no file can have are refused before a run, in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf import cli
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count
from warpffrf.model.files.paths import checked_output_path, written_whole

PENDULUM = """
[scene]
gravity = [0, 0, -9.81]
[bodies.bob]
mass = 2.0
inertia_tensor = [0.01, 0.01, 0.01]
[simulate]
"""
LONG = 240  # characters: a file's name may have 255 on most systems, that of the one it is written to has some more


@pytest.mark.parametrize("name", ["x\0.h5", "x" * LONG + ".h5", "x" * 400 + ".h5"])
def test_names_that_no_file_can_have(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="^results: .*(NUL|shorter name)"):
        checked_output_path(tmp_path / name, "results", overwrite=False)
    assert not list(tmp_path.iterdir())


def test_the_longest_name_that_is_accepted_is_written(tmp_path: Path) -> None:
    """Whatever length this system and this machine's name leave."""
    for length in range(255, 0, -1):
        try:
            path = checked_output_path(tmp_path / ("x" * length), "results", overwrite=False)
        except InputError:
            continue
        with written_whole(path) as partial:
            partial.write_bytes(b"1")
        assert path.read_bytes() == b"1"
        return
    pytest.fail("no name is accepted")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ('duration = 0.01\nstep = 1e-3\nresults = "x\\u0000.h5"', "NUL"),
        ('duration = 0.01\nstep = 1e-3\nrecord = "x\\u0000.rrd"', "NUL"),
        (f'[[simulate.stages]]\nname = "{"s" * LONG}"\nduration = 0.01\nstep = 1e-3', "shorter name"),
        (f'[[simulate.stages]]\nname = "{"s" * 2000}"\nduration = 0.01\nstep = 1e-3', "shorter name"),
        ('[[simulate.stages]]\nname = "x\\u0000"\nduration = 0.01\nstep = 1e-3', "NUL"),
        ("duration = 0.01\nstep = 1e-3\nsave_every = 9000000000000000000", "at most"),
        ("duration = 0.01\nstep = 1e-300", "more than can be counted"),
    ],
)
def test_a_scene_with_such_names_ends_with_a_line(
    tmp_path: Path, lines: str, said: str, capsys: pytest.CaptureFixture
) -> None:
    file = tmp_path / "bob.toml"
    file.write_text(PENDULUM + lines, encoding="utf-8")
    assert cli.main(["-q", "run", str(file), "--out", str(tmp_path / "out")]) == 1
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.startswith("error: ") and said in line


def test_counts_are_counted_in_32_bits() -> None:
    assert require_count(2.0**31 - 1, "steps", 1, most=MOST_COUNTED) == 2**31 - 1
    with pytest.raises(InputError, match="at most 2147483647"):
        require_count(2**31, "steps", 1, most=MOST_COUNTED)
