"""Surfaces in contact -> device tables: geometry, grids and traces of modes.

A rigid surface has no grid; it gets an unused one of two by two nodes, so that kernels need no special case.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import Ground
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.height import Height
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import columns_of_turn, modal_moments
from warpffrf.online.compile.patches.sides import PatchSide
from warpffrf_kernels.core.model import Model

NO_NODES = 2  # columns and rows of a rigid surface's empty grid: the fewest that allow interpolation

FIELDS = (
    "body", "modal_start", "modal_count", "origin", "frame", "planar", "side", "radius", "tangent", "crown",
    "table_start", "table_count", "curve_start", "curve_count", "curve_length", "seed_start", "seed_columns",
    "seed_rows", "seed_corner", "seed_pitch", "rigid", "theta", "pitch", "columns", "periodic", "turn", "rows",
    "z_start", "mode_start",
)  # fmt: skip


def fill_surfaces(collector: Collector, m: Model) -> np.ndarray:
    """Geometry, grids and traces of modes of the surfaces in contact. Returns the first row of each in `z`."""
    lists: dict[str, list] = {name: [] for name in FIELDS}
    breaks, coefficients, z = [], [], []
    curves = Curves()
    modes, moments = [], []
    modal_start = np.cumsum([0, *collector.mode_counts])
    for body, _, surface in collector.surfaces:
        shape, profile = surface.shape, surface.shape.profile()
        cells = isinstance(surface, PatchSide)
        on_ground = isinstance(body, Ground)
        origin = np.asarray(shape.axis_point) - (0.0 if on_ground else body.center_of_mass)
        modal_count = 0 if on_ground else collector.mode_counts[body.index]
        values: dict[str, object] = {
            "body": body.index, "origin": origin,
            "modal_start": 0 if on_ground else modal_start[body.index],
            "modal_count": modal_count,
            "planar": int(profile.planar) + int(profile.free) + int(profile.height is not None), "side": profile.side,
            "radius": profile.radius,
            "tangent": profile.tangent + profile.twist, "crown": profile.crown,
            "table_start": sum(map(len, breaks)), "table_count": len(profile.coefficients),
            "rigid": int(not isinstance(surface, ContactSurface)),
            "z_start": sum(map(len, z)), "mode_start": sum(map(len, modes)),
        }  # fmt: skip
        values |= curves.add(profile.curve, profile.height)
        if len(profile.coefficients):
            breaks.append(np.asarray(profile.breaks, float))
            coefficients.append(np.concatenate([profile.coefficients, np.zeros((1, 4))]))
        if cells:
            values |= {
                "frame": _frame(surface.real), "theta": 0.0, "pitch": 1.0, "columns": 0, "periodic": 1, "turn": 0,
                "rows": max(surface.rows, NO_NODES),
            }  # fmt: skip
            z.append(np.arange(float(max(surface.rows, NO_NODES))))
        elif isinstance(surface, RigidSurface):
            values |= {
                "frame": _frame(surface), "theta": 0.0, "pitch": 1.0, "columns": NO_NODES, "periodic": 0,
                "turn": 0, "rows": NO_NODES,
            }  # fmt: skip
            z.append(np.arange(float(NO_NODES)))
            modes.append(np.zeros(NO_NODES**2 * modal_count))
            moments.append(modes[-1])
        else:
            grid = surface.grid
            values |= {
                "frame": _frame(surface),
                "theta": grid.theta_start, "pitch": grid.pitch, "columns": grid.columns,
                "periodic": int(grid.periodic), "turn": columns_of_turn(surface), "rows": grid.rows,
            }  # fmt: skip
            z.append(np.asarray(grid.z))
            modes.append(np.ascontiguousarray(surface.mode_normal).ravel())
            moments.append(modal_moments(surface).ravel())
        for name, value in values.items():
            lists[name].append(value)
    none = [np.zeros(0)]
    collector.fill(
        m.surfaces, **lists, table_break=np.concatenate(none + breaks),
        table_coefficient=np.concatenate([np.zeros((0, 4)), *coefficients]), z=np.concatenate(none + z),
        mode_normal=np.concatenate(none + modes), mode_moment=np.concatenate(none + moments),
        curve_knot=np.concatenate(none + curves.knots),
        curve_piece=np.concatenate([np.zeros((0, 8)), *curves.pieces]),
        curve_seed=np.concatenate([np.zeros(0, dtype=np.int32), *curves.seeds]),
    )  # fmt: skip
    return np.asarray(lists["z_start"], dtype=int)


class Curves:
    """The curves of extruded surfaces, each once as a flank meets several teeth, and the pieces of heights."""

    def __init__(self) -> None:
        self.found: dict[int, dict[str, object]] = {}  # by identity of the curve, which its surface keeps
        self.knots: list[np.ndarray] = []
        self.pieces: list[np.ndarray] = []
        self.seeds: list[np.ndarray] = []

    def add(self, curve: Curve | None, height: Height | None = None) -> dict[str, object]:
        """The fields of a surface with this curve or height, None without one."""
        start, seed_start = sum(map(len, self.knots)), sum(map(len, self.seeds))
        found: dict[str, object] = {
            "curve_start": start, "curve_count": 0, "curve_length": 0.0, "seed_start": seed_start,
            "seed_columns": 0, "seed_rows": 0, "seed_corner": np.zeros(2), "seed_pitch": 1.0,
        }  # fmt: skip
        if height is not None:
            self.pieces.append(height.pieces.reshape(-1, 8))
            self.knots.append(np.zeros(len(self.pieces[-1])))
            columns, rows = height.counts
            return found | {"seed_columns": columns, "seed_rows": rows, "seed_corner": -height.half}
        if curve is None:
            return found
        if id(curve) in self.found:
            return self.found[id(curve)]
        corner, pitch, seeds = curve.seeds
        pieces = curve.coefficients.reshape(-1, 8)
        self.knots.append(curve.knots)
        self.pieces.append(np.concatenate([pieces, np.zeros((1, 8))]))
        self.seeds.append(seeds.astype(np.int32).ravel())
        self.found[id(curve)] = found | {
            "curve_count": len(pieces), "curve_length": curve.length if curve.closed else 0.0,
            "seed_columns": seeds.shape[0], "seed_rows": seeds.shape[1], "seed_corner": corner, "seed_pitch": pitch,
        }  # fmt: skip
        return self.found[id(curve)]


def _frame(surface: ContactSurface | RigidSurface) -> np.ndarray:
    """Columns e_0, e_1, e_a, of the grid's frame."""
    if isinstance(surface, RigidSurface):
        return np.asarray(surface.shape.frame).T
    e_a, e_0 = np.asarray(surface.shape.e_a), surface.grid.e_0
    return np.stack([e_0, np.cross(e_a, e_0), e_a], axis=1)
