r"""Limit points of a static run: if no equilibrium is near, the structure jumps to another one.

A load step that fails at any halving has met a limit point if a path of decreasing energy leads from the last
equilibrium, under the loads at its end, to another one. Newton's method cannot follow it: in between a direction has
negative stiffness -s^2, and proximal steps of a load step (`warpffrf_kernels.step.proximal`) longer than 1/s lead
back uphill. `start.settle` can, because it shortens its steps there. Therefore

1. the state x_0 of the last equilibrium is stored, and `settle` computes x_1, at rest under the loads of the end;
2. x_0 is restored, and the load step is repeated, its iteration starting with the increments x_1 - x_0.

It then ends at x_1 like any other load step: small-sliding contacts have slipped from x_0 to x_1, works are booked by
the trapezoidal rule, and the energy released, in a motion kinetic energy, is in the numerical line. The step
extends to the end of the user's step at once, so that loads pass the limit by less than one user step.

The path between x_0 and x_1 is that of steepest descent in the metric of mass, not a motion: if several equilibria
are lower, a motion may reach another one. The friction of joints and contacts would be omitted on the path; therefore
scenes with such friction do not jump.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.friction import rubbing
from warpffrf.model.reduced.inertia import skin_displacement
from warpffrf.model.rotation import matrix
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import ENERGY_LINES
from warpffrf.online.start.static_equilibrium import LEAST, settle
from warpffrf_kernels.core import control as k

Array = np.ndarray
LOST = int(k.NOT_CONVERGED | k.NOT_FINITE | k.ENERGY | k.NOT_AT_REST | k.UNDERFLOW)  # failures at a limit point
HOLDS = ("hold", "hold_count", "hold_firm", "hold_weak")  # of free motions
NUMERICAL = ENERGY_LINES.index("numerical")


@dataclass(frozen=True)
class Jump:
    """Jump from the equilibrium at `begin` [s] to that of the load step which ends at `end` [s]: largest displacement
    `distance` [m] of a point, on body `body`, and `energy` [J] released."""

    begin: float
    end: float
    body: str
    distance: float
    energy: float

    def note(self) -> str:
        """A line for the report."""
        return (
            f"the structure has jumped in the load step to t = {self.end:.6g} s: no equilibrium was near beyond "
            f"t = {self.begin:.6g} s, and under the loads of the step's end body {self.body!r} came to rest up to "
            f"{1e3 * self.distance:.4g} mm away; that gave off {self.energy:.4g} J (ledger line numerical). A run in "
            "time shows whether it swings on from there, load steps driven by a displacement follow the path between"
        )


def snap_through(engine: Engine) -> Jump | None:
    """Repeat the failed load step of `engine` as a jump; None: there is none, and the engine is unchanged, with the
    failure in its status."""
    if int(np.bitwise_or.reduce(engine.word("status"))) & ~LOST or rubbing(engine.scene):
        return None
    kept, notes = engine.checkpoint(), list(engine.start_notes)
    step, target, rejected = (int(engine.word(name)[0]) for name in ("step", "target", "rejected"))
    start, size, begin = (float(engine.word(name)[0]) for name in ("start_time", "user_step", "time"))
    before, energy = _places(engine), _numerical(engine)
    held = {name: getattr(engine.scratch, name).numpy().copy() for name in HOLDS}
    engine.scratch.hold_count.zero_()
    settled = _settled(engine, start + size * (step + 1))
    for name, values in held.items():
        getattr(engine.scratch, name).assign(values)
    after = {name: getattr(engine.state, name).numpy().copy() for name in ("r", "p", "q", "lam")}
    engine.start_notes[:] = notes
    engine.resume(kept)
    engine.start_notes[:] = notes
    engine.control(status=0)
    if settled:
        scratch = engine.scratch  # not the previous one: it is reallocated if an attempt exceeded the capacity
        scratch.dx.assign(after["r"] - kept["r"])
        scratch.psi.assign(_turns(kept["p"], after["p"]))
        scratch.dq.assign(after["q"] - kept["q"])
        engine.state.lam.assign(after["lam"])
        engine.control(again=1, level=0, sub=0, proximal_level=0)  # a repeated attempt starts from what is in `scratch`
    engine.control(target=step + 1)
    engine.replay(1)  # without x_1 it fails as before
    jumped = settled and int(engine.word("step")[0]) > step
    if settled and not jumped:
        engine.resume(kept)
        engine.start_notes[:] = notes
        engine.control(status=0, target=step + 1)
        engine.replay(1)
    engine.control(target=target)
    if not jumped:
        engine.control(rejected=rejected)
        return None
    given_off = energy - _numerical(engine)
    engine.given_off += max(given_off, 0.0)
    name, distance = max(_moved(before, _places(engine)).items(), key=lambda moved: moved[1])
    return Jump(begin, float(engine.word("time")[0]), name, distance, given_off)


def _settled(engine: Engine, time: float) -> bool:
    """Whether the scene comes to rest under the loads of `time` [s], from the present state."""
    engine.control(status=0, energy_bounded=0)
    engine.clock(time=time, start_time=time)
    engine.static_step(LEAST * float(engine.compiled.model.length))  # drives move to their positions at that time
    return not np.any(engine.word("status")) and settle(engine)


def _turns(p0: Array, p1: Array) -> Array:
    """Rotation vectors (..., 3) [rad] psi with R(p1) = R(p0) exp(psi), of quaternions (..., 4)."""
    v0, w0, v1, w1 = p0[..., :3], p0[..., 3:], p1[..., :3], p1[..., 3:]
    v = w0 * v1 - w1 * v0 - np.cross(v0, v1)
    w = w0 * w1 + np.sum(v0 * v1, axis=-1, keepdims=True)
    v, w = np.where(w < 0.0, -v, v), np.abs(w)
    sine = np.linalg.norm(v, axis=-1, keepdims=True)
    return v * np.where(sine > 0.0, 2.0 * np.arctan2(sine, w) / np.where(sine > 0.0, sine, 1.0), 2.0)


def _numerical(engine: Engine) -> float:
    return float(engine.state.energy.numpy()[0, 0, NUMERICAL])


def _places(engine: Engine) -> dict[str, Array]:
    """Points (n, 3) [m] of the surface of each body, with its global modes; of a rigid one its centre of mass."""
    state, found = engine.state, {}
    r, p, q = (getattr(state, name).numpy()[0] for name in ("r", "p", "q"))
    for i, body in enumerate(engine.scene.bodies):
        local = np.zeros((1, 3))
        if body.reduced is not None:
            first = engine.compiled.modal_start[i]
            moved = skin_displacement(body, q[first : first + body.mode_count])
            local = body.reduced.surface.points + moved - body.center_of_mass
        found[body.name] = r[i] + local @ matrix(p[i]).T
    return found


def _moved(before: dict[str, Array], after: dict[str, Array]) -> dict[str, float]:
    """Largest distance [m] between points, by body."""
    return {name: float(np.linalg.norm(after[name] - x, axis=1).max()) for name, x in before.items()}
