"""Files behind names: pipes, devices, files of the system, includes without end, and long numbers."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import Budget
from warpffrf.model.mesh.files.matrices import read_matrix
from warpffrf.model.mesh.files.reader import SUFFIXES
from warpffrf.scene_file.source import parse

MATRICES = (".mtx", ".mm", ".sti", ".mas", ".op4", ".op2")


@pytest.mark.parametrize("suffix", [*SUFFIXES, *MATRICES])
@pytest.mark.parametrize("behind", ["pipe", "/dev/zero", "/proc/self/maps", "folder"])
def test_what_is_no_ordinary_file(tmp_path: Path, suffix: str, behind: str) -> None:
    path = tmp_path / f"name{suffix}"
    if behind == "pipe":
        os.mkfifo(path)
    elif behind == "folder":
        path.mkdir()
    else:
        path.symlink_to(behind)
    with pytest.raises(InputError, match=rf"name\{suffix}: .*(is not a regular file|Is a directory)"):
        read_matrix(path) if suffix in MATRICES else wfmesh.read(path, length_unit="m")


INCLUDE = {".inp": "*INCLUDE, INPUT={}\n", ".bdf": "INCLUDE '{}'\n"}


@pytest.mark.parametrize("suffix", list(INCLUDE))
def test_includes_end(tmp_path: Path, suffix: str) -> None:
    """Each of 31 files twice the next one; a chain of 200; a pipe."""
    line = INCLUDE[suffix]
    for i in range(31):
        (tmp_path / f"l{i}{suffix}").write_text(2 * line.format(f"l{i + 1}{suffix}") if i < 30 else "")
    with pytest.raises(InputError, match=r"is one file more than 1000"):
        wfmesh.read(tmp_path / f"l0{suffix}", length_unit="m")
    for i in range(200):
        (tmp_path / f"c{i}{suffix}").write_text(line.format(f"c{i + 1}{suffix}"))
    with pytest.raises(InputError, match="lies more than 50 files deep"):
        wfmesh.read(tmp_path / f"c0{suffix}", length_unit="m")
    os.mkfifo(tmp_path / "pipe.inc")
    (tmp_path / f"m{suffix}").write_text(line.format("pipe.inc"))
    with pytest.raises(InputError, match="cannot be read .is not a regular file"):
        wfmesh.read(tmp_path / f"m{suffix}", length_unit="m")


def test_a_budget_of_bytes_is_one_for_all_files(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(bytes(60))
    budget = Budget(bytes_left=100)
    budget.read(tmp_path / "a")
    with pytest.raises(InputError, match="has 60 bytes, more than 40 are not read"):
        budget.read(tmp_path / "a")


@pytest.mark.parametrize("digits", [2000, 5000, 100_000])
def test_long_integers_of_scene_files(digits: int) -> None:
    with pytest.raises(InputError, match="name:2: a number of more than 1000 digits"):
        parse(f"a = 1\nb = {digits * '9'}\n", "name", Path())


@pytest.mark.parametrize("text", [5000 * "9" + ".1", "1." + 5000 * "9", 20 * "9" + ".1"])
def test_long_numbers_of_dofs(tmp_path: Path, text: str) -> None:
    (tmp_path / "k.sti").write_text("1 1 2.0\n")
    (tmp_path / "k.dof").write_text(text + "\n")
    with pytest.raises(InputError, match="k.dof, line 1: .* is not node.direction"):
        read_matrix(tmp_path / "k.sti")


OP4 = (
    "       2       2       6       2K       1P,3E23.16\n       1       1       1\n{}\n"
    "       2       2       1\n 2.0000000000000000E+00\n       3       1       1\n 1.0000000000000000E+00\n"
)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (" 1.0000000000000000E+00", None),
        (" 1.00000000000000000nan", "line 3 is neither a head nor numbers"),
        ("                    nan", "line 3 is neither a head nor numbers"),
        (" 1.000000000000000E+00", "line 3 is neither a head nor numbers"),
        (" 1.0000000000000000E+99\x00", "line 3 is neither a head nor numbers"),
    ],
)
def test_text_of_output4(tmp_path: Path, value: str, message: str | None) -> None:
    pytest.importorskip("pyyeti.nastran.op4")
    path = tmp_path / "k.op4"
    path.write_text(OP4.format(value))
    if message is None:
        assert read_matrix(path, "K").matrix.toarray().tolist() == [[1.0, 0.0], [0.0, 2.0]]
        for code in ("utf-16", "utf-16-le", "utf-16-be"):
            path.write_text(OP4.format(value), encoding=code)
            with pytest.raises(InputError, match="cannot be read as OUTPUT4"):
                read_matrix(path, "K")
        return
    with pytest.raises(InputError, match=message):
        read_matrix(path, "K")
