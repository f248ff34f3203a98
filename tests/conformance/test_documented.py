"""Every public name says what it is, in which shape, unit and frame, what it raises, and where its physics is from.

The rules are mechanical. A docstring is that of a name, of a method that takes the place of one in a base class also
that one's, of a class also those of its bases in the package, where arguments stand that all of a kind take.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from enum import Enum
from typing import Any

import pytest
from public_names import Public, everything, members, own_text, top_level

import warpffrf as wf

EVERYTHING = everything()
CLASSES = [
    one for one in EVERYTHING if inspect.isclass(one.thing) and one.owner is None and not issubclass(one.thing, Enum)
]
CALLED = [one for one in EVERYTHING if one.function is not None]
UNIT = re.compile(  # in brackets or in the text, or a word that says that there is none
    r"\[[^\]]+\]|\b(?:m|m2|m3|um|rad|s|Hz|N|Pa|J|W|kg|degrees|Celsius)\b|\b1/\w|%|\bdimensionless\b|\bbool\b|\bTrue\b|"
    r"\bunit (?:direction|normal|tangent)|\bquaternion|\b(?:number|count|index|factor|ratio|share|fraction|tolerance|"
    r"column|cell|exponent)s?\b",
    re.IGNORECASE,
)
AXES = r"(?:\.\.\.|\w[\w+* ]*)"
SHAPE = re.compile(rf"\({AXES},(?: {AXES},?)*\)|\(\.\.\.\)|any shape|of their shape|broadcast")
FRAME = re.compile(r"world|user|axes|axis|frame|first surface|first face|of the mesh|body|grid|normal", re.IGNORECASE)
SOURCE = re.compile(r"\b(?:1[6-9]|20)\d\d\b|\bISO \d{3}")  # a year, next to which author and title stand, or a standard
RAISED = ("InputError", "unknown_name", "_unknown")
VECTOR = re.compile(r"\((?:T, |n, |m, |k, )?3,?\)")

# Laws, methods and formulas that someone has published: the docstring of each, or of its module, says who and when.
PHYSICS = [
    "wf.laws.RollingHysteresis",
    "wf.integrators.GeneralizedAlpha", "wf.integrators.HHT", "wf.integrators.Newmark", "wf.integrators.EnergyMomentum",
    "wf.laws.GreenwoodTripp", "wf.laws.HertzPoint", "wf.laws.HuntCrossley", "wf.laws.IsoLamina",
    "wf.laws.EyringTraction", "wf.laws.PalmgrenLine", "wf.laws.Stribeck", "wf.laws.TractionCurve", "wf.oils.Barus",
    "wf.oils.DowsonHigginson", "wf.oils.Roelands", "wf.oils.iso_vg", "wf.oils.vogel", "wf.oils.walther",
    "wf.oils.VogelLaw", "wf.oils.WaltherLaw", "wf.oils.RoelandsLaw", "wf.oils.ExponentialLaw",
    "wf.films.FilmTemperature",
    "wf.bases.Balanced", "wf.bases.CraigBampton", "wf.bases.CraigChang", "wf.bases.Krylov", "wf.bases.POD",
    "wf.bases.TrialVectorDerivatives", "wf.damping.Rayleigh", "wf.films.Roughness",
    "wf.bearings.catalogue_torque", "wf.bearings.contamination_factor", "wf.bearings.drag_torque",
    "wf.bearings.duty_life", "wf.bearings.fit", "wf.gears.Gear", "wf.gears.GearPair",
]  # fmt: skip


def whole_text(public: Public) -> str:
    """The docstring, of a class with those of its bases, of a member with that of its class."""
    if public.owner is None and inspect.isclass(public.thing):
        bases = [own_text(kind) for kind in public.thing.__mro__[1:] if kind.__module__.startswith("warpffrf")]
        return "\n".join([public.text, *bases])
    return public.text


def arguments(public: Public) -> list[inspect.Parameter]:
    """What a user gives; of results, which the program makes, nothing."""
    called = public.thing if public.owner is None else public.function
    made_by_program = inspect.isclass(called) and (called is wf.Result or not public.label.startswith("wf."))
    if (
        public.is_property
        or called is wf.InputError
        or (made_by_program and not hasattr(called, "__dataclass_fields__"))
    ):
        return []
    found = inspect.signature(called).parameters.values()
    return [p for p in found if p.name not in ("self", "cls") and not p.name.startswith("_")]


def is_named(name: str, text: str) -> bool:
    """In its own words, in the singular or the plural, with words joined or apart."""
    return re.search(rf"\b{name.replace('_', '[_ -]')}s?\b", text) is not None


def raises(function: Any) -> bool:
    """Whether the body raises `InputError` itself."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except OSError:  # made by `dataclass`, which checks nothing
        return False
    names = [ast.unparse(n.exc) for n in ast.walk(tree) if isinstance(n, ast.Raise) and n.exc is not None]
    return any(name.split("(")[0].split(".")[-1] in RAISED for name in names)


