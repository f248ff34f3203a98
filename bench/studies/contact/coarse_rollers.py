r"""Rollers on meshes far coarser than their contact, on contact-fixed cells.

Two hollow steel rollers (R 50, bore 15, width 20 mm) whose bores are held at an approach. References are full finite
elements of one roller on the plane of symmetry between the two (`free_end`): quadratic cells, six in a half-width, no
modes, no half-space; none of it is the package's. Where rollers are tilted, skewed, or several, nothing is symmetric,
and the reference is the package's own body-fixed grid on a mesh made for the contact, three quadratic cells in a
half-width.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from references.closed_forms import LineContact, contact_modulus
from references.closed_forms.elliptic import EllipticContact
from references.finite_elements.free_end import STEEL_ROLLER, EndPressure, press_crowned, press_pair, press_roller
from scenes.flat_settings import reduce_flat
from scenes.user_meshes import cut_into_tets, gmsh_roller, serendipity, straight
from warpffrf.model import joints, signals, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate
from warpffrf.study.markdown import table

Array = np.ndarray
STEEL = STEEL_ROLLER.material
R, BORE, WIDTH = STEEL_ROLLER.outer_radius, STEEL_ROLLER.inner_radius, STEEL_ROLLER.width
PAIR = "pair"
LOADS = (3e3, 9e3)  # N: approaches of 5 and 15 um
LEVEL = (6.0, 0.125)  # cells in a, end cell over a
CROWNS = ((0.14, 1e3), (0.5, 1e3), (2.0, 300.0), (2.0, 1500.0))  # m, N
CROWNED_LEVEL = 6.0
INSIDE = (2e-4, 6e-5)  # m from the end
FINE_SECTORS = 1600
FINEST = 2e-3  # m, elements of the second mesh
LONG = replace(STEEL_ROLLER, width=2.0 * WIDTH)  # the wider partner
FLUSH_LEVEL = (5.0, 0.125)  # as LEVEL
TURNED_APPROACH, BESIDE_APPROACH = 3e-5, 2e-5  # m
APART = (np.pi, 0.5, 0.26, 0.18, 0.12)  # rad between two rollers on one
REVOLUTIONS, STRIDE = 10, 0.02  # rad per step: a quarter of an element of 4 mm
LAYER = 0.8  # of the size of the cells at the rim over that of the layers
ROLLED, TURNS = 3.0, 60  # elements of 4 mm, saved places


def hexahedra(size: float, order: int = 2, crown_radius: float | None = None, width: float = WIDTH) -> Mesh:
    """The roller in cells of `size` [m] at the rim."""
    return roller_mesh(
        R, BORE, width, sectors=4 * round(0.5 * np.pi * R / size), layers=round(LAYER * (R - BORE) / size),
        axial=round(width / size), order=order, crown_radius=crown_radius,
    )  # fmt: skip


MESHES: dict[str, Callable[[], Mesh]] = {
    "hex8, 4 mm": lambda: hexahedra(4e-3, 1),
    "hex8, 2 mm": lambda: hexahedra(2e-3, 1),
    "hex8, 1 mm": lambda: hexahedra(1e-3, 1),
    "hex20, 8 mm": lambda: serendipity(hexahedra(8e-3)),
    "hex20, 4 mm": lambda: serendipity(hexahedra(4e-3)),
    "hex20, 2 mm": lambda: serendipity(hexahedra(2e-3)),
    "hex27, 4 mm": lambda: hexahedra(4e-3),
    "tet10, 4 mm": lambda: cut_into_tets(hexahedra(4e-3)),
    "tet10, 2 mm": lambda: cut_into_tets(hexahedra(2e-3)),
    "tet10, 4 mm, Gmsh": gmsh_roller,
    "tet4, 4 mm": lambda: straight(cut_into_tets(hexahedra(4e-3))),
    "tet4, 2 mm": lambda: straight(cut_into_tets(hexahedra(2e-3))),
    "tet4, 4 mm, Gmsh": lambda: straight(gmsh_roller()),
}


def reduced(mesh: Mesh, crown_radius: float | None = None, **options: Any) -> ReducedBody:
    """The roller for contact on cells, its bore rigid."""
    shape = surfaces.Cylinder() if crown_radius is None else surfaces.CrownedCylinder(crown_radius=crown_radius)
    given = {"modes": 0, "contact_fixed": True, "cache": False, "progress": False, **options}
    return reduce_flat(mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": shape}, **given)


def held(
    lower: ReducedBody, upper: ReducedBody, approach: float, *, tilt: float = 0.0, skew: float = 0.0,
    shift: float = 0.0, turning: float = 0.0, **contact: Any,
) -> Scene:  # fmt: skip
    """Two rollers with axes along y, the upper one `approach` [m] too near above the lower, tilted about x and skewed
    about z [rad], shifted along y [m]; bores held, or turning [rad/s] against each other."""
    scene = Scene(gravity=(0, 0, 0))
    first = scene.add_body(lower, name="lower")
    about_x = np.array([np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt)])
    about_z = np.array([0.0, 0.0, np.sin(0.5 * skew), np.cos(0.5 * skew)])
    turn = rot.quaternion(rot.matrix(about_z) @ rot.matrix(about_x))
    second = scene.add_body(upper, name="upper", position=(0, shift, 2 * R - approach), rotation=turn)
    for body, sense in ((first, 1.0), (second, -1.0)):
        if not turning:
            scene.add(joints.Fixed(scene.ground, body["bore"]))
            continue
        axle = scene.add(joints.Revolute(scene.ground, body["bore"], axis=(0, 1, 0)))
        scene.add(joints.Drive(axle, signals.Ramp(0.0, sense * turning, duration=1e-3), quantity="velocity"))
    scene.add(Contact(first["rim"], second["rim"], **{"grid": "contact_fixed", "name": PAIR, **contact}))
    return scene


@dataclass(frozen=True, eq=False)
class Found:
    """Of a state at rest: force [N], peak pressure at mid-width [Pa], and largest pressures across (m,) at z (m,)
    [m]."""

    force: float
    peak: float
    z: Array
    along: Array

    @classmethod
    def of(cls, scene: Scene) -> Found:
        """The static state of a scene of `held`."""
        result = equilibrium(scene)
        if result.status != "completed":
            raise RuntimeError(result.message)
        pair = result.contact(PAIR)
        p = pair.mean_pressure[-1]
        return cls(
            float(pair.force_magnitude[-1]), float(pair.mid_peak_pressure[-1]), np.atleast_2d(pair.rows)[-1],
            p[p.shape[0] // 2],
        )  # fmt: skip

    def near_end(self, inside: float) -> float:
        """Pressure [Pa] on the line of contact, `inside` [m] from the end; the mean of both ends."""
        half = 0.5 * WIDTH - inside
        return float(np.mean(np.interp([-half, half], self.z, self.along)))


def ripple(body: ReducedBody, approach: float) -> float:
    """How far the force goes up and down while the rollers rotate by three elements at constant approach, of its mean
    [-]."""
    angle, step = ROLLED * 4e-3 / R, 1e-4
    scene = held(body, body, approach, turning=angle / (TURNS * step))
    result = simulate(scene, TURNS * step, step=step, start="equilibrium", progress=False)
    if result.status != "completed":
        raise RuntimeError(result.message)
    force = result.contact(PAIR).force_magnitude
    return float(np.ptp(force) / force.mean())


def half_width_under(load: float) -> float:
    """Half-width [m] of two equal rollers under the load [N]."""
    return LineContact(load / WIDTH, R, contact_modulus(STEEL)).half_width


def straight_reference(load: float) -> EndPressure:
    """Finite elements of a straight roller under the load [N]."""
    return press_roller(STEEL_ROLLER, load, half_width_under(load), *LEVEL)


def crowned_reference(crown_radius: float, load: float) -> EndPressure:
    """Finite elements of a crowned roller under the load [N]."""
    axes = EllipticContact(load, R, crown_radius, contact_modulus(STEEL)).half_axes
    return press_crowned(STEEL_ROLLER, crown_radius, load, axes, CROWNED_LEVEL)


def fine_roller() -> ReducedBody:
    """The roller on a mesh for nodes of 0.1 mm around, twelve cells below the rim and twenty along the axis."""
    mesh = roller_mesh(
        R, BORE, WIDTH, sectors=FINE_SECTORS, layers=12, axial=20, grading=1.6, order=2
    )  # fmt: skip
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=0, progress=False
    )


def between_rigid(body: ReducedBody, apart: float, approach: float, **contact: Any) -> Scene:
    """The roller, its bore held, with two rigid rollers of R/10 on it, `apart` [rad] from each other, each `approach`
    [m] too near."""
    scene = Scene(gravity=(0, 0, 0))
    middle = scene.add_body(body, name="lower")
    scene.add(joints.Fixed(scene.ground, middle["bore"]))
    small = 0.1 * R
    for n, angle in enumerate((-0.5 * apart, 0.5 * apart)):
        place = (R + small - approach) * np.array([np.sin(angle), 0.0, np.cos(angle)])
        shape = surfaces.Cylinder(radius=small, axis_point=place, axis_direction=(0, 1, 0))
        partner = scene.ground.surface(shape, name=f"small {n}")
        scene.add(Contact(middle["rim"], partner, **{"grid": "contact_fixed", "name": f"{PAIR} {n}", **contact}))
    return scene


def spurious(body: ReducedBody, approach: float) -> float:
    """Of the load, the mean force that cells which travel would do work with over REVOLUTIONS at constant approach: the
    ledger's `contact_grid` at the end over force and way."""
    angle, step = 2.0 * np.pi * REVOLUTIONS, 1e-3
    scene = held(body, body, approach, turning=STRIDE / step)
    result = simulate(
        scene,
        step * round(angle / STRIDE),
        step=step,
        start="equilibrium",
        options=RunOptions(save_every=10),
        progress=False,
    )
    if result.status != "completed":
        raise RuntimeError(result.message)
    force = float(result.contact(PAIR).force_magnitude.mean())
    return float(abs(result.history.energy["contact_grid"][-1])) / (force * angle * R)


