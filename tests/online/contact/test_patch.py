"""Pressures on cells that travel with the patch: against a dense NumPy reference, Hertz, and what must not change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

import warpffrf as wf
from patch_reference import Patch, press_both
from references.closed_forms import LineContact, PointContact, contact_modulus
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.far_field import UNUSABLE
from warpffrf.online import run
from warpffrf.online.compile.patches.plan import MIDDLE_ROW, SPAN, PatchPlan, crowned_edges, span_of
from warpffrf.online.engine import Engine
from warpffrf.online.run import find_equilibrium
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.linearise import linearise

STEEL = wf.Material(210e9, 0.3, 7800.0)
RADIUS, WIDTH = 0.05, 0.02
NAME = "lower-upper"
LAWS = [
    wf.laws.LinearLayer(3e14), wf.laws.NonlinearLayer(1e21, 1.5), wf.laws.HuntCrossley(1e20, 1.5, 0.1),
    wf.laws.TabulatedLayer((-3e-6, -1e-6, 0.0), (1e9, 2e8, 0.0)), wf.laws.ExponentialAsperities(3e8, 5e-7),
]  # fmt: skip
# Forces of the run and of the reference on the same cells; tables between levels of W err by 5e-5.
SAME = 2e-4
# Two patches side by side: parabolas for round gaps, rows in their middles, strips without a width compared with their
# distance.
BESIDE = 2e-3
TAIL, CUT_OFF = 0.05, 1e-3  # of the largest line pressure, in the outermost strips; of the force, beyond them: 4e-4
RIPPLE = 5e-4  # of a force at constant approach over two elements, from one saved step to another; 6e-5 measured
POINT = 0.01  # half-widths and peaks of a ball on eight cells, against Hertz at the load
ENERGY = 5e-3  # of the energy of an impact, that cells which grow and shrink with it make or take: 3e-3 measured
LINEARISED = 0.01  # of a compliance: cells that stay where they are, or follow; 0.4 and 0.9 % measured
# Of pressures as cell means in the root of the mean square, times the strips in b, compared with Hertz at the line
# load: 0.041 to 0.046 measured. An edge in the middle of a strip makes it 0.14 in the half-plane.
MEANS = 0.05
MOVING = 1e-3  # of the contact's energy, that a patch makes which travels over elements of 8 mm: 4.4e-4 measured


@pytest.fixture(scope="module")
def roller():
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=40, layers=4, axial=3, order=1)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
        grid=wf.ContactGrid(contact_fixed=True, tangential=True), cache=False, progress=False,
    )  # fmt: skip


def pair(roller, approach, *, turning: float | None = None, tilt: float = 0.0, **contact):
    """Two rollers whose bores are held at an `approach` [m], or turn at a speed [rad/s]."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    half = 0.5 * tilt
    upper = scene.add_body(
        roller, name="upper", position=(0, 0, 2 * RADIUS - approach), rotation=(np.sin(half), 0, 0, np.cos(half))
    )
    for body, sense in ((lower, 1.0), (upper, -1.0)):
        if turning is None:
            scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
            continue
        axle = scene.add(wf.joints.Revolute(scene.ground, body["bore"], axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(axle, wf.signals.Ramp(0.0, sense * turning, duration=1e-3), quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], upper["rim"], **{"grid": "contact_fixed", **contact}))
    return scene


def pressed(roller, found, gap, approach, layer=None) -> np.ndarray:
    """Forces (cells,) of the reference on the cells that a run has `found`: half of a pair is a roller on a plane."""
    cells, length = found.cells, found.cells.length[-1]
    edges = np.append(cells.z[-1] - 0.5 * length, cells.z[-1][-1] + 0.5 * length[-1])
    grid = roller.contact_surfaces["rim"].grid
    strips = found.pressure.shape[1]
    patch = Patch(
        roller, "rim", "bore", grid.theta_start + grid.pitch * cells.column[-1], strips,
        2.0 * cells.half_width[-1] / strips, edges,
    )  # fmt: skip
    return patch.press(gap(patch), 0.5 * approach, layer)


