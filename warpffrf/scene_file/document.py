"""The document of a scene file: includes merged, `--set` applied, parameters substituted.

    include = ["steel.toml"]           other files, relative to this one; values in this file override included values
    [parameters]                       free values, used by expressions "= name" anywhere else
    upper.load = 20e3

Tables are merged key by key; lists and values are replaced as a whole, and so is a table whose `kind` changes.
`--set upper.load=2000` names a parameter or a key of the document; a new value must have the type of the value that it
replaces (an integer is accepted for a float).

Lines of errors. An error of a call keeps its message; its line in the scene file is found from the first name or key of
the file that the message contains.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from copy import deepcopy
from difflib import get_close_matches
from pathlib import Path as FilePath
from typing import Any

from warpffrf.model.errors import InputError, nearest, suggestion
from warpffrf.scene_file.numbers import evaluate, is_expression
from warpffrf.scene_file.source import LARGEST_INTEGER, Path, Place, Source, parse, read_source

MOST_FILES = 100
MOST_VALUES = 1_000_000  # in a document, with parameters substituted
TYPES = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    list: "a list",
    dict: "a table",
}


def dotted(path: Path) -> str:
    """A path in the notation of --set."""
    return ".".join(str(key) for key in path)


def read_document(path: FilePath, settings: Sequence[str] = ()) -> Source:
    """The scene file at `path` with includes, `settings` ("name=value") and parameters applied. Raises `InputError`."""
    return resolved(merged_document(path, settings))


def merged_document(path: FilePath, settings: Sequence[str] = ()) -> Source:
    """As `read_document`, with parameters and expressions not yet evaluated."""
    return with_settings(_with_includes(path, path.name, (), [0]), settings)


def with_settings(source: Source, settings: Sequence[str]) -> Source:
    """A copy of a merged document with `settings` ("name=value") applied. Raises `InputError`."""
    changed = Source(deepcopy(source.values), dict(source.places))
    for setting in settings:
        _set(changed, setting)
    return changed


def document_of(text: str, folder: FilePath, settings: Sequence[str] = (), name: str = "scene.toml") -> Source:
    """`read_document` of a text; its relative paths start from `folder`."""
    return resolved(with_settings(_included(parse(text, name, folder), (), [0]), settings))


# --- includes


def _with_includes(path: FilePath, name: str, above: tuple[FilePath, ...], count: list[int]) -> Source:
    count[0] += 1
    if count[0] > MOST_FILES:
        raise InputError(f"{name}: more than {MOST_FILES} files are included")
    return _included(read_source(path, name), (*above, path.resolve()), count)


def _included(source: Source, above: tuple[FilePath, ...], count: list[int]) -> Source:
    includes = source.values.pop("include", [])
    if not isinstance(includes, list) or not all(isinstance(entry, str) for entry in includes):
        raise InputError(f"{source.place(('include',))}: include must be a list of file names, got {includes!r}")
    base = Source({}, dict(source.places))
    for index, entry in enumerate(includes):
        place = source.place(("include", index))
        try:
            file = (place.folder / entry).resolve()
            exists = file.is_file()
        except (OSError, ValueError, RuntimeError) as error:
            raise InputError(f"{place}: include {entry!r} is not a file name ({error})") from None
        if not exists:
            near = nearest(file.name, _beside(file, above))
            close = f"did you mean {near!r}? " if near else ""
            raise InputError(f"{place}: include {entry!r} does not exist; {close}it is searched in {place.folder}")
        if file in above:
            raise InputError(f"{place}: include {entry!r} includes itself")
        _merge(base, _with_includes(file, entry, above, count))
    _merge(base, source)
    return base


def _beside(file: FilePath, above: tuple[FilePath, ...]) -> list[str]:
    """Names of the scene files in the folder of `file` that may be included: not those `above`."""
    try:
        return sorted(path.name for path in file.parent.glob("*.toml") if path.is_file() and path not in above)
    except OSError:
        return []


def _merge(into: Source, other: Source) -> None:
    """Merge `other` into `into`; values of `other` override."""
    replaced: set[Path] = set()
    _put_above(into, other, (), replaced)
    into.places = {p: place for p, place in into.places.items() if not _below(p, replaced)}
    into.places.update({p: place for p, place in other.places.items() if _below(p, replaced)})


def _put_above(into: Source, other: Source, path: Path, replaced: set[Path]) -> None:
    """Merge the tables at `path`; paths whose values are taken from `other` are added to `replaced`."""
    below, above = _at(into.values, path), _at(other.values, path)
    for key, value in above.items():
        old, here = below.get(key), (*path, key)
        same_thing = isinstance(old, dict) and isinstance(value, dict)
        if same_thing and old.get("kind", value.get("kind")) == value.get("kind", old.get("kind")):
            into.places[here] = other.place(here)
            _put_above(into, other, here, replaced)
            continue
        below[key] = value
        replaced.add(here)


def _below(path: Path, places: set[Path]) -> bool:
    return any(path[:n] in places for n in range(1, len(path) + 1))


def _at(values: Any, path: Path) -> Any:
    for key in path:
        values = values[key]
    return values


# --- settings


def _set(source: Source, setting: str) -> None:
    name, equals, text = setting.partition("=")
    place = Place(f"--set {setting}", FilePath.cwd())
    if not equals or not name.strip() or not setting.isprintable():
        raise InputError(f"{place}: write --set NAME=VALUE, for example --set upper.load=2000")
    try:
        path = max(parse(f"{name} = 0", "--set", FilePath.cwd()).places, key=len)
    except InputError:
        raise InputError(f"{place}: {name!r} is not a dotted name") from None
    for candidate in (("parameters", *path), path):
        if _exists(source.values, candidate):
            _replace(source, candidate, text.strip(), place)
            return
    parent = path[:-1]
    if path[0] != "parameters" and parent and isinstance(_get(source.values, parent), dict):
        _replace(source, path, text.strip(), place)  # a key that the file omits; checked later against the schema
        return
    known = [dotted(p) for p in _leaves(source.values.get("parameters", {}), ())]
    known += [dotted(p) for p in _leaves(source.values, ()) if p[0] != "parameters"]
    close = get_close_matches(dotted(path), known, n=3)
    hint = (
        f"did you mean {', '.join(map(repr, close))}?" if close else "parameters are defined in the table [parameters]"
    )
    raise InputError(f"{place}: there is no parameter or key {dotted(path)!r}; {hint}")


def _replace(source: Source, path: Path, text: str, place: Place) -> None:
    parent = _at(source.values, path[:-1])
    missing = object()
    old = parent.get(path[-1], missing)
    try:
        value = text if is_expression(text) else parse(f"v = {text}", "--set", place.folder).values["v"]
    except InputError:
        if not isinstance(old, str) and old is not missing:
            raise InputError(f"{place}: {text!r} is not {TYPES[type(old)]}") from None
        value = text
    if old is not missing and not is_expression(old) and not is_expression(value):
        value = _kept_type(value, old, text, place)
    parent[path[-1]] = value
    for known in [p for p in source.places if p[: len(path)] == path]:
        del source.places[known]
    source.places[path] = place


def _kept_type(value: Any, old: Any, text: str, place: Place) -> Any:
    if isinstance(old, float) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if isinstance(old, str) and not isinstance(value, str) and not isinstance(value, list | dict):
        return text
    if isinstance(old, list) and isinstance(value, list):
        floats = any(isinstance(entry, float) for entry in old)
        return [float(v) if floats and type(v) is int else v for v in value]
    if type(value) is not type(old):
        raise InputError(f"{place}: {text!r} is not {TYPES[type(old)]}, the type of the value in the file ({old!r})")
    return value


def _exists(values: Any, path: Path) -> bool:
    return _get(values, path) is not None


def _get(values: Any, path: Path) -> Any:
    for key in path:
        if not isinstance(values, dict) or key not in values:
            return None
        values = values[key]
    return values


def _leaves(values: Any, path: Path) -> list[Path]:
    if not isinstance(values, dict):
        return [path]
    return [leaf for key, value in values.items() for leaf in _leaves(value, (*path, key))]


# --- parameters


def resolved(source: Source) -> Source:
    """The document without its parameters and with every expression evaluated."""
    parameters = source.values.pop("parameters", {})
    if not isinstance(parameters, dict):
        raise InputError(f"{source.place(('parameters',))}: parameters must be a table")
    names = [dotted(leaf) for leaf in _leaves(parameters, ())]
    busy: list[str] = []
    done: dict[str, Any] = {}
    sizes: dict[int, int] = {}  # of the lists in `done`, by their identity

    def parameter(name: str) -> Any:
        path = tuple(name.split("."))
        value = _get(parameters, path)
        if value is None:
            raise InputError(f"there is no parameter {name!r}{suggestion(name, names)}")
        if name in busy:
            raise InputError(f"parameter {name!r} depends on itself, through {', '.join(busy)}")
        if name not in done:
            busy.append(name)
            done[name] = worked_out(value, ("parameters", *path))
            busy.pop()
            if _size(done[name], sizes) > MOST_VALUES:
                raise InputError(f"parameter {name!r} contains more than {MOST_VALUES} values")
        return done[name]

    def worked_out(value: Any, path: Path) -> Any:
        if isinstance(value, dict):
            return {key: worked_out(entry, (*path, key)) for key, entry in value.items()}
        if isinstance(value, list):
            return [worked_out(entry, (*path, index)) for index, entry in enumerate(value)]
        if not is_expression(value):
            return value
        try:
            found = evaluate(value, parameter)
        except RecursionError:
            raise InputError(f"{source.place(path)}: parameters depend on each other too deeply") from None
        except InputError as error:
            if len(busy) > 0:  # report the line of the definition, not of the use
                raise _Placed.of(error, source.place(path)) from None
            raise InputError(str(_Placed.of(error, source.place(path)))) from None
        if isinstance(found, int) and abs(found) > LARGEST_INTEGER:
            raise InputError(f"{source.place(path)}: {value!r} is an integer of more than 64 bits")
        return found

    for leaf in _leaves(parameters, ()):
        worked_out(_get(parameters, leaf), ("parameters", *leaf))
    whole = {key: worked_out(value, (key,)) for key, value in source.values.items()}
    if _size(whole, sizes) > MOST_VALUES:
        raise InputError(f"{source.place(())}: contains more than {MOST_VALUES} values, with parameters substituted")
    return Source(whole, source.places)


def _size(value: Any, known: dict[int, int]) -> int:
    """Number of values in `value`; shared lists count once per occurrence. `known`: counts by identity of objects that
    remain referenced."""
    if not isinstance(value, list | dict):
        return 1
    if id(value) not in known:
        known[id(value)] = sum(_size(v, known) for v in (value.values() if isinstance(value, dict) else value))
    return known[id(value)]


class _Placed(InputError):
    """An error whose message begins with its place already."""

    @classmethod
    def of(cls, error: InputError, place: Place) -> _Placed:
        return error if isinstance(error, cls) else cls(f"{place}: {error}")


# --- output as text


def to_toml(values: dict[str, Any]) -> str:
    """TOML text with these values: one header per table, nested tables inline."""
    lines = []
    plain = {key: value for key, value in values.items() if not isinstance(value, dict)}
    lines += [f"{_key(key)} = {_inline(value)}" for key, value in plain.items()]
    for section, table in values.items():
        if not isinstance(table, dict):
            continue
        if all(isinstance(entry, dict) for entry in table.values()) and table:
            for name, entries in table.items():
                lines += ["", f"[{_key(section)}.{_key(name)}]"]
                lines += [f"{_key(key)} = {_inline(value)}" for key, value in entries.items()]
        else:
            lines += ["", f"[{_key(section)}]", *(f"{_key(key)} = {_inline(value)}" for key, value in table.items())]
    return "\n".join(lines).strip() + "\n"


def _inline(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_inline(entry)}" for key, entry in value.items()) + "}"
    return repr(value)


def _key(key: str) -> str:
    bare = key.replace("_", "a").replace("-", "a")
    return key if bare.isascii() and bare.isalnum() else _quoted(key)


def _quoted(text: str) -> str:
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(escapes.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text) + '"'


class Refused(InputError):
    """An error whose message begins with its place already."""


def refused_place(source: Source, path: Path, table: Any, message: str) -> Place:
    """The place in the table at `path` that the message refers to: the first quoted name that is a key or a text
    there, or else the longest key that is a word of the message, or else the table."""
    quoted, named = len(message), ""
    found = worded = path
    for below, words in _words(table, path):
        for word in words:
            quote = re.search(rf"{re.escape(repr(word))}(?!:)", message)  # 'name': is the subject of the message
            at = quote.start() if quote else quoted
            if at < quoted:
                quoted, found = at, below
        key = str(below[-1])
        if len(key) > len(named) and re.search(rf"(?<![\w.'\"]){re.escape(key)}(?![\w'\"])", message):
            named, worded = key, below
    return source.place(found if quoted < len(message) else worded)


def _words(value: Any, path: Path) -> Iterator[tuple[Path, list[str]]]:
    """Every path below `path` with its key and its text."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield (*path, key), [word for word in (key, entry) if isinstance(word, str)]
        yield from _words(entry, (*path, key))
