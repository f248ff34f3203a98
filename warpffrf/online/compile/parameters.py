"""Constants of the device that a `Simulation` changes between its steps: each is one number of an array, or a few.

A change acts from the beginning of the next step on. With the stiffness of a spring its energy jumps without motion,

    dE = 1/2 (k_1 - k_0) (c - c_0)^2,

booked as work of forces, as by `warpffrf.online.stages`; the others have no energy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.films.film import Film
from warpffrf.model.oil_temperature import temperature_of
from warpffrf.online.compile.films.tables import oil_numbers

if TYPE_CHECKING:
    from warpffrf.online.compile.scene import CompiledScene

MARK = "parameters"  # of a checkpoint: the values, where any was changed


@dataclass(frozen=True)
class Parameter:
    """A constant with its value in the scene: entries `at` of the array `name` of the struct `owner` on the device,
    which have the `numbers` of a value. row: of a spring with this stiffness, -1 without."""

    unit: str
    initial: float
    owner: Any
    name: str
    at: tuple[int, ...]
    positive: bool = False  # it has to be
    numbers: Callable[[float], Sequence[float] | float] = float
    row: int = -1


class Parameters:
    """The constants of a compiled scene that may change, by name, and their values."""

    def __init__(self, compiled: CompiledScene) -> None:
        self.known = dict(_parameters(compiled))
        self.values = {name: each.initial for name, each in self.known.items()}

    def require(self, name: str, value: float) -> None:
        """Raises `InputError` for a value that the parameter called `name` cannot have."""
        each = self.known[name]
        if each.unit == "degC":
            temperature_of(value, f"Simulation: parameter {name!r}")
        elif value < 0.0 or (each.positive and value == 0.0):
            least = "positive" if each.positive else "at least 0"
            raise InputError(f"Simulation: parameter {name!r} must be {least}, got {value:g}")

    def set(self, values: Mapping[str, float], stretch: Callable[[int], float]) -> float:
        """Give parameters, by name, new `values`; returns the energy [J] that springs gain, with the coordinates
        `stretch` of their rows."""
        gained = 0.0
        for name, value in values.items():
            each = self.known[name]
            if each.row >= 0:
                off = stretch(each.row) - float(each.owner.reference.numpy()[each.row])
                gained += 0.5 * (value - self.values[name]) * off**2
            self._put(name, value)
        return gained

    def _put(self, name: str, value: float) -> None:
        each = self.known[name]
        array = getattr(each.owner, each.name)
        numbers = array.numpy().copy()
        numbers[each.at] = each.numbers(value)
        array.assign(numbers)
        self.values[name] = value

    def checkpoint(self) -> dict[str, np.ndarray]:
        """The values; empty as long as they are those of the scene."""
        changed = any(value != self.known[name].initial for name, value in self.values.items())
        return {MARK: np.array(list(self.values.values()))} if changed else {}

    def resume(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """The values of a checkpoint of the same scene, whose energy has them already."""
        initial = [each.initial for each in self.known.values()]
        for name, value in zip(self.known, np.asarray(checkpoint.get(MARK, initial)).tolist(), strict=True):
            if value != self.values[name]:
                self._put(name, value)


def _parameters(compiled: CompiledScene) -> list[tuple[str, Parameter]]:
    """What may change: spring rows of their own, coefficients of friction that do not depend on the slip speed, oils of
    isothermal films."""
    scene, m, elements = compiled.scene, compiled.model, compiled.elements
    found: list[tuple[str, Parameter]] = []
    for name, law in compiled.forces.laws.items():
        if len(law.coordinates) != 1 or law.elastic or law.viscous:
            continue
        row = compiled.forces.rows[name][0]
        per = "N{}/m" if law.coordinates[0].kind in ("translation", "distance") else "N m{}/rad"
        for kind, unit, own in (("stiffness", per.format(""), row), ("damping", per.format(" s"), -1)):
            value = float(getattr(law, kind)[0, 0])
            if value > 0.0:  # a row that has none is another kind of equation
                found.append((f"{kind}[{name}]", Parameter(unit, value, m.rows, kind, (row,), positive=True, row=own)))
    rubbing = (
        [(c.name, c.friction, m.pairs, "friction") for c in scene.finite_sliding],
        [(c.name, None if c.moments() else c.friction, elements.lumped, "friction") for c in scene.lumped_contacts],
        [(name, law.friction, elements.joint_frictions, "coefficient") for name, law in compiled.slips.laws.items()],
    )
    for items in rubbing:
        for i, (name, law, owner, array) in enumerate(items):
            if law is not None and law.acts and not law.breaks:
                mu = law.largest_coefficient
                found.append((f"friction[{name}]", Parameter("1", mu, owner, array, (i,), positive=True)))
    for i, film in enumerate(scene.films):
        if film.temperature is None and film.oil.thermal is not None:
            found.append((f"oil_temperature[{film.name}]", _of_oil(compiled, i, film)))
    return found


def _of_oil(compiled: CompiledScene, i: int, film: Film) -> Parameter:
    thermal: Any = film.oil.thermal
    return Parameter(
        "degC", float(thermal.temperature), compiled.films, "oil", (i,),
        numbers=lambda temperature: oil_numbers(film.oil.at(temperature))[1],
    )  # fmt: skip
