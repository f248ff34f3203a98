"""Mode shapes of universal files, dataset 55, as programs of modal analysis and finite elements write them.

Normal modes (analysis type 2) have a frequency and ratios of viscous and hysteretic damping, complex modes (3 and 7)
an eigenvalue lambda: frequency |lambda|/2 pi, damping ratio -Re lambda/|lambda|. A hysteretic ratio eta is taken as
zeta = eta/2, which dissipates the same at resonance. Displacements, velocities and accelerations of a mode are the same
shape. They are given in the displacement system of their node (15, 2411), which 18 or 2420 defines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.raw_mesh import listed_counts, places, require_once
from warpffrf.model.mesh.files.unv import NOT_CARTESIAN, UniversalFile, check_units, placed

Array = np.ndarray
KIND = "file of modes"
NORMAL, COMPLEX_MODES = 2, (3, 7)  # analysis types
TRANSLATIONS = (2, 3)  # data characteristics: three translations; with three rotations
REAL, COMPLEX = 2, 5  # data types
TAKEN = {0: "unknown", 1: "general", 8: "displacement", 11: "velocity", 12: "acceleration"}
HIGHEST = 1e9  # Hz
MOST_NUMBERED, MOST_LISTED = 1000, 8  # modes whose numbers are checked; numbers in a note
GLOBAL = 1  # the system that programs write without defining it


@dataclass(frozen=True, eq=False)
class ShapesRead:
    """`points` (n, 3) [file's unit] with their `numbers` (n,); `frequencies` (t,) [Hz], `damping` (t,) ratios and
    `shapes` (t, n, 3), real or complex; `notes` on what is not used."""

    numbers: Array
    points: Array
    frequencies: Array
    damping: Array
    shapes: Array
    notes: tuple[str, ...]


class _File(UniversalFile):
    def __init__(self, path: Path) -> None:
        self.modes: list[tuple[int, float, float, Array, Array]] = []  # line, frequency, damping, nodes, shape
        self.mode_numbers: list[int] = []
        super().__init__(path, KIND)

    def others(self) -> dict[int, Callable[[int, int], None]]:
        return {55: self._data}

    def _data(self, first: int, last: int) -> None:
        """Five lines of text, two of integers, one of numbers, then for each node its number and values."""
        if last < first + 8:
            raise self.lines.fault(first, "dataset 55 is cut off; export the file again")
        (_, analysis, characteristic, specific, type_, count), _ = (
            a[0] for a in self.lines.table(np.array([first + 5]), [10] * 6)
        )
        modes = analysis == NORMAL or analysis in COMPLEX_MODES
        if not modes or characteristic not in TRANSLATIONS or specific not in TAKEN or type_ not in (REAL, COMPLEX):
            self.ignored["55 that is no mode shape of translations"] += 1
            return
        if count != 3 * (characteristic - 1):
            raise self.lines.fault(
                first + 5, f"dataset 55: {count} values per node are not {3 * (characteristic - 1)}; export it again"
            )
        whole, _ = self.lines.table(np.array([first + 6]), [10] * 8)
        needed = 4 if analysis == NORMAL else 6
        if whole[0, 1] < needed:
            raise self.lines.fault(first + 6, f"dataset 55: a mode has {needed} numbers; export the file again")
        _, (facts,) = self.lines.table(np.array([first + 7]), [], [13] * 6, needed=needed)
        frequency, damping = self._rates(first + 7, analysis, facts)
        width = int(count) * (2 if type_ == COMPLEX else 1)
        lines = 1 + -(-width // 6)
        if (last - first - 8) % lines or last == first + 8:
            raise self.lines.fault(last - 1, f"dataset 55: a node has {lines} lines; export the file again")
        begin = np.arange(first + 8, last, lines)
        nodes = self.lines.table(begin, [10])[0][:, 0]
        rows = [
            self.lines.table(begin + i, [], [13] * min(6, width - 6 * (i - 1)), needed=min(6, width - 6 * (i - 1)))[1]
            for i in range(1, lines)
        ]
        values = np.concatenate(rows, axis=1)
        shape = values[:, 0:6:2] + 1j * values[:, 1:6:2] if type_ == COMPLEX else values[:, :3]
        require_once(nodes, f"{self.lines.label}, line {first + 9}: node of a mode")
        self.modes.append((first, frequency, damping, nodes, shape))
        self.mode_numbers.append(int(whole[0, 3]))

    def _rates(self, line: int, analysis: int, facts: Array) -> tuple[float, float]:
        """Frequency [Hz] and damping ratio."""
        if analysis == NORMAL:
            frequency, damping = float(facts[0]), float(facts[2] if facts[2] else 0.5 * facts[3])
        else:
            size = float(np.hypot(facts[0], facts[1]))
            frequency, damping = size / (2.0 * np.pi), -float(facts[0]) / size if size > 0.0 else 0.0
        if not 0.0 <= frequency < HIGHEST or not abs(damping) <= 1.0:
            raise self.lines.fault(
                line, f"a mode of {frequency:g} Hz with the damping ratio {damping:g} is none; export the file again"
            )
        return frequency, damping


def read_modes(path: Path) -> ShapesRead:
    """Nodes and mode shapes of a universal file; modes in the order of the file. Raises `InputError`, with the line,
    for damaged datasets, and for nodes of shapes without a place."""
    file = _File(path)
    label = file.lines.label
    if not file.numbers or not file.modes:
        missing = "nodes (dataset 15 or 2411)" if not file.numbers else "mode shapes (dataset 55)"
        raise InputError(f"{label}: there are no {missing}; export geometry and modes into one file")
    numbers = np.concatenate(file.numbers)
    require_once(numbers, f"{label}: node")
    points = placed(file, np.concatenate(file.points), np.concatenate(file.systems))
    nodes = np.sort(file.modes[0][3])
    at = places(numbers, nodes)
    if np.any(at < 0):
        raise InputError(f"{label}: node {nodes[np.argmin(at)]} of the modes has no place in dataset 15 or 2411")
    axes = np.tile(np.eye(3), (len(nodes), 1, 1))
    systems = np.concatenate(file.displaced)[at]
    for number in np.unique(systems).tolist():
        if number in file.axes:
            axes[systems == number] = file.axes[number][:3]
        elif number > GLOBAL or NOT_CARTESIAN in file.ignored:
            raise InputError(
                f"{label}: displacements are given in the coordinate system {number}, which no dataset 18 or 2420 "
                "defines as Cartesian; export them in the global system"
            )
    shapes = []
    for line, _, _, own, shape in file.modes:
        order = np.argsort(own)
        if not np.array_equal(own[order], nodes):
            raise file.lines.fault(line, "this mode has other nodes than the first one; export all modes together")
        shapes.append(np.einsum("ni,nij->nj", shape[order], axes))
    notes: list[str] = []
    check_units(file, notes)
    if file.ignored:
        notes.append(f"datasets and elements that are not used: {listed_counts(file.ignored)}")
    given = set(file.mode_numbers)
    if len(given) == len(file.modes):  # programs that number every mode 1 tell nothing
        absent = sorted(set(range(1, min(max(given), MOST_NUMBERED) + 1)) - given)
        if absent:
            notes.append(f"modes are numbered up to {max(given)}, without {_listed(absent)}: they are not in the file")
    unmoved = len(numbers) - len(nodes)
    if unmoved:
        notes.append(f"{unmoved} of {len(numbers)} nodes have no motion in the modes; they are not used")
    frequencies, damping = (np.array([mode[i] for mode in file.modes]) for i in (1, 2))
    return ShapesRead(nodes, points[at], frequencies, damping, np.array(shapes), tuple(notes))


def _listed(numbers: list[int]) -> str:
    """The first of them."""
    rest = len(numbers) - MOST_LISTED
    return ", ".join(map(str, numbers[:MOST_LISTED])) + (f" and {rest} more" if rest > 0 else "")
