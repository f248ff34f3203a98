"""One declaration an array: axes, type, unit and what it holds.

    class State(Arrays):
        pressure: DeviceArray = reals("world", "pair", "hat", unit="Pa", note="at the nodes")

An axis is a name of `axes.Sizes`, with a factor and a few entries more where that is needed: "6*body", "slot+1"; or a
number. A `run` is read and written along contiguous stretches by index: its axes are one.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.online.settings import LARGEST_INDEX

Axis = str | int
FORM = re.compile(r"(?:(\d+)\*)?([a-z_]+)(?:\+(\d+))?")


class DeviceArray(Protocol):
    """What the host uses of a Warp array."""

    shape: tuple[int, ...]
    ndim: int

    def numpy(self) -> np.ndarray: ...
    def assign(self, src: Any) -> Any: ...
    def fill_(self, value: Any) -> None: ...
    def zero_(self) -> None: ...
    def flatten(self) -> DeviceArray: ...


@dataclass(frozen=True)
class Declaration:
    """An array before it has a size."""

    axes: tuple[Axis, ...]
    dtype: Any
    unit: str
    note: str
    run: bool
    carried: bool = False  # what stands there from before the attempt is used
    zero_without: bool = False  # zero says what is to be said in a scene where no launch sets it
    instead: str = ""  # array that takes its place in a scene without its axes

    @property
    def ndim(self) -> int:
        return 1 if self.run else len(self.axes)

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Length of each axis; raises KeyError for an axis that has no size."""
        return tuple(length(axis, sizes) for axis in self.axes)

    def allocate(self, sizes: Mapping[str, int], device: str) -> DeviceArray:
        """Zero array; an axis without entries gets one that nobody uses, so that kernels can be given it.

        Raises InputError for more entries than the indices of kernels reach.
        """
        shape = tuple(max(n, 1) for n in self.shape(sizes))
        size = int(np.prod(shape, dtype=np.int64))
        if size > LARGEST_INDEX:
            raise InputError(
                f"scene: an array of {size} numbers is needed, at most {LARGEST_INDEX} can be indexed; run fewer "
                "worlds at a time, or lower the capacity of the contacts"
            )
        return wp.zeros((size,) if self.run else shape, dtype=self.dtype, device=device)


def length(axis: Axis, sizes: Mapping[str, int]) -> int:
    """Entries along `axis`, none where its name has none; raises KeyError for a name without a size."""
    if isinstance(axis, int):
        return axis
    factor, name, more = parts(axis)
    return factor * sizes[name] + more if sizes[name] else 0


def parts(axis: str) -> tuple[int, str, int]:
    """Factor, name and entries more of an axis."""
    found = FORM.fullmatch(axis)
    if found is None:
        raise ValueError(f"{axis!r} is no axis: a name, with a factor and a number more at most, like '2*hat+1'")
    factor, name, more = found.groups()
    return int(factor or 1), name, int(more or 0)


def reals(*axes: Axis, unit: str = "", note: str = "", run: bool = False, **more: Any) -> Any:
    """Declare an array of reals; `more`: the other fields of `Declaration`."""
    return Declaration(axes, wp.float64, unit, note, run, **more)


def integers(*axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of integers."""
    return Declaration(axes, wp.int32, "", note, False, **more)


def vectors(*axes: Axis, unit: str = "", note: str = "", **more: Any) -> Any:
    """Declare an array of vectors of three."""
    return Declaration(axes, wp.vec3d, unit, note, False, **more)


def matrices(*axes: Axis, unit: str = "", note: str = "", **more: Any) -> Any:
    """Declare an array of matrices of three by three."""
    return Declaration(axes, wp.mat33d, unit, note, False, **more)


def quaternions(*axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of unit quaternions."""
    return Declaration(axes, wp.quatd, "", note, False, **more)


def structs(of: Any, *axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of a Warp struct."""
    return Declaration(axes, of, "", note, False, **more)


class Arrays:
    """Arrays as attributes, declared in the classes that derive from this one; `carried=True`: all of the class are."""

    declarations: ClassVar[dict[str, Declaration]] = {}

    def __init_subclass__(cls, carried: bool = False) -> None:
        own = {name: value for name, value in vars(cls).items() if isinstance(value, Declaration)}
        if carried:
            own = {name: replace(value, carried=True) for name, value in own.items()}
        found: dict[str, Declaration] = {}
        for part in [getattr(base, "declarations", {}) for base in cls.__bases__] + [own]:
            twice = sorted(set(found) & set(part))
            if twice:
                raise TypeError(f"{cls.__name__}: {', '.join(twice)} declared twice; choose another name")
            found |= part
        for name in own:
            delattr(cls, name)  # there is one on instances only
        cls.declarations = found

    def __init__(self, sizes: Mapping[str, int], device: str, beside: Arrays | None = None) -> None:
        """All arrays, zero. `beside`: where an array may be found that takes the place of another."""
        for name, declaration in self.declarations.items():
            missing = declaration.instead and 0 in declaration.shape(sizes)
            if not missing:
                setattr(self, name, declaration.allocate(sizes, device))
        for name, declaration in self.declarations.items():
            if name not in vars(self):
                owner = self if declaration.instead in vars(self) else beside
                setattr(self, name, getattr(owner, declaration.instead))

    def to_numpy(self) -> dict[str, np.ndarray]:
        """Copies of all arrays by name."""
        return {name: getattr(self, name).numpy().copy() for name in self.declarations}

    def assign(self, values: Mapping[str, np.ndarray]) -> None:
        """Overwrite all arrays with the copies of `to_numpy`."""
        for name in self.declarations:
            getattr(self, name).assign(values[name])
