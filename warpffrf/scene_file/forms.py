"""Schema of the tables of a scene file, derived from the signatures of the Python calls that they represent.

A `Form` is a call and its arguments. Types come from the annotations and are checked by pydantic: numbers, texts, lists
and tables strictly, everything else when the call is made. An argument that refers to another object of the scene has a
role, found by its name (`a`, `b`, `port`, `joint`, ...) or its annotation (`Joint`). Joints, forces, sensors, drives,
contacts and films are found as the classes with a `scene_list`; signals, surfaces, bases,
damping and integrators are found in their modules. A class added to its module is a new `kind` here.
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, wraps
from types import ModuleType
from typing import Any, NotRequired

from warpffrf.model.errors import InputError, suggestion
from warpffrf.model.gears.gear import FLANKS
from warpffrf.model.renamed import REPLACED
from warpffrf.scene_file.source import Path, Source

PORTS = ("a", "b", "port", "onto", "first", "second")  # arguments that are ports of bodies
NAMED = {"joint": "joints", "contact": "contacts", "body": "bodies", "sensor": "sensors"}  # role -> section
PATHS = ("path", "M", "K")
ITEM_MODULES = ("joints", "forces", "sensors", "contact", "lumped_contact", "films")  # of warpffrf.model
ABSTRACT = ("joint", "force", "sensor")  # kinds of base classes
WORDS = {
    "float_type": "must be a number", "int_type": "must be a whole number", "bool_type": "must be true or false",
    "int_from_float": "must be a whole number", "string_type": "must be a text", "list_type": "must be a list",
    "dict_type": "must be a table", "literal_error": "has no such value", "finite_number": "must be finite",
}  # fmt: skip
_TYPES: dict[str, Any] = {"float": float, "int": int, "bool": bool, "str": str, "Characteristic": dict}
_TEXTS = ("Path", "os.PathLike[str]")
_WORDS = "Literal"
_TABLES = ("Mapping", "dict")
_LISTS = ("Sequence", "list", "tuple")


@dataclass(frozen=True)
class Form:
    """A call as a table: `roles` argument -> what its value refers to, "" for plain values."""

    title: str  # for messages: what the table describes
    call: Callable[..., Any]
    roles: dict[str, str]
    adapter: Any  # pydantic TypeAdapter of the whole table
    alone: bool = False  # the only form of its section: its table has no key `kind`

    def check(self, source: Source, path: Path, table: dict[str, Any]) -> None:
        """Raises `InputError`, with the line, for an unknown key, a missing one, or a value of the wrong type."""
        from pydantic import ValidationError

        try:
            self.adapter.validate_python(table)
        except ValidationError as error:
            wrong = sorted(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden")
            told: dict[Any, str] = {}  # one message per place, for unions of types too
            for one in wrong:  # a misspelt key explains a missing key
                place = (one["loc"][:1], *(part for part in one["loc"] if isinstance(part, int)))
                told.setdefault(place, self._told(source, path, one))
            found = list(told.values())
            raise InputError(found[0] + (f" (and {len(found) - 1} more)" if len(found) > 1 else "")) from None

    def _told(self, source: Source, path: Path, error: Any) -> str:
        key = str(error["loc"][0]) if error["loc"] else ""
        here = (*path, *error["loc"])
        what = f"{source.place(here if error['type'] != 'missing' else path)}: {shown(path)}"
        if error["type"] == "extra_forbidden":
            hint = REPLACED.get((self.title, key)) or suggestion(key, tuple(self.roles))
            return f"{what}: unknown key {key!r}{hint}"
        if error["type"] == "missing":
            return f"{what}: the key {key!r} is missing"
        words = WORDS.get(error["type"], error["msg"][:1].lower() + error["msg"][1:])
        inner = "".join(f"[{n}]" for n in error["loc"][1:] if isinstance(n, int))
        return f"{what}: {key}{inner} {words}, got {brief(error['input'])}"


def brief(value: Any) -> str:
    """A value for a message."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def shown(path: Path) -> str:
    """The header of a table, for messages: [joints.hinge]."""
    return f"[{'.'.join(str(key) for key in path)}]"


