r"""Bolts of stacked sheets, and what they make in the engine while sheets turn, which linear finite elements have not.

A bolt pulls two heads together that are h apart along z. Linear finite elements have them move by d_z against each
other along z, and the force F does the work -F d_z. In the engine heads move in the frame of their body, linearly, and
the frame turns with the body, by phi about y (its mean axes: int rho r x u = 0, so that phi = p.u with p of the mass
matrix). With d_x, how far heads move against each other along x, d_x - h phi of it is left in the frame.

*Pairs of forces* keep their direction in space. Along it heads are

    (h + d_z) cos phi - (d_x - h phi) sin phi = h + d_z + h phi^2/2 - phi d_x + ...

apart; F times that is the potential, whose quadratic part is

    V = F (h phi^2/2 - phi d_x) = F/(2 h) (d_x - h phi)^2 - F/(2 h) d_x^2.

*Springs* between the heads pull along the line that joins them, of length

    sqrt((h + d_z)^2 + (d_x - h phi)^2) = h + d_z + (d_x - h phi)^2/(2 h) + ...,      V = F/(2 h) (d_x - h phi)^2.

These are stiffnesses of rank one: F/h along d_x - h p, and -F/h along d_x. Where sheets turn as one, by theta with
d_x = h theta, a bolt that turns along should do no work. Pairs of forces make -F h theta^2/2 of it, a couple F h theta
that bends on, and both kinds F h (theta - phi)^2/2, as displacements within the frame are straight lines. With bolts at
1/4 and 3/4 of the length L of a cantilever under a force P at its tip, theta is 0.219 and 0.469, and phi 0.350, times
P L^2/(EI): the amplitude changes by +0.71 F h L/(EI) of pairs, and by -0.094 F h L/(EI) of springs.

A joint that lets heads part along an axis only, with a `JointSpringDamper`, would hold them across and against each
other's turning as well, as fitted bolts do; sheets are to slide here.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from references.small_sliding.full_model import FullModel
from warpffrf.model.bodies import Port
from warpffrf.model.forces import SpringDamper
from warpffrf.model.mesh.facets import rigid_modes

Array = np.ndarray
Springs = list[tuple[Array, float]]
UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
ABOUT_Y = 4  # of the six rigid motions


def apart(model: FullModel, low: str, high: str, axis: Any) -> Array:
    """a (dofs,): a.u is how far the facet set `high` of the first body moves from `low` along `axis`."""
    return model.spread(0, high, axis) - model.spread(0, low, axis)


def mean_turn(model: FullModel) -> Array:
    """p (dofs,): p.u [rad] is the turn about y of the mean axes."""
    R = rigid_modes(model.points, model.points.mean(axis=0))
    MR = model.M @ R
    return np.linalg.solve(R.T @ MR, MR.T)[ABOUT_Y]


def turning(model: FullModel, heads: list[tuple[str, str]], height: float, tension: Array, *, line: bool) -> Springs:
    """The springs of V (module docstring) for bolts between `heads`, `height` h [m] apart, under `tension` (bolts,)
    [N]; line: the bolts are springs along the line between heads, else pairs of forces."""
    p = mean_turn(model)
    found = []
    for (low, high), F in zip(heads, tension, strict=True):
        d = apart(model, low, high, ALONG)
        found.append((d - height * p, F / height))
        if not line:
            found.append((d, -F / height))
    return found


def shank(low: Port, high: Port, stiffness: float, tension: float, *, name: str) -> SpringDamper:
    """A spring between heads that pulls with `tension` [N] as long as nothing has given way."""
    length = float(np.linalg.norm(high.world_point() - low.world_point()))
    return SpringDamper(low, high, stiffness, free_length=length - tension / stiffness, name=name)
