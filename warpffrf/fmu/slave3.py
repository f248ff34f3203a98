"""The class of the FMI 3.0 slave, for the library pythonfmu3, which is in the FMU; its instance is in `instance.py`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from pythonfmu3 import (  # type: ignore[import-not-found]
    DefaultExperiment,
    Float64,
    Fmi3Causality,
    Fmi3Initial,
    Fmi3Slave,
    Fmi3Status,
    Fmi3StepResult,
    Fmi3Variability,
    String,
    Unit,
)

from warpffrf.fmu.instance import STATUS, TIME, Instance, from_bytes, to_bytes
from warpffrf.fmu.units import base_powers


class SceneSlave(Fmi3Slave):
    """A scene as an FMI 3.0 slave; what it is made of is in the definition in its resources."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._instance = instance = Instance(Path(self.resources), lambda said: self.log(said, Fmi3Status.error))  # pyright: ignore[reportArgumentType]
        known = instance.definition
        self.modelName, self.description = known["identifier"], known["description"]
        self.version = known["version"]
        self.default_experiment = DefaultExperiment(start_time=0.0, step_size=instance.step_size)
        units = sorted({each["unit"] for each in (*known["inputs"], *known["outputs"])} - {""})
        self.register_units([Unit(unit, **powers) for unit in units if (powers := base_powers(unit)) is not None])
        time = Float64(
            TIME, causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous,
            getter=lambda: instance.time,
        )  # fmt: skip
        self.register_variable(time, nested=False)
        for each in known["inputs"]:
            options = {"getter": partial(instance.get, each["name"]), "setter": partial(instance.set, each["name"])}
            self._add(each, Fmi3Causality.input, **options)
        for each in known["outputs"]:
            getter = partial(instance.get, each["name"])
            self._add(each, Fmi3Causality.output, getter=getter, initial=Fmi3Initial.calculated)
        text = String(
            STATUS, causality=Fmi3Causality.output, variability=Fmi3Variability.discrete,
            initial=Fmi3Initial.calculated, description="completed, or what went wrong, and the remedy",
            getter=lambda: instance.status,
        )  # fmt: skip
        self.register_variable(text, nested=False)

    def _add(self, known: dict[str, str], causality: Any, **options: Any) -> None:
        unit = known["unit"] if known["unit"] in self.units else None
        self.register_variable(
            Float64(known["name"], causality=causality, variability=Fmi3Variability.continuous, unit=unit, **options),
            nested=False,
        )

    def to_xml(self, model_options: dict[str, str] = {}) -> Element:  # noqa: B006 (that of the library)
        """The model description of the library, with free names, and outputs that no present input acts on."""
        root = super().to_xml(model_options)
        root.set("variableNamingConvention", "flat")
        for output in root.iterfind("ModelStructure/Output"):
            output.set("dependencies", "")
        return root

    # --- calls of the importing tool

    # pythonfmu3 0.3 does not pass the start time on: the first communication point is the start

    def exit_initialization_mode(self) -> None:
        self._instance.end_initialisation()

    def do_step(self, current_time: float, step_size: float) -> Any:
        made = self._instance.step(current_time, step_size)
        return Fmi3StepResult(Fmi3Status.ok if made else Fmi3Status.discard)

    def _get_fmu_state(self) -> dict[str, Any]:
        return self._instance.state()

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self._instance.put(state)

    _fmu_state_to_bytes = staticmethod(to_bytes)
    _fmu_state_from_bytes = staticmethod(from_bytes)  # pyright: ignore[reportAssignmentType]
