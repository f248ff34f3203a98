r"""What all laws of contact have in common: the layer that lies between two surfaces, pressure against depth.

With the gap g [m] between the deformed surfaces, negative where they enter one another, d = -g is the *depth* by which
the layer is compressed. A layer is a rising curve p = P(d), zero below a depth d_0 (0 for a layer that begins at touch,
negative for one that reaches out), and holds the energy

    W(d) = int_d0^d P(e) de        [J/m^2].

A law that also depends on how fast it is compressed has p = P(d) (1 + chi d_dot), cut at zero: surfaces do not pull.
The part P(d) alone is elastic; p - P(d) dissipates (p - P) d_dot >= 0.

The solver wants the inverse: contact is solved for pressures (`warpffrf_kernels.layers.weak_layer`), in which a layer
is the yield y(p) = P^-1(p). P must rise strictly, with a slope that is nowhere zero: laws whose slope would vanish at
touch are shifted by a depth far below any of use, and say so."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np


@dataclass(frozen=True)
class Curve:
    """A law as the kernels read it (`warpffrf_kernels.layers.layer_laws`): the name of its form, its numbers, and the
    table (n, 2) of depth [m] and pressure [Pa] of a tabulated one."""

    form: str
    numbers: tuple[float, ...]
    table: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    damping: float = 0.0  # s/m, chi of the module docstring


class Law(Protocol):
    """A contact law: a frozen dataclass with a `kind`, listed in `warpffrf.model.laws.LAWS`."""

    kind: ClassVar[str]

    @property
    def compliance(self) -> float:
        """Constant yield [m/Pa] of what lies between; 0 where there is none, or it is no constant."""
        ...

    @property
    def curve(self) -> Curve | None:
        """The curve of a layer whose yield is no constant, else None."""
        ...

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        ...
