"""Meshes of gears and cams against the curves of their sections, their areas, and rotation by a pitch."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf.model import mesh
from warpffrf.model.errors import InputError
from warpffrf.model.gears import Gear
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.surfaces import Curve, Extruded

M = 4.5e-3  # m
WIDTH = 14e-3
PINION = Gear(M, 16, profile_shift=0.1817, tip_diameter=82.45e-3)
CASES: dict[str, tuple[Gear, float]] = {  # and the radius of the rim
    "pinion": (PINION, 15e-3),
    "rounded": (replace(PINION, tip_rounding=0.3e-3, tip_relief=20e-6, tip_relief_length=3e-3), 15e-3),
    "few teeth": (Gear(M, 8, profile_shift=0.55, tip_diameter=47e-3), 5e-3),
    "thin rim": (Gear(M, 120, tip_rounding=0.2e-3), 0.257),
    "internal": (Gear(M, 80, internal=True, tip_rounding=0.2e-3), 0.195),
    "narrow root": (Gear(M, 60, internal=True, profile_shift=-0.5, root_radius=0.2), 0.150),
}
CASES |= {
    "right-handed": (Gear(M, 22, helix_angle=np.radians(24.0), tip_rounding=0.3e-3), 25e-3),
    "left-handed": (Gear(M, 60, internal=True, helix_angle=np.radians(-24.0), tip_rounding=0.2e-3), 0.162),
}
EXACT = 1e-10  # m


def area(section: Curve) -> float:
    """Within a closed curve, by Gauss's rule, exact for its pieces; negative where it is clockwise."""
    x, weight = np.polynomial.legendre.leggauss(4)
    h = np.diff(section.knots)[:, None]
    u = section.knots[:-1, None] + 0.5 * h * (x + 1.0)
    p, t = section.at(u), section.at(u, 1)
    return 0.5 * float(np.sum(0.5 * h * weight * (p[..., 0] * t[..., 1] - p[..., 1] * t[..., 0])))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", list(CASES))
def test_cells_and_facets(name: str, order: int) -> None:
    """Cells are not inverted; nodes of flanks lie on the curves of their teeth, the facets point away from them."""
    gear, rim = CASES[name]
    body = mesh.gear(gear, WIDTH, rim_radius=rim, teeth=3, axial=2, order=order).check()
    for side in ("right", "left"):
        for tooth in (1, 3):
            facets = body.facets(f"flank_{side}_{tooth}")
            shape = gear.surfaces((side,), (tooth,))[f"flank_{side}_{tooth}"]
            nodes = body.points[facets.node_set]
            theta, z, distance = shape.chart(nodes)
            assert np.abs(distance).max() < EXACT
            assert np.abs(np.ptp(z) - WIDTH) < EXACT
            assert np.all(
                np.sum(facets.node_normals(body.points) * shape.normal(theta, z), axis=1) > 0.75
            )  # 0.99 but on a rounding, which has one cell
            r = np.hypot(nodes[:, 0], nodes[:, 2])
            ends = 0.5 * np.sort([gear.root_form_diameter, gear.tip_diameter])
            assert [r.min(), r.max()] == pytest.approx(ends, abs=1e-9)
    hub = "outside" if gear.internal else "bore"
    for set_name, radius in (("tips", 0.5 * gear.tip_diameter), (hub, rim)):
        nodes = body.points[body.facets(set_name).node_set]
        assert np.hypot(nodes[:, 0], nodes[:, 2]) == pytest.approx(radius, abs=EXACT)
    flanks = [f"flank_{side}_{tooth}" for side in ("right", "left") for tooth in (1, 2, 3)]
    assert set(body.facet_sets) == {*flanks, "roots", "tips", hub, "ends", "side_low", "side_high"}
    assert sum(body.sets.values()) == len(body.outer_facets())


@pytest.mark.parametrize("name", ["rounded", "thin rim", "internal", "right-handed", "left-handed"])
def test_volumes_converge_to_the_area_of_the_section(name: str) -> None:
    """With the square of the size of linear cells; of quadratic ones the error is below 1e-5 at once."""
    gear, rim = CASES[name]
    known = abs(area(gear.section()) - gear.side * np.pi * rim**2) * WIDTH / gear.teeth

    def error(order: int, fineness: int) -> float:
        counts = {"along": 12 * fineness, "across": 4 * fineness, "layers": 2 * fineness, "axial": fineness}
        return abs(mesh.gear(gear, WIDTH, rim_radius=rim, teeth=1, order=order, **counts).volume() / known - 1.0)

    assert error(2, 1) < 1e-5
    assert error(1, 1) / error(1, 2) > 3.0


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", ["few teeth", "internal", "right-handed"])
def test_sectors_follow_by_rotation(name: str, order: int) -> None:
    """Nodes, cells and facets of a whole gear as those of the first sector, by a pitch about +y."""
    gear, rim = CASES[name]
    body = mesh.gear(gear, WIDTH, rim_radius=rim, along=3, across=2, layers=1, rim_layers=1, axial=1, order=order)
    body.check()
    assert body.cyclic is not None and body.cyclic.sectors == gear.teeth
    nodes = body.points.reshape(gear.teeth, -1, 3)
    a = 2.0 * np.pi / gear.teeth
    rotation = np.array([[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]])
    assert np.abs(np.roll(nodes, -1, axis=0) - nodes @ rotation.T).max() < EXACT
    per_sector = nodes.shape[1]
    ((_, cells),) = body.cells.items()
    cells = cells.reshape(gear.teeth, -1, cells.shape[1])
    assert cells[0].max() < 2 * per_sector
    assert np.array_equal(np.roll(cells, -1, axis=0), (cells + per_sector) % len(body.points))
    first, last = (body.facets(f"flank_left_{k}").single[1] for k in (1, gear.teeth))
    assert np.array_equal((first + (gear.teeth - 1) * per_sector) % len(body.points), last)
    part = mesh.gear(
        gear, WIDTH, rim_radius=rim, teeth=2, along=3, across=2, layers=1, rim_layers=1, axial=1, order=order
    )
    assert part.cyclic is None
    assert part.volume() == pytest.approx(2.0 / gear.teeth * body.volume(), rel=1e-12)
    low, high = (part.points[part.facets(f"side_{end}").node_set] for end in ("low", "high"))
    for nodes, angle in ((low, -0.5 * a), (high, 1.5 * a)):
        flip = np.pi if gear.internal else 0.0  # nothing but the angle matters
        assert (
            np.abs(np.sin(np.arctan2(-nodes[:, 2], nodes[:, 0]) - angle - gear.twist * nodes[:, 1] + flip)).max() < 1e-9
        )