def form_of(title: str, call: Callable[..., Any], roles: dict[str, str], leave_out: tuple[str, ...] = ()) -> Form:
    """The form of `call`. roles: of arguments whose names and annotations do not determine them. leave_out: arguments
    that the program sets."""
    from pydantic import ConfigDict, TypeAdapter
    from typing_extensions import TypedDict  # pydantic rejects typing.TypedDict before Python 3.12

    fields: dict[str, Any] = {}
    found: dict[str, str] = {}
    for name, parameter in inspect.signature(call).parameters.items():
        if name in leave_out or parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        annotation = parameter.annotation if isinstance(parameter.annotation, str) else ""
        found[name] = roles.get(name, "materials" if re.search(r"\bMaterial\b", annotation) else "")
        needed = parameter.default is inspect.Parameter.empty
        kind = _type_of(annotation) if not found[name] else str if found[name] in ("joints", "contacts") else Any
        fields[name] = kind if needed else NotRequired[kind]
    table = TypedDict(title.replace(" ", "_"), fields)  # pyright: ignore
    config = ConfigDict(extra="forbid", strict=True, arbitrary_types_allowed=True)
    setattr(table, "__pydantic_config__", config)  # noqa: B010 (TypedDict as a call has no other way)
    return Form(title, call, found, TypeAdapter(table))


def flat(call: Callable[..., Any], **objects: Callable[..., Any]) -> Callable[..., Any]:
    """`call` that takes the fields of the option `objects` (argument -> class) in place of these: a flat table."""
    kept = inspect.signature(call).parameters
    fields = {name: inspect.signature(cls).parameters for name, cls in objects.items()}
    added = [p.replace(kind=p.KEYWORD_ONLY) for own in fields.values() for p in own.values()]

    @wraps(call)
    def flattened(*args: Any, **given: Any) -> Any:
        for name, own in fields.items():
            if values := {key: given.pop(key) for key in own if key in given}:
                given[name] = objects[name](**values)
        return call(*args, **given)

    parameters = [*(p for name, p in kept.items() if name not in objects), *added]
    setattr(flattened, "__signature__", inspect.Signature(parameters))  # noqa: B010 (functions have no such attribute)
    return flattened


def listed(kind: type) -> Callable[..., Any]:
    """A geometry of bearings, `kind`, or with `catalogue` that of a designation, some of whose estimates are replaced
    by the other fields. Raises `InputError` for fields that are missing without a designation."""
    from warpffrf.model.bearings import catalogue as geometry_of

    own = inspect.signature(kind).parameters

    def made(*, catalogue: str | None = None, **given: Any) -> Any:
        if catalogue is not None:
            found = geometry_of(catalogue, **given)
            if not isinstance(found, kind):
                raise InputError(
                    f"catalogue: {catalogue!r} is a {type(found).__name__}, not a {kind.__name__}; correct the kind"
                )
            return found
        for name, parameter in own.items():
            if parameter.default is inspect.Parameter.empty and name not in given:
                raise InputError(f'the key {name!r} is missing; give it, or a designation, such as catalogue = "6310"')
        return kind(**given)

    designation = inspect.Parameter("catalogue", inspect.Parameter.KEYWORD_ONLY, default=None, annotation="str | None")
    optional = [p.replace(default=None) for p in own.values()]
    setattr(made, "__signature__", inspect.Signature([designation, *optional]))  # noqa: B010
    return made


def with_sets(call: Callable[..., Any]) -> Callable[..., Any]:
    """`call`, which makes a mesh, with the facet sets `sets` in addition: {name: arguments of `Mesh.select_box`}."""
    from warpffrf.model.mesh import Mesh

    @wraps(call)
    def made(*, sets: dict[str, Any] | None = None, **given: Any) -> Any:
        mesh = call(**given)
        for name, box in (sets or {}).items():
            known = tuple(inspect.signature(Mesh.select_box).parameters)[2:]
            if not isinstance(box, dict) or not set(box) <= set(known):
                raise InputError(f"sets: {name!r} must be a table with {', '.join(known)}, got {brief(box)}")
            mesh = mesh.select_box(name, **box)
        return mesh

    own = inspect.Parameter("sets", inspect.Parameter.KEYWORD_ONLY, default=None, annotation="dict | None")
    parameters = (p.replace(kind=p.KEYWORD_ONLY) for p in inspect.signature(call).parameters.values())
    setattr(made, "__signature__", inspect.Signature([*parameters, own]))  # noqa: B010
    return made


def estimated_elements(designation: Any) -> int:
    """Number of elements of a bearing of the catalogue; 0 of an unknown one, which is refused when it is made."""
    from warpffrf.model.bearings.designations import boundary, estimate

    try:
        inside = estimate(boundary(designation))
        return inside["elements"] * inside.get("rows", 1)
    except InputError:
        return 0


