"""What the temperature of a flexible body depends on, besides its material: surfaces by which heat leaves it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oil_temperature import temperature_of


@named_arguments
@dataclass(frozen=True)
class BodyTemperature:
    """The temperature of a flexible body, for `reduce(thermal=...)`: heat is conducted between its contact surfaces,
    which films heat, and the surfaces named here; all others are insulated.

    convection: {facet set: (h, T)}, h [W/(m2 K)] the coefficient of heat transfer to surroundings of temperature T
    [degrees Celsius]. fixed: {facet set: T}, surfaces of given temperature. Both temperatures can be changed later.
    reference [degrees Celsius]: at which the body has the dimensions of its mesh. modes: slowest modes of the body's
    temperature that are kept, besides its responses to heating of each contact surface and to these surroundings.

    Its material requires conductivity, heat_capacity and expansion. Raises `InputError`, also where heat has no way to
    leave.

    >>> wf.films.BodyTemperature(convection={"back": (200.0, 40.0)}).reference
    20.0
    """

    convection: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    reference: float = 20.0
    modes: int = 12

    def __post_init__(self) -> None:
        label = "films.BodyTemperature"
        for name, example in (("convection", '{"back": (200.0, 40.0)}'), ("fixed", '{"bore": 40.0}')):
            given = getattr(self, name)
            if not isinstance(given, Mapping) or not all(isinstance(key, str) for key in given):
                raise InputError(f"{label}: {name} must be {{facet set: ...}}, such as {example}; got {given!r}")
        convection = {}
        for name, pair in self.convection.items():
            h, T = require_array(pair, f"{label}: convection of {name!r}, (h, T)", (2,))
            require_number(h, f"{label}: convection of {name!r}: h [W/(m2 K)]", positive=True)
            convection[name] = (float(h), temperature_of(T, f"{label}: convection of {name!r}"))
        fixed = {name: temperature_of(T, f"{label}: fixed {name!r}") for name, T in self.fixed.items()}
        if both := [name for name in fixed if name in convection]:
            raise InputError(f"{label}: {both[0]!r} has a given temperature and convection; leave one of them out")
        if not convection and not fixed:
            raise InputError(
                f"{label}: heat has no way to leave the body, its temperature would rise for ever; name surfaces with "
                "convection={facet set: (h, T)} or fixed={facet set: T}"
            )
        object.__setattr__(self, "convection", convection)
        object.__setattr__(self, "fixed", fixed)
        object.__setattr__(self, "reference", temperature_of(self.reference, f"{label}: reference"))
        object.__setattr__(self, "modes", require_count(self.modes, f"{label}: modes", 0))

    @property
    def temperatures(self) -> dict[str, float]:
        """Temperature [degrees Celsius] of each surface by which heat leaves, those with convection first."""
        return {name: T for name, (_, T) in self.convection.items()} | dict(self.fixed)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {
            "convection": [[name, *pair] for name, pair in self.convection.items()],
            "fixed": [[name, T] for name, T in self.fixed.items()],
            "reference": self.reference,
            "modes": self.modes,
        }
