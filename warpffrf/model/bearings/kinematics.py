r"""Kinematics of elements that roll without slip on two raceways: orbit and spin from the speeds of the rings.

With e_r outward, e_t around and e_a along the axis of the bearing, an element orbits with w_c and rotates with omega =
w_r e_r + w_a e_a. Its surface at the contact with the outer raceway, D/2 n_o from its centre with n_o = cos(alpha_o)
e_r + sin(alpha_o) e_a, and with the inner one, -D/2 n_i, has their circumferential velocity:

    w_c d/2 + D/2 (w_a cos alpha_o - w_r sin alpha_o) = w_o (d/2 + D/2 cos alpha_o),
    w_c d/2 - D/2 (w_a cos alpha_i - w_r sin alpha_i) = w_i (d/2 - D/2 cos alpha_i),

d the pitch diameter, w_i and w_o the speeds of the rings. The pivoting remains undetermined, a rotation about the line
of contact, which no point contact resists. Raceway control (Jones 1959) has none at one of the rings, of the speed w
and the angle alpha:

    (omega - w e_a) . n = w_r cos alpha + (w_a - w) sin alpha = 0,

the outer one at high speed, where the centrifugal force presses there. A roller rotates about its own axis against the
cage, omega - w_c e_a parallel to a, and touches in the direction m of its middle at both raceways: w_r cos tau + (w_a -
w_c) sin tau = 0. At equal angles, gamma = D cos(alpha)/d,

    w_c = (w_i (1 - gamma) + w_o (1 + gamma))/2,

and the rolling against the cage is d/(2 D) (1 - gamma^2)(w_o - w_i). Rotating w_r e_r with w_c requires the gyroscopic
moment I w_c w_r about e_t, which friction must provide.

A point of a raceway meets the Z elements of a row one after the other, Z times per rotation of its ring relative to the
cage, a point of an element each raceway once per rotation relative to the cage:

    BPFO = Z |w_c - w_o|/(2 pi),    BPFI = Z |w_i - w_c|/(2 pi),    BSF = d/(2 D) (1 - gamma^2) |w_i - w_o|/(2 pi),
    FTF = |w_c|/(2 pi).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Rolling:
    """Speeds [rad/s] of an element: `orbit` about the axis, and its rotation, `radial` outward and `axial` along the
    axis, not against the cage but in the world."""

    orbit: float
    radial: float
    axial: float


@dataclass(frozen=True)
class DefectFrequencies:
    """Frequencies [Hz] of the impacts of defects: `bpfo` and `bpfi`, elements that pass a point of the outer and of the
    inner raceway; `bsf`, rotation of an element relative to the cage, in which its defect meets each raceway once;
    `ftf`, rotation of the cage."""

    bpfo: float
    bpfi: float
    bsf: float
    ftf: float


def rolling(
    diameter: float, pitch: float, inner: float, outer: float, angles: tuple[float, float], control: str = "outer"
) -> Rolling:
    """Without slip on rings of the speeds `inner` and `outer` [rad/s] at the contact angles (inner, outer) [rad], not
    pivoting on the raceway `control`, "inner" or "outer", or, of a roller, about its own axis against the "cage"."""
    (c_i, c_o), (s_i, s_o) = np.cos(angles), np.sin(angles)
    R, r = 0.5 * pitch, 0.5 * diameter
    speed, c, s = (inner, c_i, s_i) if control == "inner" else (outer, c_o, s_o)
    axle = [-s, c, s] if control == "cage" else [0.0, c, s]
    rows = np.array([[R, -r * s_o, r * c_o], [R, r * s_i, -r * c_i], axle])
    pivoting = 0.0 if control == "cage" else speed * s
    known: Any = np.array([outer * (R + r * c_o), inner * (R - r * c_i), pivoting])
    orbit, radial, axial = np.linalg.solve(rows, known)
    return Rolling(float(orbit), float(radial), float(axial))
