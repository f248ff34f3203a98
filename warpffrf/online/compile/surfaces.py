"""Surfaces in contact -> device tables: geometry, grids, compliance and traces of modes.

A rigid surface has no grid; it gets one of two by two nodes that nothing reaches, with no compliance, so that kernels
need not know.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from warpffrf_kernels.core.model import Model

from warpffrf.online.compile.compliance_tables import modal_moments, response_table, weak_compliance
from warpffrf.online.compile.shared import surface_reaches

NO_NODES = 2  # columns and rows of a rigid surface's empty grid: the fewest between which can be interpolated

FIELDS = (
    "body", "modal_start", "modal_count", "origin", "frame", "planar", "side", "radius", "tangent", "crown",
    "table_start", "table_count", "rigid", "theta", "pitch", "columns", "periodic", "turn", "rows", "block", "reach",
    "z_start", "lag_start", "mode_start",
)  # fmt: skip


def is_rigid(surface: Any) -> bool:
    """True for a surface without a grid, of a rigid body or the ground."""
    return surface.grid is None


def fill_surfaces(compiler: Any, m: Model) -> None:
    """Tables of the surfaces in contact, those of one that serves several pairs once; after `fill_pairs`, which knows
    how far the compliance is asked for."""
    lists: dict[str, list] = {name: [] for name in FIELDS}
    breaks, coefficients, z = [], [], []
    D, MDM, modes, moments = [], [], [], []
    yieldings = [value for contact in compiler.scene.contacts for value in (contact.law.yielding, 0.0)]  # on the first
    modal_start = np.cumsum([0, *compiler.mode_counts])
    known: dict[tuple, dict[str, int]] = {}  # where the tables of a surface begin, with and without a layer
    owned = zip(compiler.surfaces, compiler.places, yieldings, surface_reaches(compiler, m), strict=True)
    for (body, surface), place, yielding, reach in owned:
        shape, profile = surface.shape, surface.shape.profile()
        on_ground = body.index < 0
        origin = np.asarray(shape.axis_point) - (0.0 if on_ground else body.center_of_mass)
        values: dict[str, Any] = {
            "body": body.index, "origin": origin,
            "modal_start": 0 if on_ground else modal_start[body.index],
            "modal_count": 0 if on_ground else compiler.mode_counts[body.index],
            "planar": int(profile.planar), "side": profile.side, "radius": profile.radius,
            "tangent": profile.tangent, "crown": profile.crown,
            "table_start": sum(map(len, breaks)), "table_count": len(profile.coefficients),
            "rigid": int(is_rigid(surface)), "reach": reach,
        }  # fmt: skip
        begins = {"z_start": sum(map(len, z)), "lag_start": sum(map(len, D)), "mode_start": sum(map(len, modes))}
        if len(profile.coefficients):
            breaks.append(np.asarray(profile.breaks, float))
            coefficients.append(np.concatenate([profile.coefficients, np.zeros((1, 4))]))
        if is_rigid(surface):
            values |= {
                "frame": np.asarray(shape.frame).T, "theta": 0.0, "pitch": 1.0, "columns": NO_NODES, "periodic": 0,
                "turn": 0, "rows": NO_NODES, "block": NO_NODES,
            }  # fmt: skip
            values |= begins
            z.append(np.arange(float(NO_NODES)))
            empty = np.zeros(NO_NODES**3 * (NO_NODES + 2 * reach))
            D.append(empty)
            MDM.append(empty)
            modes.append(np.zeros(NO_NODES**2 * values["modal_count"]))
            moments.append(modes[-1])
        else:
            grid = surface.grid
            e_a = np.asarray(shape.e_a)
            sectors, block = len(surface.lags), surface.lags.shape[1] // grid.rows
            values |= {
                "frame": np.stack([grid.e_0, np.cross(e_a, grid.e_0), e_a], axis=1),
                "theta": grid.theta_start, "pitch": grid.pitch, "columns": grid.columns,
                "periodic": int(grid.periodic), "turn": sectors * block if sectors > 1 or grid.periodic else 0,
                "rows": grid.rows, "block": block,
            }  # fmt: skip
            values |= known.setdefault((place, yielding), begins)
            if known[place, yielding] is begins:
                z.append(np.asarray(grid.z))
                D.append(response_table(surface, surface.lags, reach).ravel())
                MDM.append(response_table(surface, weak_compliance(surface, yielding), reach).ravel())
                modes.append(np.ascontiguousarray(surface.mode_normal).ravel())
                moments.append(modal_moments(surface).ravel())
        for name, value in values.items():
            lists[name].append(value)
    none = [np.zeros(0)]
    compiler.fill(
        m.surfaces, **lists, table_break=np.concatenate(none + breaks),
        table_coefficient=np.concatenate([np.zeros((0, 4)), *coefficients]), z=np.concatenate(none + z),
        compliance=np.concatenate(none + D), self_compliance=np.concatenate(none + MDM),
        mode_normal=np.concatenate(none + modes), mode_moment=np.concatenate(none + moments),
    )  # fmt: skip
