"""Parts of HDF5 files: what a file cannot hold is not allocated, and what lies elsewhere is not followed."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.files.hdf5_parts import COMPLEX, member, names, read, read_text


@pytest.fixture
def file(tmp_path: Path) -> Iterator[Any]:
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.arange(3.0)
    with h5py.File(tmp_path / "a.h5", "w") as made:
        made["group/numbers"] = np.arange(6.0).reshape(2, 3)
        made["text"], made["words"], made["complex"] = "told", np.array([b"a"]), np.zeros(2, dtype=complex)
        made["record"] = np.zeros(2, dtype=[("n", np.int32), ("x", np.float64, 3)])
        made.create_dataset("packed", data=np.zeros(1 << 20), compression="gzip", shuffle=True)
        made["soft"], made["far"] = h5py.SoftLink("/group"), h5py.ExternalLink("other.h5", "/x")
        made.create_dataset("never written", shape=(1 << 40,), dtype="f8", chunks=True)
        made.create_dataset("packed, never written", shape=(1 << 30,), dtype="f8", compression="gzip")
        made.create_dataset("beside", shape=(100,), dtype="f8", external=[("x.bin", 0, 800)])
        layout = h5py.VirtualLayout(shape=(3,), dtype="f8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "x", shape=(3,))
        made.create_virtual_dataset("virtual", layout)
        made.create_dataset("odd packing", data=np.zeros(1000), compression="lzf")
    with h5py.File(tmp_path / "a.h5", "r") as opened:
        yield opened


def test_numbers_and_text_are_read(file: Any) -> None:
    assert np.array_equal(read(file, "group/numbers"), np.arange(6.0).reshape(2, 3))
    assert np.array_equal(read(file, "group/numbers", np.s_[:, 1]), [1.0, 4.0])
    assert read(file, "packed").nbytes == 8 << 20 and read(file, "record").dtype.names == ("n", "x")
    assert read_text(file, "text") == "told" and read(file, "complex", kinds=COMPLEX).dtype == complex
    assert names(file, "group") == ["numbers"] and names(file, "nothing") == []


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("far", "link to another place"),
        ("soft/numbers", "link to another place"),
        ("beside", "in another file"),
        ("virtual", "in another file"),
        ("never written", "more than the file can contain"),
        ("packed, never written", "more than the file can contain"),
        ("odd packing", "compressed by lzf"),
        ("words", "no numbers"),
        ("complex", "no numbers"),
        ("group", "no dataset"),
    ],
)
def test_what_is_not_of_the_file_is_refused(file: Any, path: str, words: str) -> None:
    tracemalloc.start()
    with pytest.raises(InputError, match=words):
        read(file, path)
    assert tracemalloc.get_traced_memory()[1] < 1 << 20
    tracemalloc.stop()


def test_what_is_not_there(file: Any) -> None:
    for path in ("nothing", "group/nothing", "text/more"):
        with pytest.raises(KeyError):
            member(file, path)
    for path in ("group/numbers", "words"):
        with pytest.raises(InputError, match="no text"):
            read_text(file, path)
