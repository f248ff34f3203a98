"""The part that one world has in the arrays of several: what an engine of this world alone would have.

Worlds come first in every array, one behind the other, so that the part of a world is contiguous, and a view on it has
the shape that the array has where there is but one world. What is launched on views works on this world alone. They
are made when they are asked for, as a scene asks for few of all arrays. What has no worlds, the conditions of loops, is
the same for all.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, TypeVar

from warpffrf.online.arrays.declaration import Arrays

Kind = TypeVar("Kind", bound=Arrays)


class Views(dict[str, Any]):
    """Views on `arrays`, by name, of `world` of `worlds`; the constants called `of_worlds` have worlds first, too.

    An array that takes the place of another is one view with it.
    """

    def __init__(self, arrays: Mapping[str, Any], world: int, worlds: int, of_worlds: tuple[str, ...]) -> None:
        super().__init__()
        self._arrays, self._world, self._worlds, self._of_worlds = arrays, world, worlds, of_worlds
        self._made: dict[int, Any] = {}  # by the identity of the array

    def __missing__(self, name: str) -> Any:
        array = self._arrays[name]
        if id(array) not in self._made:
            self._made[id(array)] = self._view(name, array)
        self[name] = self._made[id(array)]
        return self[name]

    def _view(self, name: str, array: Any) -> Any:
        if name not in self._of_worlds:
            return array
        each = array.shape[0] // self._worlds  # of a run, whose axes are one, all that the world has
        return array[self._world * each : (self._world + 1) * each]


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
        return vars(self)["_views"][name]

    return type(f"{kind.__name__}OfAWorld", (kind,), {"__getattr__": __getattr__})