def arguments_of(call: Callable[..., Any]) -> Callable[..., dict[str, Any]]:
    """Takes the arguments of `call` and returns them."""

    @wraps(call)
    def arguments(**given: Any) -> dict[str, Any]:
        return given

    return arguments


def staged(call: Callable[..., Any]) -> Callable[..., Any]:
    """`call` whose duration may be given as `stages`."""

    @wraps(call)
    def with_stages(*, stages: Any = None, **given: Any) -> Any:
        if stages is None:
            return call(**given)
        for name in ("duration", "step"):
            if name in given:
                raise InputError(f"stages have their own {name}; leave that of the run out")
        return call(duration=stages, **given)

    parameters = inspect.signature(call).parameters
    own = inspect.Parameter("stages", inspect.Parameter.KEYWORD_ONLY, default=None)
    both = {**parameters, "duration": own.replace(name="duration", annotation="float | None"), "stages": own}
    setattr(with_stages, "__signature__", inspect.Signature([p.replace(kind=own.kind) for p in both.values()]))  # noqa: B010
    return with_stages


def _type_of(annotation: str) -> Any:
    """The pydantic type of an annotation's text; Any for types that are not plain. TOML has no None."""
    kinds = []
    for part in (part.strip() for part in _split(annotation)):
        if part in _TYPES:
            kinds.append(_TYPES[part])
        elif part in _TEXTS or part.startswith(_WORDS):
            kinds.append(str)
        elif part.startswith(_TABLES):
            kinds.append(dict)
        elif part.startswith(_LISTS):
            kinds.append(list)
        elif part != "None":
            return Any
    if not kinds:
        return Any
    whole = kinds[0]
    for kind in kinds[1:]:
        whole = whole | kind
    return whole


def _split(annotation: str) -> list[str]:
    """Parts of a union; brackets are not split."""
    return re.findall(r"(?:[^|\[\]]|\[(?:[^\[\]]|\[(?:[^\[\]]|\[[^\[\]]*\])*\])*\])+", annotation)


def item_roles(call: Callable[..., Any]) -> dict[str, str]:
    """Roles of the arguments of a joint, force, sensor, drive or contact pair."""
    roles = {}
    for name, parameter in inspect.signature(call).parameters.items():
        annotation = parameter.annotation if isinstance(parameter.annotation, str) else ""
        if name in PORTS or re.search(r"\bPort\b", annotation):
            roles[name] = "port"
        elif name in NAMED:
            roles[name] = NAMED[name]
        elif re.search(r"\bJoint\b", annotation):
            roles[name] = "joints"
        elif _type_of(annotation) is Any and not annotation.startswith(_WORDS):
            roles[name] = "value"  # numbers, signals, and references
    return roles


def _classes(module: ModuleType) -> Iterator[tuple[str, type]]:
    for name, value in vars(module).items():
        if inspect.isclass(value) and not name.startswith("_"):
            yield name, value


def _module(name: str) -> ModuleType | None:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name == name:
            return None
        raise


@cache
def item_kinds() -> dict[str, dict[str, Form]]:
    """Section -> kind -> form of every class that `Scene.add` accepts."""
    from warpffrf.model.films import Film, MixedLubrication

    found: dict[str, dict[str, Form]] = {}
    for name in ITEM_MODULES:
        module = _module(f"warpffrf.model.{name}")
        for _, cls in _classes(module) if module else ():
            section, kind = getattr(cls, "scene_list", None), cls.__dict__.get("kind")
            if not section or not kind or kind in ABSTRACT:
                continue
            call = flat(cls, mixed=MixedLubrication) if cls is Film else cls
            found.setdefault(section, {})[kind] = form_of(kind, call, item_roles(call), leave_out=("name",))
    return found


