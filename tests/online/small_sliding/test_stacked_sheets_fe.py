"""Sheets on top of each other against a full finite-element solution: every node of every sheet, no modes.

Of the package the reference has the stiffness matrix alone. On faces of linear hexahedra the nodes of the contact grids
are the shape functions, so pressures p stand on the nodes, and with B the nodal forces of unit nodes on both sides of
all pairs, S the mean motions that the guides hold, and f the load

    K u = f + B p + S^T r,     S u = 0,     0 <= p  _|_  B^T u >= 0,

B^T u the weak gaps. Nothing is apart without load, hence p is proportional to f. Modes and compliances of the sheets
together hold all of K^-1 f; what is left is that bodies turn as they bend, which falls with the load.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.offline import reduce
from warpffrf.offline.fe import assemble, assign
from warpffrf.online import find_equilibrium

STEEL = Material(210e9, 0.3, 7850.0)
SIZE = (0.02, 0.016, 0.004)  # m, of a sheet
SPOT = 0.004  # m, radius of where the uppermost sheet is pressed
LOADS = (0.2, 20.0)  # N: far above what rounds gaps off, 1e-14 of the scene
# 1/N, of the largest pressure of a pair, by the number of sheets: the angles by which bodies turn are 0.72e-9, 1.20e-9
# and 2.59e-9 rad/N; 0.87e-9, 1.07e-9 and 2.14e-9 were seen at any load of 2 mN to 2 kN, and for 0 to 40 modes alike
TURNED = {1: 1.0e-9, 2: 1.2e-9, 4: 2.4e-9}
SEEN = 0.15  # of the largest pressure: what the compliances between faces make of it is 0.20 at four modes
SETS = 20  # of active nodes that are tried; it takes 3 to 5


@cache
def mesh() -> Mesh:
    return box(SIZE, (8, 6, 2), order=1).select("spot", "z_max", lambda c: np.hypot(c[:, 0], c[:, 1]) < SPOT)


# --- full finite elements ---


def face_mass(name: str) -> np.ndarray:
    """int N_a N_b dA (n, n) [m2] of a set of rectangles."""
    x = mesh().points
    (facets,) = mesh().facets(name).blocks.values()
    W = np.zeros((len(x), len(x)))
    for f in facets:
        area = np.linalg.norm(np.cross(x[f[1]] - x[f[0]], x[f[3]] - x[f[0]]))
        W[np.ix_(f, f)] += area / 36.0 * np.array([[4, 2, 1, 2], [2, 4, 2, 1], [1, 2, 4, 2], [2, 1, 2, 4]])
    return W


def mean_motion(name: str) -> np.ndarray:
    """(6, 3 n): the rigid motion nearest to that of a set over its area, translation and rotation at its middle."""
    W = face_mass(name)
    R = rigid_modes(mesh().points, W.sum(axis=0) @ mesh().points / W.sum())
    WR = np.kron(W, np.eye(3)) @ R
    return np.linalg.solve(R.T @ WR, WR.T)


def node_nodes() -> tuple[np.ndarray, np.ndarray]:
    """Nodes under the nodes of the lower face, and those above them; there are no nodes at both ends along x."""
    x = mesh().points
    lower = np.flatnonzero((x[:, 2] < 1e-9 - 0.5 * SIZE[2]) & (np.abs(x[:, 0]) < 0.5 * SIZE[0] - 1e-9))
    upper = [int(np.argmin(np.linalg.norm(x - x[i] * (1.0, 1.0, -1.0), axis=1))) for i in lower]
    return lower, np.array(upper)


@cache
def full_pressures(sheets: int) -> np.ndarray:
    """Pressures (sheets, nodes) [1/m2] under a load of 1 N, floor first, in the order of `node_nodes`."""
    K, _ = assemble(mesh().points, mesh().cells, assign(mesh(), STEEL))
    size = K.shape[0]
    lower, upper = node_nodes()
    grid_nodes = len(lower)
    B = np.zeros((sheets * size, sheets * grid_nodes))
    for i in range(sheets):
        B[i * size + 2 : (i + 1) * size : 3, i * grid_nodes : (i + 1) * grid_nodes] = face_mass("z_min")[:, lower]
        if i > 0:
            B[(i - 1) * size + 2 : i * size : 3, i * grid_nodes : (i + 1) * grid_nodes] = -face_mass("z_max")[:, upper]
    held = np.delete(mean_motion("x_min"), 2, axis=0)  # all but the way along the guide
    S = sp.block_diag([held / np.abs(held).max(axis=1, keepdims=True)] * sheets)
    area = np.tile(face_mass("z_min")[:, lower].sum(axis=0), sheets)
    B /= area  # mean gaps and forces of nodes
    stiff = K.diagonal().mean()
    f = np.zeros(sheets * size)
    f[-size:] = -mean_motion("spot")[2]
    active = np.ones(sheets * grid_nodes, dtype=bool)
    for _ in range(SETS):
        on = np.flatnonzero(active)
        blocks = [[sp.block_diag([K] * sheets) / stiff, S.T, -B[:, on]], [S, None, None], [-B[:, on].T, None, None]]
        matrix: Any = sp.bmat(blocks, format="csc")
        solution = splu(matrix).solve(np.append(f / stiff, np.zeros(matrix.shape[0] - len(f))))
        p = np.zeros(len(active))
        p[on] = stiff * solution[-len(on) :] / area[on]
        gap = B.T @ solution[: len(f)]
        new = np.where(active, p > 0.0, gap < 0.0)
        if np.array_equal(new, active):
            return p.reshape(sheets, grid_nodes)
        active = new
    raise AssertionError(f"active set did not settle in {SETS} changes")


# --- the reduced sheets ---


@cache
def sheet(modes: int) -> ReducedBody:
    return reduce(
        mesh(), STEEL, interfaces={"x_min": "average", "spot": "average"}, contact={"z_min": Plane(), "z_max": Plane()},
        modes=modes, cache=False, progress=False,
    )  # fmt: skip


def pressures(body: ReducedBody, sheets: int, load: float) -> np.ndarray:
    """The same of reduced sheets on a rigid floor, all guided along z, the uppermost one pressed in its middle."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    below = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    for i in range(sheets):
        part = scene.add_body(body, name=f"sheet {i + 1}", position=(0.0, 0.0, SIZE[2] * (i + 0.5)))
        scene.add(joints.Prismatic(scene.ground, part["x_min"], axis=(0, 0, 1), name=f"guide {i + 1}"))
        scene.add(Contact(part["z_min"], below, name=f"pair {i + 1}"))
        below = part["z_max"]
        if i + 1 == sheets:
            scene.add(forces.PointForce(part["spot"], (0.0, 0.0, -load)))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    surface = body.contact_surfaces["z_min"]
    theta, z = np.meshgrid(surface.grid.theta, surface.grid.z, indexing="ij")
    places = surface.shape.point(theta, z).reshape(-1, 1, 3)
    away = np.linalg.norm(places - mesh().points[node_nodes()[0]], axis=2)
    order = np.argmin(away, axis=0)
    assert len(order) == surface.local_modes and np.diagonal(away[order]).max() < 1e-12
    return np.array([contact.pressure[0].ravel()[order] for contact in rest.contacts.values()]) / load


