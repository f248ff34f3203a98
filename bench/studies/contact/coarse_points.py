r"""Hertz's contacts of solid bodies on coarse meshes: bodies, scenes and errors (page: `coarse_points_page`).

Cases C1, C2, C3 and C7, Poisson's ratios, unlike bodies, tetrahedra, and the stress below.

**Roller.** A solid roller between two rigid planes, loaded at both ends of a diameter. With nu = 0 it is in plane
strain at any width. Else it is long and has free ends: far from these the axial force over a section is zero. By the
virial int sigma_zz dA = -2 R P', int sigma_xx dA = 0, so that

    E eps_y = 2 nu P'/(pi R),      and the radius shrinks by nu eps_y R = 2 nu^2 P'/(pi E) more than in plane strain,

which is part of the approach of the axis (`roller_approach`). What is compared are line load and pressure at mid-width.

**Ball.** Pressed on a rigid plane by its weight, a uniform body force, as `elastic_sphere` has it: how much less the
ball yields than a half-space is known. In an impact it is balanced by its acceleration, uniform too.

**Block.** A rigid ball on a block held at its bottom, at nine places over an element of 4 mm; the reference are
quadratic tetrahedra of 1 mm, the ball in the middle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from references.closed_forms import HertzImpact, LineContact, PointContact, contact_modulus, cylinder_approach
from references.closed_forms.elastic_sphere import approach_correction
from scenes.user_meshes import cut_into_tets, straight
from warpffrf.model import joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, grid
from warpffrf.model.mesh import ball as ball_mesh
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate

Array = np.ndarray
Cells = tuple[int, int] | None

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
ALUMINIUM = Material(70e9, 0.33, 2700.0, name="aluminium")
RUBBER = Material(5e6, 0.49, 1100.0, name="rubber")
RATIOS = (0.0, 0.3, 0.45, 0.49)
ROLLER_RADIUS, LINE_LOAD = 0.05, 1e5  # C1: m, N/m
THIN, LONG = 0.02, 0.2  # m, width of rollers with nu = 0, and with any other
BALL_RADIUS, LOAD, SPEED = 0.01, 100.0, 0.1  # C3, C7: m, N, m/s
FINE = (24, 21)  # strips, rows of a line contact, finer than those chosen
FINE_POINT = (24, 24)
DOWN = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # turns the patch of a ball, around +x, to -z
DEPTHS = np.linspace(0.3, 1.3, 41)  # half-widths below a patch
STEPS = 200  # of an impact's duration
APPROACH = 20e-6  # m, of the ball on the block
BLOCK = (0.024, 0.012)  # m, width and depth


# --- rollers ---


def roller_approach(load: float, half_width: float, material: Material) -> float:
    """Way [m] of the axis of a long solid roller with free ends towards either of its two loaded lines, load [N/m]."""
    shrunk = 2.0 * material.poisson_ratio**2 * load / (np.pi * material.youngs_modulus)
    return cylinder_approach(load, ROLLER_RADIUS, half_width, material) + shrunk


def roller(material: Material, elements: int, order: int, below: Array | None = None) -> ReducedBody:
    """A solid roller with `elements` on the radius; `below`: depths [m] at its lowest line for the stress there."""
    width = THIN if material.poisson_ratio == 0.0 else LONG
    if elements < 3:
        width = max(width, ROLLER_RADIUS)
    sectors = 4 * int(np.ceil(0.5 * np.pi * elements))
    mesh = roller_mesh(
        ROLLER_RADIUS, 0.0, width, sectors=sectors, layers=max(1, round(0.6 * elements)),
        axial=max(2, round(width * elements / ROLLER_RADIUS)), order=order,
    )  # fmt: skip
    stress = {}
    if below is not None:
        stress["below"] = np.column_stack([0.0 * below, 0.0 * below, below - ROLLER_RADIUS])
    fewer = order == 2 and width == LONG  # grid nodes per facet: a quarter of those at mesh nodes
    spacing = 2.0 * np.pi * ROLLER_RADIUS / sectors if fewer else None
    return reduce(
        mesh, material, interfaces={"end_low": "average"}, contact={"rim": surfaces.Cylinder()}, modes=0,
        grid=ContactGrid(spacing=spacing, contact_fixed=True), stress=stress, cache=False, progress=False,
    )  # fmt: skip


def plane(scene: Scene, z: float, outward: float) -> Any:
    """A rigid plane of the ground at z [m]."""
    shape = surfaces.Plane(origin=(0.0, 0.0, z), outward=(0.0, 0.0, outward))
    return scene.ground.surface(shape, name="floor" if outward > 0.0 else "roof")


def guided(scene: Scene, body: Any) -> None:
    """Let the body move along z alone."""
    name = "end_low" if "end_low" in body.reduced.interfaces else "outside"
    scene.add(joints.Prismatic(scene.ground, body[name], axis=(0.0, 0.0, 1.0)))


def rested(scene: Scene) -> Result:
    """The static state; raises `InputError` where there is none."""
    result = equilibrium(scene)
    if result.status != "completed":
        raise InputError(f"coarse points: {result.message}")
    return result


def pressed_rollers(bodies: list[ReducedBody], squeeze: float, cells: Cells = None) -> Result:
    """Rollers one on the other between two planes, which are `squeeze` [m] nearer than they all need."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    height = 2.0 * ROLLER_RADIUS * len(bodies) - squeeze
    below = plane(scene, 0.0, 1.0)
    share = squeeze / (2 * len(bodies))
    for i, reduced in enumerate(bodies):
        z = (2 * i + 1) * (ROLLER_RADIUS - share)
        body = scene.add_body(reduced, name=f"roller {i}", position=(0.0, 0.0, z))
        guided(scene, body)
        scene.add(Contact(body["rim"], below, grid="contact_fixed", cells=cells, name=f"pair {i}"))
        below = body["rim"]
    scene.add(Contact(below, plane(scene, height, -1.0), grid="contact_fixed", cells=cells, name=f"pair {len(bodies)}"))
    return rested(scene)


