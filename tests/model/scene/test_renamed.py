"""Old names get an error that says the new one: attributes of modules, arguments, words and kinds."""

import inspect
import operator
import re
from collections.abc import Callable
from typing import Any

import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError, suggestion
from warpffrf.model.renamed import RENAMED
from warpffrf.output.result import Result
from warpffrf.scene_file.forms import flat, value_kinds

MODULES: tuple[Any, ...] = (wf, wf.films, wf.forces, wf.laws, wf.bearings)
CALLS: tuple[Callable[..., Any], ...] = (
    wf.Contact, wf.Film, flat(wf.Film, mixed=wf.films.MixedLubrication), wf.reduce, wf.ContactGrid,
    wf.Scene.add_bearing,
    wf.forces.Pretension, wf.forces.RevoluteFriction, wf.simulate, wf.study.sweep,
)  # fmt: skip
WORDS = {
    "contact_fixed",
    "body_fixed",
    "closest_point",
    "nodes",
    "full",
    "reduced",
    *wf.films.CAVITATIONS,
}  # of arguments


@pytest.mark.parametrize("old", RENAMED)
def test_every_new_name_is_one(old: str) -> None:
    known = {*WORDS, *value_kinds(), *(kind.kind for kind in (wf.forces.BearingSpring,))}
    known |= {name for module in MODULES for name in dir(module)} | {f"surfaces.{name}" for name in dir(wf.surfaces)}
    known |= {*dir(Result), "contacts"}
    known |= {name for call in CALLS for name in inspect.signature(call).parameters}
    for new in RENAMED[old]:
        argument, value = re.split(r"[.=]", new)[0], new.partition("=")[2]
        assert argument in known and set(re.findall(r"(\w+)\(", value)) <= known | {"partial"}
        for path, field in re.findall(r"wf\.([\w.]+)\((\w+)=", value):
            assert field in inspect.signature(operator.attrgetter(path)(wf)).parameters
        said = f"; it is {new} now" if value else f"; it is called {new!r} now"
        assert suggestion(old, [argument]) == said


def test_a_name_that_is_valid_elsewhere_is_no_old_one() -> None:
    """`law` is an argument of a contact as before: what is not known there is what counts."""
    assert "called" not in suggestion("law", ["friction", "grid"])


def test_scripts_written_before_are_answered() -> None:
    with pytest.raises(AttributeError, match="'Groove'; it is called 'AxialGroove' now"):
        wf.films.Groove  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]
    call: Any = wf.reduce
    with pytest.raises(TypeError, match=r"'patch_grid'; it belongs to grid=wf.ContactGrid\(contact_fixed=...\)"):
        call(None, None, patch_grid=True)
    with pytest.raises(AttributeError, match="'LapCells'; it is called 'surfaces.Matched' now"):
        wf.LapCells  # noqa: B018  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(TypeError, match="'laps'; it is called 'contact' now"):
        call(None, None, laps={})
    scene: Any = wf.Scene()
    with pytest.raises(AttributeError, match="no attribute 'lap'; it is called 'contact' now"):
        scene.lap("joint")
    balls: dict[str, Any] = {"elements": 8, "ball_diameter": 0.01, "pitch_diameter": 0.05}
    with pytest.raises(
        TypeError, match=r"'elements'; it is geometry=wf.bearings.BallGeometry\(...\) or RollerGeometry"
    ):
        scene.add_bearing("b", **balls)
    with pytest.raises(TypeError, match="'preload'; it is called 'axial_preload' now"):
        scene.add_bearing("b", wf.bearings.BallGeometry(**balls), preload=None)  # pyright: ignore[reportCallIssue]
    port: Any = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    with pytest.raises(TypeError, match="'gaps'; it is called 'kinematics' now"):
        wf.Contact(port, port, gaps="points")  # pyright: ignore[reportCallIssue]
    with pytest.raises(InputError, match="'table_coulomb' does not exist; it is called 'tabulated_friction' now"):
        from warpffrf.model.errors import unknown_name

        raise unknown_name("kind", "table_coulomb", value_kinds())
