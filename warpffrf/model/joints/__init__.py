"""Joints between two ports, and prescribed motion of their coordinates.

With x_a, A_a and x_b, A_b the world positions and axes of a joint's markers on its two sides, d = A_a^T (x_b - x_a) and
A = A_a^T A_b, the kinds of joints require

    Fixed          d = 0,            A = 1                    no coordinate
    Revolute       d = 0,            A e_z = e_z              rotation [rad]
    Cylindrical    d_x = d_y = 0,    A e_z = e_z              translation [m], rotation [rad]
    Planar         d_z = 0,          A e_z = e_z              rotation [rad]
    Prismatic      d_x = d_y = 0,    A = 1                    translation [m]
    Spherical      d = 0                                      no coordinate
    Universal      d = 0,            e_x . A e_y = 0          rotation, second_rotation [rad]
    PointOnLine    d_x = d_y = 0                              translation [m]
    PointInPlane   d_z = 0                                    no coordinate
    LineInPlane    d_z = 0,          e_z . A e_y = 0          no coordinate
    Distance       |d| = its initial value                    distance [m]

A user-defined joint is a subclass of `Joint` that defines its rows and coordinates; the scene compiler, the redundancy
check, the recording and the conformance tests read these tables. `JOINT_KINDS` lists those of the package.
"""

from __future__ import annotations

from warpffrf.model.joints.base import Joint, Marker, Row, coincident_within
from warpffrf.model.joints.drive import QUANTITIES, Drive
from warpffrf.model.joints.kinds import (
    Cylindrical,
    Distance,
    Fixed,
    LineInPlane,
    Planar,
    PointInPlane,
    PointOnLine,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
)

JOINT_KINDS: dict[str, type[Joint]] = {
    joint.kind: joint
    for joint in (
        Fixed,
        Revolute,
        Cylindrical,
        Planar,
        Prismatic,
        Spherical,
        Universal,
        PointOnLine,
        PointInPlane,
        LineInPlane,
        Distance,
    )  # fmt: skip
}

__all__ = [
    "JOINT_KINDS",
    "QUANTITIES",
    "Cylindrical",
    "Distance",
    "Drive",
    "Fixed",
    "Joint",
    "LineInPlane",
    "Marker",
    "Planar",
    "PointInPlane",
    "PointOnLine",
    "Prismatic",
    "Revolute",
    "Row",
    "Spherical",
    "Universal",
    "coincident_within",
]


def __dir__() -> list[str]:
    return __all__
