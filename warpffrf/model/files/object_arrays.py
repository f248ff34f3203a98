"""A scene, or another object of warpffrf, as a JSON document and arrays, and back, with all objects it refers to.

An object is stored as its class and attributes; shared objects remain shared. Only classes of warpffrf are created,
without their constructors, and the document contains no code, so that a foreign document can at most be wrong
(readers of a scene compare its `content_hash`). A document is read by the version that wrote it.

    [value, ...]                      the first is the object itself; others refer to each by its number
    null, true, 1.5, "text"           themselves
    {"at": number}                    another of the values
    {"array": name}                   an array; {"scalar": name}: an array's number
    {"list" | "tuple" | "set" | "frozenset": [value, ...]}, {"dict": [[key, value], ...]}
    {"csr_matrix" | "csc_matrix" | "csr_array" | "csc_array": [data, indices, indptr, shape]}      of scipy.sparse
    {"class": "module:name", "has": {attribute: value}}, {"type": "module:name"}
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy import sparse

from warpffrf.model.errors import InputError

PACKAGE = "warpffrf."
SEQUENCES = {"list": list, "tuple": tuple, "set": set, "frozenset": frozenset}
KINDS = {kind: name for name, kind in SEQUENCES.items()}
SPARSE = {kind.__name__: kind for kind in (sparse.csr_matrix, sparse.csc_matrix, sparse.csr_array, sparse.csc_array)}
PLAIN = (type(None), bool, int, float, str)


def to_arrays(thing: Any) -> tuple[list[Any], dict[str, np.ndarray]]:
    """`thing` as a document and the arrays that it names; they are its own, not copies. Raises `InputError` where it
    contains anything other than plain data and objects of warpffrf's classes."""
    packing = _Packing()
    packing.pack(thing)
    return packing.values, packing.arrays


def from_arrays(document: list[Any], arrays: Mapping[str, np.ndarray]) -> Any:
    """The argument of `to_arrays`. Raises `InputError` for a document that it did not write, or that names classes
    which this version does not have."""
    try:
        return _Unpacking(document, arrays).at(0)
    except (LookupError, TypeError, ValueError, AttributeError, ImportError, OverflowError, RecursionError) as error:
        raise InputError(f"it is of another version of warpffrf ({error})") from None


class _Packing:
    def __init__(self) -> None:
        self.values: list[Any] = []
        self.arrays: dict[str, np.ndarray] = {}
        self.known: dict[int, tuple[dict[str, Any], Any]] = {}  # by id, with the object so that the id stays its own

    def pack(self, thing: Any) -> Any:
        """The value that represents `thing`."""
        if type(thing) in PLAIN:
            return thing
        if id(thing) in self.known:
            return self.known[id(thing)][0]
        if isinstance(thing, np.ndarray | np.generic):
            if thing.dtype.hasobject:
                raise InputError("it holds arrays of objects")
            name = f"{len(self.arrays)}"
            value = {"array" if isinstance(thing, np.ndarray) else "scalar": name}
            self.arrays[name] = np.asarray(thing)
            self.known[id(thing)] = value, thing
            return value
        reference = {"at": len(self.values)}
        self.known[id(thing)] = reference, thing
        self.values.append(None)
        self.values[reference["at"]] = self._described(thing)
        return reference

    def _described(self, thing: Any) -> dict[str, Any]:
        kind = type(thing)
        if kind in KINDS:
            return {KINDS[kind]: [self.pack(member) for member in tuple(thing)]}
        if kind is dict:
            return {"dict": [[self.pack(key), self.pack(value)] for key, value in dict(thing).items()]}
        if kind in SPARSE.values():
            parts = (thing.data, thing.indices, thing.indptr, tuple(map(int, thing.shape)))
            return {kind.__name__: [self.pack(part) for part in parts]}
        if kind is type and thing.__module__.startswith(PACKAGE):
            return {"type": _name(thing)}
        if not kind.__module__.startswith(PACKAGE) or not hasattr(thing, "__dict__"):
            raise InputError(f"it holds a {kind.__module__}.{kind.__qualname__}")
        return {"class": _name(kind), "has": {name: self.pack(value) for name, value in dict(vars(thing)).items()}}


class _Unpacking:
    def __init__(self, document: list[Any], arrays: Mapping[str, np.ndarray]) -> None:
        self.document, self.arrays = document, arrays
        self.made: dict[int, Any] = {}

    def at(self, number: int) -> Any:
        """The value of that number, made once."""
        if number not in self.made:
            self._make(number, self.document[number])
        return self.made[number]

    def value(self, packed: Any) -> Any:
        """The object that a packed value represents."""
        if type(packed) in PLAIN:
            return packed
        ((kind, what),) = packed.items()
        if kind == "array":
            return self.arrays[what]
        return self.arrays[what][()] if kind == "scalar" else self.at(int(packed["at"]))

    def _make(self, number: int, described: dict[str, Any]) -> None:
        """What refers to itself is there before its members are."""
        kind = next(iter(described))
        if kind == "class":
            found = self.made[number] = object.__new__(_class(described["class"]))
            vars(found).update({name: self.value(packed) for name, packed in described["has"].items()})
        elif kind == "dict":
            found = self.made[number] = {}
            found.update((self.value(key), self.value(packed)) for key, packed in described["dict"])
        elif kind == "list":
            found = self.made[number] = []
            found.extend(self.value(packed) for packed in described["list"])
        elif kind == "type":
            self.made[number] = _class(described["type"])
        elif kind in SPARSE:
            data, indices, indptr, shape = map(self.value, described[kind])
            self.made[number] = SPARSE[kind]((data, indices, indptr), shape=shape)
        else:
            self.made[number] = SEQUENCES[kind](self.value(packed) for packed in described[kind])


def _name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str) -> type:
    module, _, path = name.partition(":")
    if not module.startswith(PACKAGE):
        raise ValueError(f"no class of warpffrf: {name}")
    found: Any = importlib.import_module(module)
    for part in path.split("."):
        found = getattr(found, part)
    if not isinstance(found, type) or found.__module__ != module:
        raise ValueError(f"no class of warpffrf: {name}")
    return found
