"""Small-sliding contacts that cannot be what was meant: faces that do not face each other, preload that nothing holds;
the cures."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.oils import Newtonian
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding import SmallSliding
from warpffrf.model.small_sliding.sliding import cells_of, refuse_pushed_apart, small_sliding_notes
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce

SIZE = (0.02, 0.02, 0.01)  # m


@lru_cache(maxsize=4)
def block(joint: str, head: str) -> Any:
    return reduce(
        box(SIZE, (2, 2, 1), order=1),
        Material(210e9, 0.3, 7800.0),
        interfaces={head: "rigid"},
        contact={"face": Matched(first=joint)},
        modes=2,
        cache=False,
        progress=False,
    )


def pair(
    place: tuple[float, float, float] = (0.0, 0.0, 0.0), turn: Any = (0, 0, 0, 1), interference: float = 0.0
) -> Scene:
    """A block on one that is held, moved from where it touches."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    low = scene.add_body(block("z_max", "z_min"), name="low", position=(0.0, 0.0, -0.005))
    high = scene.add_body(
        block("z_min", "z_max"), name="high", position=np.add((0.0, 0.0, 0.005), place), rotation=turn
    )
    scene.add(joints.Fixed(scene.ground, low["z_min"]))
    scene.add(Contact(high["face"], low["face"], sliding=SmallSliding(interference=interference), name="joint"))
    return scene


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (
            {"place": (0.05, 0.0, 0.0)},
            "contact 'joint'.*0 and 0 of their areas overlap.*0.03 m apart.*place the bodies",
        ),
        ({"place": (0.0, 0.0, 0.5)}, "0.5 m apart.*far apart"),
        ({"turn": (1.0, 0.0, 0.0, 0.0)}, "outward normals look the same way"),
    ],
)
def test_faces_that_do_not_face_each_other(given: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        cells_of(pair(**given).contacts[0])


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"place": (0.0, 0.0, 1e-3)}, "0.001 m apart where they are nearest.*scene.place"),
        ({"place": (0.0, 0.0, 1e-3), "interference": 1e-3}, None),
        ({"interference": 1e-3}, "begins 0.001 m inside the other.*unit of interference"),
        ({"place": (0.015, 0.0, 0.0)}, "0.25 and 0.25 of the areas.*smaller facet sets"),
        ({"place": (0.005, 0.0, 0.0)}, None),
        ({}, None),
    ],
)
def test_faces_that_hardly_touch_are_noted(given: dict[str, Any], says: str | None) -> None:
    lap = pair(**given).contacts[0]
    notes = small_sliding_notes(lap, cells_of(lap))
    assert len(notes) == (says is not None)
    if says is not None:
        with pytest.raises(InputError, match=says):
            raise InputError(notes[0])


def test_a_preload_without_a_load_path() -> None:
    scene = pair(interference=1e-6)
    with pytest.raises(InputError, match=r"pushes 'high' away, a preload without a load path.*preload=.*leave"):
        refuse_pushed_apart(scene)


@pytest.mark.parametrize("cure", ["bolt", "force", "gravity", "none"])
def test_what_holds_a_preload(cure: str) -> None:
    scene = pair(interference=0.0 if cure == "none" else 1e-6)
    low, high = scene.bodies
    if cure == "bolt":
        joint = scene.add(joints.Prismatic(low["z_min"], high["z_max"], axis=(0, 0, 1), point=(0, 0, 0)))
        scene.add(forces.JointSpringDamper(joint, 1e8, preload=1e3))
    elif cure == "force":
        scene.add(forces.PointForce(high["z_max"], (0.0, 0.0, -1e3)))
    elif cure == "gravity":
        scene.gravity = np.array([0.0, 0.0, -9.81])
    refuse_pushed_apart(scene)


def test_faces_on_both_sides_hold_each_other() -> None:
    """A block between two rigid faces, as a hub around its shaft: pressures have no resultant."""
    body = reduce(
        box(SIZE, (2, 2, 1), order=1),
        Material(210e9, 0.3, 7800.0),
        contact={"low": Matched(first="z_min"), "high": Matched(first="z_max")},
        modes=2,
        cache=False,
        progress=False,
    )
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body, name="held")
    for name, side in (("low", -1.0), ("high", 1.0)):
        face = surfaces.Plane(origin=(0, 0, side * 0.005), outward=(0, 0, -side), direction=(1, 0, 0))
        scene.add(
            Contact(
                held[name], scene.ground.surface(face, name=name), sliding=SmallSliding(interference=1e-6), name=name
            )
        )
        if name == "low":
            with pytest.raises(InputError, match="pushes 'held' away"):
                refuse_pushed_apart(scene)
    refuse_pushed_apart(scene)


def test_a_small_sliding_and_a_rolling_contact_on_the_same_facets() -> None:
    with pytest.raises(InputError, match=r"contact 'face': 4 facets of 'z_max' belong to contact surface.*separate"):
        reduce(
            box(SIZE, (2, 2, 1), order=1),
            Material(210e9, 0.3, 7800.0),
            contact={"face": Matched(first="z_max"), "z_max": surfaces.Plane()},
            modes=2,
            cache=False,
            progress=False,
        )


def test_the_kind_of_sliding_and_the_kind_of_surface_go_together() -> None:
    scene = pair()
    low, high = scene.bodies
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    with pytest.raises(InputError, match=r"high\['face'\], was reduced as surfaces.Matched.*give sliding='small'"):
        Contact(high["face"], floor)
    with pytest.raises(InputError, match="must be a face of a flexible body reduced as Matched.*got ground"):
        Contact(floor, high["face"], sliding="small")
    with pytest.raises(InputError, match="sliding must be 'finite', 'small', or SmallSliding"):
        Contact(high["face"], floor, sliding="tiny")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="contact 'joint': finite and small sliding are of other surfaces"):
        scene.contact("joint").sliding = "finite"  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(InputError, match="film: the first surface, high.*was reduced as surfaces.Matched"):
        Film(high["face"], floor, oil=Newtonian(0.01))
    with pytest.raises(InputError, match="are joined already, as contact 'joint'"):
        scene.add(Contact(high["face"], low["face"], sliding="small", name="again"))
    with pytest.raises(InputError, match="close_gap: a contact with finite sliding is needed"):
        scene.close_gap(scene.contact("joint"))


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("quadrature", "reduced"), ("grid", "contact_fixed"), ("kinematics", "closest_point"), ("cell_error", 0.01),
        ("cells", (11, 21)), ("capacity", 100), ("overlap", 1e-4),
    ],
)  # fmt: skip
def test_options_of_finite_sliding_are_refused(option: str, value: Any) -> None:
    contact = pair().contacts[0]
    with pytest.raises(InputError, match=f"contact 'joint': {option} is an option of finite sliding only"):
        setattr(contact, option, value)
    with pytest.raises(InputError, match=f"{option} is an option of finite sliding only"):
        Contact(contact.a, contact.b, sliding="small", **{option: value})
