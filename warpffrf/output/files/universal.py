"""Universal files: datasets as text, header 151, units 164, nodes 2411, elements 2412, shapes 55 and functions 58.

Dataset 55 has six digits, 58 in double precision thirteen. Numbers of nodes count from 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
SIGNATURE = "written by warpffrf"
STEADY = 1e-6  # of a step: frequencies so near to equal steps are declared as such
TRIANGLE, QUADRILATERAL = 91, 94  # thin shells


@dataclass(frozen=True)
class Direction:
    """A node of a function: its number, name and direction, 1 to 3 along x, y, z, negative against it, 0 none."""

    node: int
    name: str
    code: int


def dataset(number: int, lines: Iterable[str]) -> str:
    """The text of a dataset."""
    return "\n".join([f"{-1:6d}", f"{number:6d}", *lines, f"{-1:6d}", ""])


def nodes_2411(points: Array) -> str:
    lines = []
    for number, x in enumerate(points.tolist(), start=1):
        lines += ["".join(f"{n:10d}" for n in (number, 1, 1, 11)), "".join(f"{v:25.16E}" for v in x)]
    return dataset(2411, lines)


def triangles_2412(triangles: Array, properties: Array) -> str:
    """Triangles (t, 3) of nodes from 0, with a number of property each."""
    lines = []
    for number, (nodes, of) in enumerate(zip((triangles + 1).tolist(), properties.tolist(), strict=True), start=1):
        lines.append("".join(f"{n:10d}" for n in (number, TRIANGLE, of, 1, 7, 3)))
        lines.append("".join(f"{n:10d}" for n in nodes))
    return dataset(2412, lines)


def header_151(title: str) -> str:
    """Who wrote the file."""
    return dataset(151, [title[:80], SIGNATURE, "warpffrf", "", "", "warpffrf", ""])


def units_164() -> str:
    """SI units."""
    factors = "".join(f"{v:25.17E}" for v in (1.0, 1.0, 1.0))
    return dataset(164, [f"{1:10d}{'SI: m, N, s':20}{2:10d}", factors, f"{273.15:25.17E}"])


def shape_55(mode: int, frequency: float, damping: float, eigenvalue: complex, shape: Array, title: str) -> str:
    """A mode: displacements (n, 3) of nodes 1 to n. A real `shape` is a normal mode of modal mass 1, a complex one a
    complex mode with its eigenvalue [1/s]."""
    complex_ = np.iscomplexobj(shape)
    head = (1, 3 if complex_ else 2, 2, 8, 5 if complex_ else 2, 3)
    numbers = (2, 6 if complex_ else 4, 1, mode)
    facts = (eigenvalue.real, eigenvalue.imag, 0.0, 0.0, 0.0, 0.0) if complex_ else (frequency, 1.0, damping, 0.0)
    return _data_55(head, numbers, facts, shape, title)


def spectrum_55(step: int, frequency: float, velocity: Array, title: str) -> str:
    """Complex velocities (n, 3) [m/s] of nodes 1 to n, amplitudes of e^(i omega t) at a frequency [Hz]."""
    return _data_55((1, 5, 2, 11, 5, 3), (2, 1, 1, step), (frequency,), np.asarray(velocity, dtype=complex), title)


def _data_55(head: Sequence[int], numbers: Sequence[int], facts: Sequence[float], shape: Array, title: str) -> str:
    complex_ = np.iscomplexobj(shape)
    lines = [SIGNATURE, title[:80] or "NONE", "NONE", "NONE", "NONE"]
    lines += ["".join(f"{n:10d}" for n in row) for row in (head, numbers)]
    lines.append("".join(f"{x:13.5E}" for x in facts))
    values = np.stack([np.real(shape), np.imag(shape)], axis=2).reshape(len(shape), 6) if complex_ else shape
    for node, row in enumerate(values.tolist(), start=1):
        lines += [f"{node:10d}", "".join(f"{x:13.5E}" for x in row)]
    return dataset(55, lines)


def function_58(f: Array, values: Array, rate: int, at: Direction, by: Direction, titles: Sequence[str]) -> str:
    """A frequency response `values` (f,) complex at frequencies `f` [Hz]: displacement (`rate` 0), velocity or
    acceleration per force."""
    steps = np.diff(f)
    step = float(steps.mean()) if len(steps) else 1.0
    even = len(f) > 1 and step > 0.0 and bool(np.all(np.abs(steps - step) < STEADY * step))
    response, force = (f"{place.name[:10]:10}" for place in (at, by))
    lines = [SIGNATURE, *(text[:80] for text in titles), "NONE"]
    lines.append(f"{4:5d}{1:10d}{1:5d}{1:10d} {response}{at.node:10d}{at.code:4d} {force}{by.node:10d}{by.code:4d}")
    lines.append(f"{6:10d}{len(f):10d}{int(even):10d}{f[0]:13.5E}{step if even else 0.0:13.5E}{0.0:13.5E}")
    kind, unit = ((8, "m"), (11, "m/s"), (12, "m/s2"))[rate]
    for number, name, of in (
        (18, "Frequency", "Hz"),
        (kind, "Response", unit),
        (13, "Force", "N"),
        (0, "NONE", "NONE"),
    ):
        lines.append(f"{number:10d}{0:5d}{0:5d}{0:5d} {name:20} {of:20}")
    pairs = [f"{v.real:20.12E}{v.imag:20.12E}" for v in values.tolist()]
    if even:
        lines += ["".join(pairs[i : i + 2]) for i in range(0, len(pairs), 2)]
    else:
        lines += [f"{x:13.5E}{pair}" for x, pair in zip(f.tolist(), pairs, strict=True)]
    return dataset(58, lines)
