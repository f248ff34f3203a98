r"""Angular contact ball bearings at speed, alone and in preloaded pairs, by balance of one ball and root finding.

In the axial section, from the centre of the outer groove, the ball is at (x, y) outwards and along the axis, the centre
of the inner groove at (A cos alpha_0 + u, A sin alpha_0 + p): A = r_i + r_o - D, alpha_0 the angle at which balls just
touch, u the growth of the inner raceway, p the way by which the rings are pressed. With h = hypot

    delta_o = h(x, y) - r_o + D/2,          delta_i = h(A cos alpha_0 + u - x, A sin alpha_0 + p - y) - r_i + D/2,
    Q_o cos alpha_o - T_o sin alpha_o = Q_i cos alpha_i - T_i sin alpha_i + m (d/2) w_c^2,
    Q_o sin alpha_o + T_o cos alpha_o = Q_i sin alpha_i + T_i cos alpha_i,          Q = K delta^1.5,

K of Hertz at the contact angle. A ball that does not pivot on the outer ring rotates about the direction across its
line of contact there, with the speed s; where both contacts roll

    d w_c = D s,          d w_c + D s cos(alpha_i - alpha_o) = w (d - D cos alpha_i),

so that w_c = w (1 - D cos(alpha_i)/d)/(1 + cos(alpha_i - alpha_o)) (Jones). Its axis s sin alpha_o outwards goes around
with w_c, which takes the gyroscopic moment (2/5) m (D/2)^2 w_c s sin alpha_o = (D/2)(T_i + T_o) of friction forces in
the axial section. A ball that creeps by one slip speed on both rings, with friction in proportion to load and slip,
has T_i/Q_i = T_o/Q_o; frictionless balls have neither. A ring has the axial force Z (Q_i sin alpha_i + T_i cos
alpha_i).

Two equal bearings back to back on one shaft whose raceways are offset by p each: under the axial load F they are
pressed by p + x and p - x, with F the difference of their forces. With a spring both have its force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq, root

from references.closed_forms.elliptic import EllipticContact

START, SCALE = 1e-5, 1e7  # m, N/m: about what bearings are pressed by, and their stiffness


@dataclass(frozen=True)
class State:
    """Loads [N] and contact angles [rad], (inner, outer), axial force [N], orbit of the balls [rad/s]."""

    loads: tuple[float, float]
    angles: tuple[float, float]
    force: float
    orbit: float


@dataclass(frozen=True)
class AngularContact:
    """`count` balls of `diameter` on `pitch` [m] that touch at `angle` [rad], groove radii `inner`, `outer` [m],
    modulus E [Pa], Poisson ratio nu, `density` [kg/m3]; `growth` [m] of the radius of the inner raceway; gyroscopic:
    whether friction resists the gyroscopic moment."""

    count: int
    diameter: float
    pitch: float
    angle: float
    inner: float
    outer: float
    youngs_modulus: float = 210e9
    poisson_ratio: float = 0.3
    density: float = 7850.0
    growth: float = 0.0
    gyroscopic: bool = False

    @property
    def mass(self) -> float:
        return self.density * np.pi * self.diameter**3 / 6.0

    def stiffness(self, groove: float, sign: float, angle: float) -> float:
        """K [N/m^1.5] on a raceway that a ball touches at `angle` [rad], sign +1 of the inner one."""
        gamma = sign * self.diameter * np.cos(angle) / self.pitch
        around = self.diameter / 2.0 * (1.0 - gamma)  # of ball 2/D and raceway 2 gamma/(D (1 - gamma)) together
        across = 1.0 / (2.0 / self.diameter - 1.0 / groove)
        modulus = 0.5 * self.youngs_modulus / (1.0 - self.poisson_ratio**2)
        return EllipticContact(1.0, float(around), across, modulus).approach ** -1.5

    def state(self, speed: float, *, press: float | None = None, force: float | None = None) -> State:
        """The inner ring at `speed` [rad/s]; rings pressed by `press` [m] from touching balls, or by an axial `force`
        [N], as of a spring."""
        R, r = 0.5 * self.pitch, 0.5 * self.diameter
        reach = self.inner + self.outer - self.diameter
        touching = reach * np.array([np.cos(self.angle), np.sin(self.angle)])

        def found(x: np.ndarray, speed: float) -> tuple[State, np.ndarray]:
            ball, centre = x[:2], touching + [self.growth, x[2]]
            loads, angles = [], []
            for line, groove, sign in ((centre - ball, self.inner, 1.0), (ball, self.outer, -1.0)):
                angles.append(float(np.arctan2(line[1], line[0])))
                depth = max(float(np.hypot(*line)) - groove + r, 0.0)
                loads.append(self.stiffness(groove, sign, angles[-1]) * depth**1.5)
            (Q_i, Q_o), (a_i, a_o) = loads, angles
            orbit = speed * (1.0 - r / R * np.cos(a_i)) / (1.0 + np.cos(a_i - a_o))
            s_i, c_i, s_o, c_o = np.sin(a_i), np.cos(a_i), np.sin(a_o), np.cos(a_o)
            moment = self.gyroscopic * 0.4 * self.mass * r**2 * orbit**2 * R / r * s_o
            share = moment / r / (Q_i + Q_o)  # T/Q
            T_i, T_o = share * Q_i, share * Q_o
            out = Q_o * c_o - T_o * s_o - Q_i * c_i + T_i * s_i - self.mass * R * orbit**2
            along = Q_o * s_o + T_o * c_o - Q_i * s_i - T_i * c_i
            axial = float(self.count * (Q_i * s_i + T_i * c_i))
            held = axial - force if force is not None else SCALE * (x[2] - press)
            return State((Q_i, Q_o), (a_i, a_o), axial, float(orbit)), np.array([out, along, held])

        start = START if press is None else press
        x = np.array([*(0.5 * (touching + [self.growth, start])), start])
        for part in np.linspace(0.0, 1.0, 16):  # the centrifugal force grows
            x = root(lambda x, w=part * speed: found(x, w)[1], x, tol=1e-14).x
        state, lacking = found(x, speed)
        assert np.abs(lacking).max() < 1e-6 * max(state.loads)
        return state

    def pair(self, offset: float, speed: float, load: float = 0.0) -> tuple[State, State]:
        """Two of them back to back with raceways offset by `offset` [m] each, under an axial `load` [N] that presses
        the first."""

        def lacking(x: float) -> float:
            first, second = (self.state(speed, press=offset + sign * x) for sign in (1.0, -1.0))
            return first.force - second.force - load

        x: Any = brentq(lacking, 0.0, 0.9 * offset, xtol=1e-13)
        return self.state(speed, press=offset + x), self.state(speed, press=offset - x)
