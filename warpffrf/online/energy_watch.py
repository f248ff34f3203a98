"""The end of a run that makes energy: who has made it, and a cure that was tried.

`warpffrf_kernels.energy_watch` stops a run in which energy has come from nowhere. Here states are kept to go back to;
from the last one the stretch up to the end is repeated with smaller steps, to tell whether these are a cure.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from warpffrf_kernels import control as k

from warpffrf.online.checkpoint import restore

QUIET = 0.2  # of what may be made: up to there a state is one to go back to
KEPT_EVERY = 1.0  # s of computing between two states that are kept: copying one takes some milliseconds
NOISE = 1e-11  # of force times distance: round-off of their product, a hundred thousand times
FINER = (4, 16)  # steps that are tried are shorter by
HELPS = 0.25  # of what was made: a step with which less is made is a cure


def round_off_energy(engine: Any) -> float:
    """What an energy [J] is no more than round-off below, of scenes in which nothing moves."""
    state, scene = engine.state, engine.scene
    weights = [body.mass * np.linalg.norm(scene.gravity) for body in scene.bodies]
    forces = [weights, *(getattr(state, name).numpy() for name in ("load", "lam", "pair_force"))]
    largest = max(float(np.abs(f).max(initial=0.0)) for f in forces)
    return NOISE * largest * float(np.abs(state.r.numpy()).max(initial=0.0))


class EnergyWatch:
    """Beside a run of steps of `step` [s]: `look` after each chunk, `end` where the device has stopped for a gain."""

    def __init__(self, engine: Any, step: float) -> None:
        self.engine, self.step = engine, step
        self._keep()

    def _keep(self) -> None:
        self.kept, self.kept_at = self.engine.state.to_numpy(), time.perf_counter()

    def look(self) -> bool:
        """Whether the run has to end; goes on where what was made is round-off, of scenes in which nothing moves."""
        if not self.engine.word("STATUS")[0] & int(k.GAIN):
            if time.perf_counter() - self.kept_at > KEPT_EVERY and self._made() < QUIET * self._allowed():
                self._keep()
            return False
        noise = round_off_energy(self.engine)
        if self._made() > noise:
            return True
        self.engine.clock(NOISE=noise)
        self.engine.control(STATUS=0)
        return False

    def _made(self) -> float:
        return float(self.engine.word("MADE")[0])

    def _allowed(self) -> float:
        return self.engine.settings.most_made * float(self.engine.word("MOST")[0])

    def end(self) -> str:
        """Who has made energy, how much, and what smaller steps do over the stretch since the state kept last."""
        engine = self.engine
        last, rows = engine.state.to_numpy(), engine.rows[0]
        made, most, t = self._made(), float(engine.word("MOST")[0]), float(engine.word("TIME")[0])
        by_pair = engine.state.made.numpy()[0]
        owner = "the integrator"
        if by_pair.size and by_pair.max() > 0.5 * made:
            owner = f"contact {engine.scene.contacts[int(np.argmax(by_pair))].name!r}"
        began = float(self.kept["clk"][0, int(k.TIME)])
        cure = self._cure(self._created() - self._created(self.kept), most, began, t)
        engine.state.assign(last)
        engine.rows[0] = rows
        return (
            f"{owner} makes energy: by t = {t:.6g} s the run had gained {made:.3g} J, {made / most:.1%} of the largest "
            f"energy of the ledger, that nothing supplied; {cure}"
        )

    def _created(self, state: Any = None) -> float:
        """Of all pairs and the integrator so far [J], closed or not."""
        state = state or self.engine.state.to_numpy()
        return float(state["created"][0].sum() + state["energy"][0, 0, int(k.NUMERICAL)])

    def _cure(self, made: float, most: float, began: float, end: float) -> str:
        tried = f"tried from t = {began:.6g} s on"
        for finer in FINER:
            step = self.step / finer
            found = self._made_with(step, int(np.ceil((end - began) / step)))
            if found < HELPS * made:
                return f"with step={step:.3g} ({tried}) it gains {found / most:.2%}: use that, or accuracy="
        return (
            f"steps down to {self.step / FINER[-1]:.3g} s ({tried}) do not help: give the contact surfaces a finer "
            "grid (half_width=, expected_half_width=) or the machine some damping, or go on with Settings(most_made=0)"
        )

    def _made_with(self, step: float, steps: int) -> float:
        """What is made in so many steps from the state kept last [J]."""
        engine = self.engine
        engine.rows[0] = []
        restore(engine, self.kept, step)
        engine.clock(NOISE=np.inf)  # never mind what is made
        begin = done = int(engine.word("STEP")[0])
        while done < begin + steps and not engine.word("STATUS")[0]:
            engine.control(TARGET=min(done + engine.settings.ring_rows - 1, begin + steps))
            engine.replay(4 * engine.settings.ring_rows)
            done = int(engine.word("STEP")[0])
        return np.inf if engine.word("STATUS")[0] else self._created() - self._created(self.kept)
