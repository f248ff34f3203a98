"""Damping of small-sliding contacts by the amplitude of a mode: one cell against a Jenkins element, a bar against its
free decay."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, laws, signals
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding import SmallSliding
from warpffrf.model.surfaces import Matched, Plane
from warpffrf.offline import reduce
from warpffrf.output.modes_result import eigenmodes
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate, static

FRICTION, LAYER, SPRING = 0.3, 2.5e10, 5e6  # -, Pa/m along the face, N/m
YIELDS = 3e-4  # of all stiffnesses: what the block, a hundred times as stiff as steel, yields itself
SECANT = 5e-4  # of the frequency: the first harmonic of a kinked loop from 48 places
DECAY = 0.05  # of the loss: amplitudes of a cycle that decays are not one, and other modes move too
SIDE, GRAVITY = 0.02, 1.3e4  # m, m/s2: 1 MPa under the bar


@lru_cache(maxsize=1)
def stiff_block() -> ReducedBody:
    material = Material(youngs_modulus=2.1e13, poisson_ratio=0.3, density=7800.0)
    return reduce(
        box((SIDE, SIDE, SIDE), (2, 2, 2), order=1), material, interfaces={"z_max": "rigid"},
        contact={"foot": Matched(first="z_min", size=0.05)}, max_frequency=1e6, cache=False, progress=False,
    )  # fmt: skip


def guided_block() -> Scene:
    """A block that slides along x on the ground, pressed by interference, on a spring: its foot is one cell."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    block = scene.add_body(stiff_block(), name="block", position=(0.0, 0.0, 0.5 * SIDE), damping=0.0)
    floor = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(joints.Prismatic(scene.ground.at((0, 0, SIDE)), block["z_max"], axis=(1, 0, 0)))
    scene.add(forces.SpringDamper(scene.ground.at((-0.1, 0, SIDE)), block["z_max"], SPRING))
    sliding = SmallSliding(interference=1e-6, tangential_stiffness=LAYER)
    scene.add(Contact(block["foot"], floor, sliding=sliding, law=laws.LinearLayer(1e12), friction=FRICTION, name="lap"))
    return scene


def test_one_cell_is_a_jenkins_element() -> None:
    """A spring k in line with a slider of force F, in parallel with another spring: D = 4 F (a - F/k), and the
    stiffness k/pi (theta - sin(2 theta)/2) of the first harmonic, cos(theta) = 1 - 2 F/(k a)."""
    scene = guided_block()
    rest = equilibrium(scene)
    pressure = rest.history.small_sliding["lap"].normal_force[0]
    block = scene.body("block")
    modes = eigenmodes(scene, 1, about=rest)
    k, most = LAYER * SIDE**2, FRICTION * pressure
    a = most / k * np.array([0.5, 1.2, 2.0, 5.0, 20.0])
    found = modes.equivalent_damping(0, a, at=block["z_max"])
    loss = 4.0 * most * np.maximum(a - most / k, 0.0)
    theta = np.arccos(np.maximum(1.0 - 2.0 * most / (k * a), -1.0))
    stiffness = SPRING + k / np.pi * (theta - 0.5 * np.sin(2.0 * theta))
    np.testing.assert_allclose(found.loss, loss, rtol=YIELDS, atol=1e-12 * loss[-1])
    np.testing.assert_allclose(found.frequency, np.sqrt(stiffness / block.mass) / (2.0 * np.pi), rtol=SECANT)
    np.testing.assert_allclose(found.damping_ratio, loss / (2.0 * np.pi * stiffness * a**2), rtol=2.0 * SECANT)
    np.testing.assert_allclose(found.linear_frequency, modes.frequencies[0], rtol=1e-12)
    work = [0.5 * float((loop.load[1:] + loop.load[:-1]) @ np.diff(loop.coordinate)) for loop in found.loops]
    np.testing.assert_allclose(work[2:], loss[2:], rtol=0.02)  # the corners of the loop fall between two steps
    assert found.slipping["lap"].tolist() == [0.0, 1.0, 1.0, 1.0, 1.0] and not any("cycle" in n for n in found.notes)
    assert found.plot().get_title().startswith("Mode 0")


