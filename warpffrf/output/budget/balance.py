"""Forces that follow from the loads of a machine by equilibrium alone, independent of any stiffness.

Forces balance on every body as a rigid one: A x = loads, with the reactions of joints and drives, the forces of
contacts at their positions in the last saved row, each along its direction and, with friction, across it, and six
unknowns for any other connection of two bodies (films, with their own force direction, small-sliding contacts, lumped
contacts, force elements with a law). Components that are zero in all solutions of A x = 0 are given by the loads: a
contact under a weight has errors in its approach and not in its force.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import constraint_rows, held_motions, scene_length

Array = np.ndarray
MOST_BODIES = 100  # in larger machines no force is taken as given
ZERO, FREE = 1e-6, 1e-3  # of the largest singular value, and of a solution; columns are scaled to one


def given_by_loads(result: Any) -> set[str]:
    """Names of owners, "contact 'pair'", "film 'oil'" and "joint 'axle'", whose forces are given by the loads."""
    history, scene = result.history, result.history.scene
    if not 0 < len(scene.bodies) <= MOST_BODIES:
        return set()
    joints = zip(constraint_rows(scene), held_motions(scene), strict=True)
    columns, owners = list[Array](), list[str]()
    for row, values in joints:
        columns.append(values)
        owners.append(f"joint {row.joint.name!r}")
    units = np.repeat([1.0, 1.0 / scene_length(scene)], 3)

    def unknown(owner: str, one: Any, other: Any, wrenches: list[tuple[Array, Array]]) -> None:
        """Add one column for each of `wrenches`, (6,) on body `one` and its opposite on `other`, which may be the
        ground."""
        for pair in wrenches:
            column = np.zeros(6 * len(scene.bodies))
            for body, wrench in zip((one, other), pair, strict=True):
                if body.index >= 0:
                    column[6 * body.index : 6 * body.index + 6] += wrench * units
            columns.append(column)
            owners.append(owner)
            owner = ""  # for the components across an existing force

    for contact in scene.finite_sliding:
        found = result.contact(contact.name)
        if np.any(found.force[-1]):
            one, other = contact.a.body, contact.b.body
            place = _place(found, history, one)
            directions = _directions(found.force[-1])[: 3 if contact.friction.acts else 1]
            arms = [place - _origin(history, body) for body in (one, other)]
            wrenches = [
                (np.concatenate([d, np.cross(arms[0], d)]), -np.concatenate([d, np.cross(arms[1], d)]))
                for d in directions
            ]
            unknown(f"contact {contact.name!r}", one, other, wrenches)
    for owner, pressed, frame, one, other in _held(scene, history):
        place = _origin(history, one) - _origin(history, other)
        for i, d in enumerate((*frame, *frame)):
            w = np.concatenate([d, np.zeros(3)] if i < 3 else [np.zeros(3), d])
            unknown(owner if i < pressed else "", one, other, [(w, -_moved(w, place))])
    if not columns:
        return set()
    A = np.array(columns).T
    A = A / np.maximum(np.linalg.norm(A, axis=0), 1e-300)
    _, sizes, Vt = np.linalg.svd(A)
    null = Vt[np.count_nonzero(sizes > ZERO * sizes.max(initial=0.0)) :]
    free_of = np.abs(null).max(axis=0, initial=0.0) > FREE
    return set(owners) - {""} - {owner for owner, free in zip(owners, free_of, strict=True) if free}


def _place(found: Any, history: Any, first: Any) -> Array:
    """The centre (3,) of the patch of a contact in the last row, world axes."""
    theta, z = found.patch_center[-1]
    point = np.ravel(found.view.first.shape.point(theta, z))
    return _origin(history, first) + _axes(history, first) @ point


def _directions(force: Array) -> Array:
    """(3, 3) unit vectors along a force and across."""
    along = force / np.linalg.norm(force)
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    across /= np.linalg.norm(across)
    return np.array([along, across, np.cross(along, across)])


def _held(scene: Any, history: Any) -> list[tuple[str, int, Array, Any, Any]]:
    """Connections other than joints and contacts: the owner of the force, the number of leading directions (rows of (3,
    3)), and the bodies. A film acts across its axis, or along its normal."""
    found = []
    for film in scene.films:
        body, shape = film.ports[0].body, film.ports[0].surface.shape
        if shape.kind == "plane":
            pressed, frame = 1, _directions(_axes(history, body) @ shape.normal(0.0, 0.0))
        else:
            pressed, frame = 2, _directions(_axes(history, body) @ shape.axis_direction)[[1, 2, 0]]
        found.append((f"film {film.name!r}", pressed, frame, body, film.ports[1].body))
    laws = [force for force in scene.forces if history.forces[force.name].deformation.shape[1]]
    ports = [getattr(item, "joint", item).ports for item in laws]
    ports += [item.ports for item in (*scene.small_sliding, *scene.lumped_contacts)]
    held = [pair for pair in ports if len(pair) == 2]  # a small-sliding contact may have only one
    return [*found, *(("", 0, np.eye(3), one.body, other.body) for one, other in held)]


def _origin(history: Any, body: Any) -> Array:
    return history.bodies[body.name].position[-1] if body.index >= 0 else np.zeros(3)


def _axes(history: Any, body: Any) -> Array:
    return rot.matrix(history.bodies[body.name].rotation[-1]) if body.index >= 0 else np.eye(3)


def _moved(wrench: Array, place: Array) -> Array:
    """A wrench about an origin at the offset `place` (3,) [m] from its present one."""
    return np.concatenate([wrench[:3], wrench[3:] + np.cross(place, wrench[:3])])
