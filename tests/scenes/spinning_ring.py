r"""A thin ring that vibrates and spins slowly (case D3): its vibration pattern lags behind the material.

In-plane bending of a thin ring without extension, n waves around, u_r = W cos n(theta - theta_0), u_theta =
-(W/n) sin n(theta - theta_0) (Love, Treatise on the Mathematical Theory of Elasticity, 1927, art. 293; the lag: Bryan
1890):

    omega_n^2 = E I/(rho A R^4) n^2 (n^2 - 1)^2/(n^2 + 1),      d theta_0/dt = -2 Omega/(n^2 + 1) relative to it.

In modes: a pair (q_1, q_2) of equal frequency is coupled by Coriolis forces alone, 2 Omega gamma qdot with
gamma = G_12.e, and z = q_1 + i q_2 rotates with Omega gamma exactly: the frequencies are
root(omega^2 + (Omega gamma)^2) -+ Omega gamma. The reduced body's own rate (`exact_lag`) is that of the eigenvalues of

    qddot_j + 2 Omega sum_i e.G_ij qdot_i + (omega_j^2 - Omega^2 e.J2_ij e) q_i = 0

over all modes; the result of an integrator of order p deviates by order p in the step.

*Measured* in time: one mode of the pair is given a displacement at the start of a free spin. The n-th Fourier
coefficient Z(t) of the radial displacement over the skin is the sum of two exponentials, so that Z_{k+2} - s Z_{k+1} +
d Z_k = 0 for equally spaced samples (Prony 1795); s and d by least squares, the exponents from the roots, the rate of
theta_0 as minus the half sum of their imaginary parts over n. `exact_lag` does so with the two eigenvalues in which Z
participates.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import Engine, History, run
from warpffrf_kernels.core import control as k

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7800.0, name="steel")
RADIUS, WALL, WIDTH = 0.1, 2e-3, 10e-3  # m
SPIN = 50.0  # rad/s, about y: 6 % of the lowest frequency
AMPLITUDE = 1e-6  # m kg^0.5: linear vibrations
DURATION, SAMPLE = 0.06, 2e-4  # s: the pattern of two waves rotates by 69 degrees; 4 samples per period of four waves
FORGET = 20  # samples before which the method's own transient is still visible


def thin_ring(n: int) -> float:
    """Frequency [Hz] of n waves on the thin ring."""
    inertia = WALL**2 / 12.0  # I/A
    stiffness = STEEL.youngs_modulus * inertia / (STEEL.density * RADIUS**4)
    return float(np.sqrt(stiffness * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)) / (2.0 * np.pi))


def thin_lag(n: int, spin: float = SPIN) -> float:
    """Rate [rad/s] of rotation of the pattern of n waves relative to the material."""
    return -2.0 * spin / (n**2 + 1)


def ring(sectors: int = 96) -> ReducedBody:
    """The ring about y, of curved quadratic cells; its lowest modes, with the pairs of 2, 3 and 4 waves in its
    plane."""
    mesh = roller(
        RADIUS + 0.5 * WALL, RADIUS - 0.5 * WALL, WIDTH, sectors=sectors, layers=1, axial=1, grading=1.0, order=2
    )
    return reduce(mesh, STEEL, modes=10, cache=False, progress=False)


def waves(body: ReducedBody, n: int) -> Array:
    """n-th Fourier coefficient (m,) [m] of the radial displacement of each mode, over the skin."""
    x = body.surface.points
    theta, r = np.arctan2(-x[:, 2], x[:, 0]), np.hypot(x[:, 0], x[:, 2])  # right-handed about y
    modes = body.surface.modes
    radial = (modes[:, :, 0] * x[:, 0] + modes[:, :, 2] * x[:, 2]) / r
    return radial @ np.exp(-1j * n * theta) / len(x)


def pair(body: ReducedBody, n: int) -> Array:
    """Numbers (2,) of the two modes of n waves in the plane."""
    return np.sort(np.argsort(np.abs(waves(body, n)))[-2:])


def exact_lag(body: ReducedBody, n: int, level: str, spin: float = SPIN) -> float:
    """The rate [rad/s] of the reduced body, from its eigenvalues; the body keeps spinning with `spin`."""
    terms: Any = body.inertia_terms
    _, J2, G = terms.kept(level)
    count = len(G)
    omega = 2.0 * np.pi * body.frequencies[:count]
    stiffness = np.diag(omega**2) - spin**2 * J2[:, :, 1, 1]
    A = np.block([[np.zeros((count, count)), np.eye(count)], [-stiffness, -2.0 * spin * G[:, :, 1].T]])
    spectrum: Any = np.linalg.eig(A)
    values, vectors = spectrum
    share = np.linalg.norm(vectors[pair(body, n)], axis=0) / np.linalg.norm(vectors[:count], axis=0)
    own = np.argsort(share)[-4:]  # two frequencies, each with its conjugate: Z has one part of each
    imaginary, parts = values[own].imag, np.abs(waves(body, n) @ vectors[:count, own])
    turning = imaginary[np.argsort(parts)[-2:]]
    return float(-turning.sum() / (2.0 * n))


def bent_start(scene: Scene, body: str, q: Array) -> History:
    """A start for `run`: `scene` in its initial motion, with the modal coordinates `q` (m,) of `body` released from
    rest; the start of the run computes the corresponding accelerations."""
    first = run(scene, SAMPLE, step=SAMPLE, progress=False)
    state = Engine(scene).state.to_numpy()
    state["ctl"]["mode"] = int(k.STATIC)  # positions only: rates are to be set
    at = sum(b.mode_count for b in scene.bodies[: scene.body(body).index])
    state["q"][:, at : at + len(q)] = q
    return replace(first, checkpoint=state)


def spinning(
    body: ReducedBody, n: int, level: str, step: float, *, spin: float = SPIN, damping: float = 0.0
) -> History:
    """The ring in free flight, released from rest with one mode of n waves displaced by AMPLITUDE."""
    scene = Scene()
    scene.add_body(body, name="ring", inertia=level, damping=damping, angular_velocity=(0.0, spin, 0.0))
    q = np.zeros(len(body.frequencies))
    q[pair(body, n)[0]] = AMPLITUDE
    start = bent_start(scene, "ring", q)
    return run(scene, DURATION, step=step, start=start, save_every=int(round(SAMPLE / step)), progress=False)


def measured_lag(body: ReducedBody, n: int, history: History) -> float:
    """The rate [rad/s] of rotation of the pattern relative to the material, see the module."""
    Z = (history.bodies["ring"].modal @ waves(body, n))[FORGET:]
    found = np.linalg.lstsq(np.stack([Z[1:-1], -Z[:-2]], axis=1), Z[2:], rcond=None)[0]
    roots = np.roots([1.0, -found[0], found[1]])
    return float(-np.angle(roots).sum() / (2.0 * n * SAMPLE))