@dataclass(frozen=True)
class Errors:
    """Relative errors of a contact, `approach` that of the closed form's for the load found."""

    approach: float
    half_width: float
    peak: float

    def cells(self) -> list[str]:
        """As cells of a table."""
        return [f"{v:+.2%}" for v in (self.approach, self.half_width, self.peak)]


def line_errors(pair: Any, line: LineContact, approach: float) -> Errors:
    """Of the section at mid-width against Hertz's `line` there; `approach`: its relative error."""
    return Errors(
        approach, float(pair.half_width[-1]) / line.half_width - 1.0,
        float(pair.mid_peak_pressure[-1]) / line.peak_pressure - 1.0,
    )  # fmt: skip


def roller_errors(body: ReducedBody, material: Material, cells: Cells = None) -> Errors:
    """C1 and C2 at the approach that belongs to LINE_LOAD."""
    exact = LineContact(LINE_LOAD, ROLLER_RADIUS, contact_modulus(material))
    approach = roller_approach(LINE_LOAD, exact.half_width, material)
    pair = pressed_rollers([body], 2.0 * approach, cells).contact("pair 0")
    found = replace(exact, load=float(pair.line_load[-1]))
    return line_errors(pair, found, approach / roller_approach(found.load, found.half_width, material) - 1.0)


def unlike_rollers(first: Material, second: Material, half_width: float) -> tuple[Errors, float]:
    """Two rollers at a squeeze for a `half_width` [m] between them: errors there, approach that of both planes; and the
    half-width over the radius."""
    modulus = contact_modulus(first, second)
    load = np.pi * modulus * half_width**2 / (2.0 * ROLLER_RADIUS)

    def squeeze(load: float) -> float:
        between = LineContact(load, 0.5 * ROLLER_RADIUS, modulus).half_width
        total = 0.0
        for material in (first, second):
            outside = LineContact(load, ROLLER_RADIUS, contact_modulus(material)).half_width
            total += sum(roller_approach(load, a, material) for a in (outside, between))
        return total

    wanted = squeeze(load)
    bodies = [roller(material, 4, 1) for material in (first, second)]
    pair = pressed_rollers(bodies, wanted).contact("pair 1")
    found = LineContact(float(pair.line_load[-1]), 0.5 * ROLLER_RADIUS, modulus)
    return line_errors(pair, found, wanted / squeeze(found.load) - 1.0), half_width / ROLLER_RADIUS


# --- balls ---


@dataclass(frozen=True)
class BallMesh:
    """`elements` on the radius, at the surface of the ball's patch; `across` of them in the patch; kind of cells."""

    elements: float
    across: int
    kind: str

    def mesh(self) -> Mesh:
        """The ball."""
        cell = BALL_RADIUS / self.elements
        mesh = ball_mesh(
            BALL_RADIUS, patch_half_width=0.5 * self.across * cell, cell=cell, order=1 if self.kind == "hex8" else 2
        )
        return as_tets(mesh, self.kind)


