"""Mechanisms of rigid bodies with a closed form or a published motion: pendulum, Cardan shaft, slider-crank, heavy
top."""

from __future__ import annotations

import numpy as np

from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.online.history.history import History

GRAVITY = 9.81  # m/s2


def completed(scene: Scene, duration: float, steps: int, rho_inf: float = 0.9, save_every: int = 1) -> History:
    """A run to its end."""
    history = run(
        scene, duration, step=duration / steps, integrator=GeneralizedAlpha(rho_inf), save_every=save_every,
        progress=False,
    )  # fmt: skip
    assert history.status == "completed", history.message
    return history


# --- a pendulum, D6

PERIOD = 2.3678419476  # s, let go from the horizontal


def pendulum() -> Scene:
    """At rest in the horizontal, its equivalent length 1 m: joint `pivot`."""
    mass, inertia = 2.0, 0.02
    arm = 0.5 * (1.0 + np.sqrt(1.0 - 4.0 * inertia / mass))  # arm + inertia/(mass arm) = 1
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    bob = scene.add_rigid_body(mass, (inertia,) * 3, name="bob", position=(arm, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, bob.at((-arm, 0.0, 0.0)), axis=(0, 1, 0), name="pivot"))
    return scene


# --- a Cardan shaft

DELTA, CARDAN_SPEED = 0.6, 20.0  # rad between the shafts, rad/s


def cardan_shaft() -> Scene:
    """Two shafts at the angle DELTA, the first one driven: joints `bearing_1`, `cross`, `bearing_2`."""
    scene = Scene()
    e_1, e_2 = np.array([1.0, 0.0, 0.0]), np.array([np.cos(DELTA), np.sin(DELTA), 0.0])
    shaft_1 = scene.add_rigid_body(1.0, (0.01, 0.02, 0.02), name="first", position=-0.2 * e_1)
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, 0.0, DELTA])))
    shaft_2 = scene.add_rigid_body(1.0, (0.01, 0.02, 0.02), name="second", position=0.2 * e_2, rotation=turn)
    bearing = scene.add(joints.Revolute(scene.ground, shaft_1.at((0, 0, 0)), axis=e_1, name="bearing_1"))
    scene.add(
        joints.Universal(
            shaft_1.at((0.2, 0, 0)), shaft_2.at((-0.2, 0, 0)), axis=(0, 1, 0), second_axis=(0, 0, 1), name="cross"
        )
    )
    scene.add(joints.Revolute(scene.ground, shaft_2.at((0, 0, 0)), axis=e_2, name="bearing_2"))
    scene.add(joints.Drive(bearing, CARDAN_SPEED))
    return scene


def cardan_angle(theta: np.ndarray) -> np.ndarray:
    """Of the second shaft [rad], at angles of the first."""
    exact = np.arctan2(np.sin(theta), np.cos(theta) * np.cos(DELTA))
    return exact + 2.0 * np.pi * np.round((theta - exact) / (2.0 * np.pi))


# --- a slider-crank

CRANK, ROD, OMEGA, CRANK_START = 0.15, 0.5, 30.0, 0.3  # m, m, rad/s, rad
M_CRANK, M_ROD, M_PISTON, J_CRANK, J_ROD = 1.0, 0.8, 0.5, 0.01, 0.02  # kg, kg m2


def slider_crank() -> Scene:
    """Driven at OMEGA from CRANK_START: joints `axle`, `big_end`, `wrist`, `liner`."""
    scene = Scene()
    pin = CRANK * np.array([np.cos(CRANK_START), 0.0, np.sin(CRANK_START)])
    piston_at = np.array([piston_place(CRANK_START), 0.0, 0.0])
    crank = scene.add_rigid_body(M_CRANK, (J_CRANK,) * 3, name="crank", position=0.5 * pin)
    rod = scene.add_rigid_body(M_ROD, (J_ROD,) * 3, name="rod", position=0.5 * (pin + piston_at))
    piston = scene.add_rigid_body(M_PISTON, (0.01,) * 3, name="piston", position=piston_at)
    axle = scene.add(joints.Revolute(scene.ground, crank.at(-0.5 * pin), axis=(0, -1, 0), name="axle"))
    scene.add(joints.Revolute(crank.at(0.5 * pin), rod.at(0.5 * (pin - piston_at)), axis=(0, 1, 0), name="big_end"))
    scene.add(joints.Revolute(rod.at(0.5 * (piston_at - pin)), piston.at((0, 0, 0)), axis=(0, 1, 0), name="wrist"))
    scene.add(joints.Prismatic(scene.ground, piston.at((0, 0, 0)), axis=(1, 0, 0), name="liner"))
    scene.add(joints.Drive(axle, OMEGA))
    return scene


def piston_place(theta: np.ndarray | float) -> np.ndarray:
    """x [m] of the piston: r cos(theta) + sqrt(l^2 - r^2 sin(theta)^2)."""
    return CRANK * np.cos(theta) + np.sqrt(ROD**2 - (CRANK * np.sin(theta)) ** 2)


def crank_torque(theta: np.ndarray) -> np.ndarray:
    """dT/dtheta [N m] of the kinetic energy at OMEGA, by differences."""
    d = 1e-5
    return (_kinetic(theta + d) - _kinetic(theta - d)) / (2.0 * d)


def _kinetic(theta: np.ndarray) -> np.ndarray:
    s, c = np.sin(theta), np.cos(theta)
    lean = np.sqrt(ROD**2 - (CRANK * s) ** 2)
    piston = -CRANK * s - CRANK * CRANK * s * c / lean  # dx/dtheta
    phi = CRANK * c / lean  # of the rod, d/dtheta
    rod = np.array([0.5 * (piston - CRANK * s), 0.5 * CRANK * c])  # its middle
    return 0.5 * OMEGA**2 * (
        J_CRANK + M_CRANK * (0.5 * CRANK) ** 2 + M_ROD * (rod**2).sum(axis=0) + J_ROD * phi**2 + M_PISTON * piston**2
    )  # fmt: skip


# --- the heavy top, D5

TOP_AFTER_ONE = np.array([0.173343964, 0.640088592, -0.748490791])  # m, its centre of mass after 1 s
TOP_ENERGY = 5435.6967909  # J


def heavy_top() -> Scene:
    """Spinning at 150 rad/s on a ball joint at its tip: body `top`."""
    omega, X = np.array([0.0, 150.0, -4.61538]), np.array([0.0, 1.0, 0.0])
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    top = scene.add_rigid_body(
        15.0, (0.234375, 0.46875, 0.234375), name="top", position=X, angular_velocity=omega,
        velocity=np.cross(omega, X),
    )  # fmt: skip
    scene.add(joints.Spherical(scene.ground, top.at(-X), name="tip"))
    return scene
