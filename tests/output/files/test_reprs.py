"""How objects show themselves: one short line at a prompt, a small table in a notebook, documented names alone."""

import base64
import inspect
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

import warpffrf as wf
from warpffrf.model.messages import reprs
from warpffrf.online.history.history import BodyHistory, History, JointHistory
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.pair_result import PairResult
from warpffrf.output.contact.result import ContactResult, FilmResult
from warpffrf.output.result import Result
from warpffrf.output.small_sliding import SmallSlidingResult

SHORT = 240  # characters: what fits on two lines


def described() -> dict[str, Any]:
    """Everything a scene is described with."""
    steel = wf.Material(210e9, 0.3, 7850, name="steel")
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    body = wf.reduce(
        mesh, steel, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=2, cache=False,
        progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    lower, upper = (scene.add_body(body, name=name) for name in ("lower", "upper"))
    upper.position = (0, 0, 0.1)
    block = scene.add_rigid_body(
        2.0,
        (1, 1, 1),
        name="block",
        surfaces={"tread": wf.surfaces.Cylinder(radius=0.1, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))},
    )
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    return {
        "material": steel, "mesh": mesh, "reduced": body, "scene": scene, "body": upper, "rigid": block,
        "ground": scene.ground, "on_body": body.contact_surfaces["rim"], "port": lower["bore"],
        "surface": lower["rim"], "joint": axle,
        "drive": scene.add(wf.joints.Drive(axle, 1.0)),
        "force": scene.add(wf.forces.PointForce(upper["bore"], (0, 0, 1))),
        "spring": scene.add(wf.forces.TorsionalSpringDamper(axle, 1.0)),
        "contact": scene.add(wf.Contact(lower["rim"], upper["rim"])),
        "sensor": scene.add(wf.sensors.Position(upper["bore"])),
    }  # fmt: skip


def test_descriptions_show_themselves_in_short() -> None:
    things = described()
    for name, thing in things.items():
        assert len(repr(thing)) <= SHORT and "0x" not in repr(thing) and "array(" not in repr(thing), (name, thing)
    assert repr(things["joint"]) == "Revolute('axle', on=ground and lower['bore'])"
    assert repr(things["port"]) == "Port(\"lower['bore']\")"
    assert repr(things["mesh"]).startswith("Mesh('roller', nodes=216, cells=96 hex8, size=0.1 x 0.02 x 0.1 m")
    assert repr(things["rigid"]) == "Body('block', kind=rigid, mass=2 kg, position=(0, 0, 0) m, places='tread')"
    assert repr(things["scene"]).startswith("Scene(bodies='lower', 'upper', 'block', joints='axle', drives=")


def test_notebooks_get_tables() -> None:
    for name, thing in described().items():
        if name != "material":
            table, _, picture = thing._repr_html_().partition("</table>")
            assert table.startswith("<table>") and len(table) < 2000, name
            assert f"<b>{type(thing).__name__}</b>" in table
            assert picture.startswith("<img") if name == "scene" else not picture


def pixels(shown: str) -> np.ndarray:
    """(height, width, 4) of the picture in a notebook."""
    return imread(io.BytesIO(base64.b64decode(shown.partition("base64,")[2].partition('"')[0])))


def test_notebooks_get_pictures_of_scenes_and_results(result: Result) -> None:
    """A scene as it stands now, without a run; the last row of a run; nothing where nothing is there."""
    scene: Any = described()["scene"]
    before = pixels(scene._repr_html_())
    assert before.shape == (360, 480, 4) and np.ptp(before[..., :3]) > 0.3
    scene.body("upper").position = (0, 0, 0.2)
    assert np.any(pixels(scene._repr_html_()) != before)
    assert "the bodies at 0.02 s" in result._repr_html_() and np.ptp(pixels(result._repr_html_())[..., :3]) > 0.3
    assert "<img" not in wf.Scene()._repr_html_()


def test_what_cannot_be_drawn_is_shown_as_a_table(history: History) -> None:
    history.bodies["upper"].position[:] = np.nan
    assert Result(history)._repr_html_().endswith("</table>")


def test_names_of_the_user_are_escaped() -> None:
    scene = wf.Scene()
    body = scene.add_rigid_body(1.0, (1, 1, 1), name="<b>&")
    assert "&lt;b&gt;&amp;" in body._repr_html_() and "<b>&" not in body._repr_html_()


