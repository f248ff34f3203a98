"""Friction of the contact pairs -> device tables: coefficients, cells and traces of modes along the surfaces.

A scene without friction gets empty tables. Displacements by tractions are among the responses (`responses`).
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.friction import cubic_pieces
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.scene import Scene
from warpffrf.online.compile.capacity import CellRoom, slots_of
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.windows import Extent, between_axes, sine_between
from warpffrf_kernels.core.model import Model

CUBIC_SPARE = 2  # columns beyond the overlap reached by a cubic, see `cell_shares.spread_cells`
ROUND_OFF = 1e-9  # cells: a ratio of two grids that is a whole number up to this is one


def has_friction(scene: Scene) -> bool:
    """True where any pair of `scene` has friction."""
    return any(contact.friction.acts for contact in scene.finite_sliding)


def fill_friction(collector: Collector, m: Model, z_start: np.ndarray) -> None:
    """Friction fields of the model; `z_start`: of `fill_surfaces`."""
    contacts = collector.scene.finite_sliding
    collector.fill(
        m.pairs, friction=[c.friction.largest_coefficient for c in contacts],
        slip_velocity=[c.friction.creep_limit for c in contacts],
    )  # fmt: skip
    _fill_slip_speeds(collector)
    present = has_friction(collector.scene)
    if present and m.modes.dynamic_count:  # tangential compliances are those of static local modes
        rubbing_pair = next(c for c in contacts if c.friction.acts)
        raise InputError(
            f"contact {rubbing_pair.name!r}: friction needs quasi-static local modes in the whole scene, and "
            f"{m.modes.dynamic_count} of it have inertia; use local_modes='quasi_static'"
        )
    if present:
        collector.cell_room = _cell_room(collector, m)
    m.capacity.cells = collector.cell_room.cells(m.capacity.slots)
    rubbed = {side for i, c in enumerate(contacts) if c.friction.acts
              for side in collector.sides[2 * i : 2 * i + 2]}  # fmt: skip
    starts: list[int] = []
    modes: list[np.ndarray] = []
    share = (1, 1)
    area = np.zeros(collector.constants.sizes["z_entry"])
    for number, (_, _, surface) in enumerate(collector.surfaces):
        if not isinstance(surface, ContactSurface) or number not in rubbed:
            starts.append(-1)
            continue
        tangential = surface.tangential
        if tangential is None:
            raise InputError(f"surface {surface.name!r}: friction needs a body that was reduced with tangential=True")
        cells = tangential.grid
        area[z_start[number] : z_start[number] + cells.rows] = cells.pitch * np.diag(cells.gram_z(surface.shape))
        starts.append(sum(map(len, modes)))
        by_columns = tangential.mode_tangent.reshape(2, cells.columns, cells.rows, -1).transpose(1, 0, 2, 3)
        modes.append(np.ascontiguousarray(by_columns).ravel())
    for i, (contact, _, a, _, b) in enumerate(collector.pairs()):
        if contact.friction.acts and isinstance(b, ContactSurface) and i not in collector.patches:
            crossed = sine_between(Extent.of(a), Extent.of(b), between_axes(contact))
            share = tuple(np.maximum(share, _extent(a, b, crossed)))
    m.window.share_columns, m.window.share_rows = (int(n) for n in share)
    collector.fill(
        m.surfaces, cell_area=area, shear_start=starts, mode_tangent=np.concatenate([np.zeros(0), *modes]),
    )  # fmt: skip


def _fill_slip_speeds(collector: Collector) -> None:
    """Coefficients that depend on the slip speed, in cubic pieces, concatenated tables."""
    tables = [
        cubic_pieces(c.friction, f"contact {c.name!r}") if c.friction.breaks else np.zeros((0, 5))
        for c in collector.scene.finite_sliding
    ]
    pieces = [len(table) for table in tables]
    collector.fill(
        collector.elements.slip_speeds, count=sum(n > 0 for n in pieces), start=np.cumsum([0, *pieces])[:-1],
        pieces=pieces, piece=np.concatenate([np.zeros((0, 5)), *tables]),
    )  # fmt: skip


def _cell_room(collector: Collector, m: Model) -> CellRoom:
    """Cells next to active nodes are loaded too (`bounds`): a patch of n nodes in r rows and c columns has at most
    2 (c + r) neighbours.
    """
    first = most = 0
    for i, (contact, _, a, _, _) in enumerate(collector.pairs()):
        plan = collector.patches.get(i)
        if plan is not None:  # bounds are those of the cells' own pressures
            cells = plan.columns * len(plan.z)
            first, most = max(first, slots_of(contact, cells)), max(most, cells)
            continue
        grid_nodes = m.window.grid_nodes if contact.capacity is None else min(contact.capacity, m.window.grid_nodes)
        beside = 2 * (min(grid_nodes, m.window.columns) + min(grid_nodes, a.grid.rows))
        first = max(first, min(m.window.grid_nodes, slots_of(contact, grid_nodes) + beside))
        most = max(most, min(m.window.grid_nodes, grid_nodes + beside))
    return CellRoom(m.capacity.slots, m.capacity.slot_limit, first, most)


def _extent(a: ContactSurface, b: ContactSurface, crossed: float) -> tuple[int, int]:
    """Largest numbers of columns and rows of the second grid's cells under a cell of the first, `crossed` the largest
    sine of the angle between the grids.
    """
    z_a, z_b = np.asarray(a.grid.z), np.asarray(b.grid.z)
    pitch_a, pitch_b = np.max(a.grid.pitch * a.shape.radius_at(z_a)), np.min(b.grid.pitch * b.shape.radius_at(z_b))
    edges = [np.diff(np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])) for z in (z_a, z_b)]
    around = (pitch_a + crossed * edges[0].max()) / pitch_b
    along = (edges[0].max() + crossed * pitch_a) / edges[1].min()
    columns, rows = (int(np.ceil(x - ROUND_OFF)) + 1 for x in (around, along))
    return columns + CUBIC_SPARE, min(rows, len(z_b))