def straight_rows(references: dict[float, EndPressure]) -> list[list[str]]:
    """Of every mesh: degrees of freedom, error by two meshes, errors of forces, peaks and pressures near the end,
    ripple."""
    rows, finest = [], reduced(hexahedra(FINEST))
    half_width = half_width_under(LOADS[-1])
    for name, mesh in MESHES.items():
        body = reduced(mesh())
        cells = [name, str(body.report["dofs"]), f"{body.mesh_error(finest, half_width=half_width)['rim']:+.2%}"]
        for load, reference in references.items():
            found = Found.of(held(body, body, 2.0 * reference.approach))
            cells += [_error(found.force / load), _error(found.peak / reference.middle)]
            cells += [_error(found.near_end(inside) / reference.along(inside)) for inside in INSIDE]
        rows.append([*cells, f"{ripple(body, 2.0 * references[LOADS[-1]].approach):.3%}"])
    return rows


def crowned_rows() -> list[list[str]]:
    """Of every crown and mesh: errors of force and peak."""
    rows = []
    kinds: dict[str, Callable[[Mesh], Mesh]] = {
        "hex27": lambda mesh: mesh, "tet10": cut_into_tets, "tet4": lambda mesh: straight(cut_into_tets(mesh))
    }  # fmt: skip
    for crown_radius, load in CROWNS:
        reference = crowned_reference(crown_radius, load)
        for kind, made in kinds.items():
            body = reduced(made(hexahedra(4e-3, 2, crown_radius)), crown_radius)
            found = Found.of(held(body, body, 2.0 * reference.approach))
            rows.append([f"{crown_radius:g}", f"{load:g}", f"{2e6 * reference.approach:.2f}", f"{kind}, 4 mm",
                         _error(found.force / load), _error(found.peak / reference.middle)])  # fmt: skip
    return rows


