"""`LapCells`: which faces of a body make a lap, and how they are split into cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

BY = ("facets", "nodes")


@named_arguments
@dataclass(frozen=True)
class LapCells:
    """Cells of the facet set `first`, or of where it faces the facet set `second` of the same body.

    Parameters
    ----------
    first, second: names of facet sets. With one, the cells are those of a face that will lie on another body's; with
        two, those of the overlap of two faces of one body, the first of which gives the cells and their frames.
    size [m]: facets are gathered into cells up to about this size; None: each facet is a cell, or as `growth` says.
    growth: cells grow away from the outline of the overlap, outer edges and holes alike: at a distance d from it they
        are as large as a facet plus `growth` times d, and at most `size`. None: the same size everywhere.
    fine: facet sets from whose outlines d is measured in the place of that of the overlap, seen along the normals of
        the first face: those under heads of bolts, at whose edges the pressure is steep, through the sheet.
    by: "facets": a cell is a facet of the first set, cut by the outline of the second, or several of them. "nodes": a
        cell is a node of the first set, its load a nodal force; the nodes of the second have to lie opposite.

    Raises `InputError` for names that are none, sizes that are not positive, sizes of cells by nodes, and `fine`
    without `growth`.
    """

    first: str
    second: str | None = None
    size: float | None = None
    growth: float | None = None
    by: str = "facets"
    fine: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in (self.first, *(() if self.second is None else (self.second,))):
            if not isinstance(name, str) or not name:
                raise InputError(f"LapCells: a lap is between facet sets, given by name, got {name!r}")
        if self.first == self.second:
            raise InputError(
                f"LapCells: {self.first!r} cannot face itself; give two facet sets, or one for a face of this body "
                "that lies on another body's"
            )
        if self.by not in BY:
            raise unknown_name("LapCells: by", self.by, BY)
        for what, value in (("size", self.size), ("growth", self.growth)):
            if value is None:
                continue
            if self.by == "nodes":
                raise InputError(f"LapCells: {what} gathers facets; leave it out for cells by nodes")
            object.__setattr__(self, what, require_number(value, f"LapCells: {what}", positive=True))
        self._take_fine()

    def _take_fine(self) -> None:
        fine = (self.fine,) if isinstance(self.fine, str) else self.fine
        if not isinstance(fine, tuple | list) or not all(isinstance(name, str) and name for name in fine):
            raise InputError(f"LapCells: fine are names of facet sets, got {fine!r}")
        if fine and self.growth is None:
            raise InputError(f"LapCells: cells are fine at {fine[0]!r} if they grow away from there; give growth")
        object.__setattr__(self, "fine", tuple(fine))

    @property
    def sets(self) -> tuple[str, ...]:
        """The facet sets, one or two."""
        return (self.first,) if self.second is None else (self.first, self.second)

    def describe(self) -> dict[str, Any]:
        """Plain data, for provenance and the key of the cache."""
        found = {"sets": list(self.sets), "size": self.size, "growth": self.growth, "by": self.by}
        return {**found, "fine": list(self.fine)} if self.fine else found


def lap_cells(laps: Mapping[str, Any] | None) -> dict[str, LapCells]:
    """The laps of `reduce` by name: a facet set, two facet sets in a tuple or list, `LapCells`, or its arguments in a
    dict, as scene files have it. Raises `InputError` for anything else."""
    example = 'reduce: laps must be {name: ("facet set", "facet set")}, such as {"lap": ("top", "bottom")}'
    if laps is None:
        return {}
    if not isinstance(laps, Mapping) or not all(isinstance(name, str) and name for name in laps):
        raise InputError(f"{example}; got {laps!r}")
    found = {}
    for name, given in laps.items():
        if isinstance(given, LapCells):
            found[name] = given
        elif isinstance(given, str):
            found[name] = LapCells(given)
        elif isinstance(given, tuple | list) and len(given) == 2:
            found[name] = LapCells(*given)
        elif isinstance(given, Mapping):
            found[name] = _from_table(name, given)
        else:
            raise InputError(f"{example}, one facet set for a face, or LapCells; got {given!r} for {name!r}")
    return found


def _from_table(name: str, given: Mapping[str, Any]) -> LapCells:
    known = [field.name for field in fields(LapCells)]
    for key in given:
        if key not in known:
            raise unknown_name(f"reduce: lap {name!r}:", key, known)
    if "first" not in given:
        raise InputError(f"reduce: lap {name!r} needs first, the name of a facet set")
    return LapCells(**given)
