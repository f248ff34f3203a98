r"""The state in which a scene is pressed together, before friction of its surfaces acts.

Tractions need pressures that are there before anything slips. So where contact of surfaces rubs, an equilibrium with
friction (`warpffrf.online.start.rub_to_rest`) has two parts: first the scene comes to rest without friction, with all
that friction will resist held where it is; then friction takes over what was held.

Held are the rigid motions that joints and drives leave and that neither open nor close a gap under pressure, but for
which surfaces under pressure that rub have to slip: with N the motions of

    C z = 0,   L z = 0        (`warpffrf.online.start.free_motions`; springs resist nothing here)

and T the slips of cells, of closed lumped contacts and of joints that rub, the combinations N y whose slips T N y are
more than STICKS. So
a force along a plane, a spring or a weight down an incline moves nothing, and slip is counted from where the surfaces
began. What they are is known where the scene is pressed: so it is pressed twice, first to find them, then from the
initial state again with these held from the beginning, found anew as soon as something is under pressure.

A ball that lies a little off the top of another one is pushed off by what presses it, and friction holds it there, too:
where nothing is under pressure in the end, or no equilibrium with friction is found from there, motions on which gaps
lean by less than LEANS are held as well. Not at once, as such a motion may be what presses, a wedge or a roller.

What is free altogether, a wheel that rolls down an incline, is held here, too, and told by the step with friction.

What holds here bears the loads of the scene, and is stiffer than what holds free motions: a force F moves a mass m by
F/m 1e-16 s2 a step in a scene of 0.1 m.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.engine import Engine
from warpffrf.online.start.free_motions import HOLD, LEANS, FreeMotions
from warpffrf.online.start.settle import settle


def press(engine: Engine, motions: PressedMotions) -> bool:
    """Bring every world of `engine` from its present state to the one in which it is pressed together; True on success,
    else why not is in its status and in `engine.not_at_rest`."""
    begin, notes = engine.checkpoint(), list(engine.start_notes)
    found = settle(engine, motions)
    if not any(len(m) for m in motions.resisted):
        return found
    engine.resume(begin)
    engine.start_notes[:] = notes
    motions.hold()
    return settle(engine, motions)


class PressedMotions(FreeMotions):
    """Those that nothing resists, and those that friction will resist, held alike."""

    holds = yields = 1e-2 * HOLD
    weakens, bears = False, True
    first = np.inf
    leans = False  # whether gaps lean on some by less than LEANS

    def __init__(self, engine: Engine, lean: float = 0.0) -> None:
        super().__init__(engine, rubs=True)
        self.lean = lean

    def look(self) -> None:
        """As of `FreeMotions`, and whether gaps lean on motions that friction will resist."""
        super().look()
        for world, resisted in enumerate(self.resisted):
            if not self.leans and self._presses(world):
                self.leans = len(self._resisted(world, LEANS)) > len(resisted)

    @property
    def presses(self) -> bool:
        """Whether surfaces that rub are under pressure in every world."""
        return all(self._presses(world) for world in range(self.engine.worlds))

    def notes(self) -> list[str]:
        """None: the state is on the way to another one."""
        return []