def pressed_wide(roller, found, approach, layer) -> float:
    """Force of the reference on strips over half as much again as the run's, of the same width."""
    cells, length = found.cells, found.cells.length[-1]
    edges = np.append(cells.z[-1] - 0.5 * length, cells.z[-1][-1] + 0.5 * length[-1])
    grid, strips = roller.contact_surfaces["rim"].grid, found.pressure.shape[1]
    wide = Patch(
        roller, "rim", "bore", grid.theta_start + grid.pitch * cells.column[-1], strips + 8,
        2.0 * cells.half_width[-1] / strips, edges,
    )  # fmt: skip
    return float(wide.press(round_gap(wide), 0.5 * approach, layer).sum())


def round_gap(patch):
    return RADIUS - np.sqrt(RADIUS**2 - patch.x**2)


@pytest.mark.parametrize("cells", [None, (8, 9)])
@pytest.mark.parametrize("approach", [5e-6, 20e-6])
def test_two_rollers_compared_with_the_reference(roller, approach, cells) -> None:
    """A mesh of 8 mm elements and half-widths of 0.2 and 0.43 mm."""
    found = find_equilibrium(pair(roller, approach, cells=cells)).contacts[NAME]
    reference = pressed(roller, found, round_gap, approach)
    assert np.linalg.norm(found.force[-1]) == pytest.approx(reference.sum(), rel=SAME)
    p = reference.reshape(found.pressure[-1].shape)
    area = found.pressure[-1] > 0.0
    assert np.array_equal(area, p > 0.0)
    assert np.allclose(found.force_second, -found.force, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("strips", [7, 9, 11, 13, 21])
def test_pressures_are_means_of_those_of_hertz(roller, strips: int) -> None:
    """In the middle row, whose strips end where the patch ends."""
    result = find_equilibrium(pair(roller, 40e-6, cells=(strips, 9)))
    found = result.contacts[NAME]
    assert found.cells is not None
    row = found.pressure.shape[2] // 2
    s, p = 2.0 * found.cells.half_width[-1] / strips, found.pressure[-1][:, row]
    hertz = LineContact(float(s * p.sum()), 0.5 * RADIUS, contact_modulus(STEEL, STEEL))
    b = hertz.half_width
    edges = np.clip(s * (np.arange(strips + 1) - 0.5 * strips) / b, -1.0, 1.0)
    area = 0.5 * (edges * np.sqrt(1.0 - edges**2) + np.arcsin(edges))
    means = hertz.peak_pressure * b / s * np.diff(area)
    n = b / s
    assert np.linalg.norm(p - means) < MEANS / n * np.linalg.norm(means)
    assert span_of(strips) == pytest.approx(SPAN, abs=0.13)  # half a strip of 13
    free = 0.5 * strips * (1.0 - 1.0 / span_of(strips))
    assert free == pytest.approx(round(free), abs=1e-12)


def test_tilted(roller) -> None:
    """0.3 mrad about the rolling direction: the gap opens along the rollers, and the pressure moves to one end."""
    tilt, approach = 3e-4, 20e-6
    found = find_equilibrium(pair(roller, approach, tilt=tilt)).contacts[NAME]
    # half of the tilt on each side of the plane between the rollers
    reference = pressed(roller, found, lambda p: round_gap(p) + 0.5 * tilt * p.z, approach)
    assert np.linalg.norm(found.force[-1]) == pytest.approx(reference.sum(), rel=1e-3)  # z of the tilted one: 1e-4


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.kind)
def test_with_a_layer(roller, law) -> None:
    """Any law, in series with the bodies."""
    approach = 20e-6
    found = find_equilibrium(pair(roller, approach, law=law)).contacts[NAME]
    reference = pressed(roller, found, round_gap, approach, law.curve)
    assert np.linalg.norm(found.force[-1]) == pytest.approx(reference.sum(), rel=SAME)
    cells = found.cells
    assert cells is not None
    strip = 2.0 * cells.half_width[-1] / found.pressure.shape[1]
    peak = (reference.reshape(found.pressure[-1].shape) / (strip * cells.length[-1])).max()
    assert found.pressure[-1].max() == pytest.approx(peak, rel=SAME)


@pytest.mark.parametrize(("decay", "approach"), [(5e-7, 20e-6), (2e-6, 1e-5), (5e-6, -5e-6)])
def test_tails_of_asperities(roller, decay, approach) -> None:
    """Strips take in what presses, also of surfaces that are apart: 1.7 half-widths of the pressure lose little
    compared with the patch of very rough surfaces that is half as wide again."""
    law = wf.laws.ExponentialAsperities(2e8, decay)
    found = find_equilibrium(pair(roller, approach, law=law))
    assert found.status == "completed"
    contact = found.contacts[NAME]
    p = contact.pressure[-1].sum(axis=1)
    assert p[0] < TAIL * p.max() and p[-1] < TAIL * p.max()
    force = np.linalg.norm(contact.force[-1])
    wide = pressed_wide(roller, contact, approach, law.curve)
    assert force == pytest.approx(wide, rel=CUT_OFF)