def says(found: list[str]) -> str:
    return "\n".join(found)


def test_there_is_much_to_look_at() -> None:
    assert len(EVERYTHING) > 1000 and len(CALLED) > 900 and len(CLASSES) > 130


def test_each_has_a_docstring() -> None:
    assert not (found := [one.label for one in (*CLASSES, *CALLED) if len(one.text.split()) < 1]), says(found)


def test_each_constant_is_explained_where_it_is_made() -> None:
    """By a comment or a text next to it, or by its name in the docstring of its module or of the public one."""
    found = []
    for one in top_level():
        if inspect.isclass(one.thing) or inspect.isroutine(one.thing):
            continue
        public: Any = getattr(wf, one.label.split(".")[1])
        sources = [inspect.getsource(public)]
        home = re.search(rf"from (\S+) import [^\n]*\b{one.name}\b|from (\S+) import \([^)]*\b{one.name}\b", sources[0])
        if home:
            sources.append(inspect.getsource(inspect.importlib.import_module(home[1] or home[2])))  # pyright: ignore
        said = rf"^{one.name}\b[^\n]*=.*?#|\"\"\"[^\"]*\b{one.name}\b|^#[^\n]*\n(?:#[^\n]*\n)*{one.name}\b"
        if not any(re.search(said, source, re.M) for source in sources):
            found.append(one.label)
    assert not found, says(found)


def test_each_argument_is_named() -> None:
    found = []
    for one in (*CLASSES, *CALLED):
        text = whole_text(one)
        missing = [p.name for p in arguments(one) if not is_named(p.name, text)]
        found += [f"{one.label}: {', '.join(missing)}"] if missing else []
    assert not found, says(found)


def test_each_says_what_it_raises() -> None:
    found = []
    for one in CALLED:
        if raises(one.function) and not re.search("InputError|raises", one.text, re.IGNORECASE):
            found.append(one.label)
    for one in CLASSES:
        made = [one.thing.__dict__.get(name) for name in ("__init__", "__post_init__")]
        checks = any(raises(function) for function in made if inspect.isfunction(function))
        if checks and not re.search("InputError|raises", whole_text(one), re.IGNORECASE):
            found.append(one.label)
    assert not found, says(found)


def test_each_array_has_a_shape_and_each_quantity_a_unit() -> None:
    found = []
    for one in CALLED:
        kind = str(one.function.__annotations__.get("return", ""))
        if "ndarray" in kind and not SHAPE.search(one.text):
            found.append(f"{one.label}: no shape")
        if re.search(r"ndarray|float|Vector", kind) and not UNIT.search(one.text):
            found.append(f"{one.label}: no unit")
        if "ndarray" in kind and VECTOR.search(one.text) and not FRAME.search(one.text):
            found.append(f"{one.label}: no frame")
    assert not found, says(found)


