"""Pairs of bodies in one joint of every kind, in a skew pose, and the motions that each kind leaves free."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene

AXIS = np.array([1.0, -2.0, 2.0]) / 3.0
SECOND = np.array([2.0, 2.0, 1.0]) / 3.0
PLACE = np.array([0.3, -0.1, 0.2])
SPAN = np.array([0.3, 0.4, -0.2])  # from the place of the joint to the second port of a distance joint
GRAVITY = (0.3, -0.5, -9.81)

# relative motions that a kind leaves free, in turn: rotations about, then translations along axes of a's marker;
# "y'" turns about b's own y after the others; a distance leaves two more freedoms than its list, which are not axes
FREE = {
    "fixed": "",
    "revolute": "Z",
    "cylindrical": "Zz",
    "planar": "xyZ",
    "prismatic": "z",
    "spherical": "XYZ",
    "universal": "XY'",
    "point_on_line": "XYZz",
    "point_in_plane": "XYZxy",
    "line_in_plane": "ZY'xy",
    "distance": "XYZ",
}
KINDS = list(joints.JOINT_KINDS)


def make_joint(kind: str, a: Any, b: Any, **more: Any) -> joints.Joint:
    """A joint of a kind between two ports, with the axes above."""
    if kind == "universal":
        more = {"second_axis": SECOND, **more}
    if kind == "line_in_plane":
        more = {"line": SECOND, **more}
    if kind not in ("spherical", "distance"):
        more = {"axis": AXIS, **more}
    return joints.JOINT_KINDS[kind](a, b, **more)


def pair(kind: str, *, grounded: bool = False, gravity: Any = (0.0, 0.0, 0.0)) -> tuple[Scene, joints.Joint]:
    """Two rigid bodies, or the ground and one, in a skew pose, held by a joint."""
    scene = Scene(gravity=gravity)
    turned = Rotation.from_rotvec([0.5, -0.9, 0.3]).as_quat()
    J = np.array([[0.05, 0.004, -0.002], [0.004, 0.07, 0.003], [-0.002, 0.003, 0.06]])
    b = scene.add_rigid_body(
        2.0, J, name="b", center_of_mass=(0.05, -0.1, 0.15), position=(0.1, 0.2, -0.3), rotation=turned
    )
    reach = SPAN if kind == "distance" else np.zeros(3)
    if grounded:
        a = scene.ground.at(PLACE)
    else:
        body = scene.add_rigid_body(3.0, 2.0 * J, name="a", position=(0.7, 0.1, 0.0), rotation=(0.6, 0.0, 0.0, 0.8))
        a = body.at(body.to_user(PLACE))
    joint = scene.add(make_joint(kind, a, b.at(b.to_user(PLACE + reach)), name="j"))
    return scene, joint


def moved(kind: str, amounts: np.ndarray, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation (3, 3) of b against its initial attitude and displacement (3,) of its port from the joint's place, world
    axes, after the free motions of a kind by `amounts`; `axes` (3, 3) those of the marker."""
    R, d = np.eye(3), np.zeros(3)
    names = FREE[kind].replace("Y'", "y'").replace("y'", "!")
    for name, amount in zip(names, amounts, strict=True):
        if name in "XYZ":
            R = rot.rotation_vector_matrix(amount * axes[:, "XYZ".index(name)]) @ R
        elif name == "!":
            R = rot.rotation_vector_matrix(amount * (R @ axes[:, 1])) @ R
        else:
            d = d + amount * axes[:, "xyz".index(name)]
    return R, d
