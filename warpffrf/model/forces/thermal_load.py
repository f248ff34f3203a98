"""Thermal expansion of a flexible body, as a load on its global modes."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import Body, Port
from warpffrf.model.errors import InputError
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import BodyLoad
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.thermal import Warmth, require_thermal
from warpffrf.model.signals import SignalLike, as_signal


@named_arguments
class ThermalLoad(Force):
    """The thermal expansion of a flexible body at a state of its temperature, constant but for a signal.

    body: of the scene, reduced with `thermal=`. state: of `body.reduced.thermal`, such as `.steady(...)`. signal: a
    number or signal [-] that multiplies the expansion. It is a load on the global modes, which moves interfaces as the
    expansion does; what contact surfaces expand in addition is `body.reduced.thermal.local_expansion`, which
    `study.warm_equilibrium` adds to the gaps of films. Raises `InputError` for a body without temperatures.
    """

    kind = "thermal_load"

    def __init__(self, body: Body, state: Warmth, *, signal: SignalLike = 1.0, name: str | None = None) -> None:
        label = f"thermal load {name!r}" if name else "thermal load"
        if not isinstance(body, Body) or not isinstance(state, Warmth):
            raise InputError(
                f"{label}: a body of the scene and a state of its temperature are needed, such as "
                f"body.reduced.thermal.steady(...), got {body!r} and {state!r}"
            )
        self.name = name
        self.body = body
        self.modal: np.ndarray = require_thermal(body.flexible).modal_force(state)
        self.signal = as_signal(signal, f"{label}: signal")

    @property
    def ports(self) -> tuple[Port, ...]:
        return (Port(self.body, None, self.body.center_of_mass),)

    def load(self) -> BodyLoad:
        """Modal forces; expansion has no resultant."""
        return BodyLoad(self.body, np.zeros(3), np.zeros(3), self.modal, self.signal)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {"kind": self.kind, "name": self.name, "body": self.body.name}
        return {**fields, "modal": self.modal.tolist(), "signal": self.signal.describe()}
