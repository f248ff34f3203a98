"""Points at which a pair is evaluated: all Gauss points of its first grid, or those that were chosen offline.

Points chosen among the axial Gauss points of the line of centres, where a pair of cylinders is evaluated anyway, keep
this kinematics with fewer circumferential points (`warpffrf_kernels.kinematics.line_of_centres_points`). Other choices
use the general one, `warpffrf_kernels.kinematics.at_points`.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.model.reduced.contact_surface import Sampling
from warpffrf.online.compile.points import PointRule, gauss_rule

ON_STATION = 1e-9  # of the distance of two rows: round-off of the Gauss points in a file is 1e-16


def is_hyper(contact: Contact) -> bool:
    """Whether `contact` is evaluated at chosen points only."""
    return contact.quadrature == "reduced"


def on_stations(contact: Contact, z_points: int) -> bool:
    """False where the chosen points of `contact` are not on the stations of the line of centres."""
    if not is_hyper(contact):
        return True
    zeta = contact.a.surface.sampling.zeta
    places = 0.5 * (np.polynomial.legendre.leggauss(z_points)[0] + 1.0)
    return bool(np.abs(zeta[:, None] - places).min(axis=1).max() <= ON_STATION)


def rule_of(contact: Contact, theta_points: int, z_points: int) -> PointRule:
    """The points at which gaps and layer of `contact` are evaluated, with either kinematics."""
    if is_hyper(contact):
        return chosen_rule(contact.a.surface.sampling)
    return gauss_rule(contact.a.surface, theta_points, z_points)


def chosen_rule(points: Sampling) -> PointRule:
    """The points of `points`, sorted by row."""
    order = np.argsort(points.row, kind="stable")
    return PointRule(points.fraction[order], points.row[order], points.zeta[order], points.weight[order])
