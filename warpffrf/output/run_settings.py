"""Differences between the settings of two runs, as text.

Options, scene and bodies are compared by value: the scene number by number as in `Scene.describe`, a flexible body by
the settings of its reduction, and by its arrays if the settings are equal. Items of which only a content hash is known
are either equal or different. Numbers that differ by round-off, relative to their row or to the size of the machine,
are counted.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.reduced.file import stored_arrays
from warpffrf.output.files.unfinished import HASH
from warpffrf.output.result import Result

NONE = "-"
ROUND_OFF = 1e-12  # relative to the largest number of a row, or for positions to the size of the machine
PLACES = ("position", "center_of_mass", "point")
SHOWN = 6  # numbers of a row that are printed; of longer rows the first that differs
NAMED = 3  # items that only one run has
KINDS = {
    "bodies": "body", "joints": "joint", "drives": "drive", "forces": "force", "contacts": "contact",
    "lumped_contacts": "lumped contact", "films": "film",
}  # fmt: skip


def settings_apart(a: Result, b: Result, length: float) -> tuple[dict[str, tuple[str, str]], list[str]]:
    """Differences of the settings of two runs of a machine of size `length` [m], name -> (of a, of b), and notes on the
    remaining ones."""
    found, notes = _Settings(length), []
    first, second = a.history.options, b.history.options
    for name in dict.fromkeys([*first, *second]):
        if name != "scene":
            found.compare(name, first.get(name), second.get(name))
    found.compare("status", a.status, b.status)
    found.compare("rows", len(a.time), len(b.time))
    found.compare("end [s]", *(float(run.time[-1]) if len(run.time) else None for run in (a, b)))
    items = [_by_item(_plain(run.view.description)) for run in (a, b)]
    for name, own, other in (("A", *items), ("B", *reversed(items))):
        for kind in KINDS.values():
            alone = [key.removeprefix(f"{kind} ") for key in own if key.startswith(f"{kind} ") and key not in other]
            if len(alone) > 1:
                found.alone(f"{kind}: only in {name}", alone, first=name == "A")
                for key in alone:
                    del own[f"{kind} {key}"]
    found.compare("", *items)
    for name in a.view.bodies.keys() & b.view.bodies.keys():
        found.reductions(f"body {name}", *(run.view.bodies[name].reduced for run in (a, b)))
    if found.slight:
        notes.append(f"settings that differ by round-off: {found.slight}, the first {found.first_slight}")
    return found.texts, notes


class _Settings:
    """Differences found, name -> texts of both; `slight` counts numbers that differ by round-off."""

    def __init__(self, length: float) -> None:
        self.texts: dict[str, tuple[str, str]] = {}
        self.length, self.slight, self.first_slight = length, 0, ""

    def compare(self, name: str, a: Any, b: Any) -> None:
        """Compare two values; tables and rows are compared item by item."""
        if a == b:
            return
        if isinstance(a, Mapping) and isinstance(b, Mapping):
            for key in dict.fromkeys([*a, *b]):
                between = "" if not name else "." if ": " in name else ": "
                self.compare(f"{name}{between}{key}", a.get(key), b.get(key))
        elif (shape := _shape(a)) is not None and shape == _shape(b):
            self._numbers(name, *(np.ravel(np.asarray(value, dtype=float)) for value in (a, b)))
        elif _rows(a) and _rows(b) and len(a) == len(b):
            for n, (one, other) in enumerate(zip(a, b, strict=True)):
                self.compare(f"{name}[{n}]", one, other)
        else:
            texts = _text(a), _text(b)
            self.texts[name] = texts if texts[0] != texts[1] else (texts[0], f"another {texts[1].removeprefix('a ')}")

    def alone(self, name: str, items: list[str], *, first: bool) -> None:
        """Items of which only one run has some."""
        more = f" and {len(items) - NAMED} more" if len(items) > NAMED else ""
        text = ", ".join(items[:NAMED]) + more
        self.texts[name] = (text, NONE) if first else (NONE, text)

    def _numbers(self, name: str, a: np.ndarray, b: np.ndarray) -> None:
        """Compare rows of equal length."""
        size = float(np.max(np.abs([a, b])))
        if name.rpartition(".")[2].rpartition(" ")[2] in PLACES:
            size = max(size, self.length)
        if np.max(np.abs(a - b)) <= ROUND_OFF * size:
            self.slight, self.first_slight = self.slight + 1, self.first_slight or name
            return
        where = ""
        if a.size > SHOWN:
            n = int(np.flatnonzero(a != b)[0])
            where, a, b = f" (number {n + 1} of {a.size})", a[[n]], b[[n]]
        texts = [", ".join(f"{v:.6g}" for v in values) for values in (a, b)]
        if texts[0] == texts[1]:
            texts = [", ".join(repr(float(v)) for v in values) for values in (a, b)]
        self.texts[name] = texts[0] + where, texts[1]

    def reductions(self, label: str, a: Any, b: Any) -> None:
        """Compare two reduced bodies; None for a rigid one."""
        if a is None or b is None:
            self.compare(label, *("rigid" if body is None else "flexible" for body in (a, b)))
            return
        if a is b or a.content_hash() == b.content_hash():
            return
        before = len(self.texts)
        self.compare(f"{label}: reduce", *(_of_reduction(body) for body in (a, b)))
        self.compare(f"{label}: global modes", len(a.frequencies), len(b.frequencies))
        self.compare(f"{label}: local modes", a.local_modes, b.local_modes)
        if len(self.texts) == before:
            one, other = (stored_arrays(body) for body in (a, b))
            apart = {name: _apart(one[name], other[name]) for name in one.keys() & other.keys()}
            worst = max(apart, key=lambda name: apart[name], default="")
            said = f"differ by up to {apart[worst]:.1e} of the largest, in {worst}" if worst else "others"
            self.texts[f"{label}: numbers of the reduced body"] = NONE, said
            self.compare(f"{label}: versions", *(body.provenance.get("versions", {}) for body in (a, b)))


def _by_item(description: Mapping[str, Any]) -> dict[str, Any]:
    """A description whose named items are keyed by kind and name, "joint hinge"."""
    found = {name: value for name, value in description.items() if name not in KINDS}
    for where, kind in KINDS.items():
        found |= {f"{kind} {item['name']}": item for item in description.get(where, ())}
    return found


def _of_reduction(body: Any) -> dict[str, Any]:
    """The settings of a reduction, with the mesh as text."""
    found = _plain(body.provenance.get("settings", {}))
    if "mesh" in found:
        said = f"a mesh '{body.provenance.get('mesh_name', '')}', {len(body.surface.points)} nodes on its skin"
        found["mesh"] = f"{said}, {found['mesh']}"
    return found


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    """The largest difference over the largest number; infinite for different shapes."""
    if a.shape != b.shape:
        return np.inf
    if a.dtype.kind not in "fiu" or not a.size:
        return 0.0 if np.array_equal(a, b) else np.inf
    size = float(max(np.max(np.abs(a)), np.max(np.abs(b))))
    return float(np.max(np.abs(a - b))) / size if size > 0.0 else 0.0


def _plain(document: Any) -> Any:
    """The value as read back from a file."""
    return json.loads(json.dumps(document))


def _rows(value: Any) -> bool:
    return isinstance(value, list | tuple)


def _shape(value: Any) -> tuple[int, ...] | None:
    """Shape of an array of numbers, () of a scalar, None otherwise."""
    if not _rows(value):
        return () if isinstance(value, int | float) and not isinstance(value, bool) else None
    parts = {_shape(v) for v in value}
    part = parts.pop() if len(parts) == 1 else None
    return None if part is None else (len(value), *part)


def _text(value: Any) -> str:
    if value is None:
        return NONE
    if isinstance(value, Mapping):
        return str(value.get("kind", "given"))
    if _rows(value):
        return f"{len(value)} entries" if len(value) > SHOWN else ", ".join(_text(v) for v in value) or "none"
    if isinstance(value, str):
        return HASH.sub("", value) or "one"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
