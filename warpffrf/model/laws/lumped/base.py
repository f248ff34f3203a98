r"""Common base of the laws of lumped contacts.

**Damping** is that of Hunt and Crossley: the elastic force times 1 + chi a_dot, cut at zero. chi is given, or follows
from the restitution at a given impact speed (`warpffrf.model.laws.hunt_crossley`): it holds for every law here, as the
force of all is an elastic one times that factor.

**Tangential stiffness.** A fully sticking patch has the tangential stiffness k_t = kappa k_n, k_n = dF/da. Of two
half-spaces and a circular patch k_n = 2 b E*, k_t = 8 b G* (Mindlin 1949), b the radius of the patch, so that

    kappa = 4 G*/E*,      1/G* = sum (2 - nu)/G,      1/E* = sum (1 - nu^2)/E,

which is 2 (1 - nu)/(2 - nu) for like materials, 0.8235 at nu = 0.3. For an elongated patch it differs by a few per
cent.

Power force. A force that is a power of the approach, F = K a^n: a stop, a bumper, a contact with a known law.

Tabulated force. A force that is given by a table against the approach, straight between its points; the last piece is
extrapolated.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import KW_ONLY, asdict, dataclass, field
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.laws.hunt_crossley import chi_times_speed
from warpffrf.model.laws.layers import MOST_POINTS
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import Patch

STEEL_SHEAR = 2.0 * (1.0 - 0.3) / (2.0 - 0.3)  # kappa of like materials with nu = 0.3


@dataclass(frozen=True)
class Meeting:
    """Contact data for a law: its name, the relative principal curvatures [1/m] at the nearest points, the smaller
    one first, and the radius [m] of the first surface."""

    label: str
    curvatures: tuple[float, float]
    radius: float


@dataclass(frozen=True)
class Approach:
    """A law as the kernels read it (`warpffrf_kernels.lumped.approach_laws`).

    F = stiffness a^exponent, or straight between the lines of `table` (n, 2) of approach [m] and force [N]. Of a law by
    laminae `z` (m,) [m] are their positions on the first surface from its middle, `drop` (m,) [m] is the drop of its
    profile there, and every lamina has the m-th part of the force; other laws have none. shear: kappa.
    """

    stiffness: float = 0.0
    exponent: float = 1.0
    table: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    z: np.ndarray = field(default_factory=lambda: np.zeros(0))
    drop: np.ndarray = field(default_factory=lambda: np.zeros(0))
    shear: float = STEEL_SHEAR


@dataclass(frozen=True, kw_only=True)
class LumpedLaw(ABC):
    """A law of lumped contacts: a frozen dataclass with a `kind` and `approach`. Scene files refer to those in
    `warpffrf.model.laws.lumped.LUMPED_LAWS` by their kind.

    damping [s/m], chi, not negative; or restitution (0 < e <= 1) with the impact_speed [m/s] for which it is specified.
    Raises `InputError`.
    """

    damping: float = 0.0
    restitution: float | None = None
    impact_speed: float | None = None
    kind: ClassVar[str] = ""
    by_laminae: ClassVar[bool] = False  # the first surface is a roller, whose laminae each meet the other surface

    def __post_init__(self) -> None:
        name = type(self).__name__
        self._keep("damping", require_number(self.damping, f"{name}: damping [s/m]", non_negative=True))
        if (self.restitution is None) != (self.impact_speed is None):
            raise InputError(f"{name}: restitution and impact_speed belong together")
        if self.restitution is not None:
            if self.damping:
                raise InputError(f"{name}: give damping, or restitution with its impact_speed, not both")
            e = require_number(self.restitution, f"{name}: restitution", positive=True)
            if e > 1.0:
                raise InputError(f"{name}: restitution must be at most 1, got {e:g}")
            self._keep("restitution", e)
            speed = require_number(self.impact_speed, f"{name}: impact_speed [m/s]", positive=True)
            self._keep("impact_speed", speed)

    @property
    def chi(self) -> float:
        """Damping [s/m], also where the restitution is given."""
        if self.restitution is None or self.impact_speed is None:
            return self.damping
        return chi_times_speed(self.restitution) / self.impact_speed

    @abstractmethod
    def approach(self, meeting: Meeting) -> Approach:
        """The law between two surfaces with the contact data `meeting`. Raises `InputError` where it does not apply."""

    def patch(self, meeting: Meeting) -> Patch | None:
        """Size of the patch at each point between two surfaces with the contact data `meeting`, None for a law without
        a patch. Raises `InputError` as `approach`."""
        return None

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, **asdict(self)}

    def _keep(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True)
class PowerForce(LumpedLaw):
    """F = stiffness * approach^exponent where two surfaces touch in a point.

    stiffness [N/m^exponent] positive, exponent at least 1. shear: tangential stiffness over the normal one, of friction
    that sticks. damping, restitution and impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    stiffness: float
    exponent: float = 1.5
    _: KW_ONLY
    shear: float = STEEL_SHEAR
    kind: ClassVar[str] = "power_force"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, unit in (("stiffness", " [N/m^exponent]"), ("exponent", ""), ("shear", "")):
            self._keep(name, require_number(getattr(self, name), f"PowerForce: {name}{unit}", positive=True))
        if self.exponent < 1.0:
            raise InputError(
                f"PowerForce: exponent must be at least 1, got {self.exponent:g}: the stiffness would be infinite at "
                "touch; use laws.TabulatedForce"
            )

    def approach(self, meeting: Meeting) -> Approach:
        return Approach(self.stiffness, self.exponent, shear=self.shear)


@named_arguments
@dataclass(frozen=True)
class TabulatedForce(LumpedLaw):
    """`forces` (n,) [N] at the approaches (n,) [m], both rising strictly, the first force zero; below the first
    approach, which may be negative, there is none. For surfaces that touch in a point.

    shear [-]: tangential stiffness over the normal one, of friction that sticks. damping, restitution and impact_speed
    as in `LumpedLaw`. Raises `InputError` for a table that is not monotonic.
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
            raise InputError(f"TabulatedForce: at most {MOST_POINTS} points, got {len(a)}; remove points")
        for name, values in (("approaches", a), ("forces", F)):
            if np.any(falls := np.diff(values) <= 0.0):
                i = int(np.argmax(falls))
                raise InputError(
                    f"TabulatedForce: the table is not monotonic, {name} must rise strictly, got {values[i]:g} and "
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
