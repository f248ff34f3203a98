"""Modes of bodies that rotate: a ring that spins slowly (D3) and a rotating cantilever (D7)."""

from __future__ import annotations

from functools import cache

import numpy as np

from warpffrf.model import joints
from warpffrf.model.material import Material
from warpffrf.model.mesh import box, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online import run
from warpffrf.output.modes_result import Modes, eigenmodes
from warpffrf.output.result import Result

RING = Material(210e9, 0.3, 7800.0, name="ring")
SPIN = 10.0  # rad/s, slow: what is of second order in it is (2 SPIN/frequency)^2 = 6e-4
THIN_RING = {2: 127.935, 3: 361.854, 4: 693.823}  # D3: waves -> Hz
FLAP = {0.0: 3.51602, 1.0: 3.68165, 2.0: 4.13732, 5.0: 6.44954, 10.0: 11.20233}  # D7: gamma -> lambda_1
LENGTH, HEIGHT, WIDTH = 1.0, 0.005, 0.01  # m, along y, z and x; slender, so that the beam is one
BEAM = Material(210e9, 0.0, 7850.0, name="beam")  # no Poisson effect: a beam's clamp does not hold it


@cache
def thin_ring() -> ReducedBody:
    """R 0.1 m, 2 mm thick, about y."""
    mesh = roller(0.101, 0.099, 0.01, sectors=120, layers=1, axial=1, order=2)
    return reduce(mesh, RING, max_frequency=1200.0, cache=False, progress=False)


def spinning(ring: ReducedBody, level: str) -> Modes:
    """Its modes with an inertia level, spinning with SPIN."""
    scene = Scene()
    scene.add_body(ring, name="ring", damping=0.0, inertia=level, angular_velocity=(0.0, SPIN, 0.0))
    return eigenmodes(scene, 60, about="initial")


def in_plane(modes: Modes, n: int) -> np.ndarray:
    """Frequencies [rad/s] of the two modes with the largest in-plane part of n waves."""
    ring = modes.scene.body("ring").reduced
    points = ring.surface.points
    theta = np.arctan2(points[:, 0], points[:, 2])
    wave = np.exp(1j * n * theta)
    radial = np.stack([points[:, 0], np.zeros(len(points)), points[:, 2]], axis=1)
    radial /= np.linalg.norm(radial, axis=1, keepdims=True)
    parts = []
    for i in range(len(modes)):
        q = modes.shape(i, "ring").modal
        u = np.einsum("m,mnc,nc->n", q, ring.surface.modes, radial)
        whole = np.linalg.norm(np.tensordot(q, ring.surface.modes, 1))
        part = max(abs(np.vdot(wave, u)), abs(np.vdot(wave.conj(), u))) / max(whole, 1e-300)
        parts.append(part if modes.frequencies[i] > 50.0 else 0.0)
    return np.sort(2.0 * np.pi * modes.frequencies[np.argsort(parts)[-2:]])


@cache
def slender_beam() -> ReducedBody:
    """Clamped at one end."""
    mesh = box((WIDTH, LENGTH, HEIGHT), (1, 32, 1), center=(0.0, 0.5 * LENGTH, 0.0))
    return reduce(
        mesh,
        BEAM,
        interfaces={"y_min": "rigid"},
        modes=24,
        options=ReductionOptions(stiffening=True),
        cache=False,
        progress=False,
    )


def first_flap(beam: ReducedBody, gamma: float, *, level: str, stiffening: bool) -> float:
    """lambda_1 of the beam clamped at the axis of turning, about its steady state."""
    unit = np.sqrt(BEAM.youngs_modulus * HEIGHT**2 / 12.0 / (BEAM.density * LENGTH**4))  # rad/s
    speed = gamma * unit
    # what does not flap is damped, so that the axial stretch and in-plane bending of the start die out
    modes = beam.surface.modes
    flaps = np.linalg.norm(modes[:, :, 2], axis=1) > 0.7 * np.linalg.norm(modes, axis=(1, 2))
    scene = Scene()
    arm = scene.add_body(
        beam, name="arm", damping=np.where(flaps, 0.0, 1.0), inertia=level, stiffening=stiffening,
        angular_velocity=(0.0, 0.0, speed),
    )  # fmt: skip
    hub = scene.add(joints.Revolute(scene.ground, arm["y_min"], axis=(0, 0, 1), name="hub"))
    scene.add(joints.Drive(hub, speed, quantity="velocity"))
    if gamma == 0.0:
        found = eigenmodes(scene, 12, about="initial")
    else:
        steady = run(scene, 0.2, step=2e-4, save_every=1000, progress=False)
        assert steady.status == "completed", steady.message
        found = eigenmodes(scene, 12, about=Result(steady))
    tip = int(np.argmax(beam.surface.points[:, 1]))
    for i in range(len(found)):
        u = np.abs(found.displacement(i, "arm")[tip])
        if found.frequencies[i] > 0.0 and u[2] > 0.9 * np.linalg.norm(u):
            return float(2.0 * np.pi * found.frequencies[i] / unit)
    return 0.0