@pytest.mark.parametrize("apart", [0.12, 0.3])
def test_two_rollers_side_by_side(roller, apart) -> None:
    """Rigid rollers 6 and 15 mm apart on elements of 8 mm: what one does to the other is the half-space's, too.
    Compared with the reference from cell to cell."""
    approach, small = 10e-6, 0.1 * RADIUS
    scene = wf.Scene(gravity=(0, 0, 0))
    body = scene.add_body(roller, name="lower")
    scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
    for n, angle in enumerate((-0.5 * apart, 0.5 * apart)):
        place = (RADIUS + small - approach) * np.array([np.sin(angle), 0.0, np.cos(angle)])
        shape = wf.surfaces.Cylinder(radius=small, axis_point=place, axis_direction=(0, 1, 0))
        scene.add(
            wf.Contact(body["rim"], scene.ground.surface(shape, name=f"{n}"), grid="contact_fixed", name=f"pair {n}")
        )
    found = [find_equilibrium(scene).contacts[f"pair {n}"] for n in (0, 1)]
    grid = roller.contact_surfaces["rim"].grid
    patches = []
    for one in found:
        cells, strips = one.cells, one.pressure.shape[1]
        assert cells is not None
        length = cells.length[-1]
        edges = np.append(cells.z[-1] - 0.5 * length, cells.z[-1][-1] + 0.5 * length[-1])
        theta = grid.theta_start + grid.pitch * cells.column[-1]
        patches.append(Patch(roller, "rim", "bore", theta, strips, 2.0 * cells.half_width[-1] / strips, edges))
    assert abs(patches[0].theta - patches[1].theta) == pytest.approx(apart, abs=1e-5)
    gap = np.concatenate([p.x**2 * 0.5 * (1.0 / RADIUS + 1.0 / small) for p in patches])
    reference = press_both(patches[0], patches[1], gap, approach)
    for one, part in zip(found, np.split(reference, 2), strict=True):
        assert np.linalg.norm(one.force[-1]) == pytest.approx(part.sum(), rel=BESIDE)


@pytest.mark.parametrize("middle", [0.0, 3e-3])
def test_rows_under_a_crown(middle) -> None:
    """They fill the width, are finest where the crown carries, and grow evenly from there."""
    edges = crowned_edges(-0.01, 0.01, middle, 27)
    length = np.diff(edges)
    assert edges[[0, -1]] == pytest.approx([-0.01, 0.01], rel=1e-12)
    assert length.min() == pytest.approx(MIDDLE_ROW * 0.02, rel=1e-6)
    assert abs(0.5 * (edges[1:] + edges[:-1])[np.argmin(length)] - middle) < length.min()
    assert np.max(np.abs(np.log(length[1:] / length[:-1]))) < 0.25