def as_tets(mesh: Mesh, kind: str) -> Mesh:
    """A mesh of hex27 cut into tetrahedra of the `kind`, or as it is."""
    if kind == "tet10":
        return cut_into_tets(mesh)
    return straight(cut_into_tets(mesh)) if kind == "tet4" else mesh


COARSE_BALLS = (
    BallMesh(3.34, 2, "hex27"), BallMesh(5.0, 2, "hex27"), BallMesh(6.67, 4, "hex27"), BallMesh(5.2, 4, "hex8"),
    BallMesh(8.0, 4, "hex8"), BallMesh(3.34, 2, "tet10"), BallMesh(5.0, 2, "tet10"), BallMesh(8.0, 4, "tet10"),
    BallMesh(3.34, 2, "tet4"), BallMesh(8.0, 4, "tet4"),
)  # fmt: skip
PLAIN = BallMesh(5.0, 2, "hex27")


def ball(material: Material, mesh: BallMesh, below: Array | None = None) -> ReducedBody:
    """A reduced ball; `below`: depths [m] under its contact for the stress there."""
    stress = {}
    if below is not None:
        stress["below"] = np.column_stack([BALL_RADIUS - below, 0.0 * below, 0.0 * below])
    return reduce(
        mesh.mesh(), material, interfaces={"outside": "average"}, contact={"patch": surfaces.Sphere()}, modes=0,
        stress=stress, grid=ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def ball_approach(contact: PointContact, materials: Iterable[Material]) -> float:
    """Approach [m] of elastic balls, each balanced by a uniform body force: Hertz's less what a ball yields less."""
    total = contact.approach
    for material in materials:
        share = contact.modulus / material.plane_strain_modulus
        total += share * contact.approach * approach_correction(contact.half_width, BALL_RADIUS, material)
    return total


def point_errors(pair: Any, i: int, contact: PointContact, approach: float) -> Errors:
    """Of saved step `i` against Hertz's `contact` at the load found; the worse of both half-widths."""
    off = np.asarray(pair.half_widths[i]) / contact.half_width - 1.0
    return Errors(
        float(pair.history.approach[i]) / approach - 1.0, float(off[np.argmax(np.abs(off))]),
        float(pair.peak_pressure[i]) / contact.peak_pressure - 1.0,
    )  # fmt: skip


def weighed(body: ReducedBody, load: float, material: Material, cells: Cells = None, lean: float = 0.0) -> Result:
    """The ball under its weight, `load` [N], on a rigid plane; rotated by `lean` [rad] off the middle of its patch."""
    scene = Scene(gravity=(0.0, 0.0, -load / body.mass))
    depth = PointContact(load, BALL_RADIUS, contact_modulus(material)).approach
    half = 0.25 * np.pi + 0.5 * lean
    placed = scene.add_body(
        body, name="ball", position=(0.0, 0.0, BALL_RADIUS - depth), rotation=(0.0, np.sin(half), 0.0, np.cos(half))
    )
    scene.add(Contact(placed["patch"], plane(scene, 0.0, 1.0), grid="contact_fixed", cells=cells, name="pair"))
    guided(scene, placed)
    return rested(scene)


def ball_errors(body: ReducedBody, load: float, material: Material, cells: Cells = None, lean: float = 0.0) -> Errors:
    """C3."""
    pair = weighed(body, load, material, cells, lean).contact("pair")
    exact = PointContact(float(pair.force_magnitude[-1]), BALL_RADIUS, contact_modulus(material))
    return point_errors(pair, -1, exact, ball_approach(exact, [material]))


# --- impacts ---


def struck(bodies: list[ReducedBody], modulus: float, speed: float, cells: Cells = None) -> tuple[Result, HertzImpact]:
    """A ball that arrives at a rigid plane, or two that meet, with `speed` [m/s]."""
    masses = [body.mass for body in bodies]
    mass = masses[0] if len(bodies) == 1 else masses[0] * masses[1] / sum(masses)
    exact = HertzImpact(BALL_RADIUS / len(bodies), modulus, mass, speed)
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    gap = 1e-3 * exact.approach
    upper = scene.add_body(
        bodies[0], name="upper", position=(0.0, 0.0, BALL_RADIUS + gap), rotation=DOWN, velocity=(0.0, 0.0, -speed)
    )
    other = plane(scene, 0.0, 1.0)
    if len(bodies) > 1:
        up = (0.0, -np.sqrt(0.5), 0.0, np.sqrt(0.5))
        other = scene.add_body(bodies[1], name="lower", position=(0.0, 0.0, -BALL_RADIUS), rotation=up)["patch"]
    scene.add(Contact(upper["patch"], other, grid="contact_fixed", cells=cells, name="pair"))
    step = exact.duration / STEPS
    result = simulate(scene, 1.2 * exact.duration, step=step, progress=False)
    if result.status != "completed":
        raise InputError(f"coarse points: {result.message}")
    return result, exact


def contact_time(result: Result) -> float:
    """Time [s] from touch to separation: where lines through the outermost two values of F^(2/3), which is proportional
    to the approach, meet zero."""
    force = np.asarray(result.contact("pair").normal_load)
    on = np.flatnonzero(force > 0.0)
    ends = []
    for i, j in ((on[0], on[1]), (on[-1], on[-2])):
        (t, u), (f, g) = result.time[[i, j]], force[[i, j]] ** (2.0 / 3.0)
        ends.append(t - f * (u - t) / (g - f))
    return float(ends[1] - ends[0])


def impact_errors(result: Result, exact: HertzImpact) -> list[float]:
    """Of the largest force, the time of contact, the largest approach, and what is missing of the speed afterwards."""
    pair, motion = result.contact("pair"), result.body("upper")
    return [
        float(np.max(pair.normal_load)) / exact.force - 1.0, contact_time(result) / exact.duration - 1.0,
        float(np.max(pair.history.approach)) / exact.approach - 1.0,
        -float(motion.velocity[-1, 2]) / float(motion.velocity[0, 2]) - 1.0,
    ]  # fmt: skip


def unlike_balls(first: Material, second: Material, speed: float) -> tuple[Errors, float]:
    """Two balls that meet with `speed` [m/s], at the largest force; and the half-width over the radius."""
    modulus = contact_modulus(first, second)
    result, _ = struck([ball(first, PLAIN), ball(second, PLAIN)], modulus, speed)
    pair = result.contact("pair")
    i = int(np.argmax(pair.normal_load))
    exact = PointContact(float(pair.normal_load[i]), 0.5 * BALL_RADIUS, modulus)
    errors = point_errors(pair, i, exact, ball_approach(exact, [first, second]))
    return errors, exact.half_width / BALL_RADIUS


# --- ball on a block of tetrahedra ---


def block(material: Material, kind: str, size: float) -> ReducedBody:
    """A block below z = 0 of cells of `size` [m] around the middle of its top, and of 4 mm at its sides at most."""
    half = 2.0 * size if size > 3e-3 else 5.0 * size
    steps = [size] * round(half / size)
    while sum(steps) < 0.5 * BLOCK[0] - 1e-9:
        steps.append(min(1.5 * steps[-1], 4e-3, 0.5 * BLOCK[0] - sum(steps)))
    side = np.concatenate([[0.0], np.cumsum(steps)])
    down = [size] * max(round(0.004 / size), 1)
    while sum(down) < BLOCK[1] - 1e-9:
        down.append(min(1.5 * down[-1], 4e-3, BLOCK[1] - sum(down)))
    x = np.concatenate([-side[:0:-1], side])
    mesh = as_tets(grid(x, x, -np.concatenate([[0.0], np.cumsum(down)])[::-1], order=2), kind)
    mesh = mesh.select("top", "z_max", lambda c: np.max(np.abs(c[:, :2]), axis=1) < half)
    return reduce(
        mesh, material, interfaces={"z_min": "rigid"}, contact={"top": surfaces.Plane()}, modes=0,
        grid=ContactGrid(contact_fixed=True, spacing=size), cache=False, progress=False,
    )  # fmt: skip


def ball_on_block(body: ReducedBody, place: tuple[float, float], cells: Cells = None) -> float:
    """Force [N] of a rigid ball at APPROACH over `place` (x, y) [m]."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body, name="block")
    shape = surfaces.Sphere(radius=BALL_RADIUS, axis_point=(*place, BALL_RADIUS - APPROACH))
    scene.add(joints.Fixed(scene.ground, held["z_min"]))
    scene.add(
        Contact(held["top"], scene.ground.surface(shape, name="ball"), grid="contact_fixed", cells=cells, name="pair")
    )
    return float(rested(scene).contact("pair").force_magnitude[-1])


PLACES = [(x, y) for x in (0.0, 1e-3, 2e-3) for y in (0.0, 1e-3, 2e-3)]  # m, over a quarter of an element of 4 mm
BLOCKS = (("tet10", 4e-3), ("tet10", 2e-3), ("tet4", 4e-3), ("tet4", 2e-3))


# --- stress ---


def largest(t: Array, values: Array) -> tuple[float, float]:
    """Largest value and where, by a curve through all samples: the maximum is flat."""
    curve = np.polynomial.Polynomial.fit(t, values, 6)
    fine = np.linspace(t[0], t[-1], 4001)
    return float(curve(fine).max()), float(fine[np.argmax(curve(fine))])


def mises_errors(found: Array, exact: Callable[[Array], Array], depths: Array) -> list[str]:
    """Errors of the largest von Mises stress, and of its depth."""
    (value, where), (wanted, there) = largest(depths, found), largest(depths, exact(depths))
    return [f"{value / wanted - 1.0:+.2%}", f"{where / there - 1.0:+.2%}"]


def roller_mises(material: Material, elements: int, order: int) -> list[str]:
    """Below the lower line of a roller, at mid-width."""
    exact = LineContact(LINE_LOAD, ROLLER_RADIUS, contact_modulus(material))
    depths = DEPTHS * exact.half_width
    squeeze = 2.0 * roller_approach(LINE_LOAD, exact.half_width, material)
    result = pressed_rollers([roller(material, elements, order, depths)], squeeze)
    line = replace(exact, load=float(result.contact("pair 0").line_load[-1]))
    found = result.stress("roller 0", "below").von_mises[-1]
    return mises_errors(found, lambda z: line.von_mises(z, material.poisson_ratio), depths)


def ball_mises(material: Material, mesh: BallMesh) -> list[str]:
    """Below a ball under C3."""
    exact = PointContact(LOAD, BALL_RADIUS, contact_modulus(material))
    depths = DEPTHS * exact.half_width
    result = weighed(ball(material, mesh, depths), LOAD, material)
    found = result.stress("ball", "below").von_mises[-1]
    return mises_errors(found, lambda z: exact.von_mises(z, material.poisson_ratio), depths)


# --- situations that ask for trouble ---


def trouble() -> list[tuple[str, str]]:
    """What a body or a run says where the mesh is hopeless, or the patch leaves its surface."""

    def told(attempt: Callable[[], str]) -> str:
        try:
            return attempt()
        except InputError as error:
            return f"refused: {error}"

    def four_sectors() -> str:
        mesh = roller_mesh(ROLLER_RADIUS, 0.0, ROLLER_RADIUS, sectors=8, layers=1, axial=1, order=1)
        body = reduce(
            mesh, STEEL, interfaces={"end_low": "average"}, contact={"rim": surfaces.Cylinder()}, modes=0,
            grid=ContactGrid(contact_fixed=True), cache=False, progress=False,
        )  # fmt: skip
        return "; ".join(body.report["warnings"]) or "reduced"

    def one_cell() -> str:
        return "; ".join(ball(STEEL, BallMesh(3.34, 2, "hex8")).report["warnings"])

    def tetrahedra() -> str:
        return "; ".join(ball(STEEL, BallMesh(3.34, 2, "tet4")).report["warnings"])

    def soft_block() -> str:
        soft = replace(STEEL, poisson_ratio=0.49)
        coarse = block(soft, "tet4", 4e-3)
        force = ball_on_block(coarse, (0.0, 0.0)) / ball_on_block(block(soft, "tet10", 2e-3), (0.0, 0.0)) - 1.0
        return f"force {force:+.2%} against tet10 of 2 mm; " + "; ".join(coarse.report["warnings"])

    def leaning(share: float) -> Callable[[], str]:
        def attempt() -> str:
            half = 1.0 / PLAIN.elements  # rad, from the middle of the patch to its edge
            body = ball(STEEL, PLAIN)
            found = weighed(body, LOAD, STEEL, lean=share * half)
            errors = ball_errors(body, LOAD, STEEL, lean=share * half)
            return f"approach {errors.approach:+.2%}, peak {errors.peak:+.2%}; " + "; ".join(found.history.notes)

        return attempt

    return [
        ("roller, eight linear cells around, one on the radius", told(four_sectors)),
        ("ball, two by two linear cells under the patch", told(one_cell)),
        ("ball, tet4, three cells on the radius", told(tetrahedra)),
        ("block of nu = 0.49, tet4 of 4 mm", told(soft_block)),
        ("ball, patch half-way to the edge of its contact surface", told(leaning(0.5))),
        ("ball, patch on the edge of its contact surface", told(leaning(1.0))),
        ("ball, patch beyond the edge of its contact surface", told(leaning(1.5))),
    ]
