"""Contact pairs and their surfaces -> device tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp
from warpffrf_kernels import control as k
from warpffrf_kernels.contact_geometry import GUARD

from warpffrf.model.errors import InputError
from warpffrf.online.compile_inertia import dense_columns
from warpffrf.online.compliance_tables import modal_moments, response_table, weak_compliance

MIN_HALF_WINDOW = 6  # columns: margin and guard columns of a patch of a few columns
MAX_HALF_WINDOW = 60  # columns: 121 in all; a patch that needs more has a contact grid finer than any use
STENCIL_SPARE = 2  # a hat's support of length x touches at most ceil(x) + 1 cells, ceil(x) + 2 columns
ROUND_OFF = 1e-9  # cells: a ratio of two grids that is a whole number up to this is one
REACH_SPARE = 1.02  # arc length over its projection at the edge of the widest window


def fill_pairs(compiler: Any, m: Any) -> None:
    """Quadrature, windows and stencils of the pairs, and the outer columns that their gaps depend on."""
    _fill_quadrature(compiler, m)
    m.pair_first = compiler.array(np.arange(0, 2 * m.pair_count, 2), int)
    m.pair_second = compiler.array(np.arange(1, 2 * m.pair_count, 2), int)
    half = rows = second_half = second_rows = pair_modes = slots = 1
    stencil = (1, 1)
    coupled: list[list[int]] = []
    for i, contact in enumerate(compiler.scene.contacts):
        (body_a, a), (body_b, b) = compiler.surfaces[2 * i], compiler.surfaces[2 * i + 1]
        wanted = _half_window(compiler, contact, a, b)
        half, rows = max(half, wanted), max(rows, a.grid.rows)
        second_rows = max(second_rows, b.grid.rows)
        ratio = a.grid.pitch * a.shape.radius / (b.grid.pitch * b.shape.radius)
        columns = int(np.ceil(2.0 * ratio * REACH_SPARE - ROUND_OFF)) + STENCIL_SPARE
        stencil = (max(stencil[0], columns), max(stencil[1], _row_reach(a.grid.z, b.grid.z)))
        pair_modes = max(pair_modes, compiler.mode_counts[body_a.index] + compiler.mode_counts[body_b.index])
        hats = (2 * wanted + 1) * a.grid.rows
        slots += hats if contact.capacity is None else min(contact.capacity, hats)
        coupled.append(_coupled_columns(compiler, m, body_a, body_b))
    surfaces = [surface for _, surface in compiler.surfaces]
    for i in range(m.pair_count):  # all pairs share the widest window, so each needs what lies opposite that
        second_half = max(second_half, _reach_on_second(surfaces[2 * i], surfaces[2 * i + 1], half))
    m.half_window, m.window_columns, m.max_rows = half, 2 * half + 1, rows
    m.mode_capacity = m.window_columns * rows
    m.stencil_columns, m.stencil_rows = stencil
    m.second_half_window, m.second_columns = second_half, 2 * second_half + 1
    m.node_capacity = m.second_columns * second_rows
    m.reach = m.window_columns + m.second_columns + m.stencil_columns
    m.pair_modes = pair_modes
    m.slot_capacity = slots
    m.coupled_capacity = max([len(c) for c in coupled], default=1)
    if m.coupled_capacity > k.MOST_COUPLED_COLUMNS:
        raise InputError(
            f"scene: the gap of a contact pair depends on {m.coupled_capacity} outer columns, at most "
            f"{k.MOST_COUPLED_COLUMNS}: fewer modes with inertia terms, see the inertia levels of its bodies"
        )
    if stencil[0] * stencil[1] > k.MOST_STENCIL:
        raise InputError(
            f"scene: a hat of a contact's first grid covers {stencil[0]} x {stencil[1]} nodes of the second, at "
            f"most {k.MOST_STENCIL}: swap the two surfaces, or give the second a coarser traction_spacing"
        )
    m.coupled_count = compiler.array([len(c) for c in coupled], int)
    m.coupled = compiler.array(
        [c + [0] * (m.coupled_capacity - len(c)) for c in coupled], int, (-1, m.coupled_capacity)
    )


def fill_surfaces(compiler: Any, m: Any) -> None:
    """Geometry, grids, compliance and modes of the surfaces in contact; after `fill_pairs`, which knows how far."""
    lists: dict[str, list] = {name: [] for name in (
        "body", "origin", "frame", "radius", "crown", "theta", "pitch", "columns", "periodic",
        "turn", "rows", "block",
        "z_start", "lag_start", "mode_start",
    )}  # fmt: skip
    z, D, MDM, modes, moments = [], [], [], [], []
    yieldings = [value for contact in compiler.scene.contacts for value in (contact.law.yielding, 0.0)]  # on the first
    for (body, surface), yielding in zip(compiler.surfaces, yieldings, strict=True):
        grid, shape = surface.grid, surface.shape
        e_a = np.asarray(shape.e_a)
        frame = np.stack([grid.e_0, np.cross(e_a, grid.e_0), e_a], axis=1)
        sectors, side = len(surface.lags), surface.lags.shape[1]
        block = side // grid.rows
        turn = sectors * block if sectors > 1 or grid.periodic else 0
        values = (
            body.index, shape.axis_point - body.center_of_mass, frame, shape.radius,
            1.0 / shape.curvature if shape.curvature else 0.0,
            grid.theta_start, grid.pitch, grid.columns, int(grid.periodic), turn, grid.rows, block,
            sum(map(len, z)), sum(map(len, D)), sum(map(len, modes)),
        )  # fmt: skip
        for name, value in zip(lists, values, strict=True):
            lists[name].append(value)
        z.append(np.asarray(grid.z))
        D.append(response_table(surface, surface.lags, m.reach).ravel())
        MDM.append(response_table(surface, weak_compliance(surface, yielding), m.reach).ravel())
        modes.append(np.ascontiguousarray(surface.mode_normal).ravel())
        moments.append(modal_moments(surface).ravel())
    for name, values in lists.items():
        if name == "origin":
            m.surface_origin = compiler.array(values, wp.vec3d, (-1, 3))
        elif name == "frame":
            m.surface_frame = compiler.array(values, wp.mat33d, (-1, 3, 3))
        else:
            dtype = wp.float64 if name in ("radius", "crown", "theta", "pitch") else int
            setattr(m, f"surface_{name}", compiler.array(values, dtype))
    empty = [np.zeros(0)]
    m.surface_z = compiler.array(np.concatenate(empty + z))
    m.compliance = compiler.array(np.concatenate(empty + D))
    m.self_compliance = compiler.array(np.concatenate(empty + MDM))
    m.mode_normal = compiler.array(np.concatenate(empty + modes))
    m.mode_moment = compiler.array(np.concatenate(empty + moments))


def _fill_quadrature(compiler: Any, m: Any) -> None:
    settings = compiler.settings
    for name, count in (("theta", settings.theta_points), ("z", settings.z_points)):
        x, weight = np.polynomial.legendre.leggauss(count)
        setattr(m, f"{name}_points", count)
        setattr(m, f"{name}_abscissa", compiler.array(0.5 * (x + 1.0)))
        setattr(m, f"{name}_weight", compiler.array(0.5 * weight))


def _coupled_columns(compiler: Any, m: Any, body_a: Any, body_b: Any) -> list[int]:
    """Outer columns that the gap of a pair depends on: of its bodies, their modes with inertia terms, and the rows that
    end on one of their flexible interfaces."""
    own = (body_a.index, body_b.index)
    rigid = [6 * index + c for index in own for c in range(6)]
    markers = [body in own and interface >= 0 for body, interface, *_ in compiler.markers]
    ends = zip(compiler.rows.a, compiler.rows.b, strict=True)
    touching = [m.row_offset + r for r, (a, b) in enumerate(ends) if markers[a] or markers[b]]
    return rigid + dense_columns(m, compiler, (body_a, body_b)) + touching


def _half_window(compiler: Any, contact: Any, a: Any, b: Any) -> int:
    spacing = a.grid.pitch * a.shape.radius
    effective = 1.0 / (1.0 / a.shape.radius + 1.0 / b.shape.radius)
    if contact.capacity is not None:
        return max(int(np.ceil(contact.capacity / a.grid.rows / 2.0)) + int(GUARD), 2 * int(GUARD) + 1)
    wanted = int(np.ceil(compiler.settings.window_strain * effective / spacing)) + int(GUARD) + 1
    if wanted > MAX_HALF_WINDOW:
        compiler.notes.append(
            f"contact {contact.name!r}: window capped at {2 * MAX_HALF_WINDOW + 1} columns of {2 * wanted + 1}; "
            "a coarser contact grid (traction_spacing) would do, or give capacity="
        )
    quarter = int(0.5 * np.pi / a.grid.pitch) - 2  # no surface is opposite beyond a quarter turn
    return int(min(np.clip(wanted, MIN_HALF_WINDOW, MAX_HALF_WINDOW), max(quarter, int(GUARD) + 1)))


def _reach_on_second(a: Any, b: Any, half_window: int) -> int:
    """Columns of the second grid on each side that face the window: opposite xi lies asin(R_A sin(xi)/R_B)."""
    xi = min((half_window + 1.5) * a.grid.pitch, 0.5 * np.pi)
    angle = np.arcsin(min(a.shape.radius * np.sin(xi) / b.shape.radius, 1.0))
    return int(np.ceil(angle / b.grid.pitch + 0.5)) + STENCIL_SPARE


def _row_reach(z_a: np.ndarray, z_b: np.ndarray) -> int:
    """Most rows of the second grid under a hat of the first, at any axial offset."""
    widest = max(z_a[min(i + 1, len(z_a) - 1)] - z_a[max(i - 1, 0)] for i in range(len(z_a)))
    return min(len(z_b), int(np.ceil(widest / np.min(np.diff(z_b)) - ROUND_OFF)) + STENCIL_SPARE)
