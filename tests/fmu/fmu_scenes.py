"""Scene files of the tests of FMUs: a motor, and a beam, whole and in halves."""

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
STIFFNESS, DAMPING = 3e4, 5.0  # N/m, N s/m of the joint of both halves, each 8.4 kN/m at its end
LOAD = -20.0  # N at the end of the first half, from the beginning on

RUN = "[simulate]\nduration = 1.0\nstep = {step}\n"
BODY = """\
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850
[meshes.half]
kind = "box"
size = [0.5, 0.02, 0.01]
counts = [10, 1, 1]
center = [0.25, 0, 0]
order = 2
[reduced_bodies.half]
mesh = "half"
material = "steel"
interfaces = { x_min = "rigid", x_max = "rigid" }
modes = 3
"""
FIRST = ("first", 0.0, "x_min", "x_max")  # name, place [m], interfaces that are clamped and joined
SECOND = ("second", 0.5, "x_max", "x_min")


def beam(name: str, x: float, clamped: str, free: str) -> str:
    """Half a beam of 1 m that is clamped at one end."""
    return f"""\
[bodies.{name}]
body = "half"
position = [{x}, 0, 0]
[joints.{name}_wall]
kind = "fixed"
a = "ground"
b = "{name}.{clamped}"
[sensors.{name}_place]
kind = "position"
port = "{name}.{free}"
[sensors.{name}_speed]
kind = "velocity"
port = "{name}.{free}"
"""


def load(which: tuple[str, float, str, str]) -> str:
    """The load at the end of the first half."""
    if which != FIRST:
        return ""
    return f"""\
[forces.load]
kind = "point_force"
port = "first.x_max"
force = [0, 0, {LOAD}]
"""


def half(which: tuple[str, float, str, str], *, step: float) -> str:
    """One half with the force on its end, by its components, as inputs."""
    port = f"{which[0]}.{which[3]}"
    inputs = "".join(f'[signals.f{a}]\nkind = "input"\nname = "force {a}"\nunit = "N"\n' for a in "xz")
    joined = f"""\
[forces.along]
kind = "point_force"
port = "{port}"
force = ["fx", [1, 0, 0]]
[forces.up]
kind = "point_force"
port = "{port}"
force = ["fz", [0, 0, 1]]
"""
    return BODY + inputs + beam(*which) + load(which) + joined + RUN.format(step=step)


def whole(step: float) -> str:
    """Both halves, joined by a bushing."""
    joined = f"""\
[forces.coupling]
kind = "bushing"
a = "first.x_max"
b = "second.x_min"
stiffness = [{STIFFNESS}, {STIFFNESS}, {STIFFNESS}, 0, 0, 0]
damping = [{DAMPING}, {DAMPING}, {DAMPING}, 0, 0, 0]
"""
    return BODY + beam(*FIRST) + beam(*SECOND) + load(FIRST) + joined + RUN.format(step=step)
