"""Scene files of the tests of FMUs: a motor, and two pendulums that a spring-damper joins, whole and in halves."""

from __future__ import annotations

MOTOR = """\
title = "motor"
[signals.torque]
kind = "input"
name = "motor torque"
unit = "N m"
initial = 0.5
[bodies.rotor]
mass = 1.0
inertia_tensor = [0.1, 0.2, 0.1]
[joints.shaft]
kind = "revolute"
a = "ground"
b = "rotor"
axis = [0, 1, 0]
[forces.motor]
kind = "point_torque"
port = "rotor"
torque = ["torque", [0, 1, 0]]
[sensors.rim]
kind = "velocity"
port = { body = "rotor", point = [0.1, 0, 0] }
[simulate]
duration = 1.0
step = 1e-3
"""
SPEED = "body_angular_velocity_y[rotor]"  # of the motor
STIFFNESS, DAMPING = 60.0, 0.5  # N/m, N s/m of the coupling
SPACE = 0.4  # m between the pendulums, the free length


def pendulum(name: str, x: float, mass: float, angular_velocity: float) -> str:
    """A pendulum of 0.5 m that hangs below (x, 0, 0.5)."""
    return f"""\
[bodies.{name}]
mass = {mass}
inertia_tensor = [0.01, 0.01, 0.01]
position = [{x}, 0, 0]
angular_velocity = [0, {angular_velocity}, 0]
velocity = [{-0.5 * angular_velocity}, 0, 0]
[joints.{name}_hinge]
kind = "revolute"
a = "ground"
b = {{ body = "{name}", point = [0, 0, 0.5] }}
axis = [0, 1, 0]
[sensors.{name}_place]
kind = "position"
port = "{name}"
[sensors.{name}_speed]
kind = "velocity"
port = "{name}"
"""


SCENE = "[scene]\ngravity = [0, 0, -9.81]\n"
RUN = "[simulate]\nduration = 1.0\nstep = {step}\n"
FIRST = ("first", 0.0, 1.0, 1.0)  # name, x, mass, angular velocity
SECOND = ("second", SPACE, 0.6, -0.5)


def half(*which: float | str, step: float) -> str:
    """One pendulum with the force on it, by its components, as inputs."""
    name = which[0]
    inputs = "".join(f'[signals.f{a}]\nkind = "input"\nname = "force {a}"\nunit = "N"\n' for a in "xz")
    load = f"""\
[forces.along]
kind = "point_force"
port = "{name}"
force = ["fx", [1, 0, 0]]
[forces.up]
kind = "point_force"
port = "{name}"
force = ["fz", [0, 0, 1]]
"""
    return SCENE + inputs + pendulum(*which) + load + RUN.format(step=step)  # type: ignore[arg-type]


def whole(step: float) -> str:
    """Both pendulums with the spring-damper."""
    joined = f"""\
[forces.coupling]
kind = "spring_damper"
a = "first"
b = "second"
stiffness = {STIFFNESS}
damping = {DAMPING}
free_length = {SPACE}
"""
    return SCENE + pendulum(*FIRST) + pendulum(*SECOND) + joined + RUN.format(step=step)
