"""Seals of HDF5 files: any change of the bytes is seen before the HDF5 library opens the file."""

from __future__ import annotations

import random
from pathlib import Path

import h5py
import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.files import hdf5_parts
from warpffrf.model.files.sealed_file import TRAILER, check_schema, seal, verify, written_sealed


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "x.h5"
    with written_sealed(path) as opened:
        opened["numbers"] = np.arange(3000.0)
        opened.attrs["title"] = "numbers"
    return path


def look(path: Path) -> int:
    return verify(path, "file x", "write it again")


def test_a_sealed_file_is_an_hdf5_file(file: Path) -> None:
    assert look(file) == file.stat().st_size - TRAILER.size
    with h5py.File(file, "r") as opened:
        numbers = opened["numbers"]
        assert isinstance(numbers, h5py.Dataset) and np.array_equal(numbers[()], np.arange(3000.0))


def test_every_kind_of_damage_is_reported_in_one_line(file: Path) -> None:
    whole = file.read_bytes()
    rng = random.Random(1)
    n = len(whole)
    for _ in range(300):
        at = rng.randrange(n)
        flipped = bytes([whole[at] ^ 1 << rng.randrange(8)])
        for damaged in (
            whole[:at] + flipped + whole[at + 1 :],
            whole[:at],
            whole[:at] + b"x" + whole[at:],
            whole[:at] + whole[at + 7 :],
            whole[:at] + bytes(len(whole[at : at + 512])) + whole[at + 512 :],
        ):
            if damaged == whole:
                continue
            file.write_bytes(damaged)
            with pytest.raises(InputError, match=r"^file x is damaged \(.*\); write it again$"):
                look(file)


@pytest.mark.parametrize("more", [b"x", bytes(64), bytes(TRAILER.size)])
def test_bytes_behind_the_seal_are_damage(file: Path, more: bytes) -> None:
    file.write_bytes(file.read_bytes() + more)
    with pytest.raises(InputError, match="damaged"):
        look(file)


def test_a_seal_taken_off_is_missed(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: -TRAILER.size])
    with pytest.raises(InputError, match=r"^file x is damaged \(its checksum is missing.*\); write it again$"):
        look(file)


@pytest.mark.parametrize("found", [2, 4])
def test_older_and_newer_schemas_are_refused(found: int) -> None:
    with pytest.raises(InputError, match=f"^file x has schema {found}, this version.*3 alone; write it again"):
        check_schema(found, 3, "file x", "write it again")
    check_schema(3, 3, "file x", "write it again")


def test_a_changed_file_may_be_sealed_again(file: Path) -> None:
    with h5py.File(file, "a") as opened:
        opened["more"] = np.zeros(10)
    with pytest.raises(InputError, match="another program has changed it"):
        look(file)
    seal(file)
    assert look(file)


def test_what_is_no_file_of_warpffrf_is_said(tmp_path: Path) -> None:
    for content in (b"", b"text", b"\x89HDF\r\n\x1a\n" + bytes(200)):
        (tmp_path / "x.h5").write_bytes(content)
        with pytest.raises(InputError, match="no file of warpffrf"):
            look(tmp_path / "x.h5")
    with pytest.raises(InputError, match="cannot be read"):
        look(tmp_path / "no.h5")


def test_nothing_is_written_after_an_error(tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    path.write_bytes(b"old")
    with pytest.raises(ZeroDivisionError), written_sealed(path) as opened:
        opened["half"] = np.zeros(3)
        raise ZeroDivisionError
    assert path.read_bytes() == b"old" and len(list(tmp_path.iterdir())) == 1


def test_a_file_that_holds_up_the_library(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def probe() -> None:
        hdf5_parts.probe(file, "file x", "write it again")

    probe()  # the library comes back
    for script, words in (("while True: pass", "does not return"), ("import os; os.abort()", "crashes")):
        monkeypatch.setattr(hdf5_parts, "_LOOK", script)
        monkeypatch.setattr(hdf5_parts, "SECONDS", 1.0)
        with pytest.raises(InputError, match=f"^file x is damaged .*{words}.*; write it again$"):
            probe()
    monkeypatch.setattr(hdf5_parts, "_LOOK", "raise OSError")  # left to the reader
    probe()
