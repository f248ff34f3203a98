"""The quantities that errors are told of, and what they are beside.

The force of a contact in an impact of bodies whose faces have mass is an impulse over one step, J/h. It has no limit as
the step goes to zero, and its square none that is finite. Rows in which a force is more than `SPIKE` times its median
are therefore not compared; what such an impulse does is in the motions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.online.history.history import History

Array = np.ndarray
STILL = 1e-5  # of the largest way in the machine: errors of a body that moves less are beside so much
STANDS = 1e-8  # of the size of the machine: the same of one that stands still, whose ways are round-off
LIGHT = 1e-3  # of the largest contact force in the machine: the same of a contact that carries less
SPIKE = 10.0  # times the median of a force under load: the largest of a bounce of balls is 1.4 times


@dataclass(frozen=True)
class Quantity:
    """One quantity of a run: `values` (T, n) at its saved steps. Errors are lengths of differences over `size`; values
    of more than `most` are not compared. beside: what a report says of a size that is not the quantity's own."""

    name: str
    values: Array
    size: float
    most: float = np.inf
    beside: str = ""

    def at_least(self, least: float, beside: str) -> Quantity:
        """Beside `least`, where it is less and not zero."""
        return replace(self, size=least, beside=f"; beside {beside}") if 0.0 < self.size < least else self

    def apart(self, other: Array, rows: Any = slice(None)) -> Array:
        """(T,) lengths of the differences from `other` (T, n) of its `rows`."""
        own = self.values[rows]
        one, two = (np.linalg.norm(values, axis=1) <= self.most for values in (own, other))
        return np.where(one & two, np.linalg.norm(own - other, axis=1), 0.0)


def quantities(history: History) -> dict[str, Quantity]:
    """By name: the force of each contact and oil film over its root mean square, or over `LIGHT` of the largest
    one, the motion of each body (its origin, and its axes as long as its radius of gyration) over the largest way from
    its mean, or over `STILL` of the largest one, or over `STANDS` of the size of the machine, the deformation of a
    flexible one, as the root of the strain energy of each of its modes, over the root mean square of it, and what
    friction takes in each contact with small sliding, over all of it.

    A quantity that is zero in all rows is left out.
    """
    forces = [_of_force(f"contact {name!r}", contact.force) for name, contact in _contacts(history)]
    forces += [_of_force(f"film {name!r}", film.force) for name, film in history.films.items()]
    forces += [_of_force(f"contact {name!r}", contact.force) for name, contact in history.small_sliding.items()]
    least = LIGHT * max((quantity.size for quantity in forces), default=0.0)
    found = [quantity.at_least(least, f"{LIGHT:g} of the largest contact force") for quantity in forces]
    places = {body.name: _places(body, history) for body in history.scene.bodies}
    ways = {name: _way(values) for name, values in places.items()}
    least, beside = STILL * max(ways.values(), default=0.0), f"{STILL:g} of the largest way in the machine"
    if least < STANDS * (size := machine_size(history)):
        least, beside = STANDS * size, f"{STANDS:g} of the size of the machine, it stands still"
    for body in history.scene.bodies:
        motion = Quantity(f"motion of body {body.name!r}", places[body.name], ways[body.name])
        found.append(motion.at_least(least, beside))
        modal = history.bodies[body.name].modal
        if modal.size:
            strain = 2.0 * np.pi * np.asarray(body.reduced.frequencies) * modal
            found.append(_over_mean_square(f"deformation of body {body.name!r}", strain))
    for name, contact in history.small_sliding.items():
        loss = contact.loss.sum(axis=1, keepdims=True)
        found.append(Quantity(f"loss of contact {name!r}", loss, float(loss.max(initial=0.0))))
    return {quantity.name: quantity for quantity in found if quantity.size > 0.0}


def _places(body: Any, history: History) -> Array:
    """(T, 12) the origin of a body and its axes as long as its radius of gyration [m]."""
    motion = history.bodies[body.name]
    gyration = np.sqrt(0.5 * np.trace(body.inertia) / body.mass)
    axes = np.array([rot.matrix(p) for p in motion.rotation]).reshape(len(motion.rotation), 9)
    return np.concatenate([motion.position, gyration * axes], axis=1)


def _way(places: Array) -> float:
    """The largest way [m] from the mean."""
    return float(np.linalg.norm(places - places.mean(axis=0), axis=1).max()) if len(places) else 0.0


def machine_size(history: History) -> float:
    """How far [m] bodies are apart at the start, and the largest of their radii of gyration."""
    if not history.scene.bodies or not len(history.time):
        return 0.0
    places = np.array([history.bodies[body.name].position[0] for body in history.scene.bodies])
    gyration = max(np.sqrt(0.5 * np.trace(body.inertia) / body.mass) for body in history.scene.bodies)
    return float(np.linalg.norm(np.ptp(places, axis=0)) + gyration)


def shares(history: History) -> dict[str, float]:
    """By name of a distributed contact its largest force over `LIGHT` of that of the machine, at most 1: what errors
    that are beside its own force are beside that."""
    each = {name: float(np.linalg.norm(contact.force, axis=1).max(initial=0.0)) for name, contact in _contacts(history)}
    least = LIGHT * max(each.values(), default=0.0)
    return {name: min(each[name] / least, 1.0) if least > 0.0 else 1.0 for name in history.contacts}


def _contacts(history: History) -> list[tuple[str, Any]]:
    """Names and histories of distributed and lumped contacts."""
    return [*history.contacts.items(), *history.lumped_contacts.items()]


def _of_force(owner: str, values: Array) -> Quantity:
    name = f"force of {owner}"
    sizes = np.linalg.norm(values, axis=1)
    most = SPIKE * float(np.median(sizes[sizes > 0.0])) if np.any(sizes > 0.0) else np.inf
    return replace(_over_mean_square(name, values[sizes <= most]), values=values, most=most)


def _over_mean_square(name: str, values: Array) -> Quantity:
    return Quantity(name, values, float(np.sqrt(np.mean(np.sum(values**2, axis=1)))) if len(values) else 0.0)
