"""Arrays as attributes of a class, each declared once, in the topics that kernels take as arguments
(`warpffrf_kernels.core.declaration`).

class State(ContactState, Arrays):
    pressure: DeviceArray = reals("world", "pair", "node", unit="Pa", note="at the nodes")
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import warp as wp
from numpy.lib.recfunctions import structured_to_unstructured

from warpffrf.model.errors import InputError
from warpffrf.online.settings import LARGEST_INDEX
from warpffrf_kernels.core.declaration import Declaration, is_topic


def allocate(declaration: Declaration, sizes: Mapping[str, int], device: str) -> Any:
    """Zero array. An axis without entries gets one unused entry, so that the array can be passed to kernels.

    Raises InputError if the array has more entries than the indices of kernels can address.
    """
    shape = tuple(max(n, 1) for n in declaration.shape(sizes))
    size = int(np.prod(shape, dtype=np.int64))
    if size > LARGEST_INDEX:
        saved = "save fewer rows at a time (ring_rows of the settings), " if "ring_row" in declaration.axes else ""
        raise InputError(
            f"scene: an array of {size} numbers is needed, at most {LARGEST_INDEX} can be indexed; {saved}run fewer "
            "worlds at a time, or lower the capacity of the contacts"
        )
    return wp.zeros((size,) if declaration.run else shape, dtype=declaration.dtype, device=device)


def as_taken(array: Any, kind: Any) -> Any:
    """`array`, flattened if a parameter or field of this `kind` has one axis."""
    return array.flatten() if array.ndim > 1 and kind.ndim == 1 else array


class Bound(dict[Any, Any]):
    """Arrays by name; for each requested topic, a struct of the arrays that it names, in an array of length one."""

    def __missing__(self, topic: Any) -> Any:
        if not is_topic(topic):
            raise KeyError(topic)
        struct = topic()
        for name, field in topic.vars.items():
            setattr(struct, name, as_taken(self[name], field.type))
        self[topic] = wp.array([struct], dtype=topic, device=self[next(iter(topic.vars))].device)
        return self[topic]


def topic_of(annotation: Any) -> Any:
    """The topic that a parameter of a kernel takes, None if it takes something else."""
    kind = getattr(annotation, "dtype", None)
    return kind if is_topic(kind) else None


def host_structs(of: Any, count: int) -> np.ndarray:
    """Array (count,) of zero structs on the host, with fields by name."""
    found: Any = wp.zeros(count, dtype=of, device="cpu")
    return found.numpy().copy()


def numbers_of(array: Any) -> np.ndarray:
    """Values of an array on the host. The fields of structs become its last axis."""
    given = np.asarray(array)
    return structured_to_unstructured(given) if given.dtype.names else given


class Arrays:
    """Arrays as attributes, declared in derived classes; with `carried=True` all arrays of the class are carried."""

    declarations: ClassVar[dict[str, Declaration]] = {}

    def __init_subclass__(cls, carried: bool = False) -> None:
        own = {name: value for name, value in vars(cls).items() if isinstance(value, Declaration)}
        found: dict[str, Declaration] = {}
        own |= vars(cls).get("declarations", {})
        for part in [getattr(base, "declarations", {}) for base in cls.__bases__] + [own]:
            twice = sorted(set(found) & set(part))
            if twice:
                raise TypeError(f"{cls.__name__}: {', '.join(twice)} declared twice; choose another name")
            found |= part
        for name in set(own) & set(vars(cls)):
            delattr(cls, name)  # exists on instances only
        cls.declarations = {name: replace(d, carried=True) for name, d in found.items()} if carried else found

    @classmethod
    def room(cls, sizes: Mapping[str, int]) -> tuple[int, int]:
        """Bytes of all arrays, and entries of the largest, without allocating them."""
        shapes = [(d, d.shape(sizes)) for d in cls.declarations.values()]
        counts = [
            (int(np.prod([max(n, 1) for n in shape], dtype=np.int64)), wp.types.type_size_in_bytes(d.dtype))
            for d, shape in shapes
            if not (d.instead and 0 in shape)
        ]
        return sum(count * size for count, size in counts), max((count for count, _ in counts), default=1)

    def __init__(self, sizes: Mapping[str, int], device: str, beside: Arrays | None = None) -> None:
        """All arrays, zero. `beside`: owner of the arrays that other arrays are declared to share."""
        for name, declaration in self.declarations.items():
            missing = declaration.instead and 0 in declaration.shape(sizes)
            if not missing:
                setattr(self, name, allocate(declaration, sizes, device))
        for name, declaration in self.declarations.items():
            if name not in vars(self):
                owner = self if declaration.instead in vars(self) else beside
                setattr(self, name, getattr(owner, declaration.instead))

    def to_numpy(self) -> dict[str, np.ndarray]:
        """Copies of all arrays by name."""
        return {name: self.read(name).copy() for name in self.declarations}

    def read(self, name: str) -> np.ndarray:
        """One array on the host, read-only: a view on the CPU, a copy from another device."""
        return getattr(self, name).numpy()

    def assign(self, values: Mapping[str, np.ndarray]) -> None:
        """Overwrite all arrays with the copies of `to_numpy`."""
        for name in self.declarations:
            getattr(self, name).assign(values[name])
