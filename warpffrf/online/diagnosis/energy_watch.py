"""The end of a run that creates energy: its cause, and a cure that was tried.

`warpffrf_kernels.step.energy_watch` stops a run in which energy is created numerically. Here states are kept to return
to, and the last steps are repeated with smaller ones, to find whether these are a cure.

The device confirms the numerical line over some steps; a run that ends in the meantime is judged here.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.checkpoint import restore
from warpffrf.online.engine import Engine
from warpffrf_kernels.core import control as k

KEPT_EVERY = 500  # steps between two states that are kept: copying one takes some milliseconds
NOISE = 1e-11  # of force times distance: round-off of their product, a hundred thousand times
FINER = (4, 16)  # steps that are tried are shorter by this factor
INTEGRATOR = "the integrator"
TIGHTER = 0.01  # of the energy tolerance: 1,000 undamped bounces in steps of a ninetieth then make 0.5 %
AT_END = 0.1  # of the largest energy: increase that a run may end with within the steps of the device's confirmation
# of the largest energy, over the square of the steps since then: a drive that sets out smoothly, as t^3, has a line of
# 1/(3 n^2) of it after n steps
SETS_OUT = 0.5
HELPS = 0.25  # of the created energy: a step that creates less is a cure


def round_off_energy(engine: Engine) -> float:
    """Round-off bound of an energy [J], for scenes in which nothing moves."""
    state, scene = engine.state, engine.scene
    weights = [body.mass * np.linalg.norm(scene.gravity) for body in scene.bodies]
    forces = [weights, *(getattr(state, name).numpy() for name in ("load", "lam", "pair_force", "lumped_force"))]
    largest = max(float(np.abs(f).max(initial=0.0)) for f in forces)
    length = float(engine.compiled.model.length)  # where everything is at the origin
    return NOISE * largest * max(float(np.abs(state.r.numpy()).max(initial=0.0)), length)


class EnergyWatch:
    """Watch of a run of steps of `step` [s]: `look` after each chunk, `gained_at_end` after the last, `end` where
    energy was created. set_down: the run begins with the scene as described, without an equilibrium.
    """

    def __init__(self, engine: Engine, step: float, *, set_down: bool = False) -> None:
        self.engine, self.step, self.set_down = engine, step, set_down
        self.last = self.kept = engine.state.to_numpy()  # the last one may be just before the end: begin at that before

    def look(self) -> bool:
        """Whether the run has to end; it continues where the created energy is round-off, in scenes in which nothing
        moves.
        """
        if not self.engine.word("status")[0] & int(k.GAIN):
            if self.engine.word("step")[0] - self.last["ctl"]["step"][0] >= KEPT_EVERY:
                self.kept, self.last = self.last, self.engine.state.to_numpy()
            return False
        noise = round_off_energy(self.engine)
        if self._made() > noise:
            return True
        self.engine.clock(noise=noise)
        self.engine.control(status=0)
        return False

    def gained_at_end(self) -> bool:
        """Whether a run that has reached its end has created energy that the device had not yet confirmed."""
        engine = self.engine
        spell = int(engine.word("gaining_steps")[0])
        if not spell or not engine.compiled.model.limits.gain_limit:
            return False
        share = max(AT_END, SETS_OUT / spell**2)
        if self._made() <= max(share * float(engine.word("most")[0]), round_off_energy(engine)):
            return False
        engine.control(status=int(k.GAIN))
        return True

    def _made(self) -> float:
        return float(self.engine.word("made")[0])

    def end(self) -> str:
        """Cause and amount of the created energy, and the effect of smaller steps over the last steps."""
        engine = self.engine
        last, rows, drained = engine.state.to_numpy(), engine.chunks[0], engine.drained.copy()
        made, most, t = self._made(), float(engine.word("most")[0]), float(engine.word("time")[0])
        by_pair = engine.state.made.numpy()[0]
        owner = INTEGRATOR
        if by_pair.size and by_pair.sum() - float(engine.word("least")[0]) > 0.5 * made:
            owner = f"contact {engine.scene.finite_sliding[int(np.argmax(by_pair))].name!r}"
        began = float(self.kept["clk"]["time"][0])
        try:
            cure = self._cure(
                made - float(self.kept["clk"]["made"][0]), most, began, t, self._without_smaller_steps(owner)
            )
        except KeyboardInterrupt:
            cure = "interrupted before smaller steps were tried"
        finally:
            engine.put_back(last)
            engine.chunks[0], engine.drained = rows, drained
        return (
            f"{owner} creates energy: by t = {t:.6g} s the run had gained {made:.3g} J, {made / most:.1%} of the "
            f"largest energy of the ledger, without a source; {cure}"
        )

    def _without_smaller_steps(self, owner: str) -> str:
        """Cure where smaller steps do not help. Impacts of lumped contacts create a little each, also with steps as
        small as these: they are halved for the gain of a step only beyond the energy tolerance.
        """
        if owner == INTEGRATOR and self.engine.scene.lumped_contacts:
            tighter = self.engine.settings.energy_tolerance * TIGHTER
            return f"limit it in steps of impacts, energy_tolerance={tighter:.2g}"
        cure = "give the contact surfaces a finer grid (half_width=, expected_half_width=) or the machine some damping"
        if self.set_down and any(contact.friction.acts for contact in self.engine.scene.finite_sliding):
            cure = (
                f"begin at rest with closed contacts with friction, start=equilibrium(scene, friction=True), or {cure}"
            )
        return cure

    def _cure(self, made: float, most: float, began: float, end: float, otherwise: str) -> str:
        if self.engine.compiled.inputs.last >= began:
            return "smaller steps were not tried, because inputs changed"
        tried = f"tried from t = {began:.6g} s on"
        for finer in FINER:
            step = self.step / finer
            found = self._made_with(step, int(np.ceil((end - began) / step)))
            if found < HELPS * made:
                return f"with step={step:.3g} ({tried}) it gains {found / most:.2%}: use that, or step_error="
        return f"steps down to {self.step / FINER[-1]:.3g} s ({tried}) do not help: {otherwise}"

    def _made_with(self, step: float, steps: int) -> float:
        """Energy created in so many steps from the kept state [J]."""
        engine = self.engine
        engine.chunks[0] = []
        restore(engine, self.kept, step)
        engine.clock(noise=np.inf)  # ignore created energy
        begin = done = int(engine.word("step")[0])
        while done < begin + steps and not engine.word("status")[0]:
            engine.control(target=min(done + engine.settings.ring_rows - 1, begin + steps))
            engine.replay(4 * engine.settings.ring_rows)
            done = int(engine.word("step")[0])
        return np.inf if engine.word("status")[0] else self._made() - float(self.kept["clk"]["made"][0])