def test_each_argument_that_is_a_quantity_has_a_unit_near_it() -> None:
    """Within two lines after its name, or just before it; and where vectors are given, the frame is stated."""
    found = []
    for one in (*CLASSES, *CALLED):
        text = whole_text(one)
        for p in arguments(one):
            kind = str(p.annotation)
            if not re.search(r"float|Vector|Signal|Rows|ndarray|Array", kind):
                continue
            places = [m.start() for m in re.finditer(rf"\b{p.name.replace('_', '[_ -]')}s?\b", text)]
            if not any(UNIT.search(text[max(0, at - 60) : at + 240]) for at in places):
                found.append(f"{one.label}: {p.name} has no unit")
            if re.search(r"axis|point|direction|normal|center|position|velocity", p.name) and "Vector" in kind:
                found += [] if FRAME.search(text) else [f"{one.label}: {p.name} has no frame"]
    assert not found, says(found)


def test_recorded_quantities_have_shape_and_unit() -> None:
    """What a result hands on from its history is documented like a property."""
    from warpffrf.output.exposed_histories import Recorded

    found, count = [], 0
    for one in CLASSES:
        for name, value in inspect.getmembers_static(one.thing):
            if isinstance(value, Recorded):
                text, count = value.__doc__ or "", count + 1
                if not (SHAPE.search(text) and UNIT.search(text)):
                    found.append(f"{one.label}.{name}: {text}")
                if VECTOR.search(text) and not FRAME.search(text):
                    found.append(f"{one.label}.{name}: no frame")
    assert count > 20 and not found, says(found)


@pytest.mark.parametrize("label", PHYSICS)
def test_published_physics_names_its_source(label: str) -> None:
    (one,) = (one for one in EVERYTHING if one.label == label)
    assert SOURCE.search(f"{one.text}\n{inspect.getmodule(one.thing).__doc__}"), label  # pyright: ignore


def test_laws_of_all_kinds_are_in_the_list_of_physics_or_are_definitions() -> None:
    """A new law must be sorted into one of the two."""
    definitions = {
        "wf.laws.Coulomb", "wf.laws.RegularisedCoulomb", "wf.laws.TabulatedFriction", "wf.laws.ExponentialAsperities",
        "wf.laws.LinearLayer", "wf.laws.NonlinearLayer", "wf.laws.TabulatedLayer", "wf.laws.Unilateral", "wf.laws.Law",
        "wf.laws.FrictionLaw", "wf.laws.LumpedLaw", "wf.laws.TabulatedForce", "wf.laws.PowerForce", "wf.oils.Newtonian",
        "wf.oils.Oil", "wf.oils.Thermal",
        "wf.laws.RollingResistanceArm", "wf.laws.RollingResistance", "wf.laws.Approach",
    }  # fmt: skip
    laws = {one.label for one in EVERYTHING if re.match(r"wf\.(laws|oils)\.[A-Z]\w*[a-z]\w*$", one.label)}
    classes = {
        label for label in laws if inspect.isclass(getattr(getattr(wf, label.split(".")[1]), label.split(".")[2]))
    }
    assert classes <= definitions | set(PHYSICS), classes - definitions - set(PHYSICS)


def test_the_rules_find_what_they_are_for() -> None:
    """A class without any of it fails by each rule."""

    class Poor:
        def __init__(self, radius: float) -> None:
            self.radius = radius

        def force(self, approach: float) -> float:
            if approach < 0.0:
                raise wf.InputError("negative")
            return self.radius

    poor = Public("wf.Poor", Poor)
    Poor.__module__ = "warpffrf.poor"
    assert not poor.text.strip() and [p.name for p in arguments(poor)] == ["radius"]
    (method,) = members(poor)
    assert raises(method.function) and not is_named("approach", method.text) and not UNIT.search("the force of it")
    assert not SHAPE.search("forces, of each node") and SHAPE.search("(T, 3) N") and SHAPE.search("(n,) m")
    assert not FRAME.search("(T, 3) N of it") and not SOURCE.search("as everybody knows")
