"""The part of one world in the arrays of several: the arrays that an engine of this world alone would have.

The world axis is the first axis of every array, so the part of a world is contiguous, and a view on it has the shape
that the array has for a single world. Launches on views affect this world only. Views are created on request, because
a scene uses few of all arrays. Arrays without a world axis (the conditions of loops) are shared by all worlds.

From another device, every array of every world would be a separate copy of some tens of microseconds. Reads of all
arrays (`to_numpy`, `on_host`) therefore use copies that all worlds share (`OnHost`), as long as a world has not
requested one of its arrays, or a launch on them, since the worlds were last stepped together (`Views.touched`).
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

from warpffrf.online.arrays.declaration import Arrays, Bound
from warpffrf_kernels.core.declaration import is_topic

Kind = TypeVar("Kind", bound=Arrays)


class OnHost:
    """Arrays of all worlds on the host: views on the CPU, one copy each from another device until `forget`."""

    def __init__(self) -> None:
        self._held: dict[int, tuple[Any, np.ndarray]] = {}

    def forget(self) -> None:
        """Drop the copies, because the arrays have changed."""
        self._held.clear()

    def array(self, array: Any) -> np.ndarray:
        """One array, all worlds."""
        if id(array) not in self._held:
            self._held[id(array)] = array, array.numpy()
        return self._held[id(array)][1]


class Views(Bound):
    """Views on the part of `world` of `worlds` in the arrays passed to `see`, by name; the arrays `of_worlds` have the
    world axis first.

    An array that shares the memory of another has one view with it. on_host: copies that all worlds read. `touched`:
    whether this world may have changed its part since the worlds were last stepped together.
    """

    def __init__(self, world: int, worlds: int, of_worlds: tuple[str, ...], on_host: OnHost) -> None:
        super().__init__()
        self._arrays: Mapping[str, Any] = {}
        self._world, self._worlds, self._of_worlds = world, worlds, of_worlds
        self._on_host, self.touched = on_host, True
        self._made: dict[int, Any] = {}  # by the identity of the array

    def see(self, arrays: Mapping[str, Any]) -> None:
        """Use `arrays` from now on, also where views already exist (`part`)."""
        self.clear()
        self._made.clear()
        self._arrays, self.touched = arrays, True

    def __missing__(self, name: Any) -> Any:
        if is_topic(name):
            return super().__missing__(name)
        array = self._arrays[name]
        if id(array) not in self._made:
            self._made[id(array)] = self._view(name, array)
        self[name] = self._made[id(array)]
        return self[name]

    def _view(self, name: str, array: Any) -> Any:
        return array[self._places(array)] if name in self._of_worlds else array

    def _places(self, array: Any) -> slice:
        each = array.shape[0] // self._worlds  # of a run whose axes are one: everything that the world has
        return slice(self._world * each, (self._world + 1) * each)

    def numpy(self, name: str) -> np.ndarray:
        """The part of this world in an array on the host, read-only."""
        if self.touched:
            return self[name].numpy()
        found = self._on_host.array(self._arrays[name])
        return found[self._places(found)] if name in self._of_worlds else found


def part(arrays: Kind, views: Views) -> Kind:
    """`arrays` as seen by the world of `views`."""
    found = object.__new__(_part_of(type(arrays)))
    vars(found)["_views"] = views
    return found


@functools.cache
def _part_of(kind: Any) -> Any:
    """The class of parts of the arrays `kind`, which looks up its attributes in views."""

    def __getattr__(self: Any, name: str) -> Any:
        if name not in kind.declarations:
            raise AttributeError(name)
        views = vars(self)["_views"]
        views.touched = True
        return views[name]

    def read(self: Any, name: str) -> np.ndarray:
        return vars(self)["_views"].numpy(name)

    return type(f"{kind.__name__}OfAWorld", (kind,), {"__getattr__": __getattr__, "read": read})
