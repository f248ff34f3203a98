"""Structured bodies for contact: block, ball, sleeve and ring, and rollers with a profile."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references.finite_elements.meshes import facet_shares
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import ball, block, cage, ring, roller, sleeve
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.surfaces import ProfiledCylinder, Sphere

ROUND_OFF = 1e-12


def spherical_cap(R: float, h: float) -> float:
    return np.pi * h**2 * (3.0 * R - h) / 3.0


def grooved_volume(bore: float, outer: float, width: float, Rc: float, depth: float) -> float:
    """Closed form: pi int (R_o^2 - R^2) dy, R = A + w, A = R0 - Rc, w = sqrt(Rc^2 - y^2) in the groove."""
    A, e = bore + depth - Rc, np.sqrt(depth * (2.0 * Rc - depth))
    w = e * np.sqrt(Rc**2 - e**2) + Rc**2 * np.arcsin(e / Rc)  # int w dy over the groove
    inside = 2.0 * e * A**2 + 2.0 * A * w + 2.0 * (Rc**2 * e - e**3 / 3.0)
    return np.pi * (outer**2 * width - bore**2 * (width - 2.0 * e) - inside)


GROOVED: dict[str, Any] = {"groove_radius": 0.0052, "groove_depth": 0.002}
BODIES = {
    "block": (lambda o: block((0.02, 0.03, 0.01), patch_half_width=(4e-4, 6e-4), cell=2e-4, order=o), 6e-6),
    "ball": (lambda o: ball(0.01, patch_half_width=4e-4, cell=1e-4, order=o), 4.0 / 3.0 * np.pi * 1e-6),
    "sleeve": (lambda o: sleeve(0.02, 0.04, 0.01, sectors=48, axial=2, order=o), np.pi * 1.2e-3 * 0.01),
    "arc": (lambda o: sleeve(0.02, 0.04, 0.01, sectors=160, axial=2, fine_arc=0.3, order=o), np.pi * 1.2e-3 * 0.01),
    "ring": (
        lambda o: ring(0.02, 0.03, 0.014, sectors=48, axial=8, lands=2, order=o, **GROOVED),
        grooved_volume(0.02, 0.03, 0.014, 0.0052, 0.002),
    ),
    "barrel": (
        lambda o: roller(0.01, 0.002, 0.012, crown_radius=0.01, sectors=40, layers=4, axial=8, order=o),
        4.0 / 3.0 * np.pi * 1e-6 - 2.0 * spherical_cap(0.01, 0.004) - np.pi * 0.002**2 * 0.012,
    ),
    "solid": (
        lambda o: roller(0.01, 0, 0.012, crown_radius=0.01, sectors=40, layers=4, axial=8, order=o),
        4.0 / 3.0 * np.pi * 1e-6 - 2.0 * spherical_cap(0.01, 0.004),
    ),
    "cone": (
        lambda o: roller(0.011, 0.002, 0.01, profile=lambda y: 0.01 + 0.2 * y, sectors=40, layers=4, axial=3, order=o),
        np.pi * (0.009**2 + 0.009 * 0.011 + 0.011**2) / 3.0 * 0.01 - np.pi * 0.002**2 * 0.01,
    ),
}


@pytest.fixture(scope="module", params=BODIES)
def body(request):
    make, volume = BODIES[request.param]
    return request.param, {order: make(order) for order in (1, 2)}, volume


def test_cells_are_sound(body):
    """No inverted cell, at the points of the quadrature as little as at the nodes; no gap between parts."""
    _, meshes, _ = body
    for mesh in meshes.values():
        mesh.check()
        for kind, nodes in mesh.cells.items():
            cell = cell_kind(kind)
            assert cell.jacobians(mesh.points[nodes], cell.quadrature_points).min() > 0.0


def test_volume_is_that_of_the_body(body):
    """Exact for the block; else the error of linear cells, and a far smaller one of curved quadratic cells."""
    name, meshes, volume = body
    linear, quadratic = (abs(meshes[order].volume() / volume - 1.0) for order in (1, 2))
    if name == "block":
        assert max(linear, quadratic) < ROUND_OFF
    else:
        assert linear < 0.06 and quadratic < 0.02 * linear


def test_sets_are_the_whole_surface(body):
    """Sets other than parts of others cover each outer facet once."""
    name, meshes, _ = body
    parts = {
        "block": ["top", "bottom", "sides"],
        "ball": ["outside"],
        "ring": ["groove", "lands", "outside", "ends"],
        "solid": ["rim", "ends"],
    }
    tube = ["rim", "bore", "ends"] if name in ("barrel", "cone") else ["bore", "outside", "ends"]
    for mesh in meshes.values():
        found = np.concatenate([np.sort(mesh.facets(s).single[1], axis=1) for s in parts.get(name, tube)])
        outer = np.sort(mesh.outer_facets().single[1], axis=1)
        assert len(found) == len(outer) and len(np.unique(np.concatenate([found, outer]), axis=0)) == len(outer)


def test_facets_look_outwards(body):
    """Gauss: the flux of x through all facets is three times the volume, 1e-12 of it."""
    _, meshes, _ = body
    for order, mesh in meshes.items():
        kind, nodes = mesh.outer_facets().single
        facet = facet_kind(kind)
        x, w = np.polynomial.legendre.leggauss(order + 2)
        points = np.stack([v.ravel() for v in np.meshgrid(x, x, indexing="ij")], axis=1)
        N, slopes = facet.shape(points)
        at = mesh.points[nodes]
        along = np.einsum("mki,qkd->mqdi", at, slopes)
        flux = np.einsum("mqi,mqi->mq", np.einsum("qk,mki->mqi", N, at), np.cross(along[:, :, 0], along[:, :, 1]))
        assert np.sum(flux @ np.outer(w, w).ravel()) == pytest.approx(3.0 * mesh.volume(), rel=1e-9)


@pytest.mark.parametrize("order", [1, 2])
def test_patch_of_the_block_is_a_regular_grid(order):
    mesh = block((0.02, 0.03, 0.01), patch_half_width=(4e-4, 6e-4), cell=2e-4, order=order)
    x = mesh.points[mesh.facets("patch").node_set]
    assert np.all(x[:, 2] == 0.0) and np.all(mesh.points[:, 2] <= 0.0)
    for axis, (half, cells) in enumerate(((4e-4, 4), (6e-4, 6))):
        lines = np.unique(np.round(x[:, axis], 12))
        assert np.allclose(lines, np.linspace(-half, half, order * cells + 1), atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_patch_of_the_ball_stands_on_lines_of_its_chart(order):
    R = 0.01
    mesh = ball(R, patch_half_width=(4e-4, 3e-4), cell=1e-4, order=order)
    outside = mesh.points[mesh.facets("outside").node_set]
    assert np.abs(np.linalg.norm(outside, axis=1) - R).max() < ROUND_OFF * R
    shape = Sphere(axis_point=(0, 0, 0), axis_direction=(0, 1, 0)).fitted(mesh.points[mesh.facets("patch").node_set])
    theta, z, _ = shape.chart(mesh.points[mesh.facets("patch").node_set])
    assert np.allclose(np.unique(np.round(theta, 10)), np.linspace(-0.04, 0.04, order * 8 + 1), atol=1e-10)
    assert np.allclose(np.unique(np.round(z, 12)), np.linspace(-3e-4, 3e-4, order * 6 + 1), atol=1e-12)
    assert len(theta) == (order * 8 + 1) * (order * 6 + 1)


@pytest.mark.parametrize("make", [BODIES["sleeve"][0], BODIES["ring"][0]])
def test_equal_cells_around_are_periodic(make):
    mesh = make(2)
    assert mesh.cyclic.sectors == 48
    angle = 2.0 * np.pi / 48
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    sectors = mesh.points.reshape(48, -1, 3)
    assert np.abs(np.roll(sectors, -1, axis=0) - sectors @ turn.T).max() < 1e-15


def test_fine_arc():
    """Equal cells within it, larger ones behind, the same number on both sides; the patch covers the arc."""
    mesh = sleeve(0.02, 0.03, 0.01, sectors=100, axial=1, fine_arc=0.3, order=1)
    assert mesh.cyclic is None
    x = mesh.points[mesh.facets("bore").node_set]
    theta = np.unique(np.round(np.arctan2(-x[:, 2], x[:, 0]), 12))
    steps = np.diff(np.append(theta, theta[0] + 2.0 * np.pi))
    fine = np.isclose(steps, 2.0 * np.pi / 100)
    assert fine.sum() == 10 and 5.0 * steps.min() > steps.max() > 3.0 * steps.min()
    assert np.allclose(theta[:-1], -theta[-2::-1])  # the last is the back itself
    p = mesh.points[mesh.facets("patch").node_set]
    assert np.abs(np.arctan2(-p[:, 2], p[:, 0])).max() == pytest.approx(0.1 * np.pi)


def test_groove_and_lands():
    mesh = ring(0.02, 0.03, 0.014, sectors=12, axial=4, order=2, **GROOVED)
    x = mesh.points[mesh.facets("groove").node_set]
    rho = np.hypot(x[:, 0], x[:, 2])
    assert np.abs(np.hypot(rho - (0.022 - 0.0052), x[:, 1]) - 0.0052).max() < 1e-15
    lands = mesh.points[mesh.facets("lands").node_set]
    assert np.allclose(np.hypot(lands[:, 0], lands[:, 2]), 0.02, rtol=1e-12)


def test_layers_of_a_sleeve_grow_outwards():
    mesh = sleeve(0.02, 0.04, 0.01, sectors=90, axial=1, order=1)
    radius = np.unique(np.round(np.hypot(mesh.points[:, 0], mesh.points[:, 2]), 12))
    steps = np.diff(radius)
    assert np.all(np.diff(steps) > 0.0) and steps[0] < 1.2 * 2.0 * np.pi * 0.02 / 90


def test_profile_of_a_roller_is_kept():
    """A function or a shape: the rim's nodes are on it, middle nodes too."""

    class Barrel:
        def radius_at(self, z):
            return 0.01 - 3.0 * z**2

    for profile in (Barrel(), Barrel().radius_at):
        mesh = roller(0.01, 0.004, 0.02, profile=profile, sectors=8, layers=2, axial=4)
        x = mesh.points[mesh.facets("rim").node_set]
        assert np.abs(np.hypot(x[:, 0], x[:, 2]) - (0.01 - 3.0 * x[:, 1] ** 2)).max() < 1e-16
        mesh.check()


