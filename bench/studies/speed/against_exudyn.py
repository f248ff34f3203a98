"""The same flexible body in EXUDYN: mesh, matrices and modes are ours, the equations and the integrator are its own.

EXUDYN (J. Gerstmayr, https://github.com/jgerstmayr/EXUDYN) is the open multibody program nearest to this one. Its
`ObjectFFRFreducedOrder` is fed the consistent M, K and the global modes of a `ReducedBody` at all nodes, so what is
compared are the inertia terms, the joint, and the time integration. A bar of hex20 cells, one cell across, is used:
all its nodes lie on the skin, where a `ReducedBody` keeps its modes. The bar hangs from the ground by a spherical
joint in its `root`, a rigid interface: its nodes move as a rigid body to first order, so the mean of their
displacements, which EXUDYN's marker takes, is the displacement of the interface's point in both programs.

EXUDYN is optional (`pip install -e ".[verify]"`) and imported when called only.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version as installed_version
from time import perf_counter
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from scenes.flat_settings import reduce_flat
from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline.fe import assemble, assign
from warpffrf.online import GeneralizedAlpha, History, run

LENGTH, HEIGHT, WIDTH = 0.5, 0.02, 0.012  # m
SOFT = Material(youngs_modulus=5e7, poisson_ratio=0.3, density=1200.0)  # a rubber: bends by millimetres
GRAVITY = (0.0, 0.0, -9.81)
SPIN = (0.0, 3.0, 12.0)  # rad/s: out of the plane of gravity, so that the motion is spatial
RHO_INF = 0.8
ATTACHMENT = 6  # modes that the rigid interface adds to the vibration modes
SAME_NODE = 1e-9  # m: nodes of the skin and of the mesh are the same numbers


def bar(cells: int = 32) -> Mesh:
    """hex20 bar along x, one cell across, with the facet sets `root` (x = 0) and `tip`."""
    x = np.linspace(0.0, LENGTH, 2 * cells + 1)
    corner = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)])
    edges = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
    local = np.concatenate([corner, [(corner[a] + corner[b]) // 2 for a, b in edges]])
    keys: dict[tuple[int, int, int], int] = {}
    table = np.zeros((cells, 20), dtype=np.int64)
    for e in range(cells):
        for i, (a, b, c) in enumerate(local):
            table[e, i] = keys.setdefault((int(a) + 2 * e, int(b), int(c)), len(keys))
    points = np.array([(x[a], 0.5 * HEIGHT * (b - 1), 0.5 * WIDTH * (c - 1)) for a, b, c in keys])
    bare = Mesh(points, {"hex20": table})
    outer = bare.outer_facets()
    at = outer.centers(points)[:, 0]
    return Mesh(points, bare.cells, {"root": outer.kept(at < 1e-9), "tip": outer.kept(at > LENGTH - 1e-9)})


def reduced_bar(mesh: Mesh, modes: int, **options: Any) -> ReducedBody:
    """The bar with `modes` global modes, attachment modes counted, all of them with inertia terms; `options` of
    `reduce`."""
    options = {"inertia_modes": modes, **options}
    return reduce_flat(
        mesh, SOFT, interfaces={"root": "rigid"}, modes=modes - ATTACHMENT, cache=False, progress=False, **options
    )


def version() -> str:
    """Of the EXUDYN that is installed."""
    return installed_version("exudyn")


def nodal_modes(mesh: Mesh, body: ReducedBody) -> np.ndarray:
    """Global modes at all nodes of the mesh (3 n, m), of a mesh whose nodes all lie on the skin."""
    distance, at = KDTree(body.surface.points).query(mesh.points)
    if distance.max() > SAME_NODE:
        raise ValueError("the mesh has nodes inside, where a reduced body keeps no modes")
    modes = np.asarray(body.surface.modes, dtype=np.float64)[:, at]
    return modes.reshape(len(modes), -1).T


def our_scene(body: ReducedBody, inertia: str = "full", spin: tuple[float, float, float] = SPIN) -> Scene:
    """The bar let go from the horizontal with the angular velocity `spin` [rad/s] about its root."""
    scene = Scene(gravity=GRAVITY)
    part = scene.add_body(body, name="bar", angular_velocity=spin, damping=0.0, inertia=inertia)
    scene.add(joints.Spherical(scene.ground, part["root"]))
    return scene


def our_tip(history: History, mesh: Mesh, modes: np.ndarray) -> np.ndarray:
    """Mean position of the tip's nodes (T, 3) [m], world axes."""
    nodes = tip_nodes(mesh)
    phi = modes.reshape(-1, 3, modes.shape[1])[nodes].mean(axis=0)
    place = mesh.points[nodes].mean(axis=0)
    motion = history.bodies["bar"]
    local = place + motion.modal @ phi.T
    return motion.position + np.array([rot.matrix(p) @ x for p, x in zip(motion.rotation, local, strict=True)])


