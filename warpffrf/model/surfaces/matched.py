"""`Matched`: a face for small-sliding contact, whose cells keep their partners."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

BY = ("facets", "nodes")


@named_arguments
@dataclass(frozen=True)
class Matched:
    """A face of any shape for `Contact(..., sliding="small")`, divided into cells with fixed partners.

    Parameters
    ----------
    second: None for a face in contact with another body's; or the facet set of this body that faces it. The cells are
        then those of the overlap of the two faces, the first of which defines the cells and their frames.
    size [m]: facets are gathered into cells up to about this size; None: each facet is a cell, or as `growth` defines.
    growth: cells grow away from the outline of the overlap, outer edges and holes: at a distance d from it they
        are as large as a facet plus `growth` times d, and at most `size`. None: the same size everywhere.
    by: "facets": a cell is a facet of the first set, cut by the outline of the second, or several of them. "nodes": a
        cell is a node of the first set, its load a nodal force; the nodes of the second must lie opposite.
    fine: facet sets from whose outlines, projected along the normals of the first face, d is measured instead of from
        that of the overlap: those under heads of bolts, at whose edges the pressure is steep, through the sheet.
    first: facet set of the face; None: the one with the name of the surface.

    Raises `InputError` for invalid names, sizes that are not positive, sizes of cells by nodes, and `fine` without
    `growth`.
    """

    second: str | None = None
    size: float | None = None
    growth: float | None = None
    by: str = "facets"
    fine: tuple[str, ...] = ()
    first: str | None = None

    kind = "matched"

    def __post_init__(self) -> None:
        for name in (self.first, self.second):
            if name is not None and (not isinstance(name, str) or not name):
                raise InputError(f"Matched: faces are facet sets, given by name, got {name!r}")
        if self.first is not None and self.first == self.second:
            raise InputError(
                f"Matched: {self.first!r} cannot face itself; give two facet sets, or one for a face of this body that "
                "lies on another body's"
            )
        if self.by not in BY:
            raise unknown_name("Matched: by", self.by, BY)
        for what, value in (("size", self.size), ("growth", self.growth)):
            if value is None:
                continue
            if self.by == "nodes":
                raise InputError(f"Matched: {what} gathers facets; leave it out for cells by nodes")
            object.__setattr__(self, what, require_number(value, f"Matched: {what}", positive=True))
        self._take_fine()

    def _take_fine(self) -> None:
        fine = (self.fine,) if isinstance(self.fine, str) else self.fine
        if not isinstance(fine, tuple | list) or not all(isinstance(name, str) and name for name in fine):
            raise InputError(f"Matched: fine are names of facet sets, got {fine!r}")
        if fine and self.growth is None:
            raise InputError(f"Matched: cells are fine at {fine[0]!r} if they grow away from there; give growth")
        object.__setattr__(self, "fine", tuple(fine))

    def called(self, name: str) -> Matched:
        """The same with its facet set: that of the name of the surface where none was given."""
        return self if self.first is not None else replace(self, first=name)

    @property
    def sets(self) -> tuple[str, ...]:
        """The facet sets, one or two, of a surface with a name (`called`)."""
        return tuple(name for name in (self.first, self.second) if name is not None)

    def describe(self) -> dict[str, Any]:
        """Plain data, for provenance and the key of the cache."""
        found = {"sets": list(self.sets), "size": self.size, "growth": self.growth, "by": self.by}
        return {**found, "fine": list(self.fine)} if self.fine else found
