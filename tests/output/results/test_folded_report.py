"""Reports of machines with many alike things: as one, with the least and the largest of each figure and whose it is."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.output.report.fold import FEWEST, Entry, Figure, folded, folded_notes
from warpffrf.output.result import Result

COUNT = 6
Y, Z = (0, 1, 0), (0, 0, 1)
STEEL = wf.Material(210e9, 0.3, 7850.0)
PLACED: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": Y}


def cushions(count: int) -> wf.Scene:
    """Rollers that their own springs press on rings, which other springs hold, with a grid each of their own kind: one
    flexible roller, in as many places, on the flat ground, under growing loads; and rigid ones, lumped, next to
    them."""
    mesh = wf.mesh.roller(0.01, 0.005, 0.004, sectors=60, layers=2, axial=1, order=1)
    roller = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0, cache=False,
        progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    for n in range(count):
        floor = scene.ground.surface(wf.surfaces.Plane(origin=(0.1 * n, 0, 0), outward=Z), name=f"floor {n}")
        body = scene.add_body(roller, name=f"roller {n}", position=(0.1 * n, 0, 0.01))
        guide = scene.add(wf.joints.Prismatic(scene.ground, body["bore"], axis=Z, name=f"guide {n}"))
        scene.add(wf.forces.JointSpringDamper(guide, 1e6, 1e3, preload=2e3 * (1 + (5 * n) % count), name=f"spring {n}"))
        scene.add(wf.Contact(body["rim"], floor, name=f"pair {n}"))
        skin = wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=Z)
        ball = scene.add_rigid_body(
            0.03, (1e-6,) * 3, name=f"ball {n}", position=(0.1 * n, 1, 0.01), surfaces={"skin": skin}
        )
        slide = scene.add(wf.joints.Prismatic(scene.ground, ball.at((0, 0, 0)), axis=Z, name=f"slide {n}"))
        scene.add(wf.forces.JointSpringDamper(slide, 1e3, preload=10.0 * (1 + (3 * n) % count), name=f"push {n}"))
        scene.add(wf.LumpedContact(ball["skin"], floor, law=wf.laws.HertzPoint(STEEL, STEEL), name=f"ball {n}"))
    return scene


@pytest.fixture(scope="module")
def result() -> Result:
    return wf.simulate(cushions(COUNT), 2e-4, step=1e-4, start="equilibrium", progress=False)


def test_a_bearing_is_reported_on_one_screen(result: Result) -> None:
    assert result.status == "completed", result.message
    every, few = (result.report(progress=False, pairs=pairs).splitlines() for pairs in ("all", "folded"))
    assert len(every) > 10 * COUNT
    assert len(few) < len(every) - 8 * COUNT and len(few) < 60
    assert result.report(progress=False).splitlines() == few


def test_least_and_largest_are_those_of_the_table(result: Result) -> None:
    """Against the histories themselves, and the names with them."""
    text = result.report(progress=False)
    forces = {name: result.contact(name).force_magnitude[-1] for name in result.contact_names}
    least, largest = min(forces, key=lambda n: forces[n]), max(forces, key=lambda n: forces[n])
    assert f"{COUNT} contacts 'pair 0' to 'pair {COUNT - 1}': last row" in text
    assert f"  force           {forces[least]:.6g} ('{least}') to {forces[largest]:.6g} ('{largest}') N" in text
    widths = [result.contact(name).half_width[-1] * 1e6 for name in result.contact_names]
    assert f"  half-width      {min(widths):.5g} ('" in text and f"to {max(widths):.5g} ('" in text
    lumped = {n: np.linalg.norm(result.lumped_contact(n).force[-1]) for n in result.lumped_contact_names}
    least, largest = min(lumped, key=lambda n: lumped[n]), max(lumped, key=lambda n: lumped[n])
    line = next(line for line in text.splitlines() if line.startswith(f"{COUNT} lumped contacts 'ball 0' to"))
    assert f"force {lumped[least]:.5g} ('{least}') to {lumped[largest]:.5g} ('{largest}') N" in line
    assert re.search(rf"^{COUNT} joints 'guide 0' to 'guide {COUNT - 1}': reaction ", text, re.M)
    assert re.search(rf"^{COUNT} forces 'push 0' to 'push {COUNT - 1}': ", text, re.M)


def test_all_are_there_when_they_are_asked_for(result: Result) -> None:
    text = result.report(progress=False, pairs="all")
    for name in result.contact_names:
        force = result.contact(name).force_magnitude[-1]
        assert f"contact '{name}': last row, a line across the width\n  force           {force:.6g} N" in text
    for name in (*result.lumped_contact_names, *result.history.joints, *result.history.forces):
        assert f"'{name}': " in text
    with pytest.raises(wf.InputError, match="pairs is 'each'; known: 'folded', 'all'"):
        result.report(pairs="each")  # pyright: ignore[reportArgumentType]


def said(text: str) -> Figure:
    return Figure("", text, inline=True)


def test_one_that_differs_stays_by_itself() -> None:
    """In a word, in the number of its figures, or in its sort; and few are not folded."""
    texts = [f"{n}.5 mm2, {-n} m/s2 and {n}e-3 um by Hertz's '{n}x'" for n in range(FEWEST + 2)]
    entries = [Entry("thing", (f"a {n}",), [said(text)]) for n, text in enumerate(texts)]
    odd = Entry(
        "thing", ("a 9",), [said("9.5 mm2, -9 m/s2 and 9e-3 um by Hertz's '9x'"), Figure("warning", "of no use")]
    )
    other = Entry("thing", ("a 8",), [said(texts[0])], sort="another")
    group, *rest = folded([*entries, odd, other])
    assert group.names == tuple(f"a {n}" for n in range(FEWEST + 2))
    assert group.lines() == [
        f"{FEWEST + 2} things 'a 0' to 'a {FEWEST + 1}': 0.5 ('a 0') to {FEWEST + 1}.5 ('a {FEWEST + 1}') mm2, "
        f"-{FEWEST + 1} ('a {FEWEST + 1}') to 0 ('a 0') m/s2 and 0e-3 ('a 0') to {FEWEST + 1}e-3 "
        f"('a {FEWEST + 1}') um by Hertz's '#x'"
    ]
    assert rest == [odd, other]
    assert odd.lines() == [f"thing 'a 9': {odd.figures[0].text}", "  warning         of no use"]
    assert folded(entries[: FEWEST - 1]) == entries[: FEWEST - 1]
    assert folded(entries, "all") == entries


def test_notes_that_say_the_same_are_one() -> None:
    notes = [f"contact 'pair {n}': the patch is {n % 3} columns wide" for n in range(6)] + ["2 steps were halved"]
    assert folded_notes(notes) == [
        "6 alike, 'pair 0' to 'pair 5': contact 'pair #': the patch is 0 ('pair 0') to 2 ('pair 2') columns wide",
        "2 steps were halved",
    ]
    assert folded_notes(notes, "all") == notes
    of_surfaces = [f"contact surface roller {n}['rim']: 3 modes are neglected" for n in range(6)]
    assert folded_notes(of_surfaces) == ["6 alike: contact surface roller #['rim']: 3 modes are neglected"]


def test_what_is_not_a_number_is_counted() -> None:
    entries = [Entry("body", (f"a{n}",), [said(v)]) for n, v in enumerate(["nan", "1", "2", "nan"])]
    (found,) = folded(entries)
    assert found.lines() == ["4 bodies 'a0' to 'a3': 1 ('a1') to 2 ('a2'), 2 nan"]
    same = [Entry("body", entry.names, [said("2")]) for entry in entries[1:3]] * 2
    assert folded(same)[0].figures[0].text == "2"
