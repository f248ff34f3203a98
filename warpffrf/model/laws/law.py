r"""What all laws of contact have in common: the layer that lies between two surfaces, pressure against depth.

With the gap g [m] between the deformed surfaces, negative where they enter one another, d = -g is the *depth* by which
the layer is compressed. A layer is a rising curve p = P(d), zero below a depth d_0 (0 for a layer that begins at touch,
negative for one that reaches out), and holds the energy

    W(d) = int_d0^d P(e) de        [J/m^2].

A law that also depends on how fast it is compressed has p = P(d) (1 + chi d_dot), cut at zero: surfaces do not pull.
The part P(d) alone is elastic; p - P(d) dissipates (p - P) d_dot >= 0. P must then be convex, so that a step has one
depth for each pressure.

The solver wants the inverse: contact is solved for pressures (`warpffrf_kernels.layers.weak_layer`), in which a layer
is the yield y(p) = P^-1(p). All readers, checks of a run and references of the tests too, have what they need from
the law's `curve` and `chi`: a law is a name, its parameters and these.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.laws.curves import Curve


class Law(ABC):
    """A contact law: a frozen dataclass with a `kind` and a `curve`. Those in `warpffrf.model.laws.LAWS` are known to
    scene files by their kind."""

    kind: ClassVar[str]

    @property
    @abstractmethod
    def curve(self) -> Curve | None:
        """Pressure against depth; None where nothing lies between the surfaces."""

    @property
    def chi(self) -> float:
        """Damping [s/m] of the module docstring."""
        return 0.0

    @property
    def remark(self) -> str:
        """What the report of a run is to say of the law, behind the name of its contact."""
        return ""

    @property
    def compliance(self) -> float:
        """Constant yield [m/Pa] of what lies between; 0 where there is none, or it is no constant."""
        return 0.0 if self.curve is None else self.curve.compliance

    @property
    def bent(self) -> Curve | None:
        """The curve of a layer whose yield is no constant, else None."""
        return None if self.curve is None or self.curve.compliance else self.curve

    def pressure(self, gap: Any, closing_speed: Any = 0.0) -> np.ndarray:
        """Pressure [Pa] at the gaps [m], with the closing_speed [m/s] at which they become less, shapes that
        broadcast."""
        elastic = self._given.pressure(-np.asarray(gap, float))
        if not self.chi:
            return elastic
        return np.maximum(elastic * (1.0 + self.chi * np.asarray(closing_speed, float)), 0.0)

    def energy(self, gap: Any) -> np.ndarray:
        """Elastic energy [J/m^2] of the layer at the gaps [m], any shape."""
        return self._given.energy(-np.asarray(gap, float))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}

    @property
    def _given(self) -> Curve:
        if self.curve is None:
            raise TypeError(f"{self.kind}: nothing lies between the surfaces, there is no pressure to a gap")
        return self.curve
