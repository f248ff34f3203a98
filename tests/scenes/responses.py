"""Scenes of frequency responses: a frame of two arms on a hinge, and two crossed rollers pressed together."""

from __future__ import annotations

import numpy as np

import warpffrf as wf
from references.finite_elements.jointed_frame import Arm

Array = np.ndarray
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
ARM = Arm((0.2, 0.02, 0.015), (6, 1, 1), STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density)
STIFFNESS = np.array([2e6, 3e6, 1e6, 50.0, 80.0, 120.0])  # N/m, N m/rad
DAMPING = np.array([60.0, 40.0, 30.0, 0.01, 0.02, 0.03])  # the same times s
RADIUS, HALF_LENGTH, LOAD = 0.05, 4e-3, 2000.0  # m, m, N
MASSES, BED, BED_DAMPING = (3.0, 2.0), 4e7, 800.0  # kg, lower and upper; N/m, N s/m


def frame(modes: int = 40) -> tuple[wf.Scene, list]:
    """The frame of `references.finite_elements.jointed_frame`; the scene, and the ports at the hinge and far end."""
    a = ARM.size[0]
    arm = wf.reduce(
        wf.mesh.box(ARM.size, ARM.counts, center=(0.5 * a, 0, 0)), STEEL, modes=modes,
        interfaces={"x_min": "rigid", "x_max": "rigid"}, cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    first = scene.add_body(arm, name="first", damping=0.0)
    second = scene.add_body(
        arm, name="second", position=(a, 0, 0), rotation={"axis": (0, 0, 1), "angle": 0.5 * np.pi}, damping=0.0
    )
    scene.add(wf.joints.Fixed(scene.ground, first["x_min"], name="root"))
    scene.add(wf.joints.Revolute(first["x_max"], second["x_min"], axis=(0, 0, 1), name="hinge"))
    scene.add(wf.forces.Bushing(scene.ground, second["x_max"], STIFFNESS, DAMPING, point=(a, a, 0), name="bushing"))
    return scene, [first["x_max"], second["x_max"]]


def rollers(load: float = LOAD, cells: tuple[int, int] = (71, 71)) -> tuple[wf.Scene, list]:
    """Two crossed rollers, half-spaces, guided along z: the lower on a spring and damper, the upper under `load` [N].

    Crossed at a right angle, rollers of equal radius touch as a ball of that radius does on a plane. Small motions hold
    the cells of the patch: their stiffness is 0.5 % off with 21 x 21 cells, 0.3 % with 51 x 51, 0.05 % with 71 x 71.
    """
    scene = wf.Scene(gravity=(0, 0, 0))
    ports = []
    for name, mass, z, axis in (("lower", MASSES[0], 0.0, (0, 1, 0)), ("upper", MASSES[1], 2.0 * RADIUS, (1, 0, 0))):
        rim = wf.surfaces.Cylinder(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=axis)
        body = wf.half_space_body(
            mass, (2e-3,) * 3, STEEL, contact={"rim": rim}, extent=(-HALF_LENGTH, HALF_LENGTH), free_ends=False
        )
        placed = scene.add_body(body, name=name, position=(0, 0, z))
        scene.add(wf.joints.Prismatic(scene.ground, placed["center"], axis=(0, 0, 1), name=f"guide {name}"))
        ports.append((placed["center"], placed["rim"]))
    (lower, first), (upper, second) = ports
    scene.add(wf.forces.Bushing(scene.ground, lower, (0, 0, BED, 0, 0, 0), (0, 0, BED_DAMPING, 0, 0, 0), name="bed"))
    scene.add(wf.forces.PointForce(upper, (0, 0, -load), name="load"))
    scene.add(wf.Contact(first, second, cells=cells, name="touch"))
    return scene, [lower, upper]


def two_masses(contact: float, frequencies: Array) -> Array:
    """(2, 2, f) m/N: the rollers as two masses, the lower on its bed, with a spring of `contact` [N/m] between them."""
    w = 2.0 * np.pi * np.asarray(frequencies)
    bed = BED + 1j * w * BED_DAMPING - MASSES[0] * w**2
    upper = np.full_like(bed, contact) - MASSES[1] * w**2
    determinant = (bed + contact) * upper - contact**2
    return np.array([[upper, np.full_like(bed, contact)], [np.full_like(bed, contact), bed + contact]]) / determinant