def test_profile_given_as_a_surface():
    """Its own z counts, wherever along the axis and in whichever direction the shape has it."""
    y = np.array([0.001, 0.003])
    table = (np.array([-0.02, 0.0, 0.02]), np.array([2e-4, 0.0, 4e-4]))
    shape = ProfiledCylinder(radius=0.01, axis_point=(0, 0.004, 0), axis_direction=(0, -1, 0), table=table)
    mesh = roller(0.01, 0.004, 0.008, profile=shape, sectors=8, layers=2, axial=4)
    x = mesh.points[mesh.facets("rim").node_set]
    assert np.abs(shape.chart(x)[2]).max() < 1e-15
    for axial in y:
        on = np.isclose(x[:, 1], axial)
        assert on.any() and np.allclose(np.hypot(x[on, 0], x[on, 2]), shape.radius_at(0.004 - axial), rtol=1e-12)
    with pytest.raises(InputError, match="must be complete"):
        roller(0.01, 0.004, 0.008, profile=Sphere(), sectors=8, layers=2, axial=4)
    tilted = Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=(1, 0, 0))
    with pytest.raises(InputError, match="axis of the shape must be"):
        roller(0.01, 0.004, 0.008, profile=tilted, sectors=8, layers=2, axial=4)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: block((1, 1, 1), patch_half_width=0.6, cell=0.1), "does not fit"),
        (lambda: block((1, 1, 0), patch_half_width=0.1, cell=0.1), "greater than zero"),
        (lambda: block((1, 1, 1), patch_half_width=0.1, cell=0.2), "larger than half the patch"),
        (lambda: block((1, 1, 1), patch_half_width=(0.1, 0.0), cell=0.1), "patch_half_width"),
        (lambda: block((1, 1, 1), patch_half_width=0.1, cell=0.1, growth=1.0), "above 1"),
        (lambda: block((1, 1, 1), patch_half_width=0.1, cell=0.1, order=3), "order"),
        (lambda: ball(-1.0, patch_half_width=0.1, cell=0.1), "radius"),
        (lambda: ball(1.0, patch_half_width=0.5, cell=0.1), "crown_radius"),
        (lambda: sleeve(0.02, 0.01, 0.01, sectors=9, axial=1), "smaller than outer_radius"),
        (lambda: sleeve(0.02, 0.03, 0.01, sectors=2, axial=1), "sectors"),
        (lambda: sleeve(0.02, 0.03, 0.01, sectors=20, axial=1, fine_arc=3.0), "leave it out"),
        (lambda: ring(0.02, 0.03, 0.002, sectors=9, axial=1, **GROOVED), "wider"),
        (lambda: ring(0.02, 0.03, 0.02, sectors=9, axial=1, groove_radius=0.01, groove_depth=0.01), "groove_depth"),
        (lambda: roller(0.02, 0.01, 0.01, sectors=9, axial=1, layers=1, profile=lambda y: 0.009), "no wall"),
        (lambda: roller(0.02, 0.01, 0.01, sectors=9, axial=1, layers=1, profile=0.02), "function"),
        (
            lambda: roller(0.02, 0.01, 0.01, sectors=9, axial=1, layers=1, profile=lambda y: 0.02, crown_radius=1.0),
            "one of them",
        ),
    ],
)
def test_impossible_bodies_are_refused(make, text):
    with pytest.raises(InputError, match=text):
        make()