def test_partner_that_travels_along_the_axis(roller) -> None:
    """Its free ends stay where they were for the near field, and the run says so."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * RADIUS - 1e-5))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    slide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(slide, wf.signals.Ramp(0.0, 1.0, duration=1e-3), quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed"))
    history = run(scene, 1e-3, step=1e-4, start="equilibrium", progress=False)
    assert history.status == "completed"
    assert any("moved 0.0005 m along the axis" in note for note in history.notes)


def test_rolling(roller) -> None:
    """Two elements long: the force does not know them, nor does frictionless contact turn an axle."""
    step = 1e-4
    turn = 2.0 * 2.0 * np.pi / 40  # rad
    history = run(pair(roller, 20e-6, turning=turn / 60e-4), 60 * step, step=step, start="equilibrium", progress=False)
    assert history.status == "completed"
    found = history.contacts[NAME]
    force = np.linalg.norm(found.force, axis=1)
    assert np.ptp(force) < RIPPLE * force.mean()
    assert np.max(np.abs(found.torque[:, 1])) < 1e-9 * force.mean() * RADIUS
    assert found.cells is not None and np.ptp(found.cells.column) > 1.5  # it has moved over the mesh
    assert np.max(np.abs(history.energy["contact_grid"])) < MOVING * history.energy["contact"][-1]


@pytest.fixture(scope="module")
def ball():
    mesh = wf.mesh.ball(0.01, patch_half_width=0.0039, cell=0.0026, order=1, growth=2.0)
    return wf.reduce(
        mesh, STEEL, interfaces={"outside": "average"}, contact={"patch": wf.surfaces.Sphere()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


DOWN = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # turns the patch of the mesh, around +x, to -z


def on_floor(ball, height, velocity=(0.0, 0.0, 0.0), **contact):
    scene = wf.Scene(gravity=(0, 0, 0))
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    body = scene.add_body(ball, name="ball", position=(0, 0, 0.01 + height), rotation=DOWN, velocity=velocity)
    scene.add(wf.Contact(body["patch"], floor, grid="contact_fixed", name="pair", **contact))
    return scene, body


def test_rows_end_where_a_narrower_plane_ends(roller) -> None:
    """Rows and tables are the same whichever surface is named first; a plane that lies across the roller is refused,
    whose ends are none of the rows."""

    def plans(direction) -> list[PatchPlan]:
        block = wf.reduce(
            wf.mesh.box((0.03, 0.014, 0.02), (6, 4, 3), order=1), STEEL, interfaces={"z_min": "rigid"},
            contact={"z_max": wf.surfaces.Plane(direction=direction)}, grid=wf.ContactGrid(contact_fixed=True),
            cache=False, progress=False,
        )  # fmt: skip
        scene = wf.Scene(gravity=(0, 0, 0))
        below = scene.add_body(block, name="block")
        above = scene.add_body(roller, name="roller", position=(0, 0, 0.01 + RADIUS))
        ports = above["rim"], below["z_max"]
        with np.errstate(divide="raise", invalid="raise"):
            return [PatchPlan.of(wf.Contact(*pair, cells=(9, 11), name=NAME)) for pair in (ports, ports[::-1])]

    first, second = plans((0, 1, 0))
    assert first.edges[[0, -1]] == pytest.approx([-0.007, 0.007])
    np.testing.assert_allclose(first.edges, second.edges, atol=1e-15)
    np.testing.assert_allclose(first.table, second.table, rtol=1e-9)
    with pytest.raises(InputError, match="lie across the axis of .*direction="):
        plans((1, 0, 0))


def test_ball_on_a_plane(ball) -> None:
    """Four elements on the radius, a contact of 0.015 radii: half-widths and peak against Hertz at the force found."""
    scene, body = on_floor(ball, -2e-6)
    scene.add(wf.joints.Fixed(scene.ground, body["outside"]))
    found = find_equilibrium(scene).contacts["pair"]
    hertz = PointContact(abs(found.force[-1, 2]), 0.01, contact_modulus(STEEL))
    cells, p = found.cells, found.pressure[-1]
    assert cells is not None
    strip = 2.0 * cells.half_width[-1] / len(p)
    x = strip * (np.arange(len(p)) - 0.5 * (len(p) - 1))
    across = (p.sum(axis=1) * (x**2 + strip**2 / 12.0)).sum() / p.sum()
    z, length = cells.z[-1] - cells.z[-1].mean(), cells.length[-1]
    along = (p.sum(axis=0) * (z**2 + length**2 / 12.0)).sum() / p.sum()
    for second in (across, along):
        assert np.sqrt(5.0 * second) == pytest.approx(hertz.half_width, rel=POINT)
    assert p.max() == pytest.approx(hertz.peak_pressure, rel=POINT)


def test_impact_gives_back_its_energy(ball) -> None:
    """A ball falls on the floor and leaves: what cells that grow and shrink make of energy is small."""
    scene, _ = on_floor(ball, 1e-7, velocity=(0.0, 0.0, -0.1))
    history = run(scene, 2e-4, step=2e-6, progress=False)
    assert history.status == "completed"
    force = history.contacts["pair"].force[:, 2]
    assert force.max() > 50.0 and force[-1] == 0.0
    made = history.energy["contact_grid"] + history.energy["numerical"]
    assert np.max(np.abs(made)) < ENERGY * history.energy["kinetic"][0]


def without_tangential_field(body: wf.ReducedBody) -> wf.ReducedBody:
    """The body as files of before have it: no tangential far field in addition to its tangential modes."""
    rim = body.contact_surfaces["rim"]
    assert rim.far is not None
    surfaces = {"rim": replace(rim, far=replace(rim.far, tangential=None))}
    return replace(body, contact_surfaces=surfaces)


def test_what_a_patch_cannot_is_refused(roller) -> None:
    plain = wf.reduce(
        wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=24, layers=2, axial=2, order=1), STEEL,
        interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip
    with pytest.raises(
        InputError, match="grid='contact_fixed' needs the far field of .*grid=ContactGrid\\(contact_fixed=True\\)"
    ):
        pair(plain, 1e-5)
    with pytest.raises(InputError, match="grid 'mesh' does not exist; known: 'auto', 'body_fixed', 'contact_fixed'"):
        pair(roller, 1e-5, grid="mesh")
    with pytest.raises(InputError, match="friction on a patch needs the tangential far field of .*tangential=True"):
        pair(without_tangential_field(roller), 1e-5, friction=0.1)
    with pytest.raises(InputError, match="cells must be \\(strips across, rows along\\), got 12"):
        pair(roller, 1e-5, cells=12)
    layered = pair(roller, 1e-5, law=wf.laws.LinearLayer(1e14))
    lower, upper = layered.bodies
    layered.add(wf.Contact(lower["rim"], upper["rim"], law=wf.laws.LinearLayer(1e13), name="second", grid="body_fixed"))
    with pytest.raises(InputError, match="'second' uses the same surfaces, .* use grid=\"body_fixed\""):
        find_equilibrium(layered)
    scene = pair(roller, 1e-5)
    third = scene.add_body(roller, name="third", position=(2 * RADIUS - 1e-5, 0, 0))
    scene.add(wf.Contact(third["rim"], scene.bodies[0]["rim"], grid="body_fixed"))
    with pytest.raises(InputError, match="body 'lower' is also loaded by 'third-lower', .*give both the same grid="):
        find_equilibrium(scene)


def test_a_mesh_whose_half_space_is_not_symmetric_is_refused(roller) -> None:
    """As of cells fifty times as long as wide (docs/studies/pressure_ends.md): named, with the cure."""
    rim = roller.contact_surfaces["rim"]
    skew = replace(roller, contact_surfaces={"rim": replace(rim, far=replace(rim.far, asymmetry=2.0 * UNUSABLE))})
    with pytest.raises(InputError, match="half-space on the mesh of .*rim.*is not symmetric .50%.*squarer cells"):
        pair(skew, 1e-5)
    history = find_equilibrium(pair(skew, 1e-5, grid="auto"))
    assert history.contacts[NAME].cells is None
    assert any("pressures on the body-fixed grid" in n and "not symmetric" in n for n in history.notes)
    doubtful = replace(roller, contact_surfaces={"rim": replace(rim, far=replace(rim.far, asymmetry=0.1))})
    said = "is not symmetric (10%): forces of a patch of cells may err by more than 1 %"
    assert any(said in note for note in find_equilibrium(pair(doubtful, 1e-5)).notes)


def test_a_grid_far_longer_than_wide_is_refused(roller) -> None:
    """As in docs/studies/pressure_ends.md, where pressures were wrong by 8 to 18 % without a word."""
    rim = roller.contact_surfaces["rim"]
    long = replace(rim.grid, z=200.0 * np.asarray(rim.grid.z))
    stretched = replace(roller, contact_surfaces={"rim": replace(rim, grid=long)})
    with pytest.raises(InputError, match="contact grid of .*rim.* times as long as wide, more than the 40"):
        pair(stretched, 1e-5)


def test_the_grid_is_chosen(roller) -> None:
    """Patches where the bodies have what they need, the material grid where something is asked that they cannot do; and
    a run says so."""
    history = find_equilibrium(pair(roller, 10e-6, grid="auto"))
    assert history.contacts[NAME].cells is not None
    assert any(
        "pressures on the contact-fixed grid, for which its bodies were reduced" in note for note in history.notes
    )
    assert find_equilibrium(pair(roller, 10e-6, grid="body_fixed")).contacts[NAME].cells is None
    scene = pair(roller, 10e-6, grid="auto")
    third = scene.add_body(roller, name="third", position=(2 * RADIUS - 1e-5, 0, 0))
    scene.add(wf.joints.Fixed(scene.ground, third["bore"]))
    scene.add(wf.Contact(third["rim"], scene.bodies[0]["rim"], grid="body_fixed"))
    history = find_equilibrium(scene)
    assert history.contacts[NAME].cells is None
    assert any("body-fixed grid, as those of 'third-lower' on body 'lower' are" in note for note in history.notes)


def test_a_coarse_mesh_needs_no_option() -> None:
    """Neither the reduction nor the contact is informed that the mesh is coarse: pressures stand on cells, and nobody
    asks for a finer mesh."""
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=40, layers=4, axial=3, order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0, cache=False,
        progress=False,
    )  # fmt: skip
    assert not body.report["warnings"]
    history = find_equilibrium(pair(body, 1e-5, grid="auto"))
    assert history.contacts[NAME].cells is not None
    assert not any("finer mesh" in note for note in history.notes)


def test_a_run_states_why_cells_are_not_taken(roller) -> None:
    history = find_equilibrium(pair(without_tangential_field(roller), 1e-5, grid="auto", friction=0.1))
    assert history.contacts[NAME].cells is None
    assert any("body-fixed grid, whose columns are 0.0079 m apart" in n and "friction" in n for n in history.notes)


def test_flat_faces_on_each_other_stay_on_the_material_grid() -> None:
    """They have no width that cells could follow."""
    body = wf.reduce(
        wf.mesh.box((0.04, 0.03, 0.01), (8, 6, 2), order=1), STEEL, interfaces={"x_min": "average"},
        contact={"z_min": wf.surfaces.Plane()}, modes=0, cache=False, progress=False,
    )  # fmt: skip
    assert body.contact_surfaces["z_min"].far is not None
    scene = wf.Scene(gravity=(0, 0, 0))
    block = scene.add_body(body, name="block", position=(0, 0, -1e-7))
    scene.add(wf.joints.Fixed(scene.ground, block["x_min"]))
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(wf.Contact(block["z_min"], floor, name="flat"))
    history = find_equilibrium(scene)
    assert history.contacts["flat"].cells is None
    assert any("nearly as curved as each other" in note for note in history.notes)


def test_rollers_side_by_side_stay_on_the_material_grid(roller) -> None:
    """They have no width in common that rows could lie on; one may slide over the other later."""
    scene = pair(roller, 1e-5, grid="auto")
    scene.bodies[1].position = np.array([0.0, 1.1 * WIDTH, 2 * RADIUS - 1e-5])
    notes = Engine(scene).compiled.notes
    assert any("no width in common: pressures on the body-fixed grid" in note for note in notes)
    scene.contacts[0].grid = "contact_fixed"
    with pytest.raises(InputError, match="no width in common"):
        Engine(scene)


@pytest.mark.parametrize(
    ("cells", "law"),
    [(None, wf.laws.Unilateral()), ((9, 11), wf.laws.Unilateral()), ((9, 11), LAWS[1]), (None, LAWS[4])],
)
def test_what_is_linearised_keeps_its_cells(roller, cells: tuple[int, int] | None, law: wf.laws.Law) -> None:
    """The compliance of two pressed rollers, linearised and by the difference of two equilibria, whose cells follow.
    The last has no matrix."""

    def pressed_by(load: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        lower, upper = (scene.add_body(roller, name=n, position=(0, 0, z)) for n, z in (("lower", 0), ("upper", 0.1)))
        scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
        scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
        scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -load)))
        scene.add(wf.Contact(lower["rim"], upper["rim"], cells=cells, law=law))
        return scene

    load, more = 1e4, 50.0
    heights = [find_equilibrium(pressed_by(f)).bodies["upper"].position[0, 2] for f in (load - more, load + more)]
    engine = Engine(pressed_by(load))
    assert settle(engine)
    linear = linearise(engine)
    scale = 1.0 / np.sqrt(np.diag(linear.M))
    free = scale[:, None] * null_space(linear.C * scale)
    upper = engine.scene.bodies[1]
    pull = np.zeros(len(scale))
    pull[6 * upper.index + 2] = -1.0
    pull[-upper.mode_count :] = -roller.interfaces["bore"].modes[:, 2]
    moved = linear.T @ free @ np.linalg.lstsq(free.T @ linear.K @ free, free.T @ pull, rcond=1e-14)[0]
    given = (heights[1] - heights[0]) / (2.0 * more)
    assert moved[6 * upper.index + 2] == pytest.approx(given, rel=LINEARISED)
