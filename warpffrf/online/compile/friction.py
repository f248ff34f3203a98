"""Friction of the contact pairs -> device tables: coefficients, cells, tangential compliance and traces of modes.

A scene without friction gets empty tables. The tables are laid out like those of the normal compliance
(`compliance_tables.response_table`): for every source line of a block of columns, the responses along the columns of a
window are one contiguous run; a column has 2 rows lines of tangential direction and row, or rows lines of hats.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from warpffrf_kernels.core.model import Model

from warpffrf.model.contact_surface import ContactSurface
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.model.tangential import Tangential
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import hat_gram
from warpffrf.online.compile.shared import neighbours
from warpffrf.online.compile.windows import Extent, between_axes, sine_between

CUBIC_SPARE = 2  # columns beyond the overlap that a cubic reaches, see `cell_shares.spread_cells`
ROUND_OFF = 1e-9  # cells: a ratio of two grids that is a whole number up to this is one


def has_friction(scene: Scene) -> bool:
    """True where any pair of `scene` has friction."""
    return any(contact.friction.coefficient > 0.0 for contact in scene.contacts)


def fill_friction(collector: Collector, m: Model, reaches: Sequence[int], z_start: np.ndarray) -> None:
    """Friction fields of the model; `reaches`: of `surface_reaches`, `z_start`: of `fill_surfaces`."""
    contacts = collector.scene.contacts
    collector.fill(
        m.pairs, friction=[c.friction.coefficient for c in contacts],
        slip_velocity=[c.friction.slip_velocity for c in contacts],
    )  # fmt: skip
    present = has_friction(collector.scene)
    if present and m.modes.dynamic_count:  # tangential compliances are those of static local modes
        rubbing_pair = next(c for c in contacts if c.friction.coefficient > 0.0)
        raise InputError(
            f"contact {rubbing_pair.name!r}: friction needs quasi-static local modes in the whole scene, and "
            f"{m.modes.dynamic_count} of it have inertia; use local='quasi_static'"
        )
    collector.cell_margin = _cells_beside(collector, m) if present else 0
    m.capacity.cells = m.capacity.slots + collector.cell_margin if present else 0
    shear, tt, nt, tn = [], [], [], []
    modes: list[np.ndarray] = []
    tables: list[np.ndarray] = []
    known: dict[tuple, tuple[int, ...]] = {}  # where the tables of a surface begin, as a first and as a second one
    share = (1, 1)
    rubbing = [contact.friction.coefficient > 0.0 for contact in contacts]
    found = neighbours(collector)
    area = np.zeros(collector.constants.sizes["z_entry"])
    for number, (_, surface) in enumerate(collector.surfaces):
        side = number % 2
        # what others rub on a surface that it shares is felt by a pair without friction too
        used = any(rubbing[s // 2] for s in [number, *found[number]])
        if not isinstance(surface, ContactSurface) or not used:
            for starts, value in zip((shear, tt, nt, tn), (-1, 0, 0, 0), strict=True):
                starts.append(value)
            continue
        tangential = surface.tangential
        if tangential is None:
            raise InputError(f"surface {surface.name!r}: friction needs a body that was reduced with tangential=True")
        cells = tangential.grid
        area[z_start[number] : z_start[number] + cells.rows] = cells.pitch * np.diag(cells.gram_z(surface.shape))
        key = (collector.places[number], side)
        if key not in known:
            coupling = tangential.lags_nt if side else _weak(surface, tangential.lags_nt)
            begins = [sum(map(len, modes))]
            by_column = tangential.mode_tangent.reshape(2, cells.columns, cells.rows, -1).transpose(1, 0, 2, 3)
            modes.append(np.ascontiguousarray(by_column).ravel())
            for table in _tables(surface, tangential, coupling, reaches[number]):
                begins.append(sum(map(len, tables)))
                tables.append(table)
            known[key] = tuple(begins)
        for starts, value in zip((shear, tt, nt, tn), known[key], strict=True):
            starts.append(value)
    for contact, _, a, _, b in collector.pairs():
        if contact.friction.coefficient > 0.0 and isinstance(b, ContactSurface):
            crossed = sine_between(Extent.of(a), Extent.of(b), between_axes(contact))
            share = tuple(np.maximum(share, _extent(a, b, crossed)))
    m.window.share_columns, m.window.share_rows = (int(n) for n in share)
    none = [np.zeros(0)]
    collector.fill(
        m.surfaces, cell_area=area, shear_start=shear, tt_start=tt, nt_start=nt, tn_start=tn,
        mode_tangent=np.concatenate(none + modes), tangential=np.concatenate(none + tables),
    )  # fmt: skip


def _cells_beside(collector: Collector, m: Model) -> int:
    """Most cells that are loaded beside those where hats are (`bounds`): a patch of n hats in r rows and c
    columns has at most 2 (c + r) neighbours."""
    beside = 0
    for contact, _, a, _, _ in collector.pairs():
        hats = m.window.hats if contact.capacity is None else contact.capacity
        beside += 2 * (min(hats, m.window.columns) + min(hats, a.grid.rows))
    return beside


def _weak(surface: ContactSurface, lags_nt: np.ndarray) -> np.ndarray:
    """M D_nt, block-circulant: weak normal displacement [m^3] of the hats per tangential force [N]."""
    M = hat_gram(surface)
    if len(lags_nt) == 1:
        return M @ lags_nt
    return np.fft.irfft(np.fft.rfft(M, axis=0) @ np.fft.rfft(lags_nt, axis=0), n=len(lags_nt), axis=0)


def _tables(
    surface: ContactSurface, tangential: Tangential, coupling: np.ndarray, reach: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Flat tables of D_tt, of the coupling D_nt or M D_nt, and of its transpose."""
    cells = tangential.grid
    sectors, r = len(surface.lags), cells.rows
    c = surface.lags.shape[1] // r
    column = np.arange(-reach, c + reach)
    lag, part = (column // c) % sectors, column % c
    outside = (column < 0) | (column >= c) if sectors == 1 and not cells.periodic else np.zeros(len(column), bool)
    tt = tangential.lags_tt.reshape(sectors, 2, c, r, 2, c, r)[lag, :, part]  # column, d, k, d', j', k'
    nt = coupling.reshape(sectors, c, r, 2, c, r)[lag, part]  # column, k, d', j', k'
    # the transpose couples the other way round: block (s, s') is that of (s', s), turned
    tn = coupling.reshape(sectors, c, r, 2, c, r)[(-(column // c)) % sectors, :, :, :, part]  # column, j', k', d, k
    found = [
        tt.transpose(4, 3, 5, 0, 1, 2),  # j', d', k', column, d, k
        nt.transpose(3, 2, 4, 0, 1),  # j', d', k', column, k
        tn.transpose(1, 2, 0, 3, 4),  # j', k', column, d, k
    ]
    for table, axis in zip(found, (3, 3, 2), strict=True):
        if outside.any():
            table[(slice(None),) * axis + (outside,)] = 0.0
    return tuple(np.ascontiguousarray(table).ravel() for table in found)  # type: ignore[return-value]


def _extent(a: ContactSurface, b: ContactSurface, crossed: float) -> tuple[int, int]:
    """Most columns and rows of the second grid's cells under a cell of the first, `crossed` the largest sine of the
    angle between the grids."""
    z_a, z_b = np.asarray(a.grid.z), np.asarray(b.grid.z)
    pitch_a, pitch_b = np.max(a.grid.pitch * a.shape.radius_at(z_a)), np.min(b.grid.pitch * b.shape.radius_at(z_b))
    edges = [np.diff(np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])) for z in (z_a, z_b)]
    around = (pitch_a + crossed * edges[0].max()) / pitch_b
    along = (edges[0].max() + crossed * pitch_a) / edges[1].min()
    columns, rows = (int(np.ceil(x - ROUND_OFF)) + 1 for x in (around, along))
    return columns + CUBIC_SPARE, min(rows, len(z_b))