@lru_cache(maxsize=1)
def bar() -> ReducedBody:
    material = Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800.0)
    return reduce(
        box((0.1, 0.01, 0.01), (20, 1, 1), order=1),
        material,
        interfaces={"x_max": "rigid"},
        contact={"foot": Matched(first="z_min")},
        max_frequency=1e5,
        cache=False,
        progress=False,
    )


def bar_with_a_mass(pull: Any = 0.0) -> Scene:
    """A bar along x that its weight presses on the ground, with a mass at its end, which is pulled along x."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    body = scene.add_body(bar(), name="bar", position=(0.05, 0.0, 0.005), damping=0.0)
    end = (0.1, 0.0, 0.005)
    mass = scene.add_rigid_body(1.0, (1e-3,) * 3, name="mass", position=end)
    floor = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(joints.Fixed(mass.at((0, 0, 0)), body["x_max"]))
    scene.add(joints.Prismatic(scene.ground.at(end), mass.at((0, 0, 0)), axis=(1, 0, 0)))
    sliding, layer = SmallSliding(tangential_stiffness=1e12), laws.LinearLayer(1e13)
    scene.add(Contact(body["foot"], floor, sliding=sliding, law=layer, friction=FRICTION, name="lap"))
    scene.add(forces.PointForce(mass.at((0, 0, 0)), (pull, 0.0, 0.0)))
    return scene


def test_free_decay_loses_as_much() -> None:
    """Micro-slip: the bar slides from its end on, the further the larger the amplitude is. Released from a static
    pull, each cycle loses what the quasi-static one of its amplitude does, and takes as long."""
    scene = bar_with_a_mass(signals.Table([0.0, 1.0, 1.0 + 1e-9, 2.0], [0.0, 150.0, 0.0, 0.0]))
    modes = eigenmodes(bar_with_a_mass(), 1)
    period = 1.0 / modes.frequencies[0]
    pulled = static(scene, 1.0, step=0.1, progress=False)
    released = simulate(
        scene,
        4.0 * period,
        step=period / 200.0,
        start=pulled,
        options=RunOptions(integrator=GeneralizedAlpha(rho_inf=1.0)),
        progress=False,
    ).history
    x, lost = released.bodies["mass"].position[:, 0], released.small_sliding["lap"].loss.sum(axis=1)
    ends = 1 + np.flatnonzero(np.diff(x)[1:] * np.diff(x)[:-1] <= 0.0)
    swing = 0.5 * np.abs(np.diff(x[ends]))
    amplitude = 0.5 * (swing[1:] + swing[:-1])[:4]  # of cycles that end at every other end
    loss = (lost[ends[2:]] - lost[ends[:-2]])[:4]
    frequency = (1.0 / (released.time[ends[2:]] - released.time[ends[:-2]]))[:4]
    mass = scene.body("mass")
    found = modes.equivalent_damping(0, amplitude, at=mass.at((0.0, 0.0, 0.0)))
    assert np.all(np.diff(found.damping_ratio) < 0.0) and found.damping_ratio[0] > 0.02
    np.testing.assert_allclose(found.loss, loss, rtol=DECAY)
    np.testing.assert_allclose(found.frequency, frequency, rtol=0.01)  # ends are known to half a percent of a cycle
    assert 0.0 < found.slipping["lap"][0] < 0.3 and found.frequency[0] < 0.95 * found.linear_frequency


def test_what_cannot_be_rubbed_is_refused() -> None:
    scene = guided_block()
    modes = eigenmodes(scene, 2)
    block = scene.body("block")
    for wrong, about in (
        ({"amplitude": -1.0}, "amplitude"), ({"amplitude": [[1e-6]]}, "must have shape"),
        ({"amplitude": []}, "one amplitude"),
        ({"steps": 50}, "four"),
        ({"cycles": 2}, "cycles"), ({"at": scene.ground.at((0, 0, 0))}, "on a body that moves"),
        ({"at": "block"}, "a port is needed"),
    ):  # fmt: skip
        given = {"amplitude": 1e-6, "at": block["z_max"], **wrong}
        with pytest.raises(InputError, match=about):
            modes.equivalent_damping(0, **given)
    free = Scene()
    free.add_rigid_body(1.0, (1, 1, 1), name="stone")
    with pytest.raises(InputError, match="no small-sliding contact"):
        eigenmodes(free, about="initial").equivalent_damping(0, 1e-6)