@pytest.mark.parametrize("order", [1, 2])
def test_tread(order):
    """Equal rows within it, wider ones next to it on both sides alike, and the set that covers it."""
    R = 0.01
    bodies = (
        roller(R, 0.001, 0.018, crown_radius=R, sectors=24, layers=4, axial=6, tread=0.0012, order=order),
        ring(0.02, 0.03, 0.014, sectors=24, axial=6, tread=0.0012, order=order, **GROOVED),
    )
    for mesh in bodies:
        mesh.check()
        y = np.unique(np.round(mesh.points[mesh.facets("tread").node_set][:, 1], 12))
        assert np.allclose(y, np.linspace(-6e-4, 6e-4, 6 * order + 1), atol=1e-12)
        assert len(mesh.facets("tread")) == 24 * 6 and mesh.cyclic is not None
        rows = np.unique(np.round(mesh.points[:, 1], 12))
        assert np.allclose(rows, -rows[::-1]) and np.diff(rows).max() > 5.0 * np.diff(rows).min()


def test_ball_with_a_tread_is_nearly_a_ball():
    """Its mass lacks two flat ends and the hole, by closed form."""
    R, r, half = 0.01, 0.001, 0.0095
    mesh = roller(R, r, 2.0 * half, crown_radius=R, sectors=40, layers=5, axial=6, tread=0.0012)
    expected = 4.0 / 3.0 * np.pi * R**3 - 2.0 * spherical_cap(R, R - half) - 2.0 * np.pi * r**2 * half
    assert mesh.volume() == pytest.approx(expected, rel=1e-3)
    mesh.check()