def snake_case(name: str) -> str:
    """SmoothStep -> smooth_step."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


@cache
def signal_kinds() -> dict[str, Form]:
    """Kind -> form of every signal."""
    from warpffrf.model import signals

    classes = [cls for _, cls in _classes(signals) if issubclass(cls, signals.Signal) and cls is not signals.Signal]
    found = {}
    for cls in classes:
        signals_in = [p.name for p in inspect.signature(cls).parameters.values() if "Signal" in str(p.annotation)]
        found[snake_case(cls.__name__)] = form_of(snake_case(cls.__name__), cls, dict.fromkeys(signals_in, "value"))
    return found


@cache
def value_kinds() -> dict[str, Form]:
    """Kind -> form of every object that may be a value: signals, surfaces, bases, damping, curves, gears, contact and
    friction laws, rolling resistance, characteristics of springs, oils, feeds and forms of films, matched faces,
    contacts, integrators, treatments of local modes, stress points, parts of bearings."""
    from warpffrf.model.damping import DAMPINGS
    from warpffrf.model.films import FEEDS, FORMS, ROUGHNESSES, Dam, FilmTemperature, Pad, TiltingPads, pads
    from warpffrf.model.forces import CHARACTERISTICS
    from warpffrf.model.friction import FRICTION_LAWS
    from warpffrf.model.gears import Gear, GearPair
    from warpffrf.model.laws import LAWS, LUMPED_LAWS
    from warpffrf.model.moments import ROLLING_LAWS
    from warpffrf.model.oils import OILS, THERMAL_LAWS, DowsonHigginson, Thermal, iso_vg
    from warpffrf.model.reduced.stress_field import StressPoints
    from warpffrf.model.small_sliding import SmallSliding
    from warpffrf.model.surfaces import SHAPES, Curve, Matched, cam, rail_uic60, wheel_s1002
    from warpffrf.offline.bases import BASES

    online = importlib.import_module("warpffrf.online")
    others = [
        StressPoints,
        Matched,
        SmallSliding,
        DowsonHigginson,
        Thermal,
        iso_vg,
        Pad,
        Dam,
        pads,
        TiltingPads,
        FilmTemperature,
    ]
    others += [online.LocalModes, *online.INTEGRATORS.values()]
    found = dict(signal_kinds())
    registered = {
        **SHAPES, **BASES, **DAMPINGS, **LAWS, **LUMPED_LAWS, **FRICTION_LAWS, **CHARACTERISTICS, **OILS, **FEEDS,
        **FORMS, **ROUGHNESSES, **ROLLING_LAWS, **THERMAL_LAWS,
    }  # fmt: skip
    found.update({kind: form_of(kind, cls, {}) for kind, cls in registered.items()})
    found["extruded"] = form_of("extruded", SHAPES["extruded"], {"curve": "value"})
    found["mesh_surface"] = form_of("mesh_surface", _mesh_surface, {"mesh": "meshes"})
    curves = {"through": Curve.through, "arcs": Curve.arcs, "cam": cam, "rail_uic60": rail_uic60, "gear": Gear}
    curves |= {"gear_flank": flat(Gear.flank, self=Gear), "gear_section": flat(Gear.section, self=Gear)}
    found.update({kind: form_of(kind, call, {"lift": "value"}) for kind, call in curves.items()})
    found["gear_surfaces"] = form_of("gear_surfaces", _gear_surfaces, {"gear": "value"})
    found["gear_pair"] = form_of("gear_pair", GearPair, {"gear_1": "value", "gear_2": "value"})
    found["wheel_s1002"] = form_of("wheel_s1002", wheel_s1002, {})
    found.update({snake_case(cls.__name__): form_of(snake_case(cls.__name__), cls, {}) for cls in others})
    found.update(
        {kind: form_of(kind, cls, item_roles(cls)) for kinds in bearing_parts().values() for kind, cls in kinds}
    )
    return found


def _mesh_surface(
    mesh: Any = None, facet_set: str | None = None, outward: Any = None, direction: Any = None,
    spacing: float | None = None, fit_tolerance: float | None = None,
) -> Any:  # fmt: skip
    """A surface through the nodes of a facet set: of a `mesh`, or of that of the reduced body."""
    from warpffrf.model.surfaces import MeshSurface

    options = {"outward": outward, "direction": direction, "spacing": spacing, "fit_tolerance": fit_tolerance}
    if mesh is None and facet_set is None:
        return MeshSurface(**options)
    if mesh is None or facet_set is None:
        raise InputError("mesh_surface: mesh and facet_set belong together; give both for a rigid surface")
    return MeshSurface.of(mesh, facet_set, **options)


def _gear_surfaces(gear: Any, sides: list[str] | None = None, teeth: list[int] | None = None) -> Any:
    """All or some flanks of a gear, surfaces with their names."""
    return gear.surfaces(sides or FLANKS, teeth)


@cache
def bearing_parts() -> dict[str, tuple[tuple[str, Any], ...]]:
    """Argument of a bearing -> kinds of cages, preloads and flanges."""
    from warpffrf.model.bearings import Flanges, PocketCage, PreloadForce, PreloadOffset, PrescribedCage

    kinds = {"cage": (PrescribedCage, PocketCage), "flanges": (Flanges,)}
    kinds["axial_preload"] = (PreloadForce, PreloadOffset)
    return {argument: tuple((snake_case(cls.__name__), cls) for cls in classes) for argument, classes in kinds.items()}


@cache
def shape_kinds() -> dict[str, Form]:
    """Kind -> form of every contact surface."""
    from warpffrf.model.surfaces import SHAPES

    return {kind: value_kinds()[kind] for kind in (*SHAPES, "wheel_s1002")}


@cache
def contact_kinds() -> dict[str, Form]:
    """Kind -> form of everything that the contact surfaces of a reduced body may be."""
    return {**shape_kinds(), "matched": value_kinds()["matched"]}


@cache
def law_kinds() -> dict[tuple[str, str], dict[str, Form]]:
    """(Section of contacts, films or bearings, argument) -> kind -> form, for arguments that
    accept one sort of laws, oils, forms or parts."""
    from warpffrf.model.films import FORMS, ROUGHNESSES
    from warpffrf.model.friction import FRICTION_LAWS
    from warpffrf.model.laws import LAWS, LUMPED_LAWS
    from warpffrf.model.moments import ROLLING_LAWS
    from warpffrf.model.oils import OILS

    contacts = {"contacts": LAWS, "lumped_contacts": LUMPED_LAWS, "bearings": LUMPED_LAWS}
    of_films = {"asperities": LAWS, "oil": (*OILS, "iso_vg"), "temperature": ("film_temperature",)}
    of_films |= dict.fromkeys(("form_a", "form_b"), FORMS)
    of_films |= dict.fromkeys(("roughness_a", "roughness_b"), ROUGHNESSES)
    bearings = ("journal_bearings", "thrust_bearings")
    taken = {(section, name): kinds for section in ("films", *bearings) for name, kinds in of_films.items()}
    taken |= {(section, "tilting"): ("tilting_pads",) for section in bearings}
    for section, laws in contacts.items():
        taken |= {(section, "law"): laws, (section, "friction"): FRICTION_LAWS}
    taken |= {(section, "rolling_resistance"): ROLLING_LAWS for section in ("lumped_contacts", "bearings")}
    taken |= {(section, "friction"): FRICTION_LAWS for section in ("gear_pairs", "cams", "wheelsets")}
    taken |= {("bearings", name): FORMS for name in ("inner_form", "outer_form")}
    taken |= {("bearings", name): dict(kinds) for name, kinds in bearing_parts().items()}
    return {at: {kind: value_kinds()[kind] for kind in kinds} for at, kinds in taken.items()}


@cache
def fixed_forms() -> dict[str, dict[str, Form]]:
    """Section -> kind -> form of the tables that are not items; kind "" where a section has one form only."""
    from warpffrf.model import mesh
    from warpffrf.model.bearings import BallGeometry, Materials, RollerGeometry, RollingContact
    from warpffrf.model.films import MixedLubrication
    from warpffrf.model.material import Material
    from warpffrf.model.mesh.cut import cut
    from warpffrf.model.reduced.body import ReducedBody
    from warpffrf.model.scene import Scene
    from warpffrf.offline import ContactGrid, ReductionOptions, half_space_body, reduce, rigid_film_body
    from warpffrf.online.stages import Stage
    from warpffrf.output.options import OF_TIME, RunOptions
    from warpffrf.output.simulate import equilibrium, simulate, static

    paths: dict[str, str] = dict.fromkeys(PATHS, "path")
    of_program = ("scene", "progress", "overwrite", "resume", "check")
    rings: dict[str, str] = {"inner": "port", "outer": "port", "element_body": "reduced_bodies"}
    options: dict[str, type] = {"contact": RollingContact, "materials": Materials}
    of_pads: dict[str, str] = {
        "journal": "port",
        "runner": "port",
        "support": "port",
        "pads": "value",
        "oil": "value",
        "temperature": "value",
    }
    balls = flat(Scene.add_bearing, geometry=listed(BallGeometry), **options)
    rollers = flat(Scene.add_bearing, geometry=listed(RollerGeometry), **options)
    found = {
        "materials": {"": form_of("material", Material, {}, ("name",))},
        "meshes": {
            "roller": form_of("roller", with_sets(mesh.roller), {}),
            "box": form_of("box", with_sets(mesh.box), {}),
            "grid": form_of("grid", with_sets(mesh.grid), {}),
            "cage": form_of("cage", with_sets(mesh.cage), {}),
            "cam": form_of("cam", with_sets(mesh.cam), {"curve": "value"}),
            "gear": form_of("gear", with_sets(mesh.gear), {"gear": "value"}),
            "read": form_of("mesh file", with_sets(mesh.read), paths),
            "from_matrices": form_of("matrices", with_sets(mesh.from_matrices), paths, ("name",)),
            "cut": form_of("cut", with_sets(cut), {"mesh": "meshes"}),
        },
        "reduced_bodies": {
            "reduce": form_of(
                "reduction",
                flat(reduce, grid=ContactGrid, options=ReductionOptions),
                {"mesh": "meshes", "material": "materials", "contact": "shapes", "stress": "value of reduce"},
                ("progress",),
            ),
            "half_space": form_of("half-space body", half_space_body, {"material": "materials", "contact": "shapes"}),
            "rigid_film": form_of("rigid body of films", rigid_film_body, {"contact": "shapes"}),
            "load": form_of("reduced body file", ReducedBody.load, paths),
        },
        "scene": {"": form_of("scene", Scene, {})},
        "bodies": {
            "flexible": form_of("flexible body", Scene.add_body, {"body": "reduced_bodies"}, ("self", "name")),
            "rigid": form_of("rigid body", Scene.add_rigid_body, {}, ("self", "name")),
        },
        "bearings": {
            "ball": form_of("ball bearing", balls, rings, ("scene", "name")),
            "roller": form_of("roller bearing", rollers, rings, ("scene", "name")),
        },
        "gear_pairs": {
            "": form_of(
                "gear pair",
                Scene.add_gear_pair,
                {"gear_1": "port", "gear_2": "port", "pair": "value"},
                ("scene", "name"),
            )
        },
        "cams": {
            "": form_of(
                "cam",
                Scene.add_cam,
                {"cam": "port", "follower": "port", "carrier": "port", "speed": "value", "preload": "value"},
                ("scene", "name"),
            )
        },
        "wheelsets": {
            "": form_of(
                "wheelset",
                Scene.add_wheelset,
                {"wheel": "value", "rail": "value", "material": "materials"},
                ("scene", "name"),
            )
        },
        **{
            f"{kind}_bearings": {
                "": form_of(f"{kind} bearing", flat(call, mixed=MixedLubrication), of_pads, ("scene", "name"))
            }
            for kind, call in (("journal", Scene.add_journal_bearing), ("thrust", Scene.add_thrust_bearing))
        },
        "arrange": {
            "place": form_of("place", Scene.place, {"port": "port", "onto": "port"}, ("self",)),
            "close_gap": form_of("close_gap", Scene.close_gap, {"contact": "contacts"}, ("self", "with_bodies")),
        },
        "equilibrium": {"": form_of("equilibrium", arguments_of(equilibrium), {}, of_program)},
        "static": {"": form_of("static", flat(arguments_of(static), options=RunOptions), {}, (*of_program, *OF_TIME))},
        "simulate": {
            "": form_of(
                "simulate", staged(flat(arguments_of(simulate), options=RunOptions)), {"stages": "stages"}, of_program
            )
        },
        "stages": {"": form_of("stage", Stage, {"overrides": "overrides"})},
    }
    return {
        section: {kind: form if kind else replace(form, alone=True) for kind, form in kinds.items()}
        for section, kinds in found.items()
    }


def choose(source: Source, path: Path, table: Any, kinds: dict[str, Form], default: str | None = None) -> Form:
    """The form that the key `kind` of a table names, else the only or `default` form. Raises `InputError`."""
    if not isinstance(table, dict):
        raise InputError(f"{source.place(path)}: {shown(path)} must be a table, got {brief(table)}")
    kind: Any = table.get("kind", default)
    if "" in kinds:
        return kinds[""]
    if kind is None and len(kinds) == 1:
        (kind,) = kinds
    known = ", ".join(repr(k) for k in kinds)
    if kind is None:
        raise InputError(f"{source.place(path)}: {shown(path)}: the key 'kind' is missing; known kinds: {known}")
    if not isinstance(kind, str) or kind not in kinds:
        hint = suggestion(kind, tuple(kinds)) if isinstance(kind, str) else f"; known: {known}"
        raise InputError(f"{source.place((*path, 'kind'))}: {shown(path)}: there is no kind {kind!r}{hint}")
    return kinds[kind]
