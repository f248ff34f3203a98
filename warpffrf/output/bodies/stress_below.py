r"""Stress below the centre of a patch, from the pressure of a run, with both bodies as half-spaces.

The pressure of the saved step, at nodes or on cells, is developed onto a plane along the arc and the meridian from its
centre, which for a line is that of its section at mid-width. Its stress on the normal through the centre is in closed
form (`half_space_stress`), the same on both bodies except for Poisson's ratio. Neither the mesh nor stress points of
the body are used; effects outside of the half-space model are neglected: the curvature of the body, walls behind the
surface, and friction tractions. A line that ends with the surface has images behind both ends, which cancel the shear
on the end planes as in `patch_stress`; the effect of the remaining normal stress there is 1 % at mid-width of 20 mm at
R = 50 mm.

Nodal values are used as computed, which preserves the second moment. They oscillate from node to node about their
weighted means (`contact.result`); at the depth z below nodes h apart this has decayed to exp(-pi z/h).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.stress_field import max_shear, von_mises
from warpffrf.output.bodies.half_space_stress import under_cells, under_nodes
from warpffrf.output.bodies.stress import ENDS, SHEARED, meridian_arc

DEEP, PLACES = 3.0, 181  # depth in the smaller half-width of the patch, and number of depths


@dataclass(frozen=True, eq=False, repr=False)
class StressBelow(reprs.Rows):
    """Stress below the centre of a patch at `depth` (n,) [m]; `tensor` (n, 6) [Pa] in the order xx, yy, zz, xy, yz, zx:
    x along the arc, y along the meridian, z into the depth, tension positive; of a material of `poisson_ratio`, that of
    the `bodies`."""

    depth: np.ndarray
    tensor: np.ndarray
    poisson_ratio: float
    bodies: tuple[str, ...]

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress (n,) [Pa]."""
        return von_mises(self.tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress (n,) [Pa], half the difference of the outer principal stresses."""
        return max_shear(self.tensor)


def poisson_ratios(view: Any) -> dict[float, list[str]]:
    """Poisson's ratio -> flexible bodies of the contact that have it. Raises `InputError` for a body without material
    data."""
    found: dict[float, list[str]] = {}
    for body, surface in ((view.first_body, view.first), (view.second_body, view.second)):
        if body.reduced is None:
            continue
        material = body.reduced.provenance.get("contact_materials", {}).get(surface.name)
        if not material:
            raise InputError(
                f"contact '{view.name}': body '{body.name}' has no material data, so the stress below is not "
                "known; reduce the body again"
            )
        found.setdefault(float(material["poisson_ratio"]), []).append(body.name)
    return found


def stress_below(contact: Any, i: int, depth: Any = None) -> list[StressBelow]:
    """Stress below the centre of the patch of `contact` in saved step `i`, for each of its Poisson's ratios.

    depth: (n,) [m], not negative; None: down to `DEEP` half-widths. Raises InputError without contact, for invalid
    depths, and for bodies without material data.
    """
    if not contact.touching[i]:
        raise InputError(
            f"contact '{contact.name}': nothing touches in saved step {i}; choose one of those where `touching` is true"
        )
    if depth is None:
        size = contact.semi_axes[i, 1] if contact.patch_kind in ("point", "flat") else contact.half_width[i]
        depth = float(size) * np.linspace(0.0, DEEP, PLACES)
    depth = np.atleast_1d(np.asarray(depth, dtype=float))
    if depth.ndim != 1 or not np.all(np.isfinite(depth)) or np.any(depth < 0.0):
        raise InputError(f"contact '{contact.name}': depth must be numbers (n,) [m], not negative, got {depth}")
    points = np.stack([0.0 * depth, 0.0 * depth, depth], axis=1)
    made = _load(contact, i)
    return [
        StressBelow(depth, made(points, nu), nu, tuple(names)) for nu, names in poisson_ratios(contact.view).items()
    ]


def _load(contact: Any, i: int) -> Any:
    """The stress (n, 6) of the pressure of saved step `i` at points (n, 3) from its centre, for a Poisson's ratio."""
    shape, cells = contact.view.first.shape, contact.history.cells is not None
    lines = contact.cell_lines(i)
    middle = float(contact.center_of_pressure[i, 1]) if contact.patch_kind == "point" else 0.5 * sum(contact.ends)
    arc, z = lines if cells else (contact.arc[i], contact.rows[i])
    x, y = arc - float(contact.center[i]), meridian_arc(shape, middle, np.asarray(z))
    pressure = contact.history.pressure[i]
    under = under_cells if cells else under_nodes
    mirrors = 2.0 * meridian_arc(shape, middle, np.array(contact.ends)) if contact.patch_kind == "line" else np.zeros(0)

    def stress(points: np.ndarray, nu: float) -> np.ndarray:
        found = under(points, x, y, pressure, nu)
        for twice in mirrors:
            found = found + SHEARED * under(points * ENDS + np.array([0.0, twice, 0.0]), x, y, pressure, nu)
        return found

    return stress
