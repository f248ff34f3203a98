"""Input and output of a step: the accepted state of every world, with everything that the next step needs to continue
bitwise identically. A checkpoint is all of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.axes import Sizes
from warpffrf.online.arrays.declaration import Arrays
from warpffrf.online.compile.films.tables import heat_at_start
from warpffrf.online.compile.scene import CompiledScene
from warpffrf_kernels.core.declaration import declared_in
from warpffrf_kernels.core.state import (
    Books,
    ContactState,
    FilmState,
    FrictionState,
    JointFrictionState,
    LayerState,
    LoadState,
    LumpedState,
    MatchedState,
    MotionState,
    PretensionState,
)

LUMPED = tuple(declared_in(LumpedState))


class State(
    MotionState, LoadState, JointFrictionState, PretensionState, ContactState, FrictionState, LayerState, LumpedState,
    FilmState, MatchedState, Books, Arrays, carried=True,
):  # fmt: skip
    """Accepted state of every world."""


def initial_state(worlds: Sequence[CompiledScene], sizes: Sizes) -> State:
    """State at the initial pose and velocities of the scenes, one per world; accelerations and multipliers are zero."""
    state = State(sizes, worlds[0].device)
    state.slipping.fill_(1)
    _fill_films(worlds, state)
    if worlds[0].matched.count:
        state.matched_gap.assign(np.stack([compiled.matched.gap.numpy() for compiled in worlds]))
    motions = [initial_motion(compiled.scene) for compiled in worlds]
    for name in ("r", "p", "v", "omega"):
        getattr(state, name).assign(np.stack([motion[name] for motion in motions]))
    return state


def initial_motion(scene: Scene) -> dict[str, np.ndarray]:
    """Initial positions r (bodies, 3) of the centres of mass, orientations p (bodies, 4), and velocities v and omega
    (body axes) of a scene."""
    bodies = scene.bodies
    r, v, omega = (np.zeros((len(bodies), 3)) for _ in range(3))
    p = np.zeros((len(bodies), 4))
    for i, body in enumerate(bodies):
        A = rot.matrix(body.rotation)
        arm = A @ body.center_of_mass
        r[i] = body.position + arm
        p[i] = body.rotation
        v[i] = body.velocity + np.cross(body.angular_velocity, arm)
        omega[i] = A.T @ body.angular_velocity
    return {"r": r, "p": p, "v": v, "omega": omega}


def _fill_films(worlds: Sequence[CompiledScene], state: State) -> None:
    """Full films with zero pressure, except where it is prescribed, and the gaps of the initial configuration."""
    if not worlds[0].films.count:
        return
    for array, name in ((state.film_pressure, "given"), (state.film_mass, "begin")):
        values = np.stack([getattr(compiled.films, name).numpy() for compiled in worlds])
        array.assign(np.repeat(values[:, None], 2, axis=1))
    state.film_full.fill_(1)
    for array, name in ((state.film_temperature, "temperature"), (state.film_thinning, "thinning")):
        array.assign(np.stack([heat_at_start(compiled)[name] for compiled in worlds]))
    state.film_heat.assign(np.stack([heat_at_start(compiled)["heat"] for compiled in worlds]))
