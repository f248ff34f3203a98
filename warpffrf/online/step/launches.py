"""Launches that bind arrays by name.

    blocks(motion.predict_bodies, v_rate="v_rate0")

launches the kernel with the topics that it takes (structs of arrays, `warpffrf_kernels.core.declaration.topic`). Each
other parameter receives the array of the same name, unless it is renamed here; a number is passed as it is. Names,
types and axes are checked against the declarations (`online.arrays`) when the launch is defined, at import: a kernel
with an argument that no array declares is rejected there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import warp as wp

from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.declaration import as_taken, topic_of
from warpffrf.online.arrays.ring import Ring
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.arrays.state import State
from warpffrf_kernels.core.declaration import Declaration
from warpffrf_kernels.core.scalars import BLOCK

CONSTANTS = ("models", "patterns")  # of the scene, in structs


class All(State, Ring, Scratch):
    """Every array that a launch may name; raises TypeError at import if two have the same name."""


DECLARED: dict[str, Declaration] = All.declarations


class Launch:
    """A kernel with its topics and arrays, launched over the axes `over` if the scene has `when`; `block`: one block of
    lanes per entry instead of one thread."""

    def __init__(self, kernel: Any, over: tuple[str, ...], when: str, block: bool, given: Mapping[str, str | int]):
        self.kernel, self.over, self.when, self.block = kernel, over, when, block
        self.label = f"{kernel.module.name.rsplit('.', 1)[-1]}.{kernel.key}"
        parameters = {argument.label: argument.type for argument in kernel.adj.args}
        unknown = sorted(set(given) - {label for label, kind in parameters.items() if topic_of(kind) is None})
        if unknown:
            raise TypeError(f"launch of {self.label}: it takes no array {', '.join(unknown)}")
        for name in (*over, *([when] if when else [])):
            if name not in NAMES:
                raise TypeError(f"launch of {self.label}: {name!r} is no axis; see online.arrays.axes.NAMES")
        self.bound: list[Any] = [
            topic_of(annotation) or given.get(label, label) for label, annotation in parameters.items()
        ]
        for (label, annotation), name in zip(parameters.items(), self.bound, strict=True):
            if isinstance(name, str) and name not in CONSTANTS:
                self._check(label, annotation, name)

    def _check(self, label: str, annotation: Any, name: str) -> None:
        """Raises TypeError unless array `name` fits the parameter."""
        known = DECLARED.get(name)
        if known is None:
            raise TypeError(
                f"launch of {self.label}: no array is called {name!r}; declare it in online.arrays, or rename the "
                f"parameter in the launch: {label}='...'"
            )
        if annotation.dtype != known.dtype:
            raise TypeError(f"launch of {self.label}: {name} does not have the type of parameter {label}")
        axes = 1 if known.run else len(known.axes)
        if annotation.ndim not in (axes, 1):
            raise TypeError(
                f"launch of {self.label}: parameter {label} has {annotation.ndim} axes, {name} is declared with {axes}"
            )

    def arguments(self, arrays: Mapping[Any, Any]) -> list[Any]:
        """Arguments of the kernel in its order; an array of several axes is flattened if the kernel takes one axis."""
        found = []
        for name, parameter in zip(self.bound, self.kernel.adj.args, strict=True):
            found.append(name if isinstance(name, int) else as_taken(arrays[name], parameter.type))
        return found

    def present(self, sizes: Mapping[str, int]) -> bool:
        """Whether the scene has the parts that the launch is for."""
        return not self.when or sizes[self.when] > 0

    def go(self, arrays: Mapping[Any, Any], sizes: Mapping[str, int], device: str) -> None:
        """Launch it."""
        dim = tuple(sizes[axis] for axis in self.over)
        if self.block:
            wp.launch_tiled(self.kernel, dim=dim, inputs=self.arguments(arrays), block_dim=BLOCK, device=device)
        else:
            wp.launch(self.kernel, dim=dim, inputs=self.arguments(arrays), block_dim=BLOCK, device=device)


def blocks(kernel: Any, *over: str, when: str = "", **given: str | int) -> Launch:
    """One block of lanes for each world and each entry along the axes `over`."""
    return Launch(kernel, ("world", *over), when, True, given)


def threads(kernel: Any, *over: str, when: str = "", **given: str | int) -> Launch:
    """One thread for each world and each entry along the axes `over`."""
    return Launch(kernel, ("world", *over), when, False, given)


def once(kernel: Any, when: str = "", **given: str | int) -> Launch:
    """One block of lanes for all worlds."""
    return Launch(kernel, ("one",), when, True, given)
