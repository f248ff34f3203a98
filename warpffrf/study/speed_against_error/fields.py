r"""Pressures of two runs, whatever grids they stand on, as `warpffrf.model.half_space.box_means` compares them.

Areas are those of the first surface, A_B = R sqrt(1 + R'^2) dtheta dz. Angles on a surface of revolution are counted
from the line of centres: which of the material is in contact is said by the motion, and measured by it. On a plane they
are the chart's own.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.half_space.box_means import Boxes
from warpffrf.model.half_space.box_means import squares as of_boxes
from warpffrf.output.contact.pair_result import PairResult


def field_of(pair: PairResult, i: int) -> Boxes:
    """The pressures of `pair` at its saved step `i`."""
    x, z = pair.cell_lines(i)
    if pair.view.first.shape.kind == "plane":
        x = x + float(pair.theta[i][0] - pair.arc[i][0])
    arrays = (np.asarray(values, dtype=float) for values in (x, z, pair.mean_pressure[i]))
    return Boxes(*arrays)


def squares(field: Boxes, reference: Boxes, shape: object) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2]."""
    measure_at, radius_at = shape.measure_at, shape.radius_at  # type: ignore[attr-defined]
    middle = 0.5 * (min(field.z[0], reference.z[0]) + max(field.z[-1], reference.z[-1]))
    return of_boxes(field, reference, lambda z: measure_at(z) / radius_at(middle))
