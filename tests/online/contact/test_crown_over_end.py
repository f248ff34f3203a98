"""Crowned rollers on cells of the patch that run off an end: rows that are fine there, against a dense reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from patch_reference import Patch, line_edges, pressed
from scenes.rolling_pairs import STEEL, WIDTH, R, reduced, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import find_equilibrium, run
from warpffrf.online.compile.patches.plan import common_width, crowned_edges, end_places, is_crowned
from warpffrf.online.compile.patches.plan import line_edges as rows_of_lines
from warpffrf.online.diagnosis.border_notes import BORDER

CROWN = 2.0  # m: on both, 1/m of relative curvature along the axis, an ellipse of aspect 10 and more
TILT = 9e-3  # rad: two crowns touch at CROWN TILT/2 from their middles, 9 mm of 10
APPROACH = 2e-5  # m, of the crowns where they touch
LOAD = 3000.0  # N
LONG, SHARP = "use more rows in cells=", "one surface ends and the other continues"
FORCE = 0.005  # of the force, and of line loads over many rows: what `cell_error` asks for
EDGE = 0.02  # of the line load over two rows at a sharp edge, as r^-0.226, of which the first errs by 3 %
PEAK = 0.01  # of the largest pressure, where it is finite
HALF = 0.5 * WIDTH


@pytest.fixture(scope="module")
def crowned() -> ReducedBody:
    mesh = roller(4e-3, order=1, crown_radius=CROWN)
    return reduced(mesh, STEEL, crowned=True, tangential=None, cache=False)


@pytest.fixture(scope="module")
def straight() -> ReducedBody:
    return reduced(roller(4e-3, order=1), STEEL, tangential=None, cache=False)


def tilted(body: ReducedBody, tilt: float = TILT, **contact: Any) -> wf.Scene:
    """One above the other, which stands; the upper one tilted about x, APPROACH deep, and held."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(body, name="lower")
    height = 2.0 * R + 0.25 * CROWN * tilt**2 - APPROACH
    turn = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
    upper = scene.add_body(body, name="upper", position=(0, 0, height), rotation=turn)
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed", name="pair", **contact))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    return scene


def held(body: ReducedBody, tilt: float = TILT, **contact: Any) -> wf.Scene:
    scene = tilted(body, tilt, **contact)
    scene.add(wf.joints.Fixed(scene.ground, scene.bodies[1]["bore"]))
    return scene


