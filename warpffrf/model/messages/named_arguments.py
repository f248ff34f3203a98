"""Errors for unknown arguments of a callable that suggest the known names.

Python's own message for `simulate(scene, savevery=2)` names the wrong argument, but neither the nearest nor the
existing ones. The decorator does not change calls and signatures: only a call that failed with a `TypeError` is
examined, and if its arguments are wrong the error states the nearest name, the missing argument, or the keyword-only
arguments. A `TypeError` from further inside is passed on.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from inspect import Parameter
from typing import Any, TypeVar

from warpffrf.model.errors import suggestion
from warpffrf.model.renamed import RENAMED, REPLACED

BY_PLACE = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
Named = TypeVar("Named", bound=Callable[..., Any])


def named_arguments(thing: Named) -> Named:
    """`thing`, a function or a class with its constructor and public methods, with errors as in the module docstring.

    Calls raise `TypeError` for arguments that do not fit.
    """
    if not isinstance(thing, type):
        return _answered(thing, inspect.signature(thing), lambda args: (thing.__name__, args))  # type: ignore[return-value]
    for name, method in vars(thing).copy().items():
        if not inspect.isfunction(method) or (name.startswith("_") and name != "__init__"):
            continue
        parameters = list(inspect.signature(method).parameters.values())[1:]
        setattr(thing, name, _answered(method, inspect.Signature(parameters), _of_class(name)))
    return thing  # type: ignore[return-value]


def _of_class(name: str) -> Callable[[tuple], tuple[str, tuple]]:
    """The name of a method for its users, and the arguments that they passed."""
    if name == "__init__":
        return lambda args: (type(args[0]).__name__, args[1:])
    return lambda args: (f"{type(args[0]).__name__}.{name}", args[1:])


def _answered(
    function: Callable[..., Any], signature: inspect.Signature, seen: Callable[[tuple], tuple[str, tuple]]
) -> Callable[..., Any]:
    """`function`, whose users see `signature`; `seen`: all its arguments -> its name and theirs."""

    @functools.wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        try:
            return function(*args, **options)
        except TypeError:
            label, given = seen(args)
            text = misfit(label, signature, given, options)
            if not text:
                raise
        raise TypeError(text)

    return call


def misfit(label: str, signature: inspect.Signature, args: Sequence[Any], options: dict[str, Any]) -> str:
    """Message on `args` and `options` that do not fit the `signature` of the callable `label`, with the cure; "" where
    they fit."""
    parameters = signature.parameters.values()
    if any(p.kind is Parameter.VAR_KEYWORD for p in parameters):
        return ""
    known = [p.name for p in parameters if p.kind is not Parameter.VAR_POSITIONAL]
    for name in options:
        if name not in known:
            hint = REPLACED.get((label, name)) or _of_options(name, known, parameters) or suggestion(name, known)
            return f"{label}: there is no argument {name!r}{hint}"
    by_place = [p.name for p in parameters if p.kind in BY_PLACE]
    free = any(p.kind is Parameter.VAR_POSITIONAL for p in parameters)
    if len(args) > len(by_place) and not free:
        by_name = [f"{p.name}=..." for p in parameters if p.kind is Parameter.KEYWORD_ONLY]
        others = f"; pass the others by name: {label}({', '.join([*by_place, *by_name])})" if by_name else ""
        return f"{label}: {len(args)} positional arguments were given, it takes {_listed(by_place)}{others}"
    filled = {*by_place[: len(args)], *options}
    missing = [p.name for p in parameters if p.default is Parameter.empty and p.name in known and p.name not in filled]
    if missing:
        return f"{label}: {' and '.join(missing)} must be given; it takes {_listed(known)}"
    twice = [name for name in by_place[: len(args)] if name in options]
    return f"{label}: {twice[0]} is given twice, by position and by name" if twice else ""


def _of_options(name: str, known: Sequence[str], parameters: Iterable[Parameter]) -> str:
    """ "; it belongs to options=..." for a field, or nearly one, of an argument that is an object of options."""
    objects = [(p.name, p.default) for p in parameters if is_dataclass(p.default)]
    inner = {f.name: f"{at}=wf.{type(one).__name__}({f.name}=...)" for at, one in objects for f in fields(one)}
    for meant in (name, *RENAMED.get(name, ()), *get_close_matches(name, [*known, *inner], n=1)):
        if meant in inner:
            return f"; it belongs to {inner[meant]}"
        if meant in known:
            return ""
    return ""


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) or "none"