def flush_rows() -> list[list[str]]:
    """Of every mesh: errors of force, peak and pressure near the end of a roller on one twice as wide."""
    reference = press_pair(STEEL_ROLLER, LONG, LOADS[-1], half_width_under(LOADS[-1]), *FLUSH_LEVEL)
    kinds: dict[str, Callable[[float], Mesh]] = {
        "hex8": lambda width: hexahedra(4e-3, 1, width=width),
        "hex27": lambda width: hexahedra(4e-3, width=width),
        "tet10": lambda width: cut_into_tets(hexahedra(4e-3, width=width)),
    }  # fmt: skip
    rows = []
    for kind, made in kinds.items():
        short, long = (reduced(made(width)) for width in (WIDTH, LONG.width))
        found = Found.of(held(short, long, reference.approach))
        rows.append([f"{kind}, 4 mm", f"{1e6 * reference.approach:.2f}", _error(found.force / LOADS[-1]),
                     _error(found.peak / reference.middle),
                     _error(found.near_end(INSIDE[0]) / reference.along(INSIDE[0]))])  # fmt: skip
    return rows


def turned_rows(fine: ReducedBody, coarse: dict[str, ReducedBody]) -> list[list[str]]:
    """Tilted and skewed rollers: errors of force and largest pressure against the fine body-fixed grid."""
    rows = []
    cases: dict[str, dict[str, float]] = {"aligned": {}, "tilted by 0.5 mrad": {"tilt": 5e-4},
                                          "skewed by 5 mrad": {"skew": 5e-3}}  # fmt: skip
    for name, turned in cases.items():
        figures = {}
        for key, body in {"fine": fine, **coarse}.items():
            contact = {"grid": "body_fixed", "capacity": 6000} if key == "fine" else {}
            pair = equilibrium(held(body, body, TURNED_APPROACH, **turned, **contact)).contact(PAIR)
            figures[key] = (float(pair.force_magnitude[-1]), float(pair.peak_pressure[-1]))
        for key in coarse:
            rows.append([name, key, *(_error(a / b) for a, b in zip(figures[key], figures["fine"], strict=True))])
    return rows