def loaded(body: ReducedBody, tilt: float = TILT, load: float = LOAD, **contact: Any) -> wf.Scene:
    scene = tilted(body, tilt, **contact)
    upper = scene.bodies[1]["bore"]
    scene.add(wf.joints.Prismatic(scene.ground, upper, axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(upper, (0, 0, -load)))
    return scene


@dataclass
class Rows:
    """Pressures of a patch, summed across, by rows between `edges` [m]."""

    edges: np.ndarray
    line: np.ndarray  # N/m

    @classmethod
    def of(cls, found: Any) -> Rows:
        cells, p = found.cells, found.pressure[-1]
        length = cells.length[-1]
        edges = np.append(cells.z[-1] - 0.5 * length, cells.z[-1][-1] + 0.5 * length[-1])
        return cls(edges, p.sum(axis=0) * 2.0 * cells.half_width[-1] / len(p))

    @property
    def force(self) -> float:
        return float(self.line @ np.diff(self.edges))

    def mean(self, length: float) -> float:
        """Of the line load over a `length` [m] from the first end."""
        load = np.append(0.0, np.cumsum(self.line * np.diff(self.edges)))
        return float(np.interp(self.edges[0] + length, self.edges, load)) / length


def drop(z: np.ndarray) -> np.ndarray:
    """By how much [m] the crown has left the radius R at z [m]."""
    return CROWN - np.sqrt(CROWN**2 - z**2)


def reference(body: ReducedBody, tilt: float, height: float, half_width: float, drop: Any = drop) -> Rows:
    """Dense, of both bodies with their own ends, on rows that grow from both ends of the common width, `half_width` [m]
    of the patch: the upper one's surface is rotated about its own middle, `height` [m] above the lower one."""
    columns = 25
    shift = R * np.sin(tilt)  # of the upper meridian along the lower one
    low, high = shift - HALF * np.cos(tilt), HALF
    edges = line_edges(high - low, 0.05e-3, 0.6e-3) + 0.5 * (low + high)
    strip = 2.4 * half_width / columns
    below = Patch(body, "rim", "bore", 0.0, columns, strip, edges)
    above = Patch(body, "rim", "bore", 0.0, columns, strip, edges - shift)
    z = below.z
    on_upper = z - shift
    for _ in range(3):  # its places above those of the lower one
        on_upper = (z - (R - drop(on_upper)) * np.sin(tilt)) / np.cos(tilt)
    gap = height + on_upper * np.sin(tilt) - (R - drop(on_upper)) * np.cos(tilt) - (R - drop(z)) + below.x**2 / R
    f = pressed(below.near + below.far + below.modes + above.near + above.far + above.modes, gap)
    return Rows(edges, f.reshape(columns, -1).sum(axis=0) / np.diff(edges))


@pytest.fixture(scope="module")
def dense(crowned: ReducedBody) -> Rows:
    return reference(crowned, TILT, 2.0 * R + 0.25 * CROWN * TILT**2 - APPROACH, 0.5e-3)


def test_where_tilted_rollers_end(crowned: ReducedBody) -> None:
    """They face each other R above the middle of the lower one, which is R below that of the upper one: its ends lie
    R sin(tilt) further along than its axis has them there."""
    contact = held(crowned).contacts[0]
    low = R * np.sin(TILT) - HALF * np.cos(TILT)
    assert common_width(contact) == pytest.approx((low, HALF), abs=1e-9)
    assert sorted(end_places(contact)) == pytest.approx([-HALF, low, HALF, low + 2.0 * HALF], abs=1e-6)


def test_at_an_end_as_the_reference(crowned: ReducedBody, dense: Rows) -> None:
    """A prescribed approach, which presses nowhere near the middle of the rollers."""
    rest = find_equilibrium(held(crowned))
    assert rest.status == "completed", rest.message
    found = Rows.of(rest.contacts["pair"])
    assert found.force == pytest.approx(dense.force, rel=FORCE)
    for length, within in ((0.25e-3, EDGE), (1e-3, FORCE), (4e-3, FORCE)):
        assert found.mean(length) == pytest.approx(dense.mean(length), rel=within)
    assert found.line[0] > found.line[1]  # of a corner on a surface that goes on
    assert any(SHARP in note for note in rest.notes)
    assert not any(LONG in note for note in rest.notes)


def test_more_rows_measure_the_end_better(crowned: ReducedBody, dense: Rows) -> None:
    """The line load over the last 0.25 mm, where the row at the end is as much shorter as all others are."""
    few, many = (Rows.of(find_equilibrium(held(crowned, cells=(11, n))).contacts["pair"]) for n in (15, 41))
    assert np.diff(few.edges)[0] > 2.5 * np.diff(many.edges)[0]
    errors = [abs(found.mean(0.25e-3) / dense.mean(0.25e-3) - 1.0) for found in (few, many)]
    assert errors[1] < 0.5 * errors[0] < 0.5 * 2.0 * EDGE


def test_straight_rollers_that_touch_at_an_end(straight: ReducedBody) -> None:
    """They are no crowned ones for being tilted, and press where the middle of the patch is open."""
    tilt = 2e-3
    height = 2.0 * R + HALF * tilt - 0.5 * APPROACH
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(straight, name="lower")
    turn = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
    upper = scene.add_body(straight, name="upper", position=(0, 0, height), rotation=turn)
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed", cells=(11, 41), name="pair"))
    for body in (lower, upper):
        scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    found = Rows.of(rest.contacts["pair"])
    assert np.array_equal(found.edges.round(12), rows_of_lines(*common_width(scene.contacts[0]), 41).round(12))
    dense = reference(straight, tilt, height, 0.3e-3, np.zeros_like)
    assert found.force == pytest.approx(dense.force, rel=FORCE)
    assert found.mean(0.5e-3) == pytest.approx(dense.mean(0.5e-3), rel=EDGE)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
@pytest.mark.parametrize("angle", [1e-8, 1e-7, 1e-3])
def test_no_crown_of_axes_that_hardly_cross(straight: ReducedBody, axis: tuple[float, ...], angle: float) -> None:
    """By round-off, or by an angle that lifts straight rollers off each other by less than 1e-6 of their width."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(straight, name="lower")
    turn = np.append(np.sin(0.5 * angle) * np.array(axis), np.cos(0.5 * angle))
    upper = scene.add_body(straight, name="upper", position=(0.0, 0.0, 2.0 * R), rotation=turn)
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed", name="pair"))
    assert 0.5 * HALF**2 * angle**2 / R < 1e-6 * WIDTH
    assert not is_crowned(contact)


@pytest.mark.parametrize("tilt", [0.0, 2e-3])
def test_a_patch_that_ends_before_keeps_its_rows(crowned: ReducedBody, tilt: float) -> None:
    """Rows about the crown alone, bit for bit."""
    scene = loaded(crowned, tilt, 1000.0)
    rest = find_equilibrium(scene)
    found = Rows.of(rest.contacts["pair"])
    assert found.line[[0, -1]] == pytest.approx([0.0, 0.0], abs=0.0)
    cells: Any = rest.contacts["pair"].cells
    assert "off_end" not in rest.checkpoint
    if tilt == 0.0:
        assert np.array_equal(cells.length[-1], np.diff(crowned_edges(*common_width(scene.contacts[0]), 0.0, 27)))
    assert len(found.line) == 27


def test_on_a_plane(crowned: ReducedBody) -> None:
    """Pressure is finite at an end on a rigid plane; a row that is as long as the patch is wide is named."""
    tilt, columns = 0.5 * TILT, 25
    found = {}
    for cells in (None, (11, 9)):
        scene = wf.Scene(gravity=(0, 0, 0))
        height = R + 0.5 * CROWN * tilt**2 - 0.5 * APPROACH
        turn = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
        body = scene.add_body(crowned, name="roller", position=(0, 0, height), rotation=turn)
        plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0))
        port = scene.ground.surface(plane, name="plane")
        scene.add(wf.Contact(body["rim"], port, grid="contact_fixed", cells=cells, name="pair"))
        scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
        found[cells] = find_equilibrium(scene)
        assert found[cells].status == "completed", found[cells].message
        assert any(LONG in note for note in found[cells].notes) == (cells is not None)
    edges = line_edges(WIDTH, 0.05e-3, 0.6e-3)
    patch = Patch(crowned, "rim", "bore", 0.0, columns, 2.4 * 0.5e-3 / columns, edges)
    gap = height + patch.z * np.sin(tilt) - (R - drop(patch.z)) * np.cos(tilt) + 0.5 * patch.x**2 / R
    pressure = pressed(patch.near + patch.far + patch.modes, gap) / patch.areas
    mine = found[None].contacts["pair"]
    assert Rows.of(mine).force == pytest.approx(pressure @ patch.areas, rel=FORCE)
    assert mine.pressure[-1].max() == pytest.approx(pressure.max(), rel=PEAK)
    assert mine.pressure[-1].max(axis=0)[0] > BORDER * mine.pressure[-1].max()


def test_a_run_begins_anew(crowned: ReducedBody) -> None:
    """In time, with a load that drives the patch over the end, and in load steps; what goes on keeps rows."""
    scene = held(crowned, cells=(11, 15))
    for history in (
        run(scene, 4e-6, step=1e-6, start="equilibrium", progress=False),
        wf.static(scene, 1.0, step=0.5, progress=False).history,
    ):
        assert history.status == "completed", history.message
        first = np.diff(Rows.of(history.contacts["pair"]).edges)
        assert first[0] < 0.3 * first.max()
        assert history.checkpoint["off_end"].all()
    on = run(scene, 2e-6, step=1e-6, start=run(scene, 4e-6, step=1e-6, start="equilibrium", progress=False),
             progress=False)  # fmt: skip
    assert on.status == "completed", on.message
    assert np.array_equal(np.diff(Rows.of(on.contacts["pair"]).edges), first)
