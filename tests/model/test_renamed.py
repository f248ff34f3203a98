"""Old names get an error that says the new one: attributes of modules, arguments, words and kinds."""

import inspect
import re
from collections.abc import Callable
from typing import Any

import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError, suggestion
from warpffrf.model.renamed import RENAMED
from warpffrf.scene_file.forms import value_kinds

MODULES: tuple[Any, ...] = (wf, wf.films, wf.forces, wf.laws, wf.bearings)
CALLS: tuple[Callable[..., Any], ...] = (wf.Contact, wf.Film, wf.reduce, wf.ContactGrid)
WORDS = {
    "contact_fixed",
    "body_fixed",
    "closest_point",
    "nodes",
    "full",
    "reduced",
    *wf.films.CAVITATIONS,
}  # values of arguments


@pytest.mark.parametrize("old", RENAMED)
def test_every_new_name_is_one(old: str) -> None:
    known = {*WORDS, *value_kinds(), *(kind.kind for kind in (wf.forces.BearingSpring,))}
    known |= {name for module in MODULES for name in dir(module)}
    known |= {name for call in CALLS for name in inspect.signature(call).parameters}
    names = [new for new in RENAMED[old] if "=" not in new]
    assert [new for new in names if new not in known] == []
    if names:
        assert suggestion(old, list(known)) == f"; it is called {names[0]!r} now"


@pytest.mark.parametrize("old", [old for old, names in RENAMED.items() if "=" in names[-1]])
def test_every_moved_argument_is_a_field_of_an_options_object(old: str) -> None:
    (argument, kind, field), call = re.findall(r"(\w+)=wf\.(\w+)\((\w+)=\.\.\.\)", RENAMED[old][-1])[0], wf.reduce
    assert argument in inspect.signature(call).parameters and field in inspect.signature(getattr(wf, kind)).parameters
    assert suggestion(old, [argument]) == f"; it is {RENAMED[old][-1]} now"


def test_a_name_that_is_valid_elsewhere_is_no_old_one() -> None:
    """`law` is an argument of a contact as before: what is not known there is what counts."""
    assert "called" not in suggestion("law", ["friction", "grid"])


def test_scripts_written_before_are_answered() -> None:
    with pytest.raises(AttributeError, match="'Groove'; it is called 'AxialGroove' now"):
        wf.films.Groove  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]
    call: Any = wf.reduce
    with pytest.raises(TypeError, match=r"'patch_grid'; it is grid=wf.ContactGrid\(contact_fixed=...\) now"):
        call(None, None, patch_grid=True)
    scene = wf.Scene()
    port: Any = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    with pytest.raises(TypeError, match="'gaps'; it is called 'kinematics' now"):
        wf.Contact(port, port, gaps="points")  # pyright: ignore[reportCallIssue]
    with pytest.raises(InputError, match="'table_coulomb' does not exist; it is called 'tabulated_friction' now"):
        from warpffrf.model.errors import unknown_name

        raise unknown_name("kind", "table_coulomb", value_kinds())
