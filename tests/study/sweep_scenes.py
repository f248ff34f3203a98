"""Scenes of sweeps that take a moment: a bob on a spring along z, rigid, with a closed form."""

from __future__ import annotations

import os
import signal
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.model.messages.progress import terminated_as_interrupted

GRAVITY, MASS = 9.81, 2.0  # m/s2, kg
TIMES = {"duration": 0.01, "step": 1e-3}
IN_TIME = partial(wf.simulate, **TIMES)
FILE = """
title = "bob"
[parameters]
spring.stiffness = 1000.0
mass = 2.0
[scene]
gravity = [0, 0, -9.81]
[bodies.bob]
mass = "= mass"
inertia_tensor = [0.01, 0.01, 0.01]
[joints.guide]
kind = "prismatic"
a = "ground"
b = { body = "bob", point = [0, 0, 0] }
axis = [0, 0, 1]
[forces.spring]
kind = "joint_spring_damper"
joint = "guide"
stiffness = "= spring.stiffness"
damping = 0.0
[simulate]
duration = 0.01
step = 1e-3
"""


def scene_file(folder: Path) -> Path:
    file = folder / "bob.toml"
    file.write_text(FILE, encoding="utf-8")
    return file


def bob(stiffness: float, mass: float = MASS, name: str = "bob") -> wf.Scene:
    """Let go from where the spring has no force."""
    scene = wf.Scene(gravity=(0.0, 0.0, -GRAVITY))
    body = scene.add_rigid_body(mass, (0.01, 0.01, 0.01), name=name)
    guide = scene.add(wf.joints.Prismatic(scene.ground, body.at((0.0, 0.0, 0.0)), axis=(0.0, 0.0, 1.0), name="guide"))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=stiffness, damping=0.0, name="spring"))
    return scene


def named_bob(name: str) -> wf.Scene:
    """A bob that is called so."""
    return bob(1000.0, name=name)


def timed_bob(stiffness: float, duration: float) -> tuple[wf.Scene, Any]:
    """A bob whose runs have different lengths [s]."""
    return bob(stiffness), partial(wf.simulate, duration=duration, step=1e-3)


def shy_bob(stiffness: float) -> wf.Scene:
    """A bob that does not want to be stiff."""
    if stiffness > 3000.0:
        raise ZeroDivisionError("far too stiff")
    return bob(stiffness)


def deadly_bob(stiffness: float, folder: str, times: int) -> wf.Scene:
    """A bob of 2000 N/m that takes its process with it, so many `times`: every other time by SIGTERM, which a run takes
    as Ctrl-C."""
    if stiffness == 2000.0:
        for n in range(times):
            mark = Path(folder) / f"death {n}"
            if not mark.exists():
                mark.touch()
                with terminated_as_interrupted():
                    os.kill(os.getpid(), signal.SIGKILL if n % 2 else signal.SIGTERM)
    return bob(stiffness)


def rest(stiffness: float) -> float:
    """Where it hangs at last [m]."""
    return -MASS * GRAVITY / stiffness


def fall(result: Any) -> np.ndarray:
    """(T,) m."""
    return result.body("bob").position[:, 2]
