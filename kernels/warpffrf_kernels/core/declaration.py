"""One declaration per array: axes, type, unit and content.

    @topic
    class Bodies:
        mass: DeviceArray = reals("body", unit="kg")

An axis is a name, optionally with a factor and an offset, "6*body", "slot+1", or a number. A `run` array is read and
written along contiguous stretches by index: its axes are merged into one.
"""

import ast
import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import warp as wp

from warpffrf_kernels.core.scalars import mat33, quat, real, vec3

Axis = str | int
FORM = re.compile(r"(?:(\d+)\*)?([a-z_]+)(?:\+(\d+))?")
Kind = TypeVar("Kind")


class DeviceArray(Protocol):
    """Interface of a Warp array on the host."""

    shape: tuple[int, ...]
    ndim: int

    def numpy(self) -> Any: ...  # numpy.ndarray
    def assign(self, src: Any) -> Any: ...
    def fill_(self, value: Any) -> None: ...
    def zero_(self) -> None: ...
    def flatten(self) -> "DeviceArray": ...


@dataclass(frozen=True)
class Declaration:
    """Declaration of an array before its size is known."""

    axes: tuple[Axis, ...]
    dtype: Any
    unit: str
    note: str
    run: bool
    carried: bool = False  # contents from before the attempt are used
    zero_without: bool = False  # zero is the correct value in a scene where no launch sets it
    restored: bool = False  # a rejected attempt restores the contents from before it
    instead: str = ""  # array that replaces it in a scene without its axes
    flat: bool = False  # kernels see one axis, the host all of them

    @property
    def ndim(self) -> int:
        return 1 if self.run or self.flat else len(self.axes)

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Length of each axis; raises KeyError for an axis that has no size."""
        return tuple(length(axis, sizes) for axis in self.axes)


def length(axis: Axis, sizes: Mapping[str, int]) -> int:
    """Entries along `axis`, 0 if the size of its name is 0; raises KeyError for a name without a size."""
    if isinstance(axis, int):
        return axis
    factor, name, more = parts(axis)
    return factor * sizes[name] + more if sizes[name] else 0


def parts(axis: str) -> tuple[int, str, int]:
    """Factor, name and offset of an axis."""
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
    """Declare an array of 3-vectors."""
    return Declaration(axes, vec3, unit, note, False, **more)


def matrices(*axes: Axis, unit: str = "", note: str = "", **more: Any) -> Any:
    """Declare an array of 3x3 matrices."""
    return Declaration(axes, mat33, unit, note, False, **more)


def quaternions(*axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of unit quaternions."""
    return Declaration(axes, quat, "", note, False, **more)


def structs(of: Any, *axes: Axis, note: str = "", **more: Any) -> Any:
    """Declare an array of a Warp struct."""
    return Declaration(axes, of, "", note, False, **more)


def declared_in(topic: Any) -> dict[str, Declaration]:
    """The arrays of a topic, by name."""
    return topic.declarations


def topic(cls: type[Kind]) -> type[Kind]:
    """Warp struct of a class whose fields are numbers, other structs and declared arrays, including those of its bases;
    the declarations are kept as `declarations`. A derived class inherits them, and is no struct."""
    own = {name: value for name, value in vars(cls).items() if isinstance(value, Declaration)}
    declared = {name: d for base in cls.__bases__ for name, d in getattr(base, "declarations", {}).items()} | own
    fields: dict[str, Any] = {name: wp.array(dtype=d.dtype, ndim=d.ndim) for name, d in declared.items()}
    fields = {name: fields.get(name, annotation) for name, annotation in inspect.get_annotations(cls).items()} | fields
    for name in own:
        delattr(cls, name)
    cls.__annotations__ = fields
    setattr(cls, "declarations", declared)  # noqa: B010, no field
    found: Any = wp.struct(cls)
    found.__mro_entries__ = lambda _: (cls,)
    return found


def is_topic(kind: Any) -> bool:
    """Whether `kind` is a struct of declared arrays."""
    return hasattr(kind, "declarations") and hasattr(kind, "vars")


def kernel(function: Any) -> wp.Kernel:
    """Warp kernel whose topics are passed by address, each in an array of length one: a graph on the CPU looks up all
    arrays of each launch, including those within structs. The body sees the structs."""
    return wp.Kernel(function, code_transformers=[ByAddress(_take_addresses(function))])


def kernel_in_place(function: Any) -> wp.Kernel:
    """As `kernel`, for a kernel that reads from many topics: their fields, and those of `model = run.models[w]`, are
    loaded where they are used. Loaded at the top they occupy more registers than a GPU has."""
    return wp.Kernel(function, code_transformers=[InPlace(_take_addresses(function))])


def _take_addresses(function: Any) -> list[str]:
    """Annotates each topic of a kernel as an array of one, and returns their names."""
    topics = {name: kind for name, kind in inspect.get_annotations(function).items() if is_topic(kind)}
    function.__annotations__ |= {name: wp.array(dtype=kind) for name, kind in topics.items()}
    return list(topics)


class ByAddress(ast.NodeTransformer):
    """Prepends `run_ = run[0]` and replaces `run` by `run_` in the body."""

    def __init__(self, names: Iterable[str]) -> None:
        self.names = set(names)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        body = [self.visit(statement) for statement in node.body]
        first = [ast.copy_location(ast.parse(f"{name}_ = {name}[0]").body[0], body[0]) for name in sorted(self.names)]
        node.body = [*(ast.fix_missing_locations(statement) for statement in first), *body]
        return node

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.copy_location(ast.Name(f"{node.id}_", node.ctx), node) if node.id in self.names else node


class InPlace(ast.NodeTransformer):
    """Replaces `run` by `run[0]`, and `model` by `run[0].models[w]` in place of assigning it."""

    def __init__(self, names: Iterable[str]) -> None:
        self.names = {name: f"{name}[0]" for name in names} | {"model": "run[0].models[w]"}

    def visit_Assign(self, node: ast.Assign) -> Any:
        if ast.unparse(node) == "model = run.models[w]":
            return None
        return self.generic_visit(node)

    def visit_Name(self, node: ast.Name) -> Any:
        source = self.names.get(node.id)
        return ast.copy_location(ast.parse(source, mode="eval").body, node) if source else node
