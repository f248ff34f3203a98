"""A bearing with light rigid rollers between two flexible rings, run up under a radial load.

Shaft and cage are driven from rest to speed; the load acts on the shaft, which slides on soft springs. Each roller
is in a pocket of the cage, on a soft spring that keeps it in contact with one ring when it is unloaded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model import forces, joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce

STEEL = Material(210e9, 0.3, 7850.0)
INNER, BORE, WIDTH, WALL = 0.020, 0.012, 0.012, 0.010  # m: radius of the raceway and of the shaft, width, outer ring
WAY, HALVINGS = 0.5, 50  # rad, more than any lateral displacement angle of the shaft; halved to round-off
LOAD, SPEED, RAMP = 10e3, 2.0 * np.pi * 1000.0 / 60.0, 0.05  # N, rad/s, s


@dataclass(frozen=True)
class Bearing:
    """`count` rollers; rollers of 5 mm radius, of 4.5 mm if there are more than 15; radial clearance [m] all around."""

    count: int
    clearance: float = 0.0

    @property
    def radius(self) -> float:
        """Of a roller [m]."""
        return 0.0045 if self.count > 15 else 0.005

    @property
    def outer(self) -> float:
        """Of the outer raceway [m]."""
        return INNER + 2.0 * self.radius + self.clearance

    @property
    def cage_ratio(self) -> float:
        """Speed of the cage over that of the shaft, for pure rolling."""
        return INNER / (INNER + self.outer)


def rings(bearing: Bearing, half_width: float, *, contact_fixed: bool | None = None) -> tuple[ReducedBody, ReducedBody]:
    """Inner ring and outer ring in linear cells of half of `half_width` [m]; contact_fixed: as of `reduce`."""
    sectors = int(2.0 * np.pi * bearing.outer / (0.5 * half_width))
    inner = reduce(
        roller(INNER, BORE, WIDTH, half_width=half_width, order=1, axial=4), STEEL, interfaces={"bore": "rigid"},
        contact={"rim": surfaces.Cylinder()}, modes=10, grid=ContactGrid(contact_fixed=contact_fixed), cache=False,
        progress=False,
    )  # fmt: skip
    outer = reduce(
        sleeve(bearing.outer, bearing.outer + WALL, WIDTH, sectors=sectors, order=1, axial=4), STEEL,
        interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=10,
        grid=ContactGrid(contact_fixed=contact_fixed), cache=False, progress=False,
    )  # fmt: skip
    return inner, outer


def run_up(bearing: Bearing, bodies: tuple[ReducedBody, ReducedBody], ramp: float = RAMP) -> Scene:
    """The scene around the rings `bodies`, inner and outer, with the full speed after `ramp` [s]; pairs "in 0",
    "out 0", ..."""
    inner, outer = bodies
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    housing = scene.add_body(outer, name="outer")
    scene.add(joints.Fixed(scene.ground, housing["outside"], name="housing"))
    across = scene.add_rigid_body(0.5, (1e-3,) * 3, name="across")
    hub = scene.add_rigid_body(0.5, (1e-3,) * 3, name="hub")
    center, origin = (0.0, 0.0, 0.0), scene.ground
    slides = (
        scene.add(joints.Prismatic(origin, across.at(center), axis=(1, 0, 0), name="slide x")),
        scene.add(joints.Prismatic(across.at(center), hub.at(center), axis=(0, 0, 1), name="slide z")),
    )
    for slide in slides:
        scene.add(forces.JointSpringDamper(slide, stiffness=1e4, damping=200.0, name=f"{slide.name} spring"))
    shaft = scene.add_body(inner, name="inner")
    axle = scene.add(joints.Revolute(hub.at(center), shaft["bore"], axis=(0, 1, 0), name="shaft"))
    cage = scene.add_rigid_body(0.05, (1e-5,) * 3, name="cage")
    turn = scene.add(joints.Revolute(origin, cage.at(center), axis=(0, 1, 0), name="cage"))
    for joint, speed in ((axle, SPEED), (turn, SPEED * bearing.cage_ratio)):
        scene.add(joints.Drive(joint, signals.SmoothStep(0.0, speed, duration=ramp), quantity="velocity"))
    r = bearing.radius
    mass = STEEL.density * np.pi * r**2 * WIDTH
    along = mass * (3.0 * r**2 + WIDTH**2) / 12.0
    tread = surfaces.Cylinder(radius=r, axis_point=center, axis_direction=(0, 1, 0))
    for i, angle in enumerate(angles(bearing)):
        out = np.array([np.sin(angle), 0.0, -np.cos(angle)])
        place = (INNER + r + 0.5 * bearing.clearance) * out
        roll = scene.add_rigid_body(
            mass, (along, 0.5 * mass * r**2, along), name=f"roller {i}", position=place, surfaces={"tread": tread}
        )
        pocket = scene.add(joints.Prismatic(cage.at(place), roll.at(center), axis=tuple(out), name=f"pocket {i}"))
        scene.add(forces.JointSpringDamper(pocket, stiffness=1e4, damping=5.0, preload=-2.0, name=f"spring {i}"))
        scene.add(Contact(shaft["rim"], roll["tread"], name=f"in {i}"))
        scene.add(Contact(housing["bore"], roll["tread"], name=f"out {i}"))
    scene.add(forces.PointForce(hub.at(center), (0.0, 0.0, -LOAD)))
    return scene


def angles(bearing: Bearing) -> np.ndarray:
    """Of the rollers at the start, from the direction of the load."""
    return 2.0 * np.pi * np.arange(bearing.count) / bearing.count


def sjovall(psi: np.ndarray) -> np.ndarray:
    """Roller loads (..., count) [N] at angles `psi` from the load without clearance: cos^(10/9) (psi - phi), line
    contact (Sjoevall 1933), with the shaft displaced at the angle phi from the load, so that the lateral force
    vanishes; phi is 0 if the rollers are symmetric about the load."""
    low, high = np.full(psi.shape[:-1], -WAY), np.full(psi.shape[:-1], WAY)
    for _ in range(HALVINGS):
        phi = 0.5 * (low + high)
        shape = np.clip(np.cos(psi - phi[..., None]), 0.0, None) ** (10.0 / 9.0)
        pushed = np.sum(shape * np.sin(psi), axis=-1) > 0.0  # towards phi: it is too large
        low, high = np.where(pushed, low, phi), np.where(pushed, phi, high)
    return LOAD * shape / np.sum(shape * np.cos(psi), axis=-1, keepdims=True)
