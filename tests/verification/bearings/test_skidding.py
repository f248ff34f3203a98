"""Cages that friction of the rollers drives against a drag: at the speed of rolling under high load, slower than that
where the drag exceeds the traction of all rollers."""

from __future__ import annotations

import pytest

import warpffrf as wf
from references.closed_forms.rolling_bearings import sjoevall

MM, STEEL = 1e-3, wf.Material(210e9, 0.3, 7850.0)
COUNT, ROLLER, PITCH, SPEED = 14, 8 * MM, 48 * MM, 200.0  # rollers; m: diameter and length; m, rad/s
MU, CREEP, EXPONENT = 0.05, 5e-3, 10.0 / 9.0  # m/s
ONSET = 400.0  # N: radial load below which rollers skid
KINEMATIC = 0.5 * SPEED * (1.0 - ROLLER / PITCH)  # rad/s, of the cage
# of the speed: what is left of the start; rollers that collide with the walls of their pockets, 0.7 +- 0.4 % in a dozen
# runs of nearly the same load
STEADY, RATTLES = 1e-2, 2e-2
DURATION, STEP = 15e-3, 3e-5  # s: six times the inertia of the cage over the drag


def traction(load: float) -> float:
    """Largest drag torque [N m] on the cage under a radial load [N]. A roller whose moments balance is pushed by the
    same force on both rings, at most mu Q each; without clearance the loads of all are J_a/J_r times the radial one."""
    J_r, J_a = sjoevall(0.5, EXPONENT)
    return 0.5 * PITCH * 2.0 * MU * load * J_a / J_r


def cage_speed(load: float, cage: wf.bearings.Cage) -> float:
    """Mean speed [rad/s] in the last third of a run under a radial load [N]; the drag grows with the speed, and is the
    traction of the load ONSET at the speed of rolling."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        "b",
        wf.bearings.RollerGeometry(
            elements=COUNT, roller_diameter=ROLLER, roller_length=ROLLER, pitch_diameter=PITCH
        ),
        first=(0, 0, -1), outer=scene.ground, cage=cage,
        contact=wf.bearings.RollingContact(
            law=wf.laws.PalmgrenLine(ROLLER, 2, damping=0.5), friction=wf.laws.RegularisedCoulomb(MU, CREEP)
        ),
    )  # fmt: skip
    axle = scene.add(wf.joints.Planar(scene.ground, bearing.inner, axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, SPEED, coordinate="rotation", name="drive"))
    scene.add(wf.forces.PointForce(bearing.inner, (0, 0, -load), name="load"))
    bearing.roll(SPEED)
    if bearing.drive is not None:
        scene.drives.remove(bearing.drive)  # the rollers take the cage along
    drag = traction(ONSET) / KINEMATIC
    scene.add(wf.forces.JointSpringDamper(bearing.joints["cage_axle"], 0.0, drag, name="drag"))
    result = wf.simulate(scene, DURATION, step=STEP, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    speed = result.body("b cage").angular_velocity[:, 1]
    found = float(speed[result.time > 2.0 / 3.0 * DURATION].mean())
    print(f"{load:g} N: {found / KINEMATIC:.5f} of the speed of rolling, largest traction {traction(load):.4g} N m")
    return found


FREE, POCKETS = wf.bearings.PrescribedCage(), wf.bearings.PocketCage(0.05 * MM)


@pytest.mark.slow
@pytest.mark.parametrize("load", [10.0 * ONSET, 1.05 * ONSET])
def test_cage_has_the_speed_of_rolling(load: float) -> None:
    """Up to the creep that traction needs, CREEP times drag over largest traction at the pitch circle on either ring:
    0.1 % under high load. Five per cent above the onset nothing slips."""
    creep = CREEP * ONSET / load / (0.5 * PITCH * KINEMATIC)
    slip = 1.0 - cage_speed(load, FREE) / KINEMATIC
    assert slip < 1e-3 + (0.0 if load > 5.0 * ONSET else 1.1 * creep)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("load", "cage"), [(0.95 * ONSET, FREE), (0.6 * ONSET, FREE), (0.6 * ONSET, POCKETS)], ids=["95", "60", "pockets"]
)
def test_rollers_skid_under_low_load(load: float, cage: wf.bearings.Cage) -> None:
    """The drag of the slower cage is the traction: its speed is in proportion to the load, as soon as this is five per
    cent below the onset."""
    expected = pytest.approx(load / ONSET, rel=RATTLES if cage is POCKETS else STEADY)
    assert cage_speed(load, cage) / KINEMATIC == expected
