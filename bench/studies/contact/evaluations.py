r"""The quadratures of one contact compared: "full" and "reduced" against the law "at nodes" of the finite elements,
and what a step of each costs.

Two rollers with the mesh of the two-roller demo and nodes on a part of their rims (a *tread*) roll on each other at a
constant approach, with a stiff layer between them: the same in all three, in the nodes of "full" and "reduced" and
at every FE node "at nodes", where all local modes are coordinates of one Newton system (`references.monolithic`).
Compared over the saved steps
are

    force      |F - F_nodal| over |F_nodal|, the largest
    pressure   means over the nodes of the first grid, `sum_j M_ij s_j / a_i`, and the node forces spread in the
               same way: |p - p_nodal| over |p_nodal| in the L2 norm of the surface, the largest
    stress     von Mises stress at points under the tread, from SHALLOWEST half-widths deep on: the largest difference
               over the largest stress

Step times are those of the graph, "at nodes" those of the loop; its systems are dense, and few steps suffice.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from references.monolithic import results as monolithic
from references.monolithic.line_of_centres.pair import STIFFER as HARDEST
from references.monolithic.line_of_centres.pair import default_layer
from scenes.rollers import PAIR, STEEL
from studies.speed.step_time import BORE, RADIUS, WIDTH, swinging_pair
from warpffrf.model.laws import LinearLayer
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import ALL_ALONG, ALL_AROUND
from warpffrf.model.reduced.stress_field import von_mises
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

GRADING = 1.3
POINTS = "under"  # name of the stress points
ACROSS, DEEP = 21, 6  # stress points around and in depth
SHALLOWEST, DEEPEST = 0.3, 2.0  # half-widths: the largest shear stress of a line contact lies at 0.78
RHO = 0.8  # of the integrator, the same for all
STEP = 1e-4  # s
INTEGRATOR = GeneralizedAlpha(RHO)
OPTIONS: dict[str, Any] = {"step": STEP, "progress": False}
SEPARATED = ("full", "reduced")
STIFFER = 3.0  # layer over a node: it yields by some per cent of the approach, as penalties are chosen


@dataclass(frozen=True)
class Errors:
    """Differences of a quadrature from "at nodes", as fractions (module docstring)."""

    quadrature: str
    points: int  # of a strip
    half_width: float  # of the patch of "at nodes" [columns]
    force: float
    pressure: float
    stress: float

    def row(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def tread(
    columns: int,
    *,
    sectors: int,
    layers: int,
    axial: int,
    sampling_error: float | None = None,
    half_width: float | None = None,
    contact_fixed: bool = False,
) -> ReducedBody:
    """A roller whose nodes cover `columns` grid columns about the angle zero; `sampling_error`: with sampling points
    for it; `half_width` [m]: with stress points below the middle of the tread, over two half-widths to each side;
    `contact_fixed`: with what contact-fixed cells need."""
    mesh = roller(RADIUS, BORE, WIDTH, sectors=sectors, layers=layers, axial=axial, grading=GRADING, order=1)
    half = 0.5 * (columns + 1) * 2.0 * np.pi / sectors
    mesh = mesh.select("tread", "rim", lambda x: np.abs(np.arctan2(-x[:, 2], x[:, 0])) < half)
    stress = None if half_width is None else {POINTS: stress_points(half_width)}
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": Cylinder()}, modes=0, stress=stress,
        grid=ContactGrid(sampling_error=sampling_error, contact_fixed=contact_fixed), progress=False,
    )  # fmt: skip


def stress_points(half_width: float) -> np.ndarray:
    """Points (n, 3) [m] at mid-width under the angle zero of the tread, for patches of `half_width` [m]."""
    depth = half_width * np.linspace(SHALLOWEST, DEEPEST, DEEP)
    angle = np.linspace(-2.0, 2.0, ACROSS) * half_width / RADIUS
    R, t = np.meshgrid(RADIUS - depth, angle, indexing="ij")
    return np.stack([R * np.cos(t), np.zeros_like(R), -R * np.sin(t)], axis=-1).reshape(-1, 3)


def layer_of(body: ReducedBody, stiffer: float = STIFFER) -> LinearLayer:
    """A stiff layer: `stiffer` times the stiffness of the surface under a node."""
    return LinearLayer(stiffer / HARDEST * default_layer(body.contact_surfaces["tread"]))


def scene_of(
    body: ReducedBody,
    quadrature: str,
    approach: float,
    swing: float,
    rate: float,
    duration: float,
    stiffer: float = STIFFER,
    second: ReducedBody | None = None,
) -> Scene:
    """The rolling pair with the stiff layer of `layer_of` the lower body; arguments as of `step_time.swinging_pair`."""
    scene = swinging_pair(body, approach, swing, rate, duration, second)
    contact = scene.contacts[0]
    contact.law, contact.quadrature = layer_of(body, stiffer), quadrature
    for item in scene.bodies:
        item.level = "constant"
    return scene


def run_quadrature(scene: Scene, steps: int) -> Result:
    """`steps` steps of the scene by the engine."""
    return _completed(
        simulate(scene, steps * STEP, start="equilibrium", options=RunOptions(integrator=INTEGRATOR), **OPTIONS),
        scene.contacts[0].quadrature,
    )


def run_at_nodes(scene: Scene, steps: int, *, start: Any = "equilibrium", variant: str = "low_rank") -> Result:
    """`steps` steps of the scene by the monolithic reference, with the law at the nodes."""
    options = {**OPTIONS, "integrator": INTEGRATOR, "start": start, "variant": variant, "at_nodes": True}
    return _completed(monolithic.simulate(scene, steps * STEP, **options), "at nodes")


def _completed(result: Result, quadrature: str) -> Result:
    if result.status != "completed":
        raise RuntimeError(f"{quadrature}: {result.status}: {result.message}")
    return result


def compare(
    body: ReducedBody,
    approach: float,
    swing: float,
    rate: float,
    steps: int,
    stiffer: float = STIFFER,
    second: ReducedBody | None = None,
) -> list[Errors]:
    """Errors of "full" and "reduced" against "at nodes" over `steps` steps of rolling; arguments as of `scene_of`."""
    scenes = {
        quadrature: scene_of(body, quadrature, approach, swing, rate, steps * STEP, stiffer, second)
        for quadrature in SEPARATED
    }
    full = run_at_nodes(scenes["full"], steps)
    found = {"at nodes": full, **{name: run_quadrature(scene, steps) for name, scene in scenes.items()}}
    sizes = np.linalg.norm(full.history.contacts[PAIR].force, axis=1)
    stress = under(body, full, True)
    pressures = {name: node_means(body, result, name == "at nodes") for name, result in found.items()}
    gram = np.asarray(body.contact_surfaces["tread"].gram_z)
    out = []
    for name in SEPARATED:
        force = np.linalg.norm(found[name].history.contacts[PAIR].force, axis=1)
        worst = 0.0
        for p, reference in zip(pressures[name], pressures["at nodes"], strict=True):
            worst = max(worst, surface_norm(p - reference, gram) / surface_norm(reference, gram))
        difference = np.abs(under(body, found[name], False) - stress).max()
        out.append(
            Errors(
                name,
                points_of(body, name),
                patch_columns(body, pressures["at nodes"]),
                float(np.abs(force / sizes - 1.0).max()),
                float(worst),
                float(difference / stress.max()),
            )  # fmt: skip
        )
    return out


def patch_columns(body: ReducedBody, pressure: np.ndarray) -> float:
    """Half-width [columns] of pressures (T, columns, rows): twice the root of the second moment, meaned over T."""
    line = pressure @ np.asarray(body.contact_surfaces["tread"].gram_z).sum(axis=1)
    j, total = np.arange(line.shape[1]), line.sum(axis=1)
    middle = line @ j / total
    second = np.einsum("tj,tj->t", line, (j - middle[:, None]) ** 2) / total
    return float(2.0 * np.sqrt(second).mean())


def points_of(body: ReducedBody, quadrature: str) -> int:
    """Points of a strip that `quadrature` looks at."""
    surface = body.contact_surfaces["tread"]
    if quadrature == "reduced":
        return 0 if surface.sampling is None else surface.sampling.count
    return ALL_AROUND * ALL_ALONG * (surface.grid.rows - 1)


def on_grid(body: ReducedBody, result: Result) -> np.ndarray:
    """The recorded pressures (T, columns, rows) [Pa] on the whole grid."""
    grid, record = body.contact_surfaces["tread"].grid, result.history.contacts[PAIR]
    out = np.zeros((len(record.pressure), grid.columns, grid.rows))
    for t, (first, values) in enumerate(zip(record.first_column, record.pressure, strict=True)):
        columns = int(first) + np.arange(len(values))
        known = (columns >= 0) & (columns < grid.columns)
        out[t, columns[known]] = values[known]
    return out


def node_means(body: ReducedBody, result: Result, nodes: bool) -> np.ndarray:
    """Pressure (T, columns, rows) [Pa] on the whole grid, meaned over each node; that of `nodes` was recorded so."""
    pressure, surface = on_grid(body, result), body.contact_surfaces["tread"]
    if nodes:
        return pressure
    gram, grid = np.asarray(surface.gram_z), surface.grid
    return np.array([grid.along_theta(p) @ gram.T for p in pressure]) / (grid.pitch * gram.sum(axis=1))


def under(body: ReducedBody, result: Result, nodes: bool) -> np.ndarray:
    """Von Mises stress (T, p) [Pa] of the lower roller under the tread: of its modes and of the forces on its nodes,
    which of `nodes` are the recorded pressures times the areas of the nodes."""
    surface, grid = body.contact_surfaces["tread"], body.contact_surfaces["tread"].grid
    pressure, gram = on_grid(body, result), np.asarray(surface.gram_z)
    out = []
    for q, p in zip(result.history.bodies["lower"].modal, pressure, strict=True):
        force = p * (grid.pitch * gram.sum(axis=1)) if nodes else grid.along_theta(p) @ gram.T
        out.append(von_mises(body.stress[POINTS].evaluate(q, {"tread": -force})))
    return np.array(out)


def surface_norm(p: np.ndarray, gram: np.ndarray) -> float:
    """Root of the sum over columns of p.M_z p, p (columns, rows)."""
    return float(np.sqrt(np.einsum("jk,kl,jl->", p, gram, p)))


def step_seconds(result: Result) -> float:
    """Wall time of a step [s] of a run."""
    counters = result.history.counters
    part = "seconds_in_graph" if "seconds_in_graph" in counters else "loop_seconds"
    return float(counters[part]) / max(int(counters["steps"]), 1)
