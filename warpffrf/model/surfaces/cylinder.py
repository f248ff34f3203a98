"""Outside of a circular cylinder: R(z) = R_0."""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.revolution import RevolutionShape


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder(RevolutionShape):
    """Outside of a circular cylinder; what is None is fitted to the nodes of the facet set.

    radius [m], axis_point (3,) [m], axis_direction (3,), user frame of the body; fit_tolerance [m] is the largest
    distance of a node that is accepted, 1e-5 of the radius where None.

    >>> wf.surfaces.Cylinder().missing  # of a mesh: fitted to the nodes of its facet set
    ('radius', 'axis_point', 'axis_direction')
    >>> tread = wf.surfaces.Cylinder(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))  # of a rigid body
    """

    kind = "cylinder"