def test_lists_of_names_are_cut() -> None:
    many = reprs.names([f"roller_{i}" for i in range(24)])
    assert len(many) <= reprs.LONGEST + 10 and many.endswith(", ... (24)") and many.startswith("'roller_0', 'roller_1'")
    assert reprs.names([]) == "none"


def test_histories_show_shapes() -> None:
    T = 1000
    rows = np.zeros((T, 3))
    body = BodyHistory(rows, np.zeros((T, 4)), rows, rows, np.zeros((T, 8)))
    assert repr(body).startswith("BodyHistory(position=(1000, 3), rotation=(1000, 4), velocity=(1000, 3)")
    joint = JointHistory(np.zeros(T), rows, rows, coordinate_names=("rotation",))
    assert repr(joint) == "JointHistory(coordinate=(1000), force=(1000, 3), torque=(1000, 3), second_coordinate=(1000))"
    assert "<td" in joint._repr_html_()


def test_results_show_themselves_in_short(history: History) -> None:
    result = Result(history)
    pair = result.contact(result.contact_names[0])
    loops = result.hysteresis(np.sin(result.time), np.cos(result.time))
    for thing in (history, result, pair, loops, loops.loop()):
        assert len(repr(thing)) <= SHORT and "array(" not in repr(thing), thing
        assert "<table>" in thing._repr_html_()
    assert f"rows={len(result.time)}" in repr(pair) and repr(pair).startswith("ContactResult('")


@pytest.mark.parametrize("kind", [ContactResult, CellContactResult, FilmResult, SmallSlidingResult])
def test_completion_shows_documented_names_alone(kind: type) -> None:
    shown = [name for name in dir(kind) if not name.startswith("_") and name not in kind._hidden]
    undocumented = [name for name in shown if not inspect.getdoc(inspect.getattr_static(kind, name))]
    assert undocumented == []
    assert {"force", "torque"} <= set(shown) and "N" in str(inspect.getdoc(inspect.getattr_static(kind, "force")))


def test_internal_names_are_hidden_and_answer_still(history: History) -> None:
    pair = Result(history).contact(Result(history).contact_names[0])
    assert not {"view", "history", "measure", "side", "bodies"} & set(dir(pair))
    assert pair.view.name == pair.name and {"force", "approach", "half_width", "hertz"} <= set(dir(pair))
    with pytest.raises(AttributeError, match="ContactResult.force is a recorded quantity"):
        pair.force = np.zeros(3)  # pyright: ignore[reportAttributeAccessIssue]
    assert isinstance(pair, PairResult) and np.array_equal(pair.force, pair.history.force)


def test_no_module_of_the_model_is_left_with_a_bare_look() -> None:
    """What is added to a scene looks like something: every class with a `scene_list`."""
    for module in (wf.joints, wf.forces, wf.sensors):
        for name in module.__all__:
            value = getattr(module, name)
            if hasattr(value, "scene_list"):
                assert issubclass(value, reprs.Item), name
    for kind in (wf.Contact, wf.LumpedContact, wf.Film):
        assert issubclass(kind, reprs.Item)


def test_the_files_of_a_result_are_reported(tmp_path: Path) -> None:
    from warpffrf.output.written_file import Written

    file = tmp_path / "run.h5"
    file.write_bytes(bytes(14_200_000))
    assert str(Written.of("results", file, 1.234)) == f"'{file}', 14.2 MB, written in 1.23 s"


def test_misspelled_attributes_are_answered_with_the_nearest_public_names() -> None:
    body: Any = BodyHistory(*(np.zeros((2, n)) for n in (3, 4, 3, 3, 0)))
    with pytest.raises(
        AttributeError, match="'BodyHistory' object has no attribute 'velocty'; did you mean 'velocity'"
    ):
        body.velocty  # noqa: B018
    for name, said in (("peak_presure", "did you mean 'peak_pressure'"), ("fricton", "did you mean 'friction'")):
        with pytest.raises(AttributeError, match=said):
            getattr(ContactResult.__new__(ContactResult), name)
    for name in ("zzz", "_velocity", "__wrapped__"):
        with pytest.raises(AttributeError, match=rf"no attribute '{name}'$"):
            getattr(body, name)


def test_a_property_that_fails_says_why() -> None:
    class Own(reprs.Shown):
        @property
        def size(self) -> int:
            return None.length  # pyright: ignore[reportAttributeAccessIssue]

    with pytest.raises(AttributeError, match="'NoneType' object has no attribute 'length'"):
        Own().size  # noqa: B018
