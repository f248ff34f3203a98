"""Verification: flexible bodies: finite elements, reduction, vibrations, rotation, large deflections."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import warpffrf as wf
from demos import elastica as bent
from demos import plate as clamped
from demos import snapping_arch as arch
from demos import spinning_beam as spun
from references.closed_forms.heat import disc
from references.closed_forms.large_deflections import (
    LEVY_CLAMPED_SQUARE,
    LEVY_POISSON,
    Elastica,
    clamped_plate_frequency,
)
from references.finite_elements.heat import HeatedBox
from references.large_deflections.equilibrium_path import EquilibriumPath, pushed_arch
from scenes import rotating_bar, rotating_disc
from scenes import rotating_modes as modes
from scenes.user_meshes import cut_into_tets, straight
from studies.validate.case import Row, case
from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.offline.fe import assemble, assign

ROOM = "Flexible bodies"


@case(ROOM, "Constant strain in any mesh (B. M. Irons' patch test)")
def patch_test() -> Iterator[Row]:
    """A block of steel in crooked cells whose surface has a linear displacement: that of the nodes inside"""
    for kind, order, cut in (
        ("hex8", 1, lambda m: m), ("hex27", 2, lambda m: m), ("tet10", 2, cut_into_tets),
        ("tet4", 2, lambda m: straight(cut_into_tets(m))),
    ):  # fmt: skip
        flat = box((1.0, 1.0, 1.0), (3, 3, 3), center=(0.5, 0.5, 0.5), order=order)
        bump = np.prod(flat.points * (1.0 - flat.points), axis=1)[:, None] * 64.0
        mesh = cut(Mesh(flat.points + bump * (0.06, -0.04, 0.05), flat.cells, flat.facet_sets))
        K = assemble(mesh.points, mesh.cells, assign(mesh, arch.STEEL))[0].toarray()
        gradient = np.random.default_rng(1).standard_normal((3, 3))
        exact = (mesh.points @ gradient.T).ravel()
        inside = np.ones(3 * len(mesh.points), dtype=bool)
        inside[(3 * mesh.outer_facets().node_set[:, None] + np.arange(3)).ravel()] = False
        u = np.linalg.solve(K[np.ix_(inside, inside)], -K[np.ix_(inside, ~inside)] @ exact[~inside])
        yield Row(f"displacement off by, {kind}", np.abs(u - exact[inside]).max(), 0.0, 1e-11, "m", np.abs(exact).max())


@case(ROOM, "All nodes and eigenmodes by scikit-fem (tests/references/finite_elements/heat.py), without reduction")
def heated_pad() -> Iterator[Row]:
    """A pad of steel of 12 x 8 x 6 linear cells, cooled below, under a flux of 1e5 W/m2 above from time 0 on: hottest
    place of the skin above the surroundings, and how far it bends up, at times over the largest time constant"""
    size, counts, h = (0.06, 0.04, 0.02), (12, 8, 6), 400.0
    steel = wf.Material(210e9, 0.3, 7850.0, conductivity=45.0, heat_capacity=460.0, expansion=12e-6)
    body = wf.reduce(
        box(size, counts, center=(0, 0, 0.01), order=1), steel, contact={"z_max": wf.surfaces.Plane()}, modes=4,
        thermal=wf.films.BodyTemperature(convection={"z_min": (h, 0.0)}, reference=0.0), cache=False, progress=False,
        grid=wf.ContactGrid(contact_fixed=False),
    )  # fmt: skip
    heat: Any = body.thermal
    whole = HeatedBox(
        size, counts, youngs_modulus=210e9, poisson_ratio=0.3, density=7850.0, conductivity=45.0, heat_capacity=460.0,
        expansion=12e-6, h=h,
    )  # fmt: skip
    # the flux falls to zero in the outermost cells along its columns
    along = 0 if body.contact_surfaces["z_max"].grid.columns == counts[0] - 1 else 1
    edge = size[along] / counts[along]
    load = whole.load(lambda *x: 1e5 * np.clip(np.minimum(x[along], size[along] - x[along]) / edge, 0.0, 1.0))
    for part, tolerance in ((0.01, 0.02), (0.1, 0.02), (1.0, 0.02), (np.inf, 5e-3)):
        steady = np.isinf(part)
        flux, after = {"z_max": 1e5}, part * heat.time
        state = heat.steady(flux) if steady else heat.advance(heat.uniform(0.0), after, flux=flux)
        theta = whole.steady(load) if steady else whole.after(after, load)
        when = "steady" if steady else f"t = {part:g}"
        yield Row(f"hottest, {when}", heat.hottest(state), float(theta.max()), tolerance, "K")
        ours, theirs = (float(np.ptp(u[:, 2])) * 1e6 for u in (body.expansion(state).skin, whole.expansion(theta)))
        yield Row(f"range of displacements, {when}", ours, theirs, tolerance, "µm")


@case(ROOM, "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity (1970), section 151: disc with a hole, free edges")
def ring_with_gradient() -> Iterator[Row]:
    """A ring of steel of 20 and 50 mm, 1 mm thick, heated inside and held at its temperature outside: growth"""
    steel = wf.Material(210e9, 0.3, 7850.0, conductivity=45.0, heat_capacity=460.0, expansion=12e-6)
    body = wf.reduce(
        roller(0.05, 0.02, 0.001, sectors=24, layers=10, axial=1, order=2), steel, contact={"bore": wf.surfaces.Bore()},
        modes=4, thermal=wf.films.BodyTemperature(fixed={"rim": 40.0}, reference=40.0), cache=False, progress=False,
        grid=wf.ContactGrid(contact_fixed=False),
    )  # fmt: skip
    heat: Any = body.thermal
    free, points = body.expansion(heat.steady({"bore": 5e4})), body.surface.points
    r = np.hypot(points[:, 0], points[:, 2])
    radial = np.sum((free.skin * points)[:, [0, 2]], axis=1) / r
    for name, at in (("bore", 0.02), ("rim", 0.05)):
        there = radial[np.abs(r - at) < 1e-6].mean()
        theirs = disc(
            at, inner=0.02, outer=0.05, flux=5e4, conductivity=45.0, rim=0.0, expansion=12e-6, poisson_ratio=0.3
        )[1]  # fmt: skip
        yield Row(f"growth of the {name}", 1e6 * float(there), 1e6 * float(theirs), 1e-3, "µm")


@case(ROOM, "The same body by the general path, which shares no solution with that of repeated sectors")
def rotated_sectors() -> Iterator[Row]:
    """Reduced model: a hollow roller of repeated sectors, reduced by harmonics and as any other mesh"""
    mesh = roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=2, order=1)
    first, second = (
        wf.reduce(
            mesh, arch.STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=12,
            options=wf.ReductionOptions(periodic=periodic), cache=False, progress=False,
        )
        for periodic in (None, False)
    )  # fmt: skip
    yield Row("frequencies off by", np.abs(first.frequencies / second.frequencies - 1.0).max(), 0.0, 1e-9, scale=1.0)
    a, b = (np.linalg.eigvalsh(body.contact_surfaces["rim"].compliance(np.arange(24))) for body in (first, second))
    yield Row("spectrum of the compliance off by", np.abs(a - b).max() / b.max(), 0.0, 1e-10, scale=1.0)


@case(ROOM, "A. E. H. Love, Mathematical Theory of Elasticity (1927), art. 293; G. H. Bryan (1890)")
def spinning_ring() -> Iterator[Row]:
    """D3: frequencies of a thin steel ring, R 100 mm, and the lag of its patterns 2Ω/(n² + 1) behind the material"""
    found = modes.spinning(modes.thin_ring(), "gyroscopic")
    for n, theirs in modes.THIN_RING.items():
        low, high = modes.in_plane(found, n)
        yield Row(f"frequency, {n} waves", 0.25 * (low + high) / np.pi, theirs, 2e-3, "Hz")
        yield Row(f"lag over Ω, {n} waves", (high - low) / (2.0 * n) / modes.SPIN, 2.0 / (n * n + 1.0), 2e-3)


@case(ROOM, "A. D. Wright and others, J. Appl. Mech. 49 (1982) 197, tables of the rotating cantilever")
def rotating_cantilever() -> Iterator[Row]:
    """D7: first flap frequency of a slender cantilever by its speed of rotation γ, with geometric stiffening"""
    for gamma, theirs in modes.FLAP.items():
        found = modes.first_flap(modes.slender_beam(), gamma, level="full", stiffening=True)
        yield Row(f"λ1, γ = {gamma:g}", found, theirs, 3e-4)


@case(ROOM, "tan(kL)/k - L, k = ω sqrt(ρ/E): a bar in its own centrifugal field")
def rotating_bar_tip() -> Iterator[Row]:
    """D1: elongation of an aluminium bar of 1 m at 1,000 rad/s, inertia level full, 60 linear cells"""
    body = rotating_bar.bar(60)
    found = float(rotating_bar.elongation(body, rotating_bar.stationary(body, "full").q))
    yield Row("stationary state of the reduced model", 1e3 * found, 13.05866, 5e-6, "mm")
    settled = rotating_bar.settled_sequence(rotating_bar.bar(30), "full", (2e-5,))
    yield Row("run, spun up in 20 µs steps", 1e3 * settled[-1], 13.05866, 2e-3, "mm")


@case(ROOM, "S. P. Timoshenko and J. N. Goodier, Theory of Elasticity (1970), art. 32")
def rotating_annulus() -> Iterator[Row]:
    """D2: a steel annulus of 20 and 100 mm at 1,000 rad/s, in plane stress"""
    found = rotating_disc.spin(rotating_disc.disc(24, 8), "deformed")
    yield Row("displacement of the rim over the closed form's", 1.0 + found.rim, 1.0, 3e-4)
    yield Row("displacement of the bore over the closed form's", 1.0 + found.bore, 1.0, 1e-3)
    for name, off in (("radial", found.radial_stress), ("hoop", found.hoop_stress)):
        yield Row(f"{name} stress off by, over the largest", np.abs(off).max(), 0.0, 5e-3, scale=1.0)


@case(ROOM, "J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53 (1986) 855; lag: beam equation with tension")
def spun_up_beam() -> Iterator[Row]:
    """The demo spinning_beam: EA 28 MN, EI 14 kN m², 10 m, spun up to 6 rad/s within 15 s"""
    scene, result = spun.run(spun.FULL, stiffening=True, progress=False)
    stretch, across = spun.tip_in_hub_frame(scene, result)
    k = spun.SPEED * np.sqrt(spun.LINE_MASS / spun.AXIAL_STIFFNESS)
    theirs = np.tan(k * spun.LENGTH) / k - spun.LENGTH
    yield Row("elongation at speed", 1e3 * stretch[result.time > spun.SPIN_UP].mean(), 1e3 * theirs, 1e-3, "mm")
    yield Row("largest lag of the tip", -float(across.min()), 0.5410, 0.01, "m")


@case(ROOM, "K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272")
def elastica() -> Iterator[Row]:
    """The demo elastica: a cantilever of four bodies with geometric stiffening under a dead force at its tip"""
    steps = 32
    result = bent.run(48, steps=steps, progress=False)
    load, tip = bent.LARGEST * result.time / steps, bent.ends(result, bent.PARTS)[:, -1] / bent.LENGTH
    for wanted in (0.5, 1.0, 2.0, 4.0):
        i, exact = int(np.argmin(np.abs(load - wanted))), Elastica(wanted)
        yield Row(f"w/L, PL²/EI = {wanted:g}", tip[i, 2], exact.deflection, 1e-3)
        yield Row(f"u/L, PL²/EI = {wanted:g}", 1.0 - tip[i, 0], exact.shortening, 1e-2)


@case(ROOM, "S. Levy, NACA Report 740 (1942), table of the clamped square plate; its series errs by about 2 %")
def plate_under_pressure() -> Iterator[Row]:
    """The demo plate: a clamped square plate under pressure up to twice its thickness, membrane energy of 20 modes"""
    size = clamped.QUICK
    scene = clamped.build(size, progress=False)
    pressed = clamped.press(scene, size.loads, progress=False)
    for load, found in zip(size.loads, clamped.deflection(pressed)[1:], strict=True):
        yield Row(f"w/t, qa⁴/Et⁴ = {load:g}", found, LEVY_CLAMPED_SQUARE[load], 0.028)


@case(ROOM, "A. W. Leissa, NASA SP-160 (1969), table 4.22; one term and Duffing's equation")
def plate_vibrating() -> Iterator[Row]:
    """The demo plate: first frequency of a clamped square plate, and how it rises with the amplitude"""
    size = clamped.QUICK
    scene = clamped.build(size, progress=False)
    linear = float(wf.eigenmodes(scene, 1, about="initial").frequencies[0])
    pressed = clamped.press(scene, size.loads, progress=False)
    motion = clamped.release(pressed, size.periods, progress=False)
    A, f = clamped.cycles(motion.time - pressed.time[-1], clamped.deflection(motion))
    yield Row("first frequency", linear, clamped.FREQUENCY, 0.015, "Hz")
    for amplitude in (0.3, 0.6, 1.0):
        ratio = float(np.interp(amplitude, A[::-1], f[::-1])) / linear
        yield Row(f"f/f0, A/t = {amplitude:g}", ratio, clamped_plate_frequency(amplitude, LEVY_POISSON), 0.01)


@case(
    ROOM, "Full finite elements of the same mesh, St. Venant-Kirchhoff's material (tests/references/large_deflections)"
)
def snapping_arch() -> Iterator[Row]:
    """The demo snapping_arch: a shallow clamped arch pushed down at its crown, by displacement"""
    size = arch.QUICK
    top = (0.0, 0.0, arch.RISE + 0.5 * arch.THICKNESS)
    exact = pushed_arch(arch.mesh(size), arch.STEEL, top, arch.FARTHEST, size.steps)
    result = wf.static(arch.driven(size, progress=False), float(size.steps), step=1.0, progress=False)
    path = EquilibriumPath(arch.crown_way(result), -result.joint("rod").force[:, 2])
    for i, (name, load, place) in enumerate((("limit", 2e-3, 5e-3), ("lower limit", 5e-3, 5e-3))):
        yield Row(f"{name} load", path.loads[i], exact.loads[i], load, "N")
        yield Row(f"crown at the {name} load", 1e3 * path.limits[i], 1e3 * exact.limits[i], place, "mm")