def test_tread_wider_than_the_body_is_refused():
    with pytest.raises(InputError, match="leave it out"):
        roller(0.02, 0.01, 0.01, sectors=9, axial=2, layers=1, tread=0.01)


@pytest.mark.parametrize("order", [1, 2])
def test_cells_along_the_axis_may_be_given(order):
    """Nodes lie on the boundaries, and in the middle of quadratic cells; equal ones are those of a number of cells."""
    lines = np.array([-0.01, -0.0095, -0.008, 0.0, 0.009, 0.01])
    body = roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=lines, order=order)
    wanted = lines if order == 1 else np.sort(np.append(lines, 0.5 * (lines[1:] + lines[:-1])))
    assert np.allclose(np.unique(np.round(body.points[:, 1], 12)), wanted, atol=1e-12)
    even = roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=5, order=order)
    same = roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=np.linspace(-0.01, 0.01, 6), order=order)
    assert np.array_equal(even.points, same.points)
    assert body.volume() == pytest.approx(even.volume(), rel=ROUND_OFF)


@pytest.mark.parametrize("lines", [[-0.01, 0.02], [-0.01, 0.005, 0.005, 0.01], [0.01, -0.01], [0.01], [[-0.01, 0.01]]])
def test_boundaries_that_do_not_fill_the_width_are_refused(lines):
    with pytest.raises(InputError, match="axial"):
        roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=lines)