def tip_nodes(mesh: Mesh) -> np.ndarray:
    """Numbers of the nodes of the tip."""
    return np.flatnonzero(mesh.points[:, 0] > LENGTH - 1e-9)


@dataclass
class Rival:
    """The bar in EXUDYN, ready to be solved any number of times, each time from the start."""

    container: Any  # exudyn SystemContainer, which owns the system
    system: Any  # exudyn MainSystem
    sensor: int
    exudyn: Any

    def solve(
        self, steps: int, step: float, *, modified: bool = False, solver: str = "EigenDense", save: int = 0
    ) -> tuple[np.ndarray, float]:
        """Tip (T, 3) [m] every `save` steps (0: none) and wall seconds of `steps` steps from the start, one thread."""
        settings = self.exudyn.SimulationSettings()
        settings.parallel.numberOfThreads = 1
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = step * save if save else 10.0 * step * steps
        settings.linearSolver.solverType = getattr(self.exudyn.LinearSolverType, solver)
        settings.timeIntegration.verboseMode = 0
        integration = settings.timeIntegration
        integration.numberOfSteps, integration.endTime = steps, steps * step
        integration.generalizedAlpha.spectralRadius = RHO_INF
        integration.generalizedAlpha.computeInitialAccelerations = True
        integration.newton.useModifiedNewton = modified
        begin = perf_counter()
        done = self.system.SolveDynamic(
            settings, solverType=self.exudyn.DynamicSolverType.GeneralizedAlpha, showHints=False, showCausingItems=False
        )
        seconds = perf_counter() - begin
        if not done:
            raise RuntimeError("EXUDYN did not finish")
        tip = np.array(self.system.GetSensorStoredData(self.sensor))[:, 1:4] if save else np.zeros((0, 3))
        return tip, seconds


def rival(mesh: Mesh, body: ReducedBody, modes: np.ndarray, spin: tuple[float, float, float] = SPIN) -> Rival:
    """The same bar, joint and start in EXUDYN. Raises ImportError where it is not installed."""
    exudyn, FEM, items = (import_module(name) for name in ("exudyn", "exudyn.FEM", "exudyn.itemInterface"))
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, SOFT))
    center = np.asarray(body.center_of_mass)
    fem = FEM.FEMinterface()
    fem.nodes = {"Position": mesh.points - center}
    fem.massMatrix, fem.stiffnessMatrix = M, K
    fem.modeBasis = {"matrix": modes, "type": "NormalModes"}
    fem.surface = [{"Name": "none", "Trigs": [], "Quads": []}]
    reduced = FEM.ObjectFFRFreducedOrderInterface(fem)
    # modes are kept in single precision: in double the reduced matrices are these, and coupling by rounding is left out
    reduced.massMatrixReduced = np.eye(modes.shape[1])
    reduced.stiffnessMatrixReduced = np.diag((2.0 * np.pi * np.asarray(body.frequencies)) ** 2)
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    objects = reduced.AddObjectFFRFreducedOrder(
        system, positionRef=list(center), initialVelocity=list(np.cross(spin, center)), rotationMatrixRef=np.eye(3),
        initialAngularVelocity=list(spin), gravity=list(GRAVITY),
    )  # fmt: skip
    flexible = objects["oFFRFreducedOrder"]
    root = np.flatnonzero(mesh.points[:, 0] < 1e-9)
    # weights of the mean; the root's nodes lie symmetrically about its point
    held = system.AddMarker(
        items.MarkerSuperElementPosition(
            bodyNumber=flexible, meshNodeNumbers=list(root), weightingFactors=[1.0 / len(root)] * len(root)
        )
    )
    ground = system.AddObject(items.ObjectGround(referencePosition=[0.0, 0.0, 0.0]))
    fixed = system.AddMarker(items.MarkerBodyPosition(bodyNumber=ground, localPosition=[0.0, 0.0, 0.0]))
    system.AddObject(items.SphericalJoint(markerNumbers=[fixed, held]))
    tip = tip_nodes(mesh)
    marker = system.AddMarker(
        items.MarkerSuperElementPosition(
            bodyNumber=flexible, meshNodeNumbers=list(tip), weightingFactors=[1.0 / len(tip)] * len(tip)
        )
    )
    sensor = system.AddSensor(
        items.SensorMarker(
            markerNumber=marker, storeInternal=True, outputVariableType=exudyn.OutputVariableType.Position
        )
    )
    system.Assemble()
    return Rival(container, system, sensor, exudyn)


def our_run(scene: Scene, steps: int, step: float, save: int) -> History:
    """The same run here: `steps` steps, saved every `save`."""
    return run(scene, steps * step, step=step, integrator=GeneralizedAlpha(RHO_INF), save_every=save, progress=False)
