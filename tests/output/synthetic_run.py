"""Two hollow rollers with a Hertz pressure that travels around them: every figure of the run is known in closed form.

The bodies are real `ReducedBody` objects with an invented but consistent compliance (a Gaussian dimple under each
hat), so that skins, files and recordings are exercised without an offline run.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid, meridian_gram
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.surfaces import Cylinder
from warpffrf.online.history.history import ENERGY_LINES, BodyHistory, ContactHistory, History, JointHistory
from warpffrf.output.geometry.scene_view import BodyView, PairView, SceneView

R, WIDTH, BORE = 0.05, 0.02, 0.015
COLUMNS, ROWS, WINDOW = 180, 3, 17
PITCH = 2.0 * np.pi / COLUMNS
HALF_WIDTH = 4.0 * R * PITCH  # four nodes to the half-width
PEAK = 100e6  # Pa, in the first row
POISSON = 0.3
# a = 2 R_eff p0 / E* with R_eff = R/2 and E* = E / (2 (1 - nu^2)): the modulus that makes the first row Hertz's
E_MODULUS = 2.0 * (1.0 - POISSON**2) * R * PEAK / HALF_WIDTH
STEPS, DURATION, TURN = 9, 0.02, 0.3  # rows, s, rad rotated by the first roller
MODES = 2


def roller() -> ReducedBody:
    """A hollow roller about y: skin of rim and bore, two made-up modes, a dimple under each node."""
    z = np.linspace(-0.5, 0.5, ROWS) * WIDTH
    shape = Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    grid = SurfaceGrid(shape.e_0, 0.0, PITCH, COLUMNS, True, z, 1)
    theta = PITCH * np.arange(COLUMNS)
    ring, axial = np.meshgrid(theta, z, indexing="ij")
    rim = shape.point(ring.ravel(), axial.ravel())
    bore = rim * np.array([BORE / R, 1.0, BORE / R])
    points = np.concatenate([rim, bore])
    triangles = _tube_triangles(0, outwards=True) + _tube_triangles(COLUMNS * ROWS, outwards=False)
    normals = shape.normal(ring.ravel(), axial.ravel())
    # hat force -> dimple: an outward force moves the rim outwards, by 1e-9 m/N under it
    angle = np.arange(COLUMNS)[:, None] - np.arange(COLUMNS)[None, :]
    angle = (angle + COLUMNS // 2) % COLUMNS - COLUMNS // 2
    around = np.exp(-((angle / 6.0) ** 2))
    along = np.exp(-(((z[:, None] - z[None, :]) / (0.5 * WIDTH)) ** 2))
    normal_response = 1e-9 * np.kron(around, along)
    transfer = np.zeros((2 * COLUMNS * ROWS, 3, COLUMNS * ROWS), dtype=np.float32)
    transfer[: COLUMNS * ROWS] = normals[:, :, None] * normal_response[:, None, :]
    recovery = Recovery(transfer.reshape(1, -1, COLUMNS * ROWS), 1, np.eye(3))
    modes = np.zeros((MODES, len(points), 3))
    modes[0, :, 1] = points[:, 0]  # bends out of its plane
    modes[1, :, 0], modes[1, :, 2] = points[:, 0], -points[:, 2]  # ovals
    lags = normal_response[:ROWS].reshape(ROWS, COLUMNS, ROWS).transpose(1, 0, 2).copy()
    surface = ContactSurface("rim", shape, grid, lags, np.zeros((COLUMNS * ROWS, MODES)), recovery)
    material = {"youngs_modulus": E_MODULUS, "poisson_ratio": POISSON, "density": 7850.0, "name": ""}
    return ReducedBody(
        mass=1.0,
        center_of_mass=np.zeros(3),
        inertia=np.diag([1e-3, 2e-3, 1e-3]),
        frequencies=np.array([5e3, 8e3]),
        interfaces={"bore": Interface("rigid", np.zeros(3), np.zeros((MODES, 6)))},
        contact_surfaces={"rim": surface},
        surface=DisplaySurface(points, np.array(triangles), modes),
        report={},
        provenance={"contact_materials": {"rim": material}},
    )


def _tube_triangles(first: int, *, outwards: bool) -> list[tuple[int, int, int]]:
    triangles = []
    for j in range(COLUMNS):
        for k in range(ROWS - 1):
            a, b = first + j * ROWS + k, first + ((j + 1) % COLUMNS) * ROWS + k
            # theta grows from +x towards e_1 = -z: the axial neighbour first is counter-clockwise seen from outside
            quad = (a, b, b + 1, a + 1) if outwards else (a, a + 1, b + 1, b)
            triangles += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return triangles


def hertz_loads(offset: float) -> np.ndarray:
    """int p psi_j dtheta over the window for Hertz of peak 1, the line of centres `offset` columns from the
    middle column."""
    fine = np.arange(-1.0, WINDOW, 1.0 / 64.0) + 1.0 / 128.0  # midpoint rule, 64 points a column
    p = np.sqrt(np.maximum(0.0, 1.0 - ((fine - WINDOW // 2 - offset) * R * PITCH / HALF_WIDTH) ** 2))
    grid_nodes = np.maximum(0.0, 1.0 - np.abs(fine[None, :] - np.arange(WINDOW)[:, None]))
    return PITCH * grid_nodes @ p / 64.0


def hertz_nodes(offset: float) -> np.ndarray:
    """The L2 projection of the same pressure on the window's nodes, as a weak contact solution finds it."""
    gram = PITCH / 6.0 * (4.0 * np.eye(WINDOW) + np.eye(WINDOW, k=1) + np.eye(WINDOW, k=-1))
    return np.linalg.solve(gram, hertz_loads(offset))