def test_boundaries_next_to_a_tread_are_refused():
    with pytest.raises(InputError, match="tread"):
        roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=[-0.01, 0.0, 0.01], tread=0.005)


def test_cage_has_parallel_walls() -> None:
    """Volume and areas in closed form: a window takes length (r w/2 sqrt(1 - (w/2r)^2) + r^2 asin(w/2r)) of r_o less
    that of r_i; sectors are alike."""
    inside, outside, width, w, length, count = 22e-3, 26e-3, 12e-3, 8.1e-3, 8.5e-3, 10
    mesh = cage(inside, outside, width, pockets=count, pocket_width=w, pocket_length=length, layers=2)
    mesh.check()
    h, r = 0.5 * w, np.array([inside, outside])
    window = length * np.diff(h * np.sqrt(r**2 - h**2) + r**2 * np.arcsin(h / r))[0]
    tube = np.pi * (outside**2 - inside**2) * width
    assert mesh.volume() == pytest.approx(tube - count * window, rel=1e-5)
    areas = {}
    for name in ("bar_3", "pocket_1", "ends"):
        ((kind, facets),) = mesh.facets(name).blocks.items()
        areas[name] = facet_shares(kind, mesh.points[facets])[0].sum()
    wall = length * np.diff(np.sqrt(r**2 - h**2))[0]
    around = 2.0 * window / length
    assert areas["bar_3"] == pytest.approx(2.0 * wall, rel=1e-9)
    assert areas["pocket_1"] == pytest.approx(2.0 * wall + around, rel=1e-5)
    assert areas["ends"] == pytest.approx(2.0 * tube / width, rel=1e-5)
    bar = mesh.points[mesh.facet_sets["bar_1"].node_set].mean(axis=0)
    assert np.arctan2(-bar[2], bar[0]) == pytest.approx(np.pi / count)  # behind the first pocket, at +x
    assert mesh.cyclic is not None and mesh.cyclic.sectors == count
    for options, said in (
        ({"pocket_width": 14e-3}, "10 pockets of pocket_width 0.014 leave no bars"),
        ({"pocket_length": 12e-3}, "leaves no rings"),
        ({"inner_radius": 27e-3}, "must be smaller than outer_radius"),
        ({"around": 3}, "cage: around"),
    ):
        sizes: dict[str, Any] = {"pocket_width": w, "pocket_length": length, "inner_radius": inside, **options}
        with pytest.raises(InputError, match=said):
            cage(outer_radius=outside, width=width, pockets=count, **sizes)
