"""The table of all arrays in docs/arrays.md: `python -m warpffrf.online.arrays.table > docs/arrays.md`."""

from __future__ import annotations

import inspect
from typing import Any

from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.arrays.ring import Ring
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.arrays.state import State
from warpffrf_kernels.core.declaration import Declaration, parts
from warpffrf_kernels.core.model import Elements, External, Films, Model

TYPES = {"float64": "real", "int32": "integer", "vec3d": "vector", "mat33d": "matrix", "quatd": "quaternion"}


def markdown() -> str:
    """All declarations by class, and all axes that they use."""
    lines = [
        "# Arrays of a run",
        "",
        "Made from the declarations in `kernels/warpffrf_kernels/core/` by `python -m warpffrf.online.arrays.table`.",
        "The first axis is the world; the model has none. A *run* is read and written along contiguous",
        "ranges by index, as one axis. *Carried* arrays keep values from attempt to attempt, as all of `State`",
        "do.",
    ]
    tables = [
        (f"{whole.__name__}: {part.__name__}", str(inspect.getdoc(part)), part.declarations, whole is Scratch)
        for whole in (State, Ring, Scratch)
        for part in whole.__bases__
        if hasattr(part, "declarations") and part is not Arrays
    ]
    tables += [
        (f"Model: {name}", str(inspect.getdoc(topic)), topic.declarations, False) for name, topic in topics().items()
    ]
    used: set[str] = set()
    for title, text, declarations, scratch in tables:
        lines += ["", f"## {title}", "", text, ""]
        lines += ["| array | type | axes | unit | |", "|---|---|---|---|---|"]
        lines += [_row(name, d, scratch) for name, d in declarations.items()]
        used |= {parts(a)[1] for d in declarations.values() for a in d.axes if isinstance(a, str)}
    lines += ["", "## Axes", "", "| axis | entries |", "|---|---|"]
    lines += [f"| {name} | {text} |" for name, text in NAMES.items() if name in used]
    return "\n".join(lines) + "\n"


def topics() -> dict[str, Any]:
    """Topics of the model and its elements that have arrays, by the name of their field."""
    fields = {**vars(Model()), **vars(External()), **vars(Elements()), "films": Films()}
    found = {name: type(value) for name, value in fields.items() if hasattr(value, "declarations")}
    return {name: topic for name, topic in found.items() if topic.declarations}


def _row(name: str, d: Declaration, scratch: bool) -> str:
    kind = TYPES.get(d.dtype.__name__, d.dtype.__name__) if isinstance(d.dtype, type) else d.dtype.key
    marks = [d.note] if d.note else []
    marks += ["run"] * d.run + ["carried"] * (d.carried and scratch)
    marks += ["restored after a rejected attempt"] * d.restored
    marks += [f"`{d.instead}` without its axes"] * bool(d.instead)
    axes = " x ".join(str(axis) for axis in d.axes)
    return f"| `{name}` | {kind} | {axes} | {d.unit} | {'; '.join(marks)} |"


if __name__ == "__main__":
    print(markdown(), end="")
