"""The quantities that errors are told of, and what they are beside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.online.history.history import History

Array = np.ndarray


@dataclass(frozen=True)
class Quantity:
    """One quantity of a run: `values` (T, n) at its saved steps. Errors are lengths of differences over `size`."""

    name: str
    values: Array
    size: float

    def apart(self, other: Array) -> Array:
        """(T,) lengths of the differences from `other` (T, n)."""
        return np.linalg.norm(self.values - other, axis=1)


def quantities(history: History) -> dict[str, Quantity]:
    """By name: the force of each contact over its root mean square, the motion of each body (its origin, and its axes
    as long as its radius of gyration) over the largest way from its mean, and the deformation of a flexible one, as the
    root of the strain energy of each of its modes, over the root mean square of it.

    A quantity that is zero in all rows is left out.
    """
    found = []
    for name, contact in history.contacts.items():
        found.append(_over_mean_square(f"force of contact {name!r}", contact.force))
    for name, contact in history.lumped_contacts.items():
        found.append(_over_mean_square(f"force of contact {name!r}", contact.force))
    for body in history.scene.bodies:
        motion = history.bodies[body.name]
        T = len(motion.position)
        gyration = np.sqrt(0.5 * np.trace(body.inertia) / body.mass)
        axes = np.stack([rot.matrix(p) for p in motion.rotation]).reshape(T, 9) if T else np.zeros((0, 9))
        places = np.concatenate([motion.position, gyration * axes], axis=1)
        way = float(np.linalg.norm(places - places.mean(axis=0), axis=1).max()) if T else 0.0
        found.append(Quantity(f"motion of body {body.name!r}", places, way))
        if motion.modal.size:
            strain = 2.0 * np.pi * np.asarray(body.reduced.frequencies) * motion.modal
            found.append(_over_mean_square(f"deformation of body {body.name!r}", strain))
    return {quantity.name: quantity for quantity in found if quantity.size > 0.0}


def _over_mean_square(name: str, values: Array) -> Quantity:
    return Quantity(name, values, float(np.sqrt(np.mean(np.sum(values**2, axis=1)))) if len(values) else 0.0)