def test_cells_on_a_rounding_are_as_long_as_the_last_one() -> None:
    rounded = Gear(3e-3, 62, tip_rounding=0.3e-3)
    radius = 0.5 * rounded.tip_form_diameter
    involute = float(rounded.half["involute"][0].sum())

    def on_rounding(last: float) -> int:
        """Facets beyond the involute."""
        body = mesh.gear(
            rounded, WIDTH, rim_radius=80e-3, teeth=1, along=[0.0, 0.5, 1.0 - last / involute, 1.0], axial=1
        )
        r = np.hypot(*body.points[body.facets("flank_right_1").single[1]].mean(axis=1)[:, ::2].T)
        return int(np.sum(r > radius))

    length = float(rounded.half["rounding"][0].sum())
    for last in (0.3e-3, 0.05e-3):
        assert on_rounding(last) == np.ceil(length / last)


OVAL = Curve.through(
    [[0.05 * np.cos(a) + 0.004, 0.035 * np.sin(a)] for a in np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)],
    closed=True,
)


@pytest.mark.parametrize("order", [1, 2])
def test_cams(order: int) -> None:
    body = mesh.cam(OVAL, WIDTH, bore_radius=0.012, sectors=60, axial=2, order=order).check()
    nodes = body.points[body.facets("rim").node_set]
    shape = Extruded(curve=OVAL, axis_point=(0.0, 0.0, 0.0))
    assert np.abs(shape.chart(nodes)[2]).max() < EXACT
    bore = body.points[body.facets("bore").node_set]
    assert np.hypot(bore[:, 0], bore[:, 2]) == pytest.approx(0.012, abs=EXACT)
    known = (area(OVAL) - np.pi * 0.012**2) * WIDTH
    assert body.volume() == pytest.approx(known, rel={1: 3e-3, 2: 1e-5}[order])
    assert sum(body.sets.values()) == len(body.outer_facets())


def reversed_curve(curve: Curve) -> Curve:
    return Curve(
        knots=curve.length - curve.knots[::-1], points=curve.points[::-1], tangents=-curve.tangents[::-1], closed=True
    )


def test_impossible_gears_and_cams_are_refused() -> None:
    sizes: dict[str, Any] = {"rim_radius": 15e-3, "order": 1}
    with pytest.raises(InputError, match="gear must be a gears.Gear, got 'pinion'"):
        mesh.gear("pinion", WIDTH, **sizes)  # pyright: ignore[reportArgumentType]
    with pytest.raises(
        InputError, match="leaves a rim too thin for the mesh, in which teeth reach to .* make it smaller"
    ):
        mesh.gear(PINION, WIDTH, rim_radius=29e-3)
    with pytest.raises(InputError, match="leaves a rim too thin .* make it larger"):
        mesh.gear(CASES["internal"][0], WIDTH, rim_radius=0.186)
    with pytest.raises(InputError, match="teeth must be a whole number of at most 15"):
        mesh.gear(PINION, WIDTH, teeth=16, **sizes)
    with pytest.raises(InputError, match="along must be a whole number of at least 1"):
        mesh.gear(PINION, WIDTH, along=0, **sizes)
    pointed = Gear(M, 12, profile_shift=0.922, addendum=0.87, dedendum=1.367, root_radius=0.109, tip_rounding=0.45e-3)
    with pytest.raises(InputError, match="inverted cells, as tips are narrow .* a smaller tip_rounding"):
        mesh.gear(pointed, WIDTH, rim_radius=11e-3, axial=1)
    counts: dict[str, Any] = {"sectors": 24, "axial": 1}
    with pytest.raises(InputError, match="curve must be a closed surfaces.Curve"):
        mesh.cam(PINION.flank(), WIDTH, bore_radius=1e-3, **counts)
    with pytest.raises(InputError, match="bore_radius 0.04 m does not fit; make it smaller than 0.0348"):
        mesh.cam(OVAL, WIDTH, bore_radius=0.04, **counts)
    with pytest.raises(InputError, match="must run counter-clockwise about its origin and meet every ray"):
        mesh.cam(reversed_curve(OVAL), WIDTH, bore_radius=0.01, **counts)
    assert isinstance(mesh.gear(PINION, WIDTH, teeth=1, **sizes).facets("roots"), FacetSet)
