"""Public callables answer arguments that they do not take with names, and keep their signatures."""

from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pytest

import warpffrf as wf
from warpffrf.model.messages.named_arguments import misfit, named_arguments

# descriptions of what other things are made of: no user calls them
STRUCTURES = {
    "Characteristic", "BodyLoad", "Coordinate", "PointLoad", "SlipLaw", "SpringLaw", "TensionLaw", "SurfaceProfile",
    "Basis", "Cyclic", "FacetSet", "Matrices", "MeshReport", "Feed", "Form", "Oil", "FrictionLaw", "Law", "LumpedLaw",
    "Shape", "InputError", "Sensor", "Integrator", "from_description", "as_oil", "as_law",
    "Coefficients", "Marker", "Row", "Signal", "basis_options", "ONE_TEN_HUNDRED", "damping_ratios", "default_damping",
    "roots_at_infinity", "coincident_within", "as_signal", "Bearing", "Cage", "Example", "AxialPreload", "RunError",
    "Status", "BasisProblem", "RawBasis", "Force", "Pieces", "scalar_law", "Approach", "RevolutionShape",
    "JournalBearing",
}  # fmt: skip
WRONG = "no_argument_of_this_name"


def public() -> Iterator[tuple[str, Any]]:
    """Names of functions and classes that users call: of the package, and of its modules but the studies."""
    for name in wf.__all__:
        thing = getattr(wf, name)
        if not isinstance(thing, ModuleType):
            yield name, thing
            continue
        if name == "study":
            continue
        for inner in getattr(thing, "__all__", dir(thing)):
            member = getattr(thing, inner)
            home = str(getattr(member, "__module__", ""))
            if not inner.startswith("_") and callable(member) and home.startswith(thing.__name__):
                yield f"{name}.{inner}", member


def passes_on(thing: Callable[..., Any]) -> bool:
    """Whether it takes any name, and what it calls answers (`bearings.catalogue`)."""
    return any(p.kind is p.VAR_KEYWORD for p in inspect.signature(thing).parameters.values())


USED = [(n, t) for n, t in public() if n.split(".")[-1] not in STRUCTURES and not passes_on(t)]


@pytest.mark.parametrize(("name", "thing"), USED)
def test_public_callables_answer(name: str, thing: Callable[..., Any]) -> None:
    with pytest.raises(TypeError, match=f"there is no argument {WRONG!r}.* known: "):
        thing(**{WRONG: 1})


def turn(a: int, b: int = 2, *, angle: float, axis: str = "x") -> tuple:
    return a, b, angle, axis


@pytest.mark.parametrize(
    ("args", "options", "says"),
    [
        ((1,), {"angel": 1.0}, "turn: there is no argument 'angel'; did you mean 'angle'"),
        ((1, 2, 3), {}, "turn: 3 positional arguments were given, it takes a, b; pass the others by name: turn(a, b"),
        ((), {}, "turn: a and angle must be given; it takes a, b, angle, axis"),
        ((1,), {"a": 2, "angle": 1.0}, "turn: a is given twice, by position and by name"),
        ((1,), {"angle": 1.0}, ""),
    ],
)
def test_what_does_not_fit(args: tuple, options: dict[str, Any], says: str) -> None:
    told = misfit("turn", inspect.signature(turn), args, options)
    assert told.startswith(says) if says else told == ""


def test_signatures_and_results_stay() -> None:
    answered = named_arguments(turn)
    assert inspect.signature(answered) == inspect.signature(turn) and answered(1, angle=0.5) == (1, 2, 0.5, "x")
    assert list(inspect.signature(wf.Contact).parameters)[:3] == ["a", "b", "sliding"]
    assert pickle.loads(pickle.dumps(wf.Material(1.0, 0.3, 1.0))) == wf.Material(1.0, 0.3, 1.0)


def test_an_error_from_inside_is_passed_on() -> None:
    @named_arguments
    def length(value: Any) -> int:
        return len(value)

    with pytest.raises(TypeError, match="has no len"):
        length(3)
