"""Launches that bind arrays by name.

    blocks(motion.predict_bodies, v_rate="v_rate0")

launches the kernel with the array of each parameter's own name, but for those that are renamed here; a number is passed
as it is. Names, types and axes are held against the declarations (`online.arrays`) where the launch stands, at import:
a kernel whose argument no array declares is refused there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import warp as wp

from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.ring import Ring
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.arrays.state import State
from warpffrf_kernels.core.access import is_changed, is_read, is_written
from warpffrf_kernels.core.declaration import Declaration
from warpffrf_kernels.core.scalars import BLOCK

CONSTANTS = ("models", "patterns")  # of the scene, in structs


class All(State, Ring, Scratch):
    """Every array that a launch may name; raises TypeError at import where two have the same name."""


DECLARED: dict[str, Declaration] = All.declarations


class Launch:
    """A kernel with the arrays it works on, in the places `over`, where the scene has `when`; `block`: a block of lanes
    a place, not a thread. `read` and `written`: names of arrays, `changed`: those of
    both that another launch has to have set."""

    def __init__(self, kernel: Any, over: tuple[str, ...], when: str, block: bool, given: Mapping[str, str | int]):
        self.kernel, self.over, self.when, self.block = kernel, over, when, block
        self.label = f"{kernel.module.name.rsplit('.', 1)[-1]}.{kernel.key}"
        parameters = {argument.label: argument.type for argument in kernel.adj.args}
        unknown = sorted(set(given) - set(parameters))
        if unknown:
            raise TypeError(f"launch of {self.label}: it has no parameter {', '.join(unknown)}")
        for name in (*over, *([when] if when else [])):
            if name not in NAMES:
                raise TypeError(f"launch of {self.label}: {name!r} is no axis; see online.arrays.axes.NAMES")
        self.bound: list[str | int] = [given.get(label, label) for label in parameters]
        self.read: set[str] = set()
        self.written: set[str] = set()
        self.changed: set[str] = set()  # of what is read and written, that which another launch has set
        for (label, annotation), name in zip(parameters.items(), self.bound, strict=True):
            if isinstance(name, int) or name in CONSTANTS:
                continue
            self._check(label, annotation, name)
            if is_read(annotation):
                self.read.add(name)
            if is_changed(annotation):
                self.changed.add(name)
            if is_written(annotation):
                self.written.add(name)

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
        if annotation.ndim not in (known.ndim, 1):
            raise TypeError(
                f"launch of {self.label}: parameter {label} has {annotation.ndim} axes, {name} is declared with "
                f"{known.ndim}"
            )

    def arguments(self, arrays: Mapping[str, Any]) -> list[Any]:
        """What the kernel is given, in its order; an array of several axes is flat where the kernel takes one."""
        found = []
        for name, parameter in zip(self.bound, self.kernel.adj.args, strict=True):
            array: Any = name if isinstance(name, int) else arrays[name]
            flat = not isinstance(name, int) and array.ndim > 1 and parameter.type.ndim == 1
            found.append(array.flatten() if flat else array)
        return found

    def present(self, sizes: Mapping[str, int]) -> bool:
        """Whether the scene has what it is for."""
        return not self.when or sizes[self.when] > 0

    def go(self, arrays: Mapping[str, Any], sizes: Mapping[str, int], device: str) -> None:
        """Launch it."""
        dim = tuple(sizes[axis] for axis in self.over)
        if self.block:
            wp.launch_tiled(self.kernel, dim=dim, inputs=self.arguments(arrays), block_dim=BLOCK, device=device)
        else:
            wp.launch(self.kernel, dim=dim, inputs=self.arguments(arrays), block_dim=BLOCK, device=device)


def blocks(kernel: Any, *over: str, when: str = "", **given: str | int) -> Launch:
    """One block of lanes for each world, and each place along the axes `over` beside."""
    return Launch(kernel, ("world", *over), when, True, given)


def threads(kernel: Any, *over: str, when: str = "", **given: str | int) -> Launch:
    """One thread for each world, and each place along the axes `over` beside."""
    return Launch(kernel, ("world", *over), when, False, given)


def once(kernel: Any, when: str = "", **given: str | int) -> Launch:
    """One thread for all worlds."""
    return Launch(kernel, ("one",), when, False, given)
