"""Packing of a job for workers: pickled once, with reduced bodies by their content hash.

A reduced body may have a hundred megabytes, and a function that builds scenes usually holds one or two of them. A body
is therefore written once to the folder `bodies` of the sweep, and the job refers to it by its hash; a worker reads it
once. Other large jobs are also written there. Workers must see the folder under the same path, like a scene file and
the files that it names. A pickle runs code when it is opened. A worker therefore opens only data with the hash sent by
the sweep, whatever lies in the folder under that name: write access to the folder can make a sweep fail, but not run
code.

Workers compare their versions with those of the payload before they open it: other versions could change numbers, or
could not read the pickle.
"""

from __future__ import annotations

import hashlib
import io
import pickle
import socket
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import written_whole
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.file import read_reduced_body
from warpffrf.study.sweeps.job import OTHER_VERSIONS, Answer, Job, Numbered, versions
from warpffrf.study.sweeps.payload import Payload

BODY = "reduced body"
JOB = "{}.job"  # file of a large job
LARGE = 1 << 16  # bytes; larger jobs are not sent with every row
KEPT = 2  # opened jobs that a worker keeps: the present and the previous one

_opened: dict[str, Job] = {}


def opened(payload: Payload) -> Job:
    """The job of a payload, opened once per process. Raises `InputError` if this process cannot open it."""
    if payload.digest not in _opened:
        while len(_opened) >= KEPT:
            del _opened[next(iter(_opened))]
        content, folder = payload.content, Path(payload.folder)
        if not content:
            content = _there(folder / JOB.format(payload.digest)).read_bytes()
        if hashlib.sha256(content).hexdigest() != payload.digest:
            raise InputError(
                f"sweep: the job '{payload.digest}' in '{folder}' is not the one that was sent (its hash differs), and "
                "is not opened; see who can write to that folder, and begin anew with overwrite=True (--overwrite)"
            )
        try:
            _opened[payload.digest] = _Unpickler(io.BytesIO(content), folder).load()
        except (ImportError, AttributeError) as error:
            raise InputError(
                f"sweep: a worker cannot import what builds the scenes or reads outputs ({error}); install that module "
                "where workers run, or define the functions in the script itself"
            ) from None
    return _opened[payload.digest]


def _there(file: Path) -> Path:
    """A file of the sweep, as a worker sees it. Raises `InputError` if it does not."""
    if not file.is_file():
        raise InputError(
            f"sweep: a worker finds no '{file}'; put the store where all workers see it under the same path"
        )
    return file


def packed(job: Job, folder: Path) -> Payload:
    """The payload of a job, whose bodies are written to `folder`. Raises `InputError` for objects that cannot be
    pickled."""
    stream = io.BytesIO()
    try:
        _pickler()(stream, folder).dump(job)
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        raise InputError(
            f"sweep: what builds the scenes or reads outputs cannot be sent to other processes ({error}); define it "
            "with def at the top of a file, install cloudpickle (pip install 'warpffrf[cluster]'), or run it here, "
            "workers=1"
        ) from None
    content = stream.getvalue()
    digest = hashlib.sha256(content).hexdigest()
    if len(content) > LARGE:
        folder.mkdir(parents=True, exist_ok=True)
        with written_whole(folder / JOB.format(digest)) as partial:
            partial.write_bytes(content)
        content = b""
    return Payload(content, digest, str(folder.absolute()), versions())


def answers_of(payload: Payload, rows: Numbered, device: str | None) -> list[Answer]:
    """Answers of this process for `rows`, unless its versions differ."""
    differ = [
        f"{name} {mine}, here {payload.versions.get(name)}"
        for name, mine in versions().items()
        if payload.versions.get(name) != mine
    ]
    if differ:
        return [Answer(number, OTHER_VERSIONS, ", ".join(differ), host=socket.gethostname()) for number, _ in rows]
    return opened(payload).answers(rows, device)


def _pickler() -> Any:
    """A pickler, which accepts functions of a script if cloudpickle is installed."""
    try:
        from cloudpickle import Pickler as Kind
    except ImportError:
        from pickle import Pickler as Kind
    base: Any = Kind

    class WithBodies(base):
        """Pickler that writes bodies to the folder, once each."""

        def __init__(self, stream: Any, folder: Path) -> None:
            super().__init__(stream)
            self.folder, self.hashes = folder, {}

        def persistent_id(self, obj: Any) -> Any:
            if not isinstance(obj, ReducedBody):
                return None
            if id(obj) not in self.hashes:
                self.hashes[id(obj)] = obj.content_hash()
                file = self.folder / f"{self.hashes[id(obj)]}.h5"
                if not file.is_file():
                    self.folder.mkdir(parents=True, exist_ok=True)
                    obj.save(file)
            return BODY, self.hashes[id(obj)]

    return WithBodies


class _Unpickler(pickle.Unpickler):
    """Unpickler that reads bodies from the folder, once each."""

    def __init__(self, stream: Any, folder: Path) -> None:
        super().__init__(stream)
        self.folder, self.bodies = folder, {}

    def persistent_load(self, pid: Any) -> Any:
        kind, digest = pid
        if kind != BODY:
            raise pickle.UnpicklingError(f"unknown thing {kind!r}")
        if digest not in self.bodies:
            file = _there(self.folder / f"{digest}.h5")
            self.bodies[digest] = read_reduced_body(ReducedBody, file, f"sweep: '{file}'", content=digest)
        return self.bodies[digest]
