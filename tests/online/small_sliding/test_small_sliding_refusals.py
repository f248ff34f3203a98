"""What small-sliding contacts do not go together with is refused, with the cure."""

from __future__ import annotations

import pytest
from small_sliding_scenes import STEEL, two_blocks

from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import EnergyMomentum, RungeKutta4
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched, Plane
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.engine import Engine
from warpffrf.online.local_modes import LocalModes
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate


def test_integrators_for_checks_have_no_small_sliding() -> None:
    for integrator in (RungeKutta4(), EnergyMomentum()):
        scene = two_blocks()
        scene.joints.clear()
        scene.forces.clear()
        with pytest.raises(InputError, match="contact 'lap': only scenes of free bodies .* integrate with Gener"):
            simulate(scene, 1e-5, step=1e-6, options=RunOptions(integrator=integrator), progress=False)


def test_local_modes_with_inertia_do_not_move_small_sliding_contacts() -> None:
    body = reduce(
        box((0.02, 0.02, 0.02), (2, 2, 2), order=1), STEEL, contact={"x_max": Plane(), "foot": Matched(first="z_min")},
        modes=4, options=ReductionOptions(local_dynamics=True), cache=False, progress=False,
    )  # fmt: skip
    scene = Scene()
    block = scene.add_body(body, name="block", position=(0.0, 0.0, 0.01))
    floor = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    wall = scene.ground.surface(Plane(origin=(0.01, 0, 0), outward=(-1, 0, 0)), name="wall")
    scene.add(Contact(block["foot"], floor, sliding="small", friction=0.2, name="lap"))
    scene.add(Contact(block["x_max"], wall, name="stop"))
    with pytest.raises(
        InputError, match="contact 'lap': local_modes 'hht' gives inertia .* body 'block'.*quasi_static"
    ):
        Engine(scene, local_modes=LocalModes("hht"))
    assert any("contact 'lap': its cells yield without inertia" in note for note in Engine(scene).compiled.notes)
