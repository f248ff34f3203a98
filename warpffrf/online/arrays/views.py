"""The part that one world has in the arrays of several: what an engine of this world alone would have.

Worlds come first in every array, one behind the other, so that the part of a world is contiguous, and a view on it has
the shape that the array has where there is but one world. What is launched on views works on this world alone. They
are made when they are asked for, as a scene asks for few of all arrays. What has no worlds, the conditions of loops, is
the same for all.

From another device every array of every world would be a copy of its own, some tens of microseconds each. So what is
read of all arrays at once (`to_numpy`, `on_host`) comes out of copies that all worlds share (`OnHost`), as long as a
world has not asked for one of its arrays, or for a launch on them, since they were stepped together (`Views.touched`).
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
        """The arrays have changed."""
        self._held.clear()

    def array(self, array: Any) -> np.ndarray:
        """One of them, whole."""
        if id(array) not in self._held:
            self._held[id(array)] = array, array.numpy()
        return self._held[id(array)][1]


class Views(Bound):
    """Views on the arrays that it is to `see`, by name, of `world` of `worlds`; those called `of_worlds` have worlds
    first.

    An array that takes the place of another is one view with it. on_host: what all worlds read. `touched`: whether this
    world may have changed its part since they were stepped together.
    """

    def __init__(self, world: int, worlds: int, of_worlds: tuple[str, ...], on_host: OnHost) -> None:
        super().__init__()
        self._arrays: Mapping[str, Any] = {}
        self._world, self._worlds, self._of_worlds = world, worlds, of_worlds
        self._on_host, self.touched = on_host, True
        self._made: dict[int, Any] = {}  # by the identity of the array

    def see(self, arrays: Mapping[str, Any]) -> None:
        """`arrays` from now on, also where views are held already (`part`)."""
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
        each = array.shape[0] // self._worlds  # of a run, whose axes are one, all that the world has
        return slice(self._world * each, (self._world + 1) * each)

    def numpy(self, name: str) -> np.ndarray:
        """The part of this world in an array, on the host, to be read only."""
        if self.touched:
            return self[name].numpy()
        found = self._on_host.array(self._arrays[name])
        return found[self._places(found)] if name in self._of_worlds else found


def part(arrays: Kind, views: Views) -> Kind:
    """`arrays` as the world of `views` has them."""
    found = object.__new__(_part_of(type(arrays)))
    vars(found)["_views"] = views
    return found


@functools.cache
def _part_of(kind: Any) -> Any:
    """The class of parts of the arrays `kind`, which finds its attributes in views."""

    def __getattr__(self: Any, name: str) -> Any:
        if name not in kind.declarations:
            raise AttributeError(name)
        views = vars(self)["_views"]
        views.touched = True
        return views[name]

    def read(self: Any, name: str) -> np.ndarray:
        return vars(self)["_views"].numpy(name)

    return type(f"{kind.__name__}OfAWorld", (kind,), {"__getattr__": __getattr__, "read": read})
