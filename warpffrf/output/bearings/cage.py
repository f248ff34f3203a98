"""Forces of a cage on the elements of a bearing, and deflections of a flexible one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model import rotation as rot

if TYPE_CHECKING:
    from warpffrf.output.bearings.bearing_result import BearingResult

UM = 1e6


def force(bearing: BearingResult) -> np.ndarray:
    """`BearingResult.cage_force`."""
    history, description = bearing.history, bearing.description
    found = np.zeros((len(bearing.time), len(bearing.elements)))
    out = bearing._directions
    around = np.stack([-out[..., 1], out[..., 0], 0.0 * out[..., 0]], -1)
    for i in range(len(bearing.elements)):
        total = np.zeros((len(bearing.time), 3))
        key = f"pocket_{i + 1}"
        for name, joint in description["joints"].items():
            if name == key:
                total += history.joints[joint].force
        for name, contact in description["contacts"].items():
            if name == key or name.startswith(f"{key}_"):
                total += history.lumped_contacts[contact].force
        found[:, i] = np.einsum("tk,tki,ti->t", around[:, i], bearing.axes, total)
    return found


def deflections(bearing: BearingResult) -> dict[str, np.ndarray]:
    """`BearingResult.cage_deflection`."""
    description = bearing.description
    names, poses, name = description["pockets"], description["poses"], description["cage"]
    if not names:
        return {}
    cage, axes = bearing.history.bodies[name], np.asarray(description["axes"])
    at, turn = np.asarray(poses[name]["position"]), rot.matrix(np.asarray(poses[name]["rotation"]))
    turned = rot.matrix(cage.rotation) @ turn.T
    found = {}
    for interface, pocket in names.items():
        start = np.asarray(poses[pocket]["position"])
        out = start - np.asarray(description["center"])
        out = out - (out @ axes[2]) * axes[2]
        out /= np.linalg.norm(out)
        relative = np.einsum("tji,tj->ti", turned, bearing.history.bodies[pocket].position - cage.position)
        found[interface] = (relative - (start - at)) @ np.stack([out, np.cross(axes[2], out), axes[2]]).T
    return found


def sentences(bearing: BearingResult, row: int) -> list[str]:
    """Of a report: the largest deflection of a flexible cage in a saved step."""
    sizes = {name: float(np.linalg.norm(moved[row])) for name, moved in deflections(bearing).items()}
    if not sizes:
        return []
    name = max(sizes, key=lambda name: sizes[name])
    return [f"cage: deflection against its mean motion at most {UM * sizes[name]:.4g} um, at {name!r}"]
