"""One declaration an array: axes, type, unit and what it holds.

    @topic
    class Bodies:
        mass: DeviceArray = reals("body", unit="kg")

An axis is a name, with a factor and a few entries more where that is needed: "6*body", "slot+1"; or a number. A `run`
is read and written along contiguous stretches by index: its axes are one.
"""

import inspect
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import warp as wp

from warpffrf_kernels.core.scalars import mat33, quat, real, vec3

Axis = str | int
FORM = re.compile(r"(?:(\d+)\*)?([a-z_]+)(?:\+(\d+))?")
Kind = TypeVar("Kind")


class DeviceArray(Protocol):
    """What the host uses of a Warp array."""

    shape: tuple[int, ...]
    ndim: int

    def numpy(self) -> Any: ...  # numpy.ndarray
    def assign(self, src: Any) -> Any: ...
    def fill_(self, value: Any) -> None: ...
    def zero_(self) -> None: ...
    def flatten(self) -> "DeviceArray": ...


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
    restored: bool = False  # a rejected attempt puts back what stood there before it
    instead: str = ""  # array that takes its place in a scene without its axes

    @property
    def ndim(self) -> int:
        return 1 if self.run else len(self.axes)

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Length of each axis; raises KeyError for an axis that has no size."""
        return tuple(length(axis, sizes) for axis in self.axes)


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
    return Declaration(axes, real, unit, note, run, **more)


def integers(*axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of integers."""
    return Declaration(axes, wp.int32, "", note, False, **more)


def vectors(*axes: Axis, unit: str = "", note: str = "", **more: Any) -> Any:
    """Declare an array of vectors of three."""
    return Declaration(axes, vec3, unit, note, False, **more)


def matrices(*axes: Axis, unit: str = "", note: str = "", **more: Any) -> Any:
    """Declare an array of matrices of three by three."""
    return Declaration(axes, mat33, unit, note, False, **more)


def quaternions(*axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of unit quaternions."""
    return Declaration(axes, quat, "", note, False, **more)


def structs(of: Any, *axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of a Warp struct."""
    return Declaration(axes, of, "", note, False, **more)


def topic(cls: type[Kind]) -> type[Kind]:
    """A Warp struct of a class whose fields are numbers, other structs, and declared arrays; it keeps the latter as
    `declarations`."""
    declared = {name: value for name, value in vars(cls).items() if isinstance(value, Declaration)}
    fields: dict[str, Any] = {
        name: wp.array(dtype=declared[name].dtype, ndim=declared[name].ndim) if name in declared else annotation
        for name, annotation in inspect.get_annotations(cls).items()
    }
    for name in declared:
        delattr(cls, name)
    cls.__annotations__ = fields
    setattr(cls, "declarations", declared)  # noqa: B010, no field
    found: Any = wp.struct(cls)
    return found
