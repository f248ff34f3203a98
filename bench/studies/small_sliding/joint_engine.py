"""Small-sliding contacts of the engine in the study of joint bases: the same joint, its cells as `Matched` makes them.

The engine has the two sheets as one body that is connected at its clamped root, where both are held, and solves joint
interfaces with their body in Newton's method; the study has the flexibility of the same cells alone. Its loads are a
thousandth, as its bolts keep their direction while sheets rotate (`bolts`); everything is in proportion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.small_sliding.quasi_static import Followed
from studies.small_sliding import joint_spaces
from studies.small_sliding.joint_spaces import Entry, Joint, Space, beside, load_path, measure, of_cells
from studies.small_sliding.stacks import Engine, Sheets, cell_of

Array = np.ndarray
SCALE = 1e-3  # of the loads
GROWTHS = (2.0, 1.0, 0.5)  # of graded cells
MODES = 4  # vibration modes, with which joint interfaces are exact as with any number


@dataclass(frozen=True)
class Both:
    """The same cells in the study and in the engine, under one load."""

    load: str
    study: Entry | None
    engine: Entry


def sheets(counts: tuple[int, int, int]) -> Sheets:
    """The joint's sheets."""
    return Sheets(counts, half_width=joint_spaces.HALF_WIDTH, layer=joint_spaces.LAYER)


def ways(stacked: Sheets) -> dict[str, dict[str, Any]]:
    """Arguments of `Matched` by name; graded cells are fine where those of the study are."""
    facet = joint_spaces.SIZE[0] / stacked.counts[0]
    fine = (*(low for low, _ in stacked.bolted), "sheet0_x_min", "sheet0_x_max")
    found: dict[str, dict[str, Any]] = {"all cells": {}}
    found |= {f"cells of {n} facets": {"size": n * facet} for n in reversed(joint_spaces.GROUPS)}
    return found | {f"graded, growth {g:g}": {"growth": g, "fine": fine} for g in GROWTHS}


def followed(engine: Engine, area: Array) -> Followed:
    """The engine's history of cells of `area` (c,) [m2], loads and all in proportion to those of the study."""
    (lap,) = engine.history.small_sliding.values()
    force = np.concatenate([lap.pressure[:, :, None], -lap.traction], axis=2) * area[:, None] / SCALE
    nothing = np.zeros(len(force))
    return Followed(
        area, force, nothing[:, None] * area, -lap.slip / SCALE, lap.state,
        np.diff(engine.lost, prepend=0.0) / SCALE**2, engine.tip[:, None] / SCALE, nothing, 0,
    )  # fmt: skip


def compared(joint: Joint, stacked: Sheets, references: dict[str, tuple[float, Followed]]) -> list[Both]:
    """All ways under all loads: tip force [N] and history of the full model by name."""
    found = []
    for name, given in ways(stacked).items():
        body = stacked.reduced(MODES, by="facets", **given)
        space: Space = of_cells(joint, cell_of(body, joint.cells), name)
        for load, (tip, reference) in references.items():
            path = load_path(tip)
            history = stacked.followed([body], SCALE * path * [joint_spaces.PRELOAD, 1.0])
            counters = history.history.counters
            milliseconds = float(counters["loop_seconds"]) / int(counters["steps"]) * 1e3
            mine = beside(space, followed(history, space.cells.area), reference, milliseconds)
            found.append(Both(load, measure(space, path, reference), mine))
    return found
