"""Construction of a `Scene` from a document: all tables are checked, then the calls are made in order.

All checks, those of references included, precede the calls, because the reduction of a body takes time. An error that
a call raises is reported with the line of the key that its message names, or of the table.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Any

from warpffrf.model.errors import InputError, suggestion
from warpffrf.scene_file.document import Refused, refused_place
from warpffrf.scene_file.forms import (
    Form,
    brief,
    choose,
    contact_kinds,
    estimated_elements,
    fixed_forms,
    item_kinds,
    law_kinds,
    shape_kinds,
    shown,
    signal_kinds,
    value_kinds,
)
from warpffrf.scene_file.numbers import read_numbers
from warpffrf.scene_file.object_cache import MADE_OF, SECTIONS, Kept
from warpffrf.scene_file.source import Path, Source

TITLE = "title"
RUNS = ("equilibrium", "static", "simulate")  # calls that run the scene, each a table
FITTED = "fitted"  # a contact surface whose shape is fitted
FILE_KEYS = {"file", "column", "factor"}
PAIRS = ("gear_pairs", "cams", "wheelsets", "journal_bearings", "thrust_bearings")  # assemblies
FIRST_ITEMS = ("joints", "contacts")  # other items refer to them
WHOLE = ("interface", "point", "surface")


class Builder:
    """Builder of the scene of one document; `scene` is set by `build()`."""

    def __init__(self, source: Source, kept: Kept | None = None) -> None:
        """kept: meshes and reduced bodies of earlier scenes, reused where their definition is unchanged."""
        self.source, self.kept = source, kept
        self.fixed, self.items, self.values = fixed_forms(), item_kinds(), value_kinds()
        self.made: dict[str, dict[str, Any]] = {}  # section -> name -> object
        self.making: set[tuple[str, str]] = set()  # section and name of the objects under construction
        self.files: dict[Path, FilePath] = {}  # input files and their locations
        self.scene: Any = None
        self._check()

    # --- checking

    def _check(self) -> None:
        values = self.source.values
        sections = {**{s: self.fixed[s] for s in ("materials", "meshes", "reduced_bodies")}, "signals": signal_kinds()}
        sections["ground"] = shape_kinds()  # its surfaces
        self.sections = {**sections, **{s: self.fixed[s] for s in ("bodies", "bearings", *PAIRS)}, **self.items}
        known = (TITLE, "include", "parameters", "scene", *self.sections, "arrange", *RUNS)
        for key, table in values.items():
            if key not in known:
                raise InputError(f"{self.source.place((key,))}: unknown key {key!r}{suggestion(key, known)}")
            if key == TITLE and not isinstance(table, str):
                raise InputError(f"{self.source.place((key,))}: title must be a text, got {brief(table)}")
            if key == "arrange" and not isinstance(table, list):
                raise InputError(f"{self.source.place((key,))}: arrange must be a list of tables, [[arrange]]")
            if key not in (TITLE, "arrange") and not isinstance(table, dict):
                raise InputError(f"{self.source.place((key,))}: {key} must be a table, got {brief(table)}")
        for section in self.sections:
            for name, table in values.get(section, {}).items():
                self._check_table((section, name), table, self._form((section, name), table))
        for section in ("scene", *RUNS):
            if section in values:
                self._check_table((section,), values[section], self.fixed[section][""])
        for index, table in enumerate(values.get("arrange", [])):
            path: Path = ("arrange", index)
            self._check_table(path, table, choose(self.source, path, table, self.fixed["arrange"]))

    def _form(self, path: Path, table: Any) -> Form:
        section, default = str(path[0]), None
        if isinstance(table, dict) and section == "bodies":
            default = "rigid" if "mass" in table or "inertia_tensor" in table else "flexible"
        if isinstance(table, dict) and section == "reduced_bodies":
            default = "load" if "path" in table else "reduce"
        return choose(self.source, path, table, self.sections[section], default)

    def _check_table(self, path: Path, table: dict[str, Any], form: Form) -> None:
        chosen = () if form.alone else ("kind",)
        form.check(self.source, path, {key: value for key, value in table.items() if key not in chosen})
        for key, role in form.roles.items():
            if key in table:
                self._check_role((*path, key), table[key], role)

    def _check_role(self, path: Path, value: Any, role: str) -> None:
        if role == "port":
            self._check_port(path, value)
        elif role == "materials" and isinstance(value, dict):
            for part, name in value.items():
                self._named((*path, part), name, role)
        elif role == "stages":
            self._check_stages(path, value)
        elif role in self.sections:
            self._named(path, value, role)
        elif role != "path":
            self._check_value(path, value, role)

    def _check_stages(self, path: Path, stages: Any) -> None:
        if not isinstance(stages, list):
            raise InputError(f"{self.source.place(path)}: stages must be a list of tables, [[simulate.stages]]")
        for index, table in enumerate(stages):
            here = (*path, index)
            form = choose(self.source, here, table, self.fixed["stages"])
            self._check_table(here, table, form)
            overrides = table.get("overrides", {})
            if not isinstance(overrides, dict):
                raise InputError(f"{self.source.place((*here, 'overrides'))}: overrides must be a table")
            forces = overrides.get("forces", {})
            for name, changes in forces.items() if isinstance(forces, dict) else ():
                where = (*here, "overrides", "forces", name)
                whole = self._overridden(where, name, changes)
                self._check_table(where, whole, self._form(("forces", name), whole))

    def _overridden(self, path: Path, name: str, changes: Any) -> dict[str, Any]:
        """The table of a force with the overrides of a stage."""
        self._named(path, name, "forces")
        if not isinstance(changes, dict):
            raise InputError(f"{self.source.place(path)}: {shown(path)} must be a table, got {brief(changes)}")
        return {**self.source.values["forces"][name], **changes}

    def _check_value(self, path: Path, value: Any, role: str) -> None:
        laws = law_kinds().get((str(path[0]), str(path[-1]))) if len(path) == 3 else None
        if laws is not None and isinstance(value, str | dict) and not (isinstance(value, dict) and "kind" in value):
            number = "a number or " if path[-1] == "friction" else ""
            raise InputError(
                f"{self.source.place(path)}: {shown(path[:-1])}: {path[-1]} must be {number}a table {{kind = ...}}, "
                f"kind one of {', '.join(map(repr, laws))}, got {brief(value)}"
            )
        if isinstance(value, dict) and "kind" in value:
            kinds = contact_kinds() if role == "shapes" else laws or self.values
            if role == "shapes" and path[-1] == "contact":
                kinds = {"gear_surfaces": self.values["gear_surfaces"]}
            kinds = shape_kinds() if path[2:3] == ("surfaces",) and len(path) == 4 else kinds
            form = choose(self.source, path, value, kinds)
            self._check_table(path, value, form)
        elif isinstance(value, dict) or isinstance(value, list):
            for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
                self._check_value((*path, key), entry, role)
        elif role == "value" and isinstance(value, str):
            self._reference_check(path, value)
        elif role == "shapes" and isinstance(value, str) and value != FITTED and value not in contact_kinds():
            kinds = (FITTED, *contact_kinds())
            raise InputError(f"{self.source.place(path)}: there is no surface {value!r}{suggestion(value, kinds)}")

    def _reference_check(self, path: Path, value: str) -> None:
        if value not in self.source.values.get("signals", {}):
            try:
                self._port_parts(path, value)
            except InputError:
                signals = tuple(self.source.values.get("signals", {}))
                raise InputError(
                    f"{self.source.place(path)}: {value!r} names no signal and no port of a "
                    f"body{suggestion(value, signals)}"
                ) from None

    def _named(self, path: Path, name: Any, section: str) -> str:
        """`name` if the section has it. Raises `InputError` with near matches."""
        known = tuple(self.source.values.get(section, {}))
        if not isinstance(name, str):
            raise InputError(f"{self.source.place(path)}: {path[-1]} must be a name in [{section}], got {brief(name)}")
        if name not in known:
            raise InputError(f"{self.source.place(path)}: there is no {name!r} in [{section}]{suggestion(name, known)}")
        return name

    def _check_port(self, path: Path, value: Any) -> None:
        """Raises `InputError` for a port that does not exist, as far as this is known before bodies are constructed."""
        body, part, _ = self._port_parts(path, value)
        known = tuple(self.source.values.get("ground", {}))
        if body == "ground" and part is not None and part not in known:
            raise InputError(
                f"{self.source.place(path)}: the ground has no surface {part!r}{suggestion(part, known)}; a table "
                "[ground.NAME] defines one"
            )

    def _port_parts(self, path: Path, value: Any) -> tuple[str, str | None, Any]:
        """Body, interface or surface, and point of "body.name", "ground" or {body, interface | surface | point}."""
        bodies = ("ground", *self.source.values.get("bodies", {}), *self._bodies_of_assemblies())
        place = self.source.place(path)
        if isinstance(value, dict):
            keys = ("body", *WHOLE)
            for key in value:
                if key not in keys:
                    raise InputError(f"{self.source.place((*path, key))}: unknown key {key!r}{suggestion(key, keys)}")
            body, names = value.get("body"), [value[key] for key in ("interface", "surface") if key in value]
            if not isinstance(body, str) or body not in bodies:
                raise InputError(f"{place}: there is no body {body!r}{suggestion(str(body), bodies)}")
            if len([key for key in WHOLE if key in value]) > 1 or not all(isinstance(name, str) for name in names):
                raise InputError(f"{place}: give one of interface = 'NAME', surface = 'NAME', point = [x, y, z]")
            return body, names[0] if names else None, value.get("point")
        if not isinstance(value, str):
            raise InputError(f"{place}: {path[-1]} must be 'body.interface' or {{body, point}}, got {brief(value)}")
        if value in bodies:
            return value, None, None
        owners = [body for body in bodies if value.startswith(body + ".")]
        if not owners:
            body = value.split(".")[0]
            raise InputError(f"{place}: there is no body {body!r}{suggestion(body, bodies)}")
        body = max(owners, key=len)
        return body, value[len(body) + 1 :], None

    def _bodies_of_assemblies(self) -> Iterator[str]:
        """Names of the bodies that the tables [wheelsets], [journal_bearings], [thrust_bearings] and [bearings] create,
        of rings on a surface too, which cannot be distinguished from interfaces before bodies are made."""
        for name in self.source.values.get("wheelsets", {}):
            yield from (name, f"{name} left rail", f"{name} right rail")
        with_pads = [self.source.values.get(f"{kind}_bearings", {}) for kind in ("journal", "thrust")]
        for name, table in (item for tables in with_pads for item in tables.items()):
            pads = table.get("pads") if isinstance(table, dict) else None
            count = pads.get("count") if isinstance(pads, dict) else len(pads) if isinstance(pads, list) else 0
            yield from (name, *(f"{name} pad {i + 1}" for i in range(count if type(count) is int else 0)))
        whole = ("ground", *self.source.values.get("bodies", {}))
        for name, table in self.source.values.get("bearings", {}).items():
            if not isinstance(table, dict):
                continue
            sides = (side for side in ("inner", "outer") if table.get(side) not in whole)
            yield from (f"{name} {side} ring" for side in sides)
            count, rows = table.get("elements"), table.get("rows", 1)
            number = count * rows if type(count) is int and type(rows) is int else 0
            number = number or estimated_elements(table.get("catalogue"))
            yield from (f"{name} {table.get('kind')} {i + 1}" for i in range(number))
            yield f"{name} cage"

    # --- building

    def build(self) -> Any:
        """Build the scene. Raises `InputError` with the line of the invalid entry."""
        from warpffrf.model.scene import Scene

        values = self.source.values
        for section in ("materials", "meshes", "reduced_bodies", "signals"):
            for name in values.get(section, {}):
                self._object(section, name)
        table = values.get("scene", {})
        with self._blamed(("scene",), table):
            self.scene = Scene(**self._arguments(("scene",), table, self.fixed["scene"][""]))
        for name, table in values.get("ground", {}).items():
            with self._blamed(("ground", name), table):
                form = self._form(("ground", name), table)
                shape = form.call(**self._arguments(("ground", name), table, form))
                self.scene.ground.surface(shape, name=name)
        for name, table in values.get("bodies", {}).items():
            form = self._form(("bodies", name), table)
            with self._blamed(("bodies", name), table):
                arguments = self._arguments(("bodies", name), table, form)
                self._keep("bodies", name, form.call(self.scene, **arguments, name=name))
        for name, table in values.get("bearings", {}).items():
            form = self._form(("bearings", name), table)
            with self._blamed(("bearings", name), table):
                arguments = self._arguments(("bearings", name), table, form)
                bearing = self._keep("bearings", name, form.call(self.scene, name, **arguments))
                for body in (bearing.inner, bearing.outer, *bearing.between):
                    self.made.setdefault("bodies", {}).setdefault(body.name, body)
        for section in PAIRS:
            for name, table in values.get(section, {}).items():
                form = self._form((section, name), table)
                with self._blamed((section, name), table):
                    arguments = self._arguments((section, name), table, form)
                    before = len(self.scene.bodies)
                    self._keep(section, name, form.call(self.scene, name=name, **arguments))
                for body in self.scene.bodies[before:]:
                    self.made.setdefault("bodies", {})[body.name] = body
        for section in sorted(self.items, key=lambda section: section not in FIRST_ITEMS):
            for name, table in values.get(section, {}).items():
                with self._blamed((section, name), table):
                    self._keep(section, name, self.scene.add(self._item((section, name), table, name)))
        for index, table in enumerate(values.get("arrange", [])):
            path: Path = ("arrange", index)
            form = choose(self.source, path, table, self.fixed["arrange"])
            with self._blamed(path, table):
                form.call(self.scene, **self._arguments(path, table, form))
        return self.scene

    def _item(self, path: Path, table: dict[str, Any], name: str) -> Any:
        form = self._form((path[0], name) if path[0] in self.items else ("forces", name), table)
        return form.call(**self._arguments(path, table, form), name=name)

    def run_arguments(self, section: str) -> dict[str, Any] | None:
        """Arguments of `simulate`, `static` or `equilibrium`, None without such a table; paths as written."""
        if section not in self.source.values:
            return None
        table = self.source.values[section]
        with self._blamed((section,), table):
            form = self.fixed[section][""]
            arguments = form.call(**self._arguments((section,), table, form))
        start = arguments.get("start")
        if isinstance(start, str) and FilePath(start).suffix:
            arguments["start"] = self._file((section, "start"), start)
        return arguments

    def document(self) -> dict[str, Any]:
        """The values of the document, with absolute paths of input files, so that they hold in any folder."""
        values = copy.deepcopy(self.source.values)
        for path, file in self.files.items():
            parent: Any = values
            for key in path[:-1]:
                parent = parent.get(key, {}) if isinstance(parent, dict) else parent[key]
            if path[-1] in parent:
                parent[path[-1]] = str(file.absolute())
        return values

    def _file(self, path: Path, name: str) -> FilePath:
        """An input file; its path is relative to the file that names it."""
        self.files[path] = self.source.place(path).folder / FilePath(name).expanduser()
        return self.files[path]

    def _keep(self, section: str, name: str, thing: Any) -> Any:
        self.made.setdefault(section, {})[name] = thing
        return thing

    def _object(self, section: str, name: str) -> Any:
        """The material, mesh, reduced body or signal of this name, constructed on first use."""
        if name in self.made.get(section, {}):
            return self.made[section][name]
        if (section, name) in self.making:
            raise InputError(f"[{section}.{name}] depends on itself; name another one in its table")
        if self.kept is not None and section in SECTIONS and (found := self.kept.find(self._recipe(section, name))):
            thing, files = found
            self.files |= files
            return self._keep(section, name, thing)
        self.making.add((section, name))
        thing = self._keep(section, name, self._made(section, name))
        if self.kept is not None and section in SECTIONS:
            files = {path: file for path, file in self.files.items() if path[0] in MADE_OF}
            self.kept.keep(self._recipe(section, name), thing, files)
        return thing

    def _recipe(self, section: str, name: str) -> str:
        """Cache key of an object: its name, and all tables that may define it."""
        tables = {part: self.source.values.get(part) for part in MADE_OF[: MADE_OF.index(section) + 1]}
        return json.dumps([section, name, str(self.source.place((section, name)).folder), tables], default=str)

    def _made(self, section: str, name: str) -> Any:
        """Construct the object of this name."""
        path, table = (section, name), self.source.values[section][name]
        form = self._form(path, table)
        with self._blamed(path, table):
            arguments = self._arguments(path, table, form)
            if section == "materials" or form.title == "matrices":
                arguments["name"] = name
            if form.title == "reduction" and "material" not in arguments:
                arguments["material"] = arguments["mesh"].materials or None
            return form.call(**arguments)

    def _arguments(self, path: Path, table: dict[str, Any], form: Form) -> dict[str, Any]:
        return {
            key: self._argument((*path, key), value, form.roles[key])
            for key, value in table.items()
            if key in form.roles
        }

    def _argument(self, path: Path, value: Any, role: str) -> Any:
        if role == "port":
            return self._port(path, value)
        if role == "path":
            return self._file(path, value) if isinstance(value, str) else self._value(path, value, role)
        if role == "materials" and isinstance(value, dict):
            return {part: self._object(role, name) for part, name in value.items()}
        if role in ("materials", "meshes", "reduced_bodies"):
            return self._object(role, value)
        if role in self.sections:
            if value not in self.made.get(role, {}):
                raise InputError(f"{path[-1]}: {value!r} is defined later in [{role}]; write it first")
            return self.made[role][value]
        if role == "stages":
            return [self._stage((*path, index), table) for index, table in enumerate(value)]
        if role == "shapes" and isinstance(value, dict) and "kind" not in value:
            return {name: self._shape((*path, name), shape) for name, shape in value.items()}
        return self._value(path, value, role)

    def _stage(self, path: Path, table: dict[str, Any]) -> Any:
        with self._blamed(path, table):
            return self.fixed["stages"][""].call(**self._arguments(path, table, self.fixed["stages"][""]))

    def _shape(self, path: Path, value: Any) -> Any:
        if value == FITTED:
            return None
        return self.values[value].call() if isinstance(value, str) else self._value(path, value, "shapes")

    def _value(self, path: Path, value: Any, role: str) -> Any:
        """A value with its objects, files and references resolved."""
        if isinstance(value, dict):
            if "kind" in value:
                form = choose(self.source, path, value, self.values)
                with self._blamed(path, value):
                    return form.call(**self._arguments(path, value, form))
            if "file" in value and set(value) <= FILE_KEYS:
                if not isinstance(value["file"], str):
                    raise InputError(f"file must be a text, got {brief(value['file'])}")
                file = self._file((*path, "file"), value["file"])
                return read_numbers(file, value.get("column"), value.get("factor"))
            if role == "overrides" and path[-1] == "forces":
                return {
                    name: self._item((*path, name), self._overridden((*path, name), name, changes), name)
                    for name, changes in value.items()
                }
            return {key: self._value((*path, key), entry, role) for key, entry in value.items()}
        if isinstance(value, list):
            return [self._value((*path, index), entry, role) for index, entry in enumerate(value)]
        if role == "value" and isinstance(value, str):
            if value in self.source.values.get("signals", {}):
                return self._object("signals", value)
            return self._port(path, value)
        return value

    def _port(self, path: Path, value: Any) -> Any:
        name, part, point = self._port_parts(path, value)
        body = self.scene.ground if name == "ground" else self.made["bodies"].get(name)
        if body is None:
            raise Refused(f"{self.source.place(path)}: {shown(path[:-1])}: there is no body {name!r} here yet")
        try:
            if part is not None:
                return body[part]
            return body if point is None else body.at(point)
        except InputError as error:
            raise Refused(f"{self.source.place(path)}: {shown(path[:-1])}: {error}") from error

    @contextmanager
    def running(self, section: str) -> Iterator[None]:
        """Prefix errors of `simulate`, `static` or `equilibrium` with the line in the file."""
        try:
            yield
        except InputError as error:
            table = self.source.values[section]
            raise Refused(
                f"{refused_place(self.source, (section,), table, str(error))}: {shown((section,))}: {error}"
            ) from error
        except MemoryError as error:
            raise Refused(
                f"{self.source.place((section,))}: {shown((section,))}: there is not enough memory ({error}); save "
                "fewer rows, or make meshes and grids coarser"
            ) from error

    @contextmanager
    def _blamed(self, path: Path, table: Any) -> Iterator[None]:
        """Prefix errors of a call with the line in the file."""
        try:
            yield
        except Refused:
            raise
        except InputError as error:
            raise Refused(f"{refused_place(self.source, path, table, str(error))}: {shown(path)}: {error}") from error
        except (TypeError, ValueError, OverflowError, MemoryError) as error:
            raise Refused(f"{self.source.place(path)}: {shown(path)} cannot be used: {error}") from error
