r"""The rule for the contact grid on reduced rollers: a mesh finer than the grid, and the mesh as coarse as the grid.

One roller is pressed by a rigid cylinder, plane strain in effect (one cell along the axis), free in space, so that its
inertia holds against the load. The compliance of a window of the grid is put together from the reduced body,
`D + Phi Omega^-2 Phi^T`, and the contact solved as in `grid_errors`, the gap a parabola. Reference: the finest mesh
with its nodal grid at the same approach.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from studies.contact.grid_errors import contact_pressures
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.offline.contact.mesh_error import line_mesh_error

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
RADIUS, BORE, WIDTH = 0.05, 0.015, 0.005  # m
SECTORS = 1440  # linear cells of the finest mesh around
HALF_WIDTH = 16  # of the patch, in spacings of the finest mesh
GROWTH = {1: 1.3, 2: 1.69}  # of the layers, by order: equal for the layers of nodes
CURVATURE = 10.0  # 1/m, of the gap; the force is linear in it
SEARCHES = 6  # for the approach: each leaves a quarter of the defect
GRIDS = (8, 4, 2)  # spacings, in those of the finest mesh
MESHES = {1: (8, 4, 2, 1), 2: (8, 4, 2)}  # distances of nodes around, by order
POSITIONS = 8  # of the patch in a spacing of the grid
WINDOW = 2.0  # half-widths to either side that the contact may look at
GROWTHS = (1.15, 1.3, 1.7, 2.2, 3.0)  # of layers of cells, from one to the next
FINEST_GROWTH = 1.15  # of the reference
FINER = {1: 2, 2: 4}  # distance of nodes of the meshes that grow, in those of the finest, by order


@dataclass(frozen=True)
class RollerState:
    """Line contact of a roller on its grid: relative errors of the force against the finest mesh, worst position."""

    order: int  # of the elements
    nodes: float  # their distance around, in half-widths
    spacing: float  # of the grid, in half-widths
    centred: float
    worst: float


@dataclass(frozen=True)
class LayerState:
    """Mean error of the force over positions of the patch, and what `mesh_error` says, of layers that grow."""

    order: int  # of the elements
    half_width: float  # m
    growth: float
    error: float
    estimate: float


def meshed_roller(nodes: int, order: int, growth: float) -> Mesh:
    """The roller with `nodes` nodes around, cells of `order`, as deep at the rim as wide, growing inwards by
    `growth`."""
    size = 2.0 * np.pi * RADIUS * order / nodes
    layers = int(np.ceil(np.log1p((RADIUS - BORE) / size * (growth - 1.0)) / np.log(growth)))
    return roller(RADIUS, BORE, WIDTH, sectors=nodes // order, layers=layers, axial=1, order=order, grading=growth)


def pressed_roller(
    nodes: int, spacing: float | None = None, *, order: int = 1, growth: float | None = None, cache: bool = True
) -> ReducedBody:
    """The roller with `nodes` nodes around, cells of `order`; spacing [m] of its contact grid, None: its nodes."""
    return reduce(
        meshed_roller(nodes, order, growth or GROWTH[order]), STEEL, interfaces={"bore": "rigid"},
        contact={"rim": Cylinder()}, grid=ContactGrid(spacing=spacing), cache=cache, progress=False,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Pressed:
    """A contact: force [N] and half-width [m] from the second moment of the pressure."""

    force: float
    half_width: float


def press(body: ReducedBody, position: float, half_width: float, approach: float) -> Pressed:
    """The roller under a rigid cylinder of gap `CURVATURE x^2 - approach` [m], x the arc from `position` [m].

    The window reaches `WINDOW` of the expected half_width [m].
    """
    surface = body.contact_surfaces["rim"]
    grid = surface.grid
    spacing = grid.pitch * RADIUS
    middle, reach = position / spacing, int(np.ceil(WINDOW * half_width / spacing))
    columns = np.arange(int(np.floor(middle)) - reach, int(np.ceil(middle)) + reach + 1)
    x = columns * spacing - position
    area = WIDTH * spacing
    gap = area * (CURVATURE * (x**2 + spacing**2 / 6.0) - approach)
    f = contact_pressures(window_compliance(surface, body.frequencies, columns % grid.columns), gap)
    center = (f * x).sum() / f.sum()
    moment = (f * (x - center) ** 2).sum() / f.sum() + spacing**2 / 6.0
    return Pressed(float(area * f.sum()), float(2.0 * np.sqrt(moment)))


def window_compliance(surface: ContactSurface, frequencies: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """a_ij (n, n) [m^3/Pa] between node columns of the same pressure on all rows: `M (D + Phi Omega^-2 Phi^T) M` summed
    over rows, columns `columns` (n,) of the grid, frequencies (m,) [Hz]."""
    grid = surface.grid
    per_sector, sectors = grid.columns_per_sector, len(surface.lags)
    blocks = surface.lags.reshape(sectors, per_sector, grid.rows, per_sector, grid.rows)
    lag = (columns[:, None] // per_sector - columns[None] // per_sector) % sectors
    inside = columns % per_sector
    D = blocks[lag, inside[:, None], :, inside[None], :]  # (n, n, rows, rows)
    Phi = surface.mode_normal.reshape(grid.columns, grid.rows, -1)[columns]
    D = D + np.einsum("akm,blm->abkl", Phi / (2.0 * np.pi * frequencies) ** 2, Phi)
    along = surface.gram_z.sum(axis=1)
    M = grid.gram_theta()[np.ix_(columns, columns)]
    return M @ np.einsum("abkl,k,l->ab", D, along, along) @ M


def approach_for(body: ReducedBody, half_width: float) -> float:
    """Approach [m] at which the half-width [m] is the wanted one; it goes nearly with its square."""
    approach = CURVATURE * half_width**2 * (np.log(2.0 * RADIUS / half_width) + 0.5)
    for _ in range(SEARCHES):
        approach *= (half_width / press(body, 0.0, half_width, approach).half_width) ** 2
    return float(approach)


def roller_half_width(sectors: int = SECTORS) -> float:
    """Half-width [m] of the patch."""
    return HALF_WIDTH * 2.0 * np.pi * RADIUS / sectors


def roller_states(*, sectors: int = SECTORS, cache: bool = True) -> list[RollerState]:
    """Grids of half a half-width to an eighth, on meshes from the finest down to the grid's own spacing."""
    size = 2.0 * np.pi * RADIUS / sectors
    b = roller_half_width(sectors)
    found = []
    for order, meshes in MESHES.items():
        finest = pressed_roller(sectors, order=order, cache=cache)
        approach = approach_for(finest, b)
        exact = press(finest, 0.0, b, approach).force
        for ratio, coarser in itertools.product(GRIDS, meshes):
            if coarser > ratio:
                continue
            spacing = None if coarser == ratio else ratio * size
            body = pressed_roller(sectors // coarser, spacing, order=order, cache=cache)
            places = ratio * size * np.arange(POSITIONS) / POSITIONS  # column 0 lies on a line of nodes
            errors = np.array([press(body, x, b, approach).force for x in places]) / exact - 1.0
            worst = float(max(errors, key=abs))
            found.append(RollerState(order, coarser / HALF_WIDTH, ratio / HALF_WIDTH, float(errors[0]), worst))
    return found


def layer_states(*, sectors: int = SECTORS, half_widths: tuple[float, ...] = (0.5, 1.0, 2.0)) -> list[LayerState]:
    """Rollers whose layers grow, pressed to `half_widths` in those of the patch, against the finest quadratic mesh."""
    b = roller_half_width(sectors)
    finest = pressed_roller(sectors, order=2, growth=FINEST_GROWTH)
    found = []
    for order, growth in itertools.product((1, 2), GROWTHS):
        nodes = sectors // FINER[order]
        body, mesh = pressed_roller(nodes, order=order, growth=growth), meshed_roller(nodes, order, growth)
        surface = body.contact_surfaces["rim"]
        places = surface.grid.pitch * RADIUS * np.arange(POSITIONS) / POSITIONS
        for part in half_widths:
            approach = approach_for(finest, part * b)
            exact = press(finest, 0.0, part * b, approach).force
            error = float(np.mean([press(body, x, part * b, approach).force for x in places])) / exact - 1.0
            estimate = line_mesh_error(mesh, surface.shape, surface.grid, part * b)
            assert estimate is not None
            found.append(LayerState(order, part * b, growth, error, estimate))
    return found
