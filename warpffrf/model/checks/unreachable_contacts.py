"""Pairs that will hardly touch: too far apart, looking past each other, or held apart by the joints.

Joints hold a pair apart where every motion that they leave to its two bodies moves each surface in itself: a turn about
the own axis of a surface of revolution, a slide along a plane. That is told by the rigid motions z that the joints
leave, C z = 0, less those motions of the surfaces in themselves: nothing must remain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import null_space, orth

from warpffrf.model.checks.overlap import OVERLAP_FRACTION
from warpffrf.model.checks.redundancy import held_motions, scene_length
from warpffrf.model.placement.gap import Nearest

if TYPE_CHECKING:
    from warpffrf.model.bodies import SurfacePort
    from warpffrf.model.contact import Contact
    from warpffrf.model.scene import Scene

MOVES = 1e-6  # of a motion of length one: less is none


def out_of_reach(scene: Scene, gaps: dict[str, Nearest | None]) -> list[str]:
    """What is to be said of such pairs, a sentence each; `gaps`: `facing_gap` by the name of the pairs to look at."""
    told, free = [], None
    for contact in scene.contacts:
        if contact.name not in gaps:
            continue
        near, size = gaps[contact.name], _size(contact)
        said = f"contact {contact.name!r}: {contact.a.label} and {contact.b.label}"
        if near is None:
            told.append(
                f"{said} do not face each other anywhere; move a body, or take the other side (Bore for Cylinder)"
            )
        elif near[0] > OVERLAP_FRACTION * size:
            free = _free_motions(scene) if free is None else free
            if _held_apart(contact, free, scene_length(scene)):
                told.append(
                    f"{said} are {near[0]:.3g} m apart, and the joints let neither body move towards the other; check "
                    "radii and positions, or free a joint"
                )
            elif near[0] > size:
                told.append(
                    f"{said} are {near[0]:.3g} m apart at the start, more than the {size:.3g} m radius of the smaller "
                    "one; check radii, positions and units (m), or use scene.close_gap(pair, along=...)"
                )
    return told


def _size(contact: Contact) -> float:
    """The smaller radius [m] of the two surfaces; a plane has none but its half length."""
    sizes = []
    for port in contact.ports:
        surface = port.surface
        if not surface.shape.profile().planar:
            sizes.append(float(surface.shape.radius))
        elif surface.grid is not None:
            sizes.append(float(np.max(np.abs(surface.grid.theta))))
    return min(sizes)


def _free_motions(scene: Scene) -> np.ndarray:
    """Rigid motions (6 bodies, n) that joints and drives leave, turns counted in the length of the scene."""
    held = held_motions(scene)
    return null_space(held) if len(held) else np.eye(held.shape[1])


def _held_apart(contact: Contact, free: np.ndarray, length: float) -> bool:
    """Do all `free` motions of the two bodies move each surface in itself?"""
    for port in contact.ports:
        if port.on_ground:
            continue
        at = 6 * port.body.index
        own = orth(_in_itself(port, length))
        motion = free[at : at + 6]
        if np.abs(motion - own @ (own.T @ motion)).max(initial=0.0) > MOVES:
            return False
    return True


def _in_itself(port: SurfacePort, length: float) -> np.ndarray:
    """Motions (6, n) of the body of a surface that leave the place of the surface: translations, turns."""
    body, shape = port.body, port.surface.shape
    axes = [body.to_world(e) - body.position for e in (shape.e_0, shape.e_1, shape.e_a)]
    center = body.to_world(shape.axis_point) - body.position
    profile = shape.profile()
    turns, slides = [axes[2]], []
    if profile.planar:  # its normal is e_0
        turns, slides = [axes[0]], axes[1:]
    elif profile.spherical:
        turns = axes
    motions = [np.concatenate([-np.cross(turn, center), length * turn]) for turn in turns]
    motions += [np.concatenate([slide, np.zeros(3)]) for slide in slides]
    return np.array(motions).T
