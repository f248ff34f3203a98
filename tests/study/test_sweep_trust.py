"""What lies in the folders of sweeps and caches is taken for what its name says only where its hash says so too."""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
from pathlib import Path
from typing import Any

import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.offline import cache
from warpffrf.study.sweeps.job import versions
from warpffrf.study.sweeps.packing import BODY, JOB, opened
from warpffrf.study.sweeps.payload import Payload

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


class Harmful:
    """Leaves a file where it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.mark),)


class Reference(pickle.Pickler):
    """Pickles a reference to a reduced body."""

    def persistent_id(self, obj: Any) -> Any:
        return (BODY, obj.digest) if isinstance(obj, Digest) else None


class Digest:
    def __init__(self, digest: str) -> None:
        self.digest = digest


def bar(length: float) -> wf.ReducedBody:
    mesh = wf.mesh.box((length, 0.01, 0.01), (2, 1, 1))
    return wf.reduce(mesh, STEEL, interfaces={"x_min": "rigid"}, modes=1, progress=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("in_file", [True, False])
def test_a_job_of_another_hash_is_not_unpickled(tmp_path: Path, in_file: bool) -> None:
    content, mark = pickle.dumps(Harmful(tmp_path / "mark")), tmp_path / "mark"
    digest = hashlib.sha256(b"the job that was sent").hexdigest()
    (tmp_path / JOB.format(digest)).write_bytes(content)
    with pytest.raises(InputError, match="hash differs.*overwrite=True"):
        opened(Payload(b"" if in_file else content, digest, str(tmp_path), versions()))
    assert not mark.exists()
    opened(Payload(content, hashlib.sha256(content).hexdigest(), str(tmp_path), versions()))
    assert mark.exists()  # so it was harmful


def test_a_body_under_the_name_of_another_is_refused(folder: Path) -> None:
    """By the worker of a sweep; a reduction makes its own again: 7850 kg/m3 times 1e-5 and 2e-5 m3."""
    short, long = bar(0.1), bar(0.2)
    entries = {b.provenance["key"]: folder / f"{b.provenance['key']}.h5" for b in (short, long)}
    shutil.copy(entries[short.provenance["key"]], entries[long.provenance["key"]])
    assert bar(0.2).mass == pytest.approx(0.157, rel=1e-12)
    assert bar(0.1).report["cached"] and bar(0.2).report["cached"]  # and puts it into its place

    short.save(folder / f"{long.content_hash()}.h5")
    job = folder / "job"
    with job.open("wb") as stream:
        Reference(stream).dump(Digest(long.content_hash()))
    content = job.read_bytes()
    payload = Payload(content, hashlib.sha256(content).hexdigest(), str(folder), versions())
    with pytest.raises(InputError, match="is not the body of its name"):
        opened(payload)
    long.save(folder / f"{long.content_hash()}.h5", overwrite=True)
    reopened = opened(payload)
    assert isinstance(reopened, wf.ReducedBody) and reopened.mass == long.mass
