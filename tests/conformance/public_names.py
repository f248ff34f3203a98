"""What users can name: the public names of warpffrf and of its public modules, with what stands in their classes."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import warpffrf as wf

MADE_BY_DATACLASS = {"__init__", "__eq__", "__repr__"}


@dataclass(frozen=True)
class Public:
    """One name: where users find it, what it is, and of a member the class in which it stands."""

    label: str
    thing: Any
    owner: type | None = None

    @property
    def name(self) -> str:
        return self.label.rsplit(".", 1)[-1]

    @property
    def function(self) -> Any:
        """The function behind a function, method or property; None of the rest."""
        thing = inspect.getattr_static(self.owner, self.name) if self.owner else self.thing
        if isinstance(thing, property):
            return thing.fget
        if isinstance(thing, functools.cached_property):
            return thing.func
        if isinstance(thing, classmethod | staticmethod):
            thing = thing.__func__
        return inspect.unwrap(thing) if inspect.isfunction(thing) else None

    @property
    def is_property(self) -> bool:
        thing = inspect.getattr_static(self.owner, self.name) if self.owner else None
        return isinstance(thing, property | functools.cached_property)

    @property
    def text(self) -> str:
        """The docstring, of a member that has none that of the class it takes the place in; of a class with the one of
        its constructor, which takes its arguments."""
        if inspect.isclass(self.thing) and not self.owner:
            made = self.thing.__dict__.get("__init__")
            return f"{own_text(self.thing)}\n{made.__doc__ or '' if inspect.isfunction(made) else ''}"
        if self.owner is None:
            return inspect.getdoc(self.thing) or ""
        for one in self.owner.__mro__:
            found = one.__dict__.get(self.name)
            function = getattr(found, "fget", None) or getattr(found, "func", None) or found
            text = getattr(function, "__doc__", None)
            if found is not None and text and not (inspect.isclass(function) and one is not self.owner):
                return inspect.cleandoc(text)
        return ""


def own_text(kind: type) -> str:
    """The docstring of a class, and not the line that dataclasses make."""
    text = inspect.cleandoc(kind.__doc__ or "")
    return "" if text.startswith(f"{kind.__name__}(") else text


def modules() -> list[Any]:
    return [wf, *(value for name in wf.__all__ if inspect.ismodule(value := getattr(wf, name)))]


def top_level() -> Iterator[Public]:
    """Functions, classes and the rest, each once."""
    seen = set()
    for module in modules():
        for name in module.__all__:
            value = getattr(module, name)
            if inspect.ismodule(value) or id(value) in seen:
                continue
            seen.add(id(value))
            where = "wf" if module is wf else f"wf.{module.__name__.rsplit('.', 1)[-1]}"
            yield Public(f"{where}.{name}", value)


def results() -> Iterator[Public]:
    """Classes of what public calls give back, which users hold without naming them."""
    from warpffrf.online.history.history import BodyHistory, ForceHistory, JointHistory, LumpedHistory, SensorHistory
    from warpffrf.output.bearings.bearing_result import BearingResult
    from warpffrf.output.comparison import Comparison
    from warpffrf.output.contact.cell_result import CellContactResult
    from warpffrf.output.contact.friction import FrictionResult
    from warpffrf.output.contact.result import ContactResult, FilmResult
    from warpffrf.output.loops import Hysteresis, Loop
    from warpffrf.output.modes_result import Modes
    from warpffrf.output.small_sliding import SmallSlidingResult
    from warpffrf.output.spectrum import Spectrum

    for kind in (
        BodyHistory, ForceHistory, JointHistory, LumpedHistory, SensorHistory, Comparison, CellContactResult,
        FilmResult, FrictionResult, ContactResult, SmallSlidingResult, Modes, Spectrum, Hysteresis, Loop, BearingResult,
    ):  # fmt: skip
        yield Public(f"{kind.__module__}.{kind.__name__}", kind)


def members(kind: Public) -> Iterator[Public]:
    """Public methods and properties of a class; those that it hides are for other modules."""
    hidden = getattr(kind.thing, "_hidden", frozenset())
    for name, _ in inspect.getmembers_static(kind.thing):
        if name.startswith("_") or name in hidden:
            continue
        owner = next((c for c in kind.thing.__mro__ if name in c.__dict__), None)
        if owner is None or not owner.__module__.startswith("warpffrf"):
            continue
        found = Public(f"{kind.label}.{name}", None, kind.thing)
        if found.function is not None:
            yield found


def everything() -> list[Public]:
    found = [*top_level(), *results()]
    classes = [one for one in found if inspect.isclass(one.thing)]
    return [*found, *(member for kind in classes for member in members(kind))]
