"""Verification: gears in mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes import plane_gears
from scenes.gears import FZG, WIDTH, angle_at, on_shafts
from scenes.plane_gears import FINE, LINE_LOAD, PLAIN, RELIEVED, known, loaded
from studies.validate.case import Row, case
from warpffrf.output.simulate import equilibrium

ROOM = "Gears"
ALONG = 48  # cells along a flank: 0.04 modules, half as long as a tip rounding
PITCH = plane_gears.pair().gear_1.base_pitch  # m
ONE_PAIR = (0.0, 1.5e-3, 3e-3, 4.5e-3, 6e-3)  # m on the path of contact
TWO_PAIRS = tuple(PITCH * np.array([0.3, 0.4, 0.5, 0.6, 0.7]))
HALF_PITCH = tuple(PITCH * np.linspace(0.0, 0.5, 9))  # the other half is its mirror image
MM, UM, GN = 1e3, 1e6, 1e-9


@case(ROOM, "ISO 14635-1, closed form; G1")
def fzg_pressure() -> Iterator[Row]:
    """Gears C of the FZG test at the pitch point under 200 N m, half-spaces under their flanks"""
    yield Row("contact ratio", FZG.contact_ratio, 1.436, 5e-4)
    scene = on_shafts(FZG, angle_at(FZG, 0.0), 200.0)
    result = equilibrium(scene, progress=False)
    if result.status != "completed":
        raise RuntimeError(result.message)
    gear = result.gear("mesh")
    i = int(np.argmax(gear.load[-1]))
    yield Row("normal force", gear.load[-1, i], 200.0 / FZG.gear_1.base_radius, 1e-3, "N")
    contact = result.contact(gear.contacts[i])
    own = np.sqrt(gear.load[-1, i] / WIDTH / contact.line_load[-1])  # free ends raise the load in the middle
    yield Row("peak pressure of the mean line load", 1e-6 * own * contact.mid_peak_pressure[-1], 1347.3, 0.01, "MPa")
    yield Row("its half-width", UM * own * contact.half_width[-1], 199.6, 0.01, "µm")


@case(ROOM, "plane finite elements of both gears in contact, references/finite_elements/plane_gears.py")
def flexible_teeth() -> Iterator[Row]:
    """Segments of two gears of 62 teeth, module 3 mm, 150 N/mm, without lateral contraction; with tip relief 15 µm over
    4 mm"""
    for g in ONE_PAIR:
        ours, theirs = -loaded(g, along=ALONG, alone=True).transmission_error[0], known(g, alone=True).approach
        where = f"one pair of teeth, {MM * g:.1f} mm from the pitch point: approach"
        yield Row(where, UM * ours, UM * theirs, 0.02, "µm")
    g = ONE_PAIR[3]
    for body, forces in zip(("one", "two"), known(g, alone=True).forces, strict=True):
        ours = loaded(g, along=ALONG, alone=True).result.stress(body, "roots").principal.max()
        theirs, _ = plane_gears.flanks(PLAIN, FINE).root_stress(forces)
        yield Row(f"tension at the root, gear {body}, {MM * g:.1f} mm", 1e-6 * ours, 1e-6 * theirs, 0.02, "MPa")
    for g in TWO_PAIRS:
        ours, theirs = loaded(g, along=ALONG).load_share[0, 0], known(g).shares[0]
        yield Row(f"two pairs of teeth, {MM * g:.1f} mm: share of the first", ours, theirs, 0.03)
    for name, relief in (("without relief", PLAIN), ("with tip relief", RELIEVED)):
        ours = np.array([-loaded(g, along=ALONG, relief=relief).transmission_error[0] for g in HALF_PITCH])
        theirs = np.array([known(g, relief=relief).approach for g in HALF_PITCH])
        if relief == PLAIN:
            one, two = GN * LINE_LOAD / theirs[[0, -1]]
            yield Row("stiffness of one pair of teeth per width", GN * LINE_LOAD / ours[0], one, 0.05, "GN/m²")
            yield Row("stiffness of two pairs of teeth per width", GN * LINE_LOAD / ours[-1], two, 0.05, "GN/m²")
            yield Row("their ratio", ours[0] / ours[-1], two / one, 0.05)
        size = UM * float(np.ptp(theirs))
        yield Row(f"transmission error {name}: peak to peak", UM * float(np.ptp(ours)), size, 0.05, "µm")
        worst = int(np.argmax(np.abs(ours - theirs)))
        where = f"and where it differs most, over that: {MM * HALF_PITCH[worst]:.1f} mm"
        yield Row(where, UM * ours[worst], UM * theirs[worst], 0.05, "µm", size)
