r"""Inertia levels of the bodies of a scene.

A level defines which parts of J(q) = J0 + sum q_i J1_i + sum q_i q_j J2_ij and h = sum q_i qdot_j G_ij a body keeps:

    constant      none: rotation and deformation are not coupled
    deformed      J1, J2: inertia of the deformed body, and its conjugate, the centrifugal forces on the modes
    gyroscopic    J1, G: centrifugal load on the undeformed shape, Coriolis and Euler forces, momentum of the vibration
    full          J1, J2, G

Each is the Lagrangian of its own kinetic energy, so each conserves energy and angular momentum. `auto` takes the least
level that keeps every term whose estimate is above its bound (BOUNDS), with omega the fastest rotation that the scene
states (initial angular velocities, drives), frequencies omega_i and |J0| = tr J0/2 = int |X|^2 dm:

    centrifugal   omega^2/2 root(sum_i |J1_i|^2/omega_i^4) / root(|J0|)   deformation by the centrifugal load, of the
    size deformed      omega^2 norm(|J2_ij|/(omega_i omega_j))                 centrifugal against elastic force
    gyroscopic    2 omega max_ij |G_ij|/max(omega_i, omega_j)             Coriolis against elastic force

The last two are ratios of forces that both grow with the deformation. The first is a load. The other loads on the body
are not known before the run, so the deformation by this load is compared with the size of the body: modes have the mass
norm, hence |q|/root(|J0|) is the root mean square of the displacement over the radius of gyration.

Rotation caused by torques, contacts and springs is not stated. The estimates give the speed up to which a level
is valid; a run in which a body rotates faster is restarted, with all terms of that body (`online.run`): a change of
level in the middle of a run would change its energy and momentum. The fastest rotation of each body is part of the
state, so that a run continued from a checkpoint has the level that was chosen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.inertia import LEVELS, TERM_NAMES, GeometricStiffness, InertiaTerms
from warpffrf.model.scene import Scene

AUTO = 0.01  # a neglected term estimated above 1 % is kept: the usual accuracy of a force or displacement
NOTICEABLE = 1e-5  # a deformation of 1e-5 of the size, in steel a stress of 2 MPa: less than the effect of tolerances
BOUNDS = {"centrifugal": NOTICEABLE, "deformed inertia": AUTO, "gyroscopic": AUTO}


@dataclass(frozen=True)
class BodyInertia:
    """Inertia terms of one body: the level in use, the terms (None: constant), and those that loads stiffen (None:
    none); `limit`: the fastest rotation [rad/s] for which `auto` would choose the level.
    """

    level: str
    terms: InertiaTerms | None
    stiffening: GeometricStiffness | None
    limit: float = np.inf

    @property
    def count(self) -> int:
        """Number of modes that carry inertia."""
        return 0 if self.terms is None else len(self.terms.first)


@dataclass(frozen=True)
class InertiaPlan:
    """The levels of all bodies of a scene, and notes on them."""

    bodies: list[BodyInertia]
    notes: list[str]

    @classmethod
    def of(cls, scene: Scene, turned: Sequence[float] | np.ndarray = ()) -> InertiaPlan:
        """Levels requested by the scene; `turned`: the fastest rotation of each body [rad/s] in a run so far. Raises
        InputError for a body that was reduced without inertia terms.
        """
        plans, notes = [], []
        found = turned if len(turned) else [0.0] * len(scene.bodies)
        speed = fastest_turning(scene)
        for body, fastest in zip(scene.bodies, found, strict=True):
            if not body.mode_count:
                plans.append(BodyInertia("constant", None, None))
                continue
            plans.append(_plan(body, speed, float(fastest), notes))
        return cls(plans, notes)

    @property
    def limits(self) -> np.ndarray:
        """(bodies,) rad/s: a body that rotates faster needs another level; inf where none is chosen."""
        return np.array([plan.limit for plan in self.bodies])


def _plan(body: Body, speed: float, fastest: float, notes: list[str]) -> BodyInertia:
    terms = body.flexible.inertia_terms
    level, limit = body.level, np.inf
    stiffening = terms.stiffening if terms is not None and body.stiffening else None
    if body.stiffening and stiffening is None:
        raise InputError(
            f"body {body.name!r}: it was reduced without geometric stiffening; use ReductionOptions(stiffening=True)"
        )
    if level == "auto":
        if terms is None or not len(terms.first):
            notes.append(
                f"body {body.name!r}: reduced without inertia terms, inertia 'constant' is used; reduce it again"
            )
            return BodyInertia("constant", None, None)
        found = estimate(terms, body.inertia, 2.0 * np.pi * body.flexible.frequencies, speed)
        level = least_level([found[name] > BOUNDS[name] for name in TERM_NAMES])
        sizes = ", ".join(f"{name} {value:.1e}" for name, value in found.items())
        said = f"body {body.name!r}: inertia 'auto' chose {level!r} (estimates at {speed:.3g} rad/s: {sizes})"
        limit = fastest_for(terms, body.inertia, 2.0 * np.pi * body.flexible.frequencies, level)
        if fastest > limit:
            said += f", then 'full', as it rotates faster than {limit:.3g} rad/s, the limit of {level!r}"
            level, limit = "full", np.inf
        notes.append(said)
    if level != "constant" and (terms is None or not len(terms.first)):
        raise InputError(
            f"body {body.name!r}: inertia {level!r} needs inertia terms, which this reduced body lacks; reduce it again"
        )
    if level == "constant" and not body.stiffening:
        terms = None
    return BodyInertia(level, terms, stiffening, limit)


def fastest_turning(scene: Scene) -> float:
    """The fastest rotation that a scene states [rad/s]: of initial angular velocities and of driven rotations."""
    speeds = [float(np.linalg.norm(body.angular_velocity)) for body in scene.bodies]
    for drive in scene.drives:
        if not drive.coordinate.endswith("rotation"):
            continue
        _, slopes = drive.position().samples()
        speeds.append(float(np.abs(slopes).max()))
    return max(speeds, default=0.0)


def estimate(terms: InertiaTerms, J0: np.ndarray, omega: np.ndarray, speed: float) -> dict[str, float]:
    """Estimated size of each term at a rotation of `speed` [rad/s], see the module; `omega` (m,) [rad/s]."""
    w = omega[: len(terms.first)]
    J1 = np.linalg.norm(terms.first, axis=(1, 2), ord=2)
    J2 = np.linalg.norm(terms.second, axis=(2, 3), ord=2)
    G = np.linalg.norm(terms.gyroscopic, axis=2)
    return {
        "centrifugal": float(0.5 * speed**2 * np.linalg.norm(J1 / w**2) / np.sqrt(0.5 * np.trace(J0))),
        "deformed inertia": float(speed**2 * np.linalg.norm(J2 / np.outer(w, w), ord=2)),
        "gyroscopic": float(2.0 * speed * np.max(G / np.maximum.outer(w, w))),
    }


def fastest_for(terms: InertiaTerms, J0: np.ndarray, omega: np.ndarray, level: str) -> float:
    """The fastest rotation [rad/s] at which every term that `level` omits is within its bound; as `estimate`."""
    at_one = estimate(terms, J0, omega, 1.0)
    limits = [
        (BOUNDS[name] / at_one[name]) ** (1.0 if name == "gyroscopic" else 0.5)
        for name, kept in zip(TERM_NAMES, LEVELS[level], strict=True)
        if not kept and at_one[name] > 0.0
    ]
    return min(limits, default=np.inf)


def least_level(wanted: Sequence[bool]) -> str:
    """The least level that keeps every term that is `wanted`, in the order of TERM_NAMES."""
    return next(name for name, kept in LEVELS.items() if all(k or not w for k, w in zip(kept, wanted, strict=True)))