def difference(found: np.ndarray, exact: np.ndarray) -> float:
    """The largest of all pairs, each of its largest pressure."""
    return float((np.abs(found - exact).max(axis=1) / exact.max(axis=1)).max())


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("modes", [0, 4, 40])
@pytest.mark.parametrize("sheets", list(TURNED))
def test_pressures_are_those_of_full_finite_elements(sheets: int, modes: int, load: float) -> None:
    """Of a sheet on the floor, which is one pair alone, and of two and four, in which the faces of a sheet displace
    each other: no worse but for how far they turn."""
    exact, found = full_pressures(sheets), pressures(sheet(modes), sheets, load)
    closed = np.count_nonzero(exact, axis=1)
    assert closed.min() > 10 and closed.max() < exact.shape[1]  # nodes, and some that are open
    assert np.array_equal(found > 0.0, exact > 0.0)
    worst = difference(found, exact)
    print(f"{sheets} sheets, {modes} modes, {load} N: closed nodes {closed}, pressures agree to {worst:.1e}")
    assert worst < TURNED[sheets] * load


def test_what_loads_on_a_face_do_to_the_other_is_no_small_part() -> None:
    apart = replace(sheet(4), cross=())
    assert difference(pressures(apart, 4, LOADS[0]), full_pressures(4)) > SEEN
