"""A force that is given by a table against the approach, straight between its points; the last piece goes on."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.laws.lumped.base import STEEL_SHEAR, Approach, LumpedLaw, Meeting
from warpffrf.model.laws.tabulated_layer import MOST_POINTS
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class TabulatedForce(LumpedLaw):
    """`forces` (n,) [N] at the approaches (n,) [m], both rising strictly, the first force zero; below the first
    approach, which may be negative, there is none. For surfaces that touch in a point.

    shear [-]: tangential stiffness over the normal one, of friction that sticks. damping, restitution and impact_speed
    as in `LumpedLaw`. Raises `InputError` for a table that folds over itself.
    """

    approaches: tuple[float, ...]
    forces: tuple[float, ...]
    _: KW_ONLY
    shear: float = STEEL_SHEAR
    kind: ClassVar[str] = "tabulated_force"

    def __post_init__(self) -> None:
        super().__post_init__()
        a = require_array(self.approaches, "TabulatedForce: approaches [m]", (None,))
        F = require_array(self.forces, "TabulatedForce: forces [N]", (None,))
        if len(a) != len(F) or len(a) < 2:
            raise InputError(
                "TabulatedForce: as many forces as approaches are needed, two at least, got "
                f"{len(a)} approaches and {len(F)} forces"
            )
        if len(a) > MOST_POINTS:
            raise InputError(f"TabulatedForce: at most {MOST_POINTS} points, got {len(a)}; thin the table")
        for name, values in (("approaches", a), ("forces", F)):
            if np.any(falls := np.diff(values) <= 0.0):
                i = int(np.argmax(falls))
                raise InputError(
                    f"TabulatedForce: the table folds over itself, {name} must rise strictly, got {values[i]:g} and "
                    f"then {values[i + 1]:g} (points {i} and {i + 1})"
                )
        if F[0] != 0.0:
            raise InputError(
                f"TabulatedForce: the first force must be 0, got {F[0]:g} N; add the approach where contact begins"
            )
        self._keep("approaches", tuple(float(x) for x in a))
        self._keep("forces", tuple(float(x) for x in F))
        self._keep("shear", require_number(self.shear, "TabulatedForce: shear", positive=True))

    def approach(self, meeting: Meeting) -> Approach:
        return Approach(table=np.stack([self.approaches, self.forces], axis=1), shear=self.shear)
