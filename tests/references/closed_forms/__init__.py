"""Closed-form contact solutions to compare simulations with: Hertz, Cattaneo-Mindlin, Carter, impact, conformal
pin, joints with small sliding, large deflections.

None of these files imports the engine, the kernels or the reduction.
"""

from __future__ import annotations

from references.closed_forms.carter import CarterRolling
from references.closed_forms.conformal import ConformalPin, conformal_by_half_angle, conformal_by_load, persson
from references.closed_forms.hertz import LineContact, PointContact, contact_modulus, cylinder_approach
from references.closed_forms.impact import BarImpact, HertzImpact
from references.closed_forms.joints import BarOnBase, BoltedJoint, PressFit, TwoLeaves, equivalent_damping
from references.closed_forms.large_deflections import (
    CLAMPED_SQUARE,
    LEVY_CLAMPED_SQUARE,
    Elastica,
    bar_force,
    clamped_plate_frequency,
    pinned_beam_frequency,
)
from references.closed_forms.leaf_spring import LeafSpring
from references.closed_forms.mindlin import MindlinLine, MindlinPoint, tangential_compliance
from references.closed_forms.sliding import SlidingLine, coupling_ratio
from references.closed_forms.turned_fit import TurnedFit

__all__ = [
    "CLAMPED_SQUARE",
    "LEVY_CLAMPED_SQUARE",
    "BarImpact",
    "BarOnBase",
    "BoltedJoint",
    "CarterRolling",
    "ConformalPin",
    "Elastica",
    "HertzImpact",
    "LeafSpring",
    "LineContact",
    "MindlinLine",
    "MindlinPoint",
    "PointContact",
    "PressFit",
    "SlidingLine",
    "TurnedFit",
    "TwoLeaves",
    "bar_force",
    "clamped_plate_frequency",
    "conformal_by_half_angle",
    "conformal_by_load",
    "contact_modulus",
    "coupling_ratio",
    "cylinder_approach",
    "equivalent_damping",
    "persson",
    "pinned_beam_frequency",
    "tangential_compliance",
]
