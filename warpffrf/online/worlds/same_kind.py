"""Whether scenes fit into one graph: they may differ in numbers, not in what there is.

One graph launches the same kernels over the same axes in every world, so whatever has an axis has to be there as often
in all scenes. The order in which the outer matrix is eliminated is one for all, so joints, contacts and films are to be
between the same bodies. Hats in play have room in slots, as many in all worlds; this room grows up to what the contacts
allow, which is to be as much in all scenes, so that no world gets more than it would alone. All else is read from the
tables of each world's own scene.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.axes import NAMES, Sizes, sizes_of
from warpffrf.online.compile.outer_pattern import couplings, pattern_of
from warpffrf.online.compile.scene import CompiledScene

PLACES = ("modes with inertia", "joints and forces", "flexible interfaces", "contacts", "films and laps")  # `couplings`
KINDS = {
    "body": "bodies", "joint": "joints", "drive": "drives", "force": "forces", "contact": "contacts",
    "lumped contact": "lumped_contacts", "film": "films", "lap": "laps",
}  # fmt: skip
CURE = "worlds of one graph differ in numbers only; run this scene by itself"


def refuse_other_kinds(scenes: Sequence[CompiledScene]) -> None:
    """Raises `InputError` for the first of `scenes` that is not of the kind of scene 0."""
    first, pattern = couplings(scenes[0]), pattern_of(scenes[0])
    sizes = [sizes_of(compiled, 1, 1, pattern, projected=False, adaptive=False) for compiled in scenes]
    for i, (compiled, own) in enumerate(zip(scenes, sizes, strict=True)):
        difference = (
            _counts(compiled.scene, scenes[0].scene, i) or _axes(own, sizes[0], i) or _room(compiled, scenes[0], i)
        )
        if not difference:
            unlike = [not np.array_equal(a, b) for a, b in zip(couplings(compiled), first, strict=True)]
            if any(unlike):
                difference = f"the {PLACES[unlike.index(True)]} of scene {i} are on other bodies than those of scene 0"
        if difference:
            raise InputError(f"{difference}; {CURE}")


def _counts(scene: Scene, first: Scene, i: int) -> str:
    for one, name in KINDS.items():
        here, there = len(getattr(scene, name)), len(getattr(first, name))
        if here != there:
            return f"scene {i} has {here} {one if here == 1 else _several(one)}, scene 0 has {there}"
    return ""


def _several(one: str) -> str:
    return f"{one[:-1]}ies" if one.endswith("y") else f"{one}s"


def _room(own: CompiledScene, first: CompiledScene, i: int) -> str:
    here, there = own.model.capacity.slot_limit, first.model.capacity.slot_limit
    return "" if here == there else f"the contacts of scene {i} allow {here} hats in play, those of scene 0 {there}"


def _axes(own: Sizes, first: Sizes, i: int) -> str:
    for axis, count in own.items():
        if count != first[axis]:
            return f"scene {i} has {count} along '{axis}' ({NAMES[axis]}), scene 0 has {first[axis]}"
    return ""
