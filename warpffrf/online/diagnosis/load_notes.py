"""What the ledger of a static run says of its load steps.

The work of a load step is booked by the trapezoidal rule, which is exact where displacements are in proportion to loads
and errs with the cube of the step elsewhere. What is missing is the numerical line. It is also what a structure loses
that snaps from one equilibrium to another, which no smaller step brings back; jumps that were named have said so.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.diagnosis.energy_watch import round_off_energy
from warpffrf.online.engine import Engine
from warpffrf_kernels.core import control as k

OFF = 0.01  # of the largest energy of the ledger
IDLE = 1e-14  # of mass times (length over the longest proximal step)^2: where nothing acts, round-off works less


def is_static(engine: Engine) -> bool:
    """Whether the engine is at the end of a load step."""
    return int(engine.word("mode")[0]) == int(k.LOADING)


def load_notes(engine: Engine, energy: dict[str, np.ndarray]) -> list[str]:
    """A note where the numerical and contact-grid lines together leave more than `OFF` of the energies open."""
    if not len(energy["kinetic"]):
        return []
    left_out = ("potential", "numerical", "contact_grid")
    hand = max((float(np.abs(values).max()) for name, values in energy.items() if name not in left_out), default=0.0)
    mass = max((body.mass for body in engine.scene.bodies), default=0.0)
    idle = IDLE * mass * (float(engine.compiled.model.length) / float(engine.word("tau")[0])) ** 2
    defect = energy["numerical"] + energy["contact_grid"]
    open_end = float(np.abs(defect - defect[0]).max()) - engine.given_off
    if open_end <= max(OFF * hand, idle, round_off_energy(engine)):
        return []
    return [
        f"the works of the load steps leave {open_end:.3g} J open, {open_end / max(hand, 1e-300):.1%} of the largest "
        "energy of the ledger (lines numerical and contact grid): the steps are long for the trapezoidal rule, or the "
        "structure has snapped; a smaller step tells which"
    ]
