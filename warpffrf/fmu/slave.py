"""The class of the FMI 2.0 slave, for the library pythonfmu, which is in the FMU; its instance is in `instance.py`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real, String  # type: ignore[import-not-found]
from pythonfmu.enums import Fmi2Status  # type: ignore[import-not-found]

from warpffrf.fmu.instance import STATUS, Instance, from_bytes, to_bytes
from warpffrf.fmu.units import base_powers


class Quantity(Real):
    """A number with a unit, "" for none."""

    def __init__(self, name: str, unit: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._unit = unit

    def to_xml(self) -> Element:
        node = super().to_xml()
        if self._unit:
            node[0].set("unit", self._unit)
        return node


class SceneSlave(Fmi2Slave):
    """A scene as an FMI 2.0 slave; what it is made of is in the definition in its resources."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._instance = instance = Instance(Path(self.resources), lambda said: self.log(said, Fmi2Status.error))  # pyright: ignore[reportArgumentType]
        known = instance.definition
        self.modelName, self.description = known["identifier"], known["description"]
        self.version, self._units = known["version"], {each["unit"] for each in (*known["inputs"], *known["outputs"])}
        self.default_experiment = DefaultExperiment(start_time=0.0, step_size=instance.step_size)
        for each in known["inputs"]:
            options = {"getter": partial(instance.get, each["name"]), "setter": partial(instance.set, each["name"])}
            self._add(each, Fmi2Causality.input, **options)
        for each in known["outputs"]:
            self._add(each, Fmi2Causality.output, getter=partial(instance.get, each["name"]))
        text = String(
            STATUS, causality=Fmi2Causality.output, variability=Fmi2Variability.discrete,
            description="completed, or what went wrong, and the remedy", getter=lambda: instance.status,
        )  # fmt: skip
        self.register_variable(text, nested=False)

    def _add(self, known: dict[str, str], causality: Any, **options: Any) -> None:
        self.register_variable(Quantity(known["name"], known["unit"], causality=causality, **options), nested=False)

    def to_xml(self, model_options: dict[str, str] = {}) -> Element:  # noqa: B006 (that of the library)
        """The model description of the library, with units, free names, and outputs that no present input acts on."""
        root = super().to_xml(model_options)
        root.set("variableNamingConvention", "flat")
        units = Element("UnitDefinitions")
        for unit in sorted(self._units - {""}):
            powers = base_powers(unit)
            node = SubElement(units, "Unit", name=unit)
            if powers is not None:
                SubElement(node, "BaseUnit", {base: str(power) for base, power in powers.items()})
        if len(units):
            root.insert(1, units)  # after CoSimulation
        structure = root.find("ModelStructure")
        assert structure is not None
        outputs = structure.find("Outputs")
        assert outputs is not None
        unknowns = SubElement(structure, "InitialUnknowns")
        for output in outputs:
            SubElement(unknowns, "Unknown", index=output.attrib["index"])
            output.set("dependencies", "")
        return root

    # --- calls of the importing tool

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self._instance.begin(start_time)

    def exit_initialization_mode(self) -> None:
        self._instance.end_initialisation()

    def do_step(self, current_time: float, step_size: float) -> bool:
        return self._instance.step(current_time, step_size)

    def _get_fmu_state(self) -> dict[str, Any]:
        return self._instance.state()

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        self._instance.put(state)

    _fmu_state_to_bytes = staticmethod(to_bytes)
    _fmu_state_from_bytes = staticmethod(from_bytes)  # pyright: ignore[reportAssignmentType]
