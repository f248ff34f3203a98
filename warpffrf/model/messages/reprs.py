"""Representations of objects: one line at a prompt and in messages, a small table in a notebook, of scenes and results
with a picture.

A class returns its main properties by `_facts`, name -> value, in few words; arrays are shown by their shapes. Both
representations follow from that, so that none prints the numbers of a mesh or of a run.

Printable. Text for a terminal: names in files may contain terminal control sequences, such as colours and cursor
movements.
"""

from __future__ import annotations

import logging
import unicodedata
from dataclasses import fields
from difflib import get_close_matches
from html import escape
from typing import TYPE_CHECKING, Any

from warpffrf.model.renamed import RENAMED

LONGEST = 60  # characters of a list of names
log = logging.getLogger("warpffrf")


class Shown:
    """Representations made of `_facts`; an entry "name" comes first, without its key."""

    _hidden: frozenset[str] = frozenset()  # names that are for other modules, and that completion does not show

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - self._hidden)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Raises `AttributeError`, with the nearest public names, or the new name of one that was renamed."""
            if hasattr(type(self), name):
                return object.__getattribute__(self, name)  # a property that failed: again, for its own error
            hint = ""
            if now := [new for new in RENAMED.get(name, ()) if hasattr(type(self), new)]:
                hint = f"; it is called {now[0]!r} now"
            elif near := get_close_matches(name, [] if name[0] == "_" else [n for n in dir(self) if n[0] != "_"]):
                hint = f"; did you mean {', '.join(map(repr, near))}?"
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{hint}")

    def _facts(self) -> dict[str, Any]:
        raise TypeError(f"{type(self).__name__} does not say what to show")

    def __repr__(self) -> str:
        facts = self._facts()
        parts = [repr(facts.pop("name"))] if "name" in facts else []
        return f"{type(self).__name__}({', '.join([*parts, *(f'{key}={value}' for key, value in facts.items())])})"

    def _picture(self) -> str:
        """A picture next to the table in a notebook, as HTML; "" if there is none. Errors are logged."""
        return ""

    def _repr_html_(self) -> str:
        cell = '<{0} style="text-align:left">{1}</{0}>'
        rows = "".join(
            f"<tr>{cell.format('th', escape(key))}{cell.format('td', escape(str(value)))}</tr>"
            for key, value in self._facts().items()
        )
        try:
            picture = self._picture()
        except Exception:  # what is shown must not stop the cell of a notebook
            log.debug("%s: no picture", type(self).__name__, exc_info=True)
            picture = ""
        return f"<table><caption><b>{escape(type(self).__name__)}</b></caption>{rows}</table>{picture}"


class Item(Shown):
    """Base of scene items, represented by their name and ports.

    name: used in results, files and messages; None: formed from its kind and a number when it is added ("revolute_1").
    """

    @property
    def ports(self) -> tuple[Any, ...]:
        """The ports that it acts on or between, one or two: with two, the force on the second has its opposite on the
        first."""
        raise TypeError(f"{type(self).__name__} does not say where it is")

    def _facts(self) -> dict[str, Any]:
        item: Any = self
        return {"name": item.name, "on": " and ".join(port.label for port in item.ports)}


class Rows(Shown):
    """Representations of a dataclass of arrays: the shapes of those that are present."""

    def _facts(self) -> dict[str, Any]:
        values = {f.name: getattr(self, f.name, None) for f in fields(self)}  # pyright: ignore[reportArgumentType]
        return {name: shape_or_value(value) for name, value in values.items() if value is not None}


def shape_or_value(value: Any) -> Any:
    """The shape of an array, the representation of other objects."""
    shape = getattr(value, "shape", None)
    return value if shape is None else f"({', '.join(map(str, shape))})"


def names(items: Any) -> str:
    """Names as a list, truncated where there are many: 'lower', 'upper', ... (12)."""
    listed = [getattr(item, "name", item) for item in items]
    text = ", ".join(repr(name) for name in listed)
    if len(text) <= LONGEST:
        return text or "none"
    return f"{text[: text.rfind(',', 0, LONGEST)]}, ... ({len(listed)})"


HIDDEN = ("Cc", "Cf")  # categories of Unicode: controls, formats


def printable(text: str) -> str:
    """`text` for a terminal: control characters except line feeds and tabs, and those that change the direction
    of writing, which names in files may contain, as escapes."""
    return "".join(
        c if c in "\n\t" or unicodedata.category(c) not in HIDDEN else c.encode("unicode_escape").decode() for c in text
    )
