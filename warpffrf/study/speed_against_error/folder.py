"""Data of a study in its folder, from which an interrupted study continues.

    study.json        definition of the study, its reference, a row per completed setting, and the machines
    reference.h5      results of the reference run
    series/KEY.npz    forces and motions of each run at the common times, for the order in the step

A study is identified by its scene's content, its run, its reference and the program version. With other choices and
more rounds it is the same study: completed runs are not repeated.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.output.result import Result

STUDY, REFERENCE, SERIES = "study.json", "reference.h5", "series"
KIND = "warpffrf speed-error study"


class Folder:
    """The folder of one study; with `path` None all data stay in memory."""

    def __init__(self, path: str | os.PathLike[str] | None, identity: Mapping[str, Any], *, overwrite: bool) -> None:
        self.path = None if path is None else Path(path).expanduser()
        self.identity = json.loads(json.dumps(dict(identity)))
        self.content: dict[str, Any] = {
            "kind": KIND,
            "study": self.identity,
            "reference": None,
            "rows": {},
            "taken_on": [],
        }
        self._series: dict[str, dict[str, np.ndarray]] = {}
        self._reference: Result | None = None
        if self.path is None:
            return
        if self.path.exists() and not self.path.is_dir():
            raise InputError(f"speed_error: out '{self.path}' is a file; give the name of a folder")
        file = self.path / STUDY
        if file.is_file() and not overwrite:
            self.content = self._read(file)
        else:
            checked_output_path(file, "speed_error: out", overwrite=overwrite)
            self._remove_old()
        (self.path / SERIES).mkdir(parents=True, exist_ok=True)
        self.write()

    def _read(self, file: Path) -> dict[str, Any]:
        """The content of the folder, if it belongs to this study; raises `InputError` otherwise."""
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            there = content["study"] if content["kind"] == KIND else None
            known = isinstance(there, dict) and isinstance(content["rows"], dict)
        except (ValueError, KeyError, TypeError):
            known, there, content = False, {}, {}
        if not known or not isinstance(there, dict):
            raise InputError(f"speed_error: '{file}' is no study of warpffrf; choose another folder")
        if there == self.identity:
            return content
        cure = "choose another folder, or begin anew with overwrite=True (--overwrite)"
        if there.get("scene") != self.identity["scene"]:
            raise InputError(
                f"speed_error: '{self.path}' holds the study of another scene, '{there.get('title')}'; {cure}"
            )
        differ = [f"{k} was {there.get(k)!r} and is {v!r}" for k, v in self.identity.items() if there.get(k) != v]
        raise InputError(f"speed_error: '{self.path}' holds another study of this scene: {'; '.join(differ)}; {cure}")

    def _remove_old(self) -> None:
        """Remove the files of an earlier study, and no others."""
        if self.path is not None:
            for file in [self.path / REFERENCE, *(self.path / SERIES).glob("*.npz")]:
                file.unlink(missing_ok=True)

    def write(self) -> None:
        """Write the present state of the study."""
        if self.path is not None:
            with written_whole(self.path / STUDY) as partial:
                partial.write_text(json.dumps(self.content, indent=1) + "\n", encoding="utf-8")

    # --- the reference

    def keep_reference(self, result: Result, facts: Mapping[str, Any]) -> None:
        """Store the reference and its facts."""
        self._reference = result
        if self.path is not None:
            result.save(self.path / REFERENCE, overwrite=True)
        self.content["reference"] = dict(facts)
        self.write()

    def reference(self) -> tuple[Result, dict[str, Any]] | None:
        """The stored reference and its facts; None if there is none."""
        facts = self.content["reference"]
        if facts is None:
            return None
        if self._reference is None and self.path is not None:
            if not (self.path / REFERENCE).is_file():
                return None
            self._reference = Result.load(self.path / REFERENCE)
        return None if self._reference is None else (self._reference, facts)

    # --- runs

    def keep_machine(self, facts: Mapping[str, Any]) -> None:
        """Store the description of the machine of this sitting."""
        self.content.setdefault("taken_on", []).append(dict(facts))
        self.write()

    def machines(self) -> list[dict[str, Any]]:
        """Machines of the timed runs, one per sitting with runs."""
        return list(self.content.get("taken_on", []))

    def keep_row(self, label: str, row: Mapping[str, Any]) -> None:
        """Store a row of numbers and texts."""
        self.content["rows"][label] = dict(row)
        self.write()

    def row(self, label: str) -> dict[str, Any] | None:
        """The row of a setting, None if it has not been run."""
        return self.content["rows"].get(label)

    def times(self) -> int:
        """Number of timed runs."""
        return sum(len(row["walls"]) for row in self.content["rows"].values())

    def keep_series(self, label: str, series: Mapping[str, np.ndarray]) -> None:
        """Store arrays of a run."""
        self._series[label] = dict(series)
        if self.path is not None:
            with written_whole(self._file(label)) as partial, partial.open("wb") as stream:
                arrays: dict[str, Any] = dict(series)
                np.savez(stream, **arrays)

    def series(self, label: str) -> dict[str, np.ndarray] | None:
        """The arrays of a run; None if there are none."""
        if label not in self._series and self.path is not None and self._file(label).is_file():
            with np.load(self._file(label)) as found:
                self._series[label] = {name: found[name] for name in found.files}
        return self._series.get(label)

    def _file(self, label: str) -> Path:
        assert self.path is not None
        return self.path / SERIES / f"{hashlib.sha256(label.encode()).hexdigest()[:16]}.npz"
