"""The quantities whose errors are estimated, and their reference values.

The force of a contact in an impact of bodies whose faces have mass is an impulse over one step, J/h. It diverges as the
step goes to zero, and so does its square. Rows in which a force is more than `SPIKE` times its median are therefore not
compared; the effect of such an impulse appears in the motions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.online.history.history import History

Array = np.ndarray
STILL = 1e-5  # of the largest displacement in the machine: reference value of bodies that move less
STANDS = 1e-8  # of the size of the machine: the same for stationary bodies, whose motion is round-off
LIGHT = 1e-3  # of the largest contact force in the machine: the same for contacts that carry less
SPIKE = 10.0  # times the median of a force under load: bouncing balls reach 1.4 times


@dataclass(frozen=True)
class Quantity:
    """One quantity of a run: `values` (T, n) at its saved steps. Errors are magnitudes of differences over `size`;
    values above `most` are not compared. `beside`: text of a report on a reference value that is not the quantity's
    own. share: of a deformation its part of the largest displacement, or of the energy, in the machine: the larger.
    """

    name: str
    values: Array
    size: float
    most: float = np.inf
    beside: str = ""
    share: float = 1.0

    def at_least(self, least: float, beside: str) -> Quantity:
        """With the reference value at least `least`, unless the size is zero."""
        return replace(self, size=least, beside=f"; relative to {beside}") if 0.0 < self.size < least else self

    def apart(self, other: Array, rows: Any = slice(None)) -> Array:
        """(T,) magnitudes of the differences from `other` (T, n) of its `rows`."""
        own = self.values[rows]
        one, two = (np.linalg.norm(values, axis=1) <= self.most for values in (own, other))
        return np.where(one & two, np.linalg.norm(own - other, axis=1), 0.0)


def quantities(history: History) -> dict[str, Quantity]:
    """By name: the force of each contact and oil film relative to its root mean square, or
    `LIGHT` of the largest one; the motion of each body (origin, and axes with the length of the radius of gyration)
    relative to the largest distance from its mean, or `STILL` of the largest one, or `STANDS` of the size of the
    machine; the deformation of a flexible body, as the displacement of each of its modes in the mean over its mass [m],
    relative to its root mean square: stiff modes can ring with much strain energy and hardly move anything; and the
    friction loss of each contact with small sliding, relative to its total.

    A quantity that is zero in all rows is omitted.
    """
    forces = [_of_force(f"contact {name!r}", contact.force) for name, contact in _contacts(history)]
    forces += [_of_force(f"film {name!r}", film.force) for name, film in history.films.items()]
    forces += [_of_force(f"contact {name!r}", contact.force) for name, contact in history.small_sliding.items()]
    least = LIGHT * max((quantity.size for quantity in forces), default=0.0)
    found = [quantity.at_least(least, f"{LIGHT:g} of the largest contact force") for quantity in forces]
    places = {body.name: _places(body, history) for body in history.scene.bodies}
    ways = {name: _way(values) for name, values in places.items()}
    least, beside = STILL * max(ways.values(), default=0.0), f"{STILL:g} of the largest displacement in the machine"
    if least < STANDS * (size := machine_size(history)):
        least, beside = STANDS * size, f"{STANDS:g} of the size of the machine, it stands still"
    stored = [np.nan_to_num(history.energy[line]) for line in ("kinetic", "strain") if line in history.energy]
    energy = float(np.sum(stored, axis=0).max(initial=0.0)) if stored else 0.0
    for body in history.scene.bodies:
        motion = Quantity(f"motion of body {body.name!r}", places[body.name], ways[body.name])
        found.append(motion.at_least(least, beside))
        modal = history.bodies[body.name].modal
        if modal.size:
            omega = 2.0 * np.pi * np.asarray(body.reduced.frequencies)
            strain = 0.5 * float(np.sum((omega * modal) ** 2, axis=1).max(initial=0.0))
            deformation = _over_mean_square(f"deformation of body {body.name!r}", modal / np.sqrt(body.mass))
            whole = (strain, energy), (_largest(deformation.values), max(ways.values()))
            share = max(min(own / all_, 1.0) if all_ > 0.0 else 1.0 for own, all_ in whole)
            found.append(replace(deformation, share=share))
    for name, contact in history.small_sliding.items():
        loss = contact.loss.sum(axis=1, keepdims=True)
        found.append(Quantity(f"loss of contact {name!r}", loss, float(loss.max(initial=0.0))))
    return {quantity.name: quantity for quantity in found if quantity.size > 0.0}


def _places(body: Any, history: History) -> Array:
    """(T, 12) the origin of a body and its axes with the length of the radius of gyration [m]."""
    motion = history.bodies[body.name]
    gyration = np.sqrt(0.5 * np.trace(body.inertia) / body.mass)
    axes = rot.matrix(motion.rotation).reshape(len(motion.rotation), 9)
    return np.concatenate([motion.position, gyration * axes], axis=1)


def _largest(values: Array) -> float:
    """The largest magnitude of values (T, n)."""
    return float(np.linalg.norm(values, axis=1).max(initial=0.0))


def _way(places: Array) -> float:
    """The largest distance [m] from the mean."""
    return _largest(places - places.mean(axis=0)) if len(places) else 0.0


def machine_size(history: History) -> float:
    """Distance [m] between bodies at the start, and the largest of their radii of gyration."""
    if not history.scene.bodies or not len(history.time):
        return 0.0
    places = np.array([history.bodies[body.name].position[0] for body in history.scene.bodies])
    gyration = max(np.sqrt(0.5 * np.trace(body.inertia) / body.mass) for body in history.scene.bodies)
    return float(np.linalg.norm(np.ptp(places, axis=0)) + gyration)


def shares(history: History) -> dict[str, float]:
    """By name of a distributed contact its largest force over `LIGHT` of that of the machine, at most 1: conversion of
    errors relative to its own force."""
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