def quaternion_y(angle: np.ndarray) -> np.ndarray:
    return np.stack([0 * angle, np.sin(angle / 2), 0 * angle, np.cos(angle / 2)], axis=1)


def make_history(body: ReducedBody, *, name: str = "lower-upper") -> History:
    """Lower roller at the origin turning by +TURN about y, upper one above it turning back; contact at the top of
    the lower."""
    time = np.linspace(0.0, DURATION, STEPS)
    angle = TURN * time / DURATION
    peak = PEAK * (1.0 + time / DURATION)
    # the top of the lower roller is +z; e_1 = e_a x e_0 = y x x = -z, so the contact starts at theta = -90 degrees; a
    # turn by +angle about y carries +z towards +x, material angles under the fixed contact point decrease with it
    center_first = (-0.5 * np.pi - angle) / PITCH
    center_second = (0.5 * np.pi + angle) / PITCH
    first_column = np.floor(center_first + 0.5).astype(int) - WINDOW // 2
    second_column = np.floor(center_second + 0.5).astype(int) - WINDOW // 2
    pressure = np.zeros((STEPS, WINDOW, ROWS))
    load = np.zeros((STEPS, WINDOW, ROWS))
    gram_z = meridian_gram("nodes", body.contact_surfaces["rim"].shape, body.contact_surfaces["rim"].grid.z)
    for i in range(STEPS):
        pressure[i] = peak[i] * hertz_nodes(center_first[i] - first_column[i] - WINDOW // 2)[:, None]
        line = peak[i] * hertz_loads(center_second[i] - second_column[i] - WINDOW // 2)
        load[i] = line[:, None] * gram_z.sum(axis=1)
    total = 0.5 * np.pi * HALF_WIDTH * peak * WIDTH
    down = np.stack([0 * total, 0 * total, -total], axis=1)
    zero = np.zeros((STEPS, 3))
    modal = 1e-6 * np.stack([np.sin(angle), np.cos(angle)], axis=1)

    def motion(height: float, sign: float) -> BodyHistory:
        position = np.tile([0.0, 0.0, height], (STEPS, 1))
        spin = np.tile([0.0, sign * TURN / DURATION, 0.0], (STEPS, 1))
        return BodyHistory(position, quaternion_y(sign * angle), zero.copy(), spin, modal.copy())

    bodies = {"lower": motion(0.0, 1.0), "upper": motion(2.0 * R, -1.0)}
    contact = ContactHistory(
        force=down,
        torque=zero.copy(),
        force_second=-down,
        torque_second=zero.copy(),
        first_column=first_column % COLUMNS,
        center_column=center_first % COLUMNS,
        pressure=pressure,
        first_column_second=second_column % COLUMNS,
        load_second=load,
        approach=np.full(STEPS, 1e-5),
        active_nodes=np.count_nonzero(pressure[:, :, 0], axis=1) * ROWS,
    )
    view_bodies = {n: BodyView(n, body, body.mass, body.center_of_mass) for n in bodies}
    pair = PairView(name, view_bodies["lower"], "rim", view_bodies["upper"], "rim")
    energy = {line: np.zeros(STEPS) for line in ENERGY_LINES}
    energy["kinetic"] = 1.0 + time
    energy["drive_work"] = time.copy()
    energy["numerical"] = 1e-4 * np.sin(angle)
    return History(
        scene=SceneView("hash of this scene", view_bodies, {name: pair}, ("axle",)),
        time=time,
        step_size=np.diff(time, prepend=time[0]),
        bodies=bodies,
        joints={"axle": JointHistory(angle, zero.copy(), zero.copy())},
        contacts={name: contact},
        energy=energy,
        iterations=np.full(STEPS, 2),
        factorisations=np.full(STEPS, 3),
        counters={"steps": float(STEPS - 1)},
        notes=["a term was dropped"],
        checkpoint={"state.position": np.arange(6.0).reshape(1, 2, 3)},
    )