def beside_rows(fine: ReducedBody, coarse: dict[str, ReducedBody]) -> list[list[str]]:
    """Two small rollers on one: the force of each over that of one alone on the fine grid, and the errors of it."""
    rows = []
    alone = None
    for apart in APART:
        forces = {}
        for key, body in {"fine": fine, **coarse}.items():
            contact = {"grid": "body_fixed", "capacity": 6000} if key == "fine" else {}
            result = equilibrium(between_rigid(body, apart, BESIDE_APPROACH, **contact))
            forces[key] = float(result.contact(f"{PAIR} 0").force_magnitude[-1])
        alone = alone or forces["fine"]  # the first are opposite each other
        rows.append([f"{apart * R * 1e3:.1f}", f"{forces['fine'] / alone:.3f}",
                     *(_error(forces[key] / forces["fine"]) for key in coarse)])  # fmt: skip
    return rows


def _error(ratio: float) -> str:
    return f"{ratio - 1.0:+.2%}"


COARSE = ("hex8, 4 mm", "tet10, 4 mm, Gmsh")


def compute() -> dict[str, Any]:
    """Rows of the tables, approaches of the straight rollers [m], and dofs of the fine mesh."""
    references = {load: straight_reference(load) for load in LOADS}
    fine = fine_roller()
    coarse = {name: reduced(MESHES[name]()) for name in COARSE}
    approach = 2.0 * references[LOADS[-1]].approach
    return {
        "approaches": [reference.approach for reference in references.values()],
        "dofs": fine.report["dofs"],
        "straight": straight_rows(references),
        "crowned": crowned_rows(),
        "flush": flush_rows(),
        "turned": turned_rows(fine, coarse),
        "beside": beside_rows(fine, coarse),
        "energy": [[name, f"{spurious(body, approach):.1e}"] for name, body in coarse.items()],
    }


def page(found: dict[str, Any]) -> str:
    """The whole page."""
    places = [f"{inside * 1e3:g} mm from the end" for inside in INSIDE]
    head = ["mesh", "dofs", "two meshes"]
    for approach in found["approaches"]:
        head += [f"force at {2e6 * approach:.1f} µm", "peak", *places]
    widths = " and ".join(f"{half_width_under(load) * 1e3:.2f}" for load in LOADS)
    return f"""# Rollers on meshes coarser than their contact

Two hollow steel rollers (R 50, bore 15, width 20 mm), bores held at an approach, pressures on contact-fixed
cells, eleven strips by 21 rows (27 of crowned ones). Half-widths are about {widths} mm: 0.02 to 0.4 elements.

## Straight rollers

Compared with full finite elements of one roller on the plane of symmetry, quadratic cells of a sixth of a half-width
(`free_end`; their force is converged to 0.1 %, their peak to 0.3 %). *Peak*: at mid-width. Pressure on the line of
contact near the free end. *Two meshes*: error of the force that `ReducedBody.mesh_error` finds by hex27 of 2 mm.
*Ripple*: of the force while the rollers rotate by three elements of 4 mm at constant approach.

{table([*head, "ripple"], found["straight"])}
## Crowned rollers

Compared with finite elements with six cells in each half-axis of Hertz's ellipse.

{table(["crown [m]", "load [N]", "approach [µm]", "mesh", "force", "peak"], found["crowned"])}
## A flush roller on a wider one

The second roller is {LONG.width * 1e3:g} mm wide, 10 mm more at each end. Compared with finite elements of both with
{FLUSH_LEVEL[0]:g} cells in a half-width, whose peak is converged to 1 %, and to 1.5 % the pressure near the end, which
at the end itself has no bound.

{table(["mesh", "approach [µm]", "force", "peak", places[0]], found["flush"])}
## Tilt and skew

At {TURNED_APPROACH * 1e6:g} µm compared with the package's body-fixed grid on a mesh made for the contact (nodes every
0.1 mm, {found["dofs"]} dofs).

{table(["axes", "mesh", "force", "largest pressure"], found["turned"])}
## Two rollers on one

Rigid rollers of R 5 mm, {BESIDE_APPROACH * 1e6:g} µm each, at a distance along the rim; the force of one over that with
both opposite each other, on the same fine grid, and the error of it on meshes of 4 mm.

{table(["apart [mm]", "force", *COARSE], found["beside"])}
## Energy

Work of contact-fixed cells over {REVOLUTIONS} revolutions at constant approach, as a mean force over the load
(ledger line `contact_grid`).

{table(["mesh", "force over the load"], found["energy"])}"""
