"""Old names get an error that says the new one: attributes of modules, arguments, words and kinds."""

import inspect
from collections.abc import Callable
from typing import Any

import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError, suggestion
from warpffrf.model.renamed import RENAMED
from warpffrf.output.result import Result
from warpffrf.scene_file.forms import value_kinds

MODULES: tuple[Any, ...] = (wf, wf.films, wf.forces, wf.laws, wf.bearings)
CALLS: tuple[Callable[..., Any], ...] = (wf.Contact, wf.Film, wf.reduce)
WORDS = {"contact_fixed", "body_fixed", "closest_point", *wf.films.CAVITATIONS}  # arguments of Contact and Film


@pytest.mark.parametrize("old", RENAMED)
def test_every_new_name_is_one(old: str) -> None:
    known = {*WORDS, *value_kinds(), *(kind.kind for kind in (wf.forces.BearingSpring,))}
    known |= {name for module in MODULES for name in dir(module)} | {f"surfaces.{name}" for name in dir(wf.surfaces)}
    known |= {*dir(Result), "contacts"}
    known |= {name for call in CALLS for name in inspect.signature(call).parameters}
    assert [new for new in RENAMED[old] if new not in known] == []
    assert suggestion(old, list(known)) == f"; it is called {RENAMED[old][0]!r} now"


def test_a_name_that_is_valid_elsewhere_is_no_old_one() -> None:
    """`law` is an argument of a contact as before: what is not known there is what counts."""
    assert "called" not in suggestion("law", ["friction", "grid"])


def test_scripts_written_before_are_answered() -> None:
    with pytest.raises(AttributeError, match="'Groove'; it is called 'AxialGroove' now"):
        wf.films.Groove  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]
    call: Any = wf.reduce
    with pytest.raises(TypeError, match="'patch_grid'; it is called 'contact_fixed' now"):
        call(None, None, patch_grid=True)
    with pytest.raises(AttributeError, match="'LapCells'; it is called 'surfaces.Matched' now"):
        wf.LapCells  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(TypeError, match="'laps'; it is called 'contact' now"):
        call(None, None, laps={})
    scene: Any = wf.Scene()
    with pytest.raises(AttributeError, match="no attribute 'lap'; it is called 'contact' now"):
        scene.lap("joint")
    port: Any = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    with pytest.raises(TypeError, match="'gaps'; it is called 'kinematics' now"):
        wf.Contact(port, port, gaps="points")  # pyright: ignore[reportCallIssue]
    with pytest.raises(InputError, match="'table_coulomb' does not exist; it is called 'tabulated_friction' now"):
        from warpffrf.model.errors import unknown_name

        raise unknown_name("kind", "table_coulomb", value_kinds())
