"""Bearings of flexible and rigid elements compared with those of flexible ones alone; several minutes."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

import warpffrf as wf
from studies.bodies.flexible_bearings import NAME, Made, p8, p9, p10
from warpffrf.study.markdown import table

CHOICES = {  # name -> options of the contacts, which take the load where they choose by it
    "all": {},
    "auto": {"distributed": "auto"},
    "one": {"distributed": (1,)},
}
CASES: dict[str, tuple[Callable[..., Made], tuple[float, float, float]]] = {
    "P8, balls": (partial(p8, True), (0.0, 0.0, -8900.0)),
    "P9, balls": (partial(p9, True), (0.0, 17800.0, 0.0)),
    "P10, rollers": (partial(p10, rollers=True, ring=False), (0.0, 0.0, -4450.0)),
    "P10, rollers and outer ring": (partial(p10, rollers=True, ring=True), (0.0, 0.0, -4450.0)),
}
SIDES = "inner", "outer"


def at_rest(case: str, choice: str, *, coarse: bool) -> tuple[wf.bearings.Bearing, wf.Result, float]:
    """The equilibrium and its time [s of one core]. Raises RuntimeError where there is none."""
    made, load = CASES[case]
    options = CHOICES[choice]
    given = options | {"load": load} if options.get("distributed") == "auto" else options
    scene, bearing = made(contact=wf.bearings.RollingContact(**given), coarse=coarse)
    began = time.process_time()
    result = wf.equilibrium(scene, progress=False)
    took = time.process_time() - began
    if result.status != "completed":
        raise RuntimeError(f"{case}, {choice}: {result.message}")
    return bearing, result, took


def rows_of(case: str, *, coarse: bool) -> list[list[str]]:
    """Of the table: one of each choice."""
    rows: list[list[str]] = []
    reference = at_rest(case, "all", coarse=coarse)
    whole = reference[1].bearing(NAME)
    loads, largest = whole.outer_load[-1], whole.outer_load[-1].max()
    for choice in CHOICES:
        bearing, result, took = reference if choice == "all" else at_rest(case, choice, coarse=coarse)
        found = result.bearing(NAME)
        flexible = np.array(bearing.distributed or range(1, len(loads) + 1)) - 1
        off = np.abs(found.outer_load[-1] - loads).max() / largest
        peaks, others = np.zeros(2), np.zeros(2)
        for k, side in enumerate(SIDES):
            p, q = found.peak_pressure[side][-1], whole.peak_pressure[side][-1]
            change = np.abs(p - q) / q.max()
            peaks[k] = change[flexible].max()
            others[k] = np.delete(change, flexible).max(initial=0.0)
        moved = (found.displacement[-1] - whole.displacement[-1])[[0, 2]]
        numbers = ", ".join(str(i + 1) for i in flexible) if len(flexible) < len(loads) else "all"
        rows.append([
            case, "coarse" if coarse else "usual", choice, numbers, f"{found.outer_load[-1].max():,.0f}",
            f"{100 * off:.2f}", f"{100 * peaks.max():.2f}", f"{100 * others[0]:.1f}, {100 * others[1]:.1f}",
            f"{1e6 * np.abs(moved).max():.3f}", f"{took:.1f}",
        ])  # fmt: skip
        print(", ".join(rows[-1]), flush=True)
    return rows


HEAD = ["bearing", "mesh", "flexible", "numbers", "largest load [N]", "loads off [%]", "peaks off [%]",
        "of rigid ones inside, outside [%]", "deflection off [um]", "s"]  # fmt: skip


def compute(*cases: str) -> list[list[str]]:
    """Rows of the named cases, or of all. Raises `InputError` for a case that does not exist."""
    for name in cases:
        if name not in CASES:
            raise wf.InputError(f"there is no case {name!r}; choose from {', '.join(CASES)}")
    wf.equilibrium(p8(False)[0], progress=False)  # loads the kernels
    meshes = (True, False)
    return [row for name in cases or CASES for coarse in meshes for row in rows_of(name, coarse=coarse)]


def page(rows: list[list[str]]) -> str:
    """The study."""
    return f"""# Bearings of flexible and rigid elements

Bearings of the study of [flexible bearings](flexible_bearings.md) with some elements flexible, in distributed
contact, and the others rigid, in lumped contact of the same stiffness: those that `RollingContact(distributed="auto",
load=...)` chooses, and element 1 alone. Errors are differences from the bearing whose elements are all flexible:
loads of all elements over the largest one; peak pressures of the flexible elements, and Hertz's that `peak_pressure`
has of rigid ones, over the largest one. Seconds are those of one core for the equilibrium. Under thrust all loads are
alike, and "auto" chooses all. Hertz's pressures on a flexible ring that is wider than the rollers do not contain the
peaks at their ends.

{table(HEAD, rows)}"""
