r"""Inertia levels of the bodies of a scene -> tables of the modes that carry inertia
(`warpffrf_kernels.bodies.inertia`).

A level says which parts of J(q) = J0 + sum q_i J1_i + sum q_i q_j J2_ij and h = sum q_i qdot_j G_ij a body keeps:

    constant      none: the deformation feels no rotation, the rotation no deformation
    deformed      J1, J2: inertia of the deformed body, and its conjugate, the centrifugal forces on the modes
    gyroscopic    J1, G: centrifugal load on the undeformed shape, Coriolis and Euler forces, momentum of the vibration
    full          J1, J2, G

Each is the Lagrangian of its own kinetic energy, so each conserves energy and angular momentum. `auto` takes the least
level that keeps every term whose estimate is above its bound (BOUNDS), with omega the fastest turning that the scene
states (initial angular velocities, velocity drives), frequencies omega_i and |J0| = tr J0/2 = int |X|^2 dm:

    centrifugal   omega^2/2 root(sum_i |J1_i|^2/omega_i^4) / root(|J0|)   what the centrifugal load deforms, of the size
    deformed      omega^2 norm(|J2_ij|/(omega_i omega_j))                 centrifugal against elastic force
    gyroscopic    2 omega max_ij |G_ij|/max(omega_i, omega_j)             Coriolis against elastic force

The last two are ratios of forces that both grow with the deformation. The first is a load; what else loads the body is
not known before the run, so that it is judged by itself: modes have the mass norm, hence |q|/root(|J0|) is the root
mean square of the displacement over the radius of gyration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from warpffrf_kernels.core.model import Model

from warpffrf.model.errors import InputError
from warpffrf.model.inertia import LEVELS, PRODUCTS, TERM_NAMES

AUTO = 0.01  # a neglected term estimated above 1 % is kept: what a force or displacement is usually wanted to
NOTICEABLE = 1e-5  # a deformation of 1e-5 of the size, in steel a stress of 2 MPa: less than what tolerances leave open
BOUNDS = {"centrifugal": NOTICEABLE, "deformed inertia": AUTO, "gyroscopic": AUTO}
SAMPLES = 9  # points of a piece of a drive's signal where its speed is looked at: polynomials of degree 7


@dataclass(frozen=True)
class BodyInertia:
    """What one body carries: the level in use, the terms (None: constant), and whether loads stiffen it."""

    level: str
    terms: Any
    stiffening: bool

    @property
    def count(self) -> int:
        """Number of modes that carry inertia."""
        return 0 if self.terms is None else len(self.terms.first)


@dataclass(frozen=True)
class InertiaPlan:
    """The levels of all bodies of a scene, and what is to be said about them."""

    bodies: list[BodyInertia]
    notes: list[str]

    @classmethod
    def of(cls, scene: Any) -> InertiaPlan:
        """Levels as the scene asks for them; raises InputError for a body that was reduced without inertia terms."""
        plans, notes = [], []
        speed = fastest_turning(scene)
        for body in scene.bodies:
            if not body.mode_count:
                plans.append(BodyInertia("constant", None, False))
                continue
            plan = _plan(body, speed, notes)
            plans.append(plan)
            if 0 < plan.count < body.mode_count:
                notes.append(
                    f"body {body.name!r}: the first {plan.count} of {body.mode_count} modes carry the inertia terms"
                )
        return cls(plans, notes)


def _plan(body: Any, speed: float, notes: list[str]) -> BodyInertia:
    terms = body.reduced.inertia_terms
    level = body.level
    if body.stiffening and (terms is None or terms.stiffening is None):
        raise InputError(
            f"body {body.name!r}: it was reduced without geometric stiffening; use reduce(..., stiffening=True)"
        )
    if level == "auto":
        if terms is None or not len(terms.first):
            notes.append(
                f"body {body.name!r}: reduced without inertia terms, inertia 'constant' is used; reduce it again"
            )
            return BodyInertia("constant", None, False)
        found = estimate(terms, body.inertia, 2.0 * np.pi * body.reduced.frequencies, speed)
        level = least_level([found[name] > BOUNDS[name] for name in TERM_NAMES])
        sizes = ", ".join(f"{name} {value:.1e}" for name, value in found.items())
        notes.append(f"body {body.name!r}: inertia 'auto' chose {level!r} (estimates at {speed:.3g} rad/s: {sizes})")
    if level != "constant" and (terms is None or not len(terms.first)):
        raise InputError(
            f"body {body.name!r}: inertia {level!r} needs inertia terms, which this reduced body lacks; reduce it again"
        )
    if level == "constant" and not body.stiffening:
        terms = None
    return BodyInertia(level, terms, body.stiffening)


def fastest_turning(scene: Any) -> float:
    """The fastest turning that a scene states [rad/s]: of initial angular velocities and of driven rotations."""
    speeds = [float(np.linalg.norm(body.angular_velocity)) for body in scene.bodies]
    for drive in scene.drives:
        if not drive.coordinate.endswith("rotation"):
            continue
        breaks, c = drive.position().polynomial()
        for i in range(len(c)):
            x = np.linspace(0.0, breaks[i + 1] - breaks[i], SAMPLES)
            slope = np.polynomial.polynomial.polyval(x, np.arange(1, c.shape[1]) * c[i, 1:])
            speeds.append(float(np.abs(slope).max()))
    return max(speeds, default=0.0)


def estimate(terms: Any, J0: np.ndarray, omega: np.ndarray, speed: float) -> dict[str, float]:
    """Estimated size of each term at a turning of `speed` [rad/s], see the module; `omega` (m,) [rad/s]."""
    w = omega[: len(terms.first)]
    J1 = np.linalg.norm(terms.first, axis=(1, 2), ord=2)
    J2 = np.linalg.norm(terms.second, axis=(2, 3), ord=2)
    G = np.linalg.norm(terms.gyroscopic, axis=2)
    return {
        "centrifugal": float(0.5 * speed**2 * np.linalg.norm(J1 / w**2) / np.sqrt(0.5 * np.trace(J0))),
        "deformed inertia": float(speed**2 * np.linalg.norm(J2 / np.outer(w, w), ord=2)),
        "gyroscopic": float(2.0 * speed * np.max(G / np.maximum.outer(w, w))),
    }


def least_level(wanted: Sequence[bool]) -> str:
    """The least level that keeps every term that is `wanted`, in the order of TERM_NAMES."""
    return next(name for name, kept in LEVELS.items() if all(k or not w for k, w in zip(kept, wanted, strict=True)))


def fill_inertia(compiler: Any, m: Model) -> None:
    """Tables of the modes that carry inertia."""
    plans = compiler.inertia.bodies
    counts = [plan.count for plan in plans]
    starts = np.cumsum([0, *counts])
    modal = np.cumsum([0, *compiler.mode_counts])
    dense_of = np.full(modal[-1], -1)
    dense_body, dense_mode, first, tables = [], [], [], []
    for b, plan in enumerate(plans):
        n = plan.count
        dense_body += [b] * n
        dense_mode += list(range(modal[b], modal[b] + n))
        dense_of[modal[b] : modal[b] + n] = np.arange(starts[b], starts[b] + n)
        if n:
            J1, J2, G = plan.terms.kept(plan.level, stiffened=plan.stiffening)
            first.append(np.stack([J1[:, i, j] for i, j in PRODUCTS], axis=1))
            channels = [J2[:, :, i, j] for i, j in PRODUCTS]
            channels += [G[:, :, c].T for c in range(3)]  # line j, column i
            tables.append(np.stack(channels).ravel())
    compiler.fill(
        m.dense, count=int(starts[-1]), body=dense_body, mode=dense_mode,
        first=np.concatenate([np.zeros((0, 6)), *first]), table=np.concatenate([np.zeros(0), *tables]),
    )  # fmt: skip
    compiler.fill(m.modes, dense_of=dense_of)
    compiler.fill(
        m.bodies, dense_start=starts[:-1], dense_count=counts,
        inertia_start=np.cumsum([0] + [9 * n * n for n in counts])[:-1],
    )  # fmt: skip
    compiler.notes.extend(compiler.inertia.notes)


def mode_reach(reduced: Any) -> np.ndarray:
    """Largest displacement of each mode (m,) [m per unit coordinate], on the display surface and at interfaces."""
    fields = [reduced.surface.modes, *(interface.modes[:, None, :3] for interface in reduced.interfaces.values())]
    largest = [np.linalg.norm(np.asarray(modes), axis=-1).max(axis=1, initial=0.0) for modes in fields]
    return np.max(largest, axis=0)


def fill_stiffening(compiler: Any, m: Model) -> bool:
    """Tables of what loads at interfaces stiffen; True where there are any."""
    start = np.full(max(len(compiler.interfaces), 1), -1)
    bodies = np.full(max(len(compiler.interfaces), 1), -1)
    tables, size = [], 0
    for (b, name), f in compiler.interfaces.items():
        bodies[f] = b
        plan = compiler.inertia.bodies[b]
        if plan.stiffening:
            K = np.asarray(plan.terms.stiffening.interfaces[name])
            start[f], size = size, size + K.size
            tables.append(K.ravel())
    compiler.fill(
        m.interfaces, count=len(compiler.interfaces), body=bodies, stiffening_start=start,
        stiffening=np.concatenate([np.zeros(0), *tables]),
    )  # fmt: skip
    return bool(tables)


def dense_columns(m: Model, compiler: Any, bodies: tuple[Any, Any]) -> list[int]:
    """Outer columns of the modes of `bodies` that carry inertia."""
    counts = [plan.count for plan in compiler.inertia.bodies]
    starts = np.cumsum([0, *counts])
    indices = dict.fromkeys(body.index for body in bodies)
    return [6 * m.bodies.count + int(d) for i in indices for d in range(starts[i], starts[i + 1])]
