r"""A crowned roller on a rigid plane, tilted by 0.5 mrad, then rotated: where the load acts.

A small steel roller with a crown is pressed on a plane with 1 kN through a cradle that can tilt it. From the static
state the cradle tilts the roller's axis by phi = 0.5 mrad against the plane; then the roller rotates under its load.
The contact is frictionless.

What to expect. The crown is an arc of radius Rc about a point that lies Rc - R beyond the axis; every normal of the
crown in the plane of tilting goes through it. The normal that stands upright when the roller is tilted is the one at

    z = Rc sin(phi)

along the axis, so that the patch moves there, and the cradle has to hold the torque P (Rc - R) sin(phi). The patch is
Hertz's ellipse, with R and Rc as relative radii, tilted or not; the load and its line of action remain when the roller
rotates.
"""

from __future__ import annotations

from dataclasses import dataclass

import warpffrf as wf

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, BORE_RADIUS, WIDTH, TREAD, CROWN = 0.01, 0.003, 0.02, 0.011, 2.0  # m; TREAD: finely meshed, CROWN: Rc
LOAD, TILT = 1e3, 0.5e-3  # N, rad
CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
SPEED = 50.0  # rad/s
TILTING, WAITING, TURNING, STEP = 0.02, 0.005, 0.02, 2e-4  # s
RHO_INF = 0.5
PAIR, GUIDE, TILTS, AXLE = "roller-plane", "guide", "tilt", "axle"


@dataclass(frozen=True)
class Size:
    """Quadratic cells of the roller around, through the wall, and along the axis in the tread."""

    sectors: int = 1100  # four nodes in the half-axis across
    layers: int = 9
    axial: int = 12  # six nodes in the half-axis along


FULL, QUICK = Size(), Size(sectors=900, layers=8, axial=10)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `roller`, `carriage`, `cradle`, joints `guide`, `tilt`, `axle`, contact `roller-plane`, which
    uses the nodes of the mesh."""
    mesh = wf.mesh.roller(
        RADIUS, BORE_RADIUS, WIDTH, crown_radius=CROWN, sectors=size.sectors, layers=size.layers, axial=size.axial,
        tread=TREAD,
    )  # fmt: skip
    reduced = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": wf.surfaces.CrownedCylinder(crown_radius=CROWN)},
        modes=0, grid=wf.ContactGrid(contact_fixed=False), progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    roller = scene.add_body(reduced, name="roller", position=(0, 0, RADIUS))
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0))
    scene.add(wf.Contact(roller["tread"], scene.ground.surface(plane, name="plane"), name=PAIR))
    at = roller["bore"].world_point()
    carriage, cradle = (
        scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name=name, position=at) for name in ("carriage", "cradle")
    )
    scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name=GUIDE))
    tilt = scene.add(wf.joints.Revolute(carriage, cradle, axis=(-1, 0, 0), name=TILTS))
    axle = scene.add(wf.joints.Revolute(cradle, roller["bore"], axis=(0, 1, 0), name=AXLE))
    scene.add(wf.joints.Drive(tilt, wf.signals.SmoothStep(0.0, TILT, duration=TILTING), quantity="position"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=0.5 * TURNING, delay=TILTING + WAITING)
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(carriage, (0, 0, -LOAD), name="press"))
    return scene


def run(scene: wf.Scene, *, progress: bool = True) -> wf.Result:
    """Tilting, waiting and rotating, from the static state of the level roller."""
    end, integrator = TILTING + WAITING + TURNING, wf.integrators.GeneralizedAlpha(RHO_INF)
    return wf.simulate(
        scene, end, step=STEP, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=progress
    )
