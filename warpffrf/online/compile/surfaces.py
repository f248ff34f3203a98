"""Surfaces in contact -> device tables: geometry, grids, compliance and traces of modes.

A rigid surface has no grid; it gets one of two by two nodes that nothing reaches, with no compliance, so that kernels
need not know.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from warpffrf_kernels.core.model import Model

from warpffrf.model.bodies import Ground
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import modal_moments, response_table, weak_compliance

NO_NODES = 2  # columns and rows of a rigid surface's empty grid: the fewest between which can be interpolated

FIELDS = (
    "body", "modal_start", "modal_count", "origin", "frame", "planar", "side", "radius", "tangent", "crown",
    "table_start", "table_count", "rigid", "theta", "pitch", "columns", "periodic", "turn", "rows", "block", "reach",
    "z_start", "lag_start", "mode_start",
)  # fmt: skip


def fill_surfaces(collector: Collector, m: Model, reaches: Sequence[int]) -> np.ndarray:
    """Tables of the surfaces in contact, those of one that serves several pairs once; `reaches`: how far the compliance
    of each is asked for (`surface_reaches`). Returns where the rows of each begin in `z`."""
    lists: dict[str, list] = {name: [] for name in FIELDS}
    breaks, coefficients, z = [], [], []
    D, MDM, modes, moments = [], [], [], []
    layers = [value for contact in collector.scene.contacts for value in (contact.law.compliance, 0.0)]  # on the first
    modal_start = np.cumsum([0, *collector.mode_counts])
    known: dict[tuple, dict[str, int]] = {}  # where the tables of a surface begin, with and without a layer
    owned = zip(collector.surfaces, collector.places, layers, reaches, strict=True)
    for (body, surface), place, compliance, reach in owned:
        shape, profile = surface.shape, surface.shape.profile()
        on_ground = isinstance(body, Ground)
        origin = np.asarray(shape.axis_point) - (0.0 if on_ground else body.center_of_mass)
        modal_count = 0 if on_ground else collector.mode_counts[body.index]
        values: dict[str, object] = {
            "body": body.index, "origin": origin,
            "modal_start": 0 if on_ground else modal_start[body.index],
            "modal_count": modal_count,
            "planar": int(profile.planar), "side": profile.side, "radius": profile.radius,
            "tangent": profile.tangent, "crown": profile.crown,
            "table_start": sum(map(len, breaks)), "table_count": len(profile.coefficients),
            "rigid": int(isinstance(surface, RigidSurface)), "reach": reach,
        }  # fmt: skip
        begins = {"z_start": sum(map(len, z)), "lag_start": sum(map(len, D)), "mode_start": sum(map(len, modes))}
        if len(profile.coefficients):
            breaks.append(np.asarray(profile.breaks, float))
            coefficients.append(np.concatenate([profile.coefficients, np.zeros((1, 4))]))
        if isinstance(surface, RigidSurface):
            values |= {
                "frame": np.asarray(shape.frame).T, "theta": 0.0, "pitch": 1.0, "columns": NO_NODES, "periodic": 0,
                "turn": 0, "rows": NO_NODES, "block": NO_NODES,
            }  # fmt: skip
            values |= begins
            z.append(np.arange(float(NO_NODES)))
            empty = np.zeros(NO_NODES**3 * (NO_NODES + 2 * reach))
            D.append(empty)
            MDM.append(empty)
            modes.append(np.zeros(NO_NODES**2 * modal_count))
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
            values |= known.setdefault((place, compliance), begins)
            if known[place, compliance] is begins:
                z.append(np.asarray(grid.z))
                D.append(response_table(surface, surface.lags, reach).ravel())
                MDM.append(response_table(surface, weak_compliance(surface, compliance), reach).ravel())
                modes.append(np.ascontiguousarray(surface.mode_normal).ravel())
                moments.append(modal_moments(surface).ravel())
        for name, value in values.items():
            lists[name].append(value)
    none = [np.zeros(0)]
    collector.fill(
        m.surfaces, **lists, table_break=np.concatenate(none + breaks),
        table_coefficient=np.concatenate([np.zeros((0, 4)), *coefficients]), z=np.concatenate(none + z),
        compliance=np.concatenate(none + D), self_compliance=np.concatenate(none + MDM),
        mode_normal=np.concatenate(none + modes), mode_moment=np.concatenate(none + moments),
    )  # fmt: skip
    return np.asarray(lists["z_start"], dtype=int)
