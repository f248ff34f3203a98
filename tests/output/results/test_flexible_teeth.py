"""Flexible teeth in mesh against full finite elements: deflection, shares of two pairs of teeth, stiffness.

The transmission error over a pitch, with and without tip relief, is in `python -m studies validate flexible_teeth`.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import warpffrf as wf
from references.finite_elements.teeth import Meshed, meshed
from scenes import plane_gears
from scenes.gears import STEEL, on_hubs

GEAR = wf.gears.Gear(3e-3, 62, thickness_allowance=-30e-6)
PAIR = wf.gears.GearPair(GEAR, GEAR, 0.186)
WIDTH, RIM, TEETH, MEETING = 20e-3, 80e-3, 4, (2, 3)  # m, m
LOADS = (3000.0, 6000.0)  # N
NEXT = GEAR.base_pitch
PLACES = {"one pair": 0.0, "two pairs": 2.5e-3, "two equal pairs": 0.5 * NEXT}  # m, of tooth 2
DEFLECTION, SHARE, RATIO = 0.01, 0.01, 0.01  # observed with finer teeth: 0.002, 0.001, 0.002


ALONG = 12  # cells along the flanks: lines of the contact grid are 0.5 mm apart
REACHING = 4e-3  # m on the path of contact: from here on the other tooth touches within two lines of its tip
BENDING, AT_TIPS, PARTS = 0.005, 0.02, 0.01  # observed: 0.003, 0.016, 0.004
TENSION, WHERE = 0.05, 0.2e-3  # m; observed: 0.04, 0.1e-3, on cells of 0.5 mm in fillets with a radius of 1.1 mm
CONVERGED = 0.004  # of smaller cells, observed: 0.0017


@pytest.mark.parametrize("g", [0.0, 1.5e-3, 3e-3, 4.5e-3, 6e-3])
def test_one_pair_of_teeth(g: float) -> None:
    ours = -float(plane_gears.loaded(g, along=ALONG, alone=True).transmission_error[0])
    theirs = plane_gears.known(g, alone=True, cells=plane_gears.COARSE).approach
    assert ours == pytest.approx(theirs, rel=BENDING if g < REACHING else AT_TIPS)


@pytest.mark.parametrize("share", [0.4, 0.5, 0.6])
def test_two_pairs_of_teeth(share: float) -> None:
    g = share * plane_gears.pair().gear_1.base_pitch
    ours, theirs = plane_gears.loaded(g, along=ALONG), plane_gears.known(g, cells=plane_gears.COARSE)
    assert -ours.transmission_error[0] == pytest.approx(theirs.approach, rel=BENDING)
    assert ours.load_share[0] == pytest.approx(theirs.shares, rel=PARTS)


@pytest.mark.parametrize("g", [1.5e-3, 4.5e-3])
def test_stress_at_the_roots(g: float) -> None:
    """The largest tension, of both gears, and its place."""
    gear, known = (
        plane_gears.loaded(g, along=ALONG, alone=True),
        plane_gears.known(g, alone=True, cells=plane_gears.COARSE),
    )
    for body, forces in zip(("one", "two"), known.forces, strict=True):
        roots = gear.result.stress(body, "roots")
        tension, x = plane_gears.flanks(plane_gears.PLAIN, plane_gears.COARSE).root_stress(forces)
        worst = int(np.argmax(roots.principal[0, :, 0]))
        assert roots.principal[0, worst, 0] == pytest.approx(tension, rel=TENSION)
        assert roots.points[worst, ::2] == pytest.approx(x * [1.0, -1.0], abs=WHERE)


def test_the_plane_reference_converges() -> None:
    g = 0.4 * plane_gears.pair().gear_1.base_pitch
    coarse, fine = (plane_gears.known(g, cells=cells) for cells in (plane_gears.COARSE, (0.06e-3, 0.06e-3, 7)))
    assert coarse.approach == pytest.approx(fine.approach, rel=CONVERGED)
    assert coarse.shares == pytest.approx(fine.shares, rel=CONVERGED)


@cache
def segment() -> wf.ReducedBody:
    mesh = wf.mesh.gear(GEAR, WIDTH, rim_radius=RIM, teeth=TEETH, along=8, across=2, layers=3, axial=8, rim_layers=4)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact=GEAR.surfaces(("right",), MEETING),
        grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


@cache
def known(g: float) -> list[Meshed]:
    spots = [((2, g), (3, -g)), ((3, g - NEXT), (2, NEXT - g))][: 1 if g == 0.0 else 2]
    return meshed(PAIR, STEEL, WIDTH, RIM, TEETH, spots, LOADS)


@pytest.mark.slow
def test_against_full_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("warpffrf.model.gears.mesh.ENTRY", 0.0)  # teeth 1 and 4 have no contact
    stiffness = []
    for g in PLACES.values():
        found = [
            (load, on_hubs(PAIR, segment(), MEETING[0], g, load).gear("mesh"), fe)
            for load, fe in zip(LOADS, known(g), strict=True)
        ]
        for _, gear, fe in found:
            assert -gear.transmission_error[0] == pytest.approx(fe.approach, rel=DEFLECTION)
            assert gear.load_share[0] == pytest.approx(fe.shares, abs=SHARE)
        load, gear, fe = found[-1]
        stiffness.append((load / -float(gear.transmission_error[0]), load / fe.approach))
    (single, single_fe), *_, (double, double_fe) = stiffness
    assert double / single == pytest.approx(double_fe / single_fe, rel=RATIO)
