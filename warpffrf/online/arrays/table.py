"""The table of all arrays in docs/arrays.md: `python -m warpffrf.online.arrays.table > docs/arrays.md`."""

from __future__ import annotations

from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.declaration import Arrays, Declaration, parts
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.arrays.state import State

TYPES = {"float64": "real", "int32": "integer", "vec3d": "vector", "mat33d": "matrix", "quatd": "quaternion"}


def markdown() -> str:
    """All declarations, by class, and all axes that they have."""
    lines = [
        "# Arrays of a run",
        "",
        "Made from the declarations in `warpffrf/online/arrays/` by `python -m warpffrf.online.arrays.table`.",
        "Worlds come first. A *run* is read and written along contiguous stretches by index, as one axis. What is",
        "*carried* keeps something from attempt to attempt; all of `State` does.",
    ]
    used: set[str] = set()
    for whole in (State, Scratch):
        for part in whole.__bases__:
            lines += ["", f"## {whole.__name__}: {part.__name__}", "", str(part.__doc__), ""]
            lines += ["| array | type | axes | unit | |", "|---|---|---|---|---|"]
            if issubclass(part, Arrays):
                lines += [_row(name, d, whole is Scratch) for name, d in part.declarations.items()]
                used |= {parts(a)[1] for d in part.declarations.values() for a in d.axes if isinstance(a, str)}
    lines += ["", "## Axes", "", "| axis | entries |", "|---|---|"]
    lines += [f"| {name} | {text} |" for name, text in NAMES.items() if name in used]
    return "\n".join(lines) + "\n"


def _row(name: str, d: Declaration, scratch: bool) -> str:
    kind = TYPES.get(d.dtype.__name__, d.dtype.__name__) if isinstance(d.dtype, type) else d.dtype.key
    marks = [d.note] if d.note else []
    marks += ["run"] * d.run + ["carried"] * (d.carried and scratch)
    marks += [f"`{d.instead}` without its axes"] * bool(d.instead)
    axes = " x ".join(str(axis) for axis in d.axes)
    return f"| `{name}` | {kind} | {axes} | {d.unit} | {'; '.join(marks)} |"


if __name__ == "__main__":
    print(markdown(), end="")
