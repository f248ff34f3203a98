"""Identification of a function by a hash, which changes if a function of the same name changes.

The hash is the beginning of a sha256 of the compiled function: its instructions, names and constants, with those of
inner functions, its default values, and the plain values and functions of its closure, so that functions from one
factory with different numbers differ. Functions that it calls by global name, and objects of its closure, are not
examined.
"""

from __future__ import annotations

import functools
import hashlib
import types
from typing import Any

DIGITS = 12  # of the hash
PLAIN = (bool, int, float, complex, str, bytes, type(None), type(...))


def word_of(function: Any) -> str:
    """The hash; the same in each process with the same version of Python."""
    return hashlib.sha256(_told(function, frozenset()).encode()).hexdigest()[:DIGITS]


def _told(what: Any, within: frozenset[int]) -> str:
    """The parts of a function, a text without addresses and independent of the order of sets; within: ids of the
    enclosing functions."""
    if isinstance(what, PLAIN):
        return repr(what)
    if id(what) in within:  # a recursive function
        return "itself"
    part = functools.partial(_told, within=within | {id(what)})
    if isinstance(what, tuple):
        return f"({', '.join(map(part, what))})"
    if isinstance(what, frozenset):
        return f"{{{', '.join(sorted(map(part, what)))}}}"
    if isinstance(what, types.CodeType):
        return f"{what.co_code.hex()} {what.co_names} {part(what.co_consts)}"
    if isinstance(what, types.FunctionType):
        held = tuple(_held(cell) for cell in what.__closure__ or ())
        named = tuple(sorted((what.__kwdefaults__ or {}).items()))
        return f"{part(what.__code__)} {part(what.__defaults__ or ())} {part(named)} {part(held)}"
    if isinstance(what, functools.partial):
        return f"{part(what.func)} {part(what.args)} {part(tuple(sorted(what.keywords.items())))}"
    if isinstance(what, types.MethodType):
        return part(what.__func__)
    call = type(what).__call__ if callable(what) else None
    kind = f"{type(what).__module__}.{type(what).__qualname__}"
    return f"{kind} {part(call)}" if isinstance(call, types.FunctionType) else kind


def _held(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # the cell is still empty
        return None
