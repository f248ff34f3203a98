"""Flexible multibody simulation with distributed contact: FE bodies reduced to modes, contact inside the local solve.

    import warpffrf as wf

Public names are loaded on first use, so that importing the package is fast and does not load the viewer, plotting or
mesh libraries.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpffrf import examples, study
    from warpffrf.model import (
        bearings,
        control,
        damping,
        films,
        forces,
        gears,
        integrators,
        joints,
        laws,
        mesh,
        oils,
        sensors,
        signals,
        surfaces,
    )
    from warpffrf.model.contact import Contact
    from warpffrf.model.errors import InputError, RunError
    from warpffrf.model.films import Film
    from warpffrf.model.lumped_contact import LumpedContact
    from warpffrf.model.material import Material
    from warpffrf.model.messages.progress import quiet
    from warpffrf.model.messages.status import Status
    from warpffrf.model.reduced.body import ReducedBody
    from warpffrf.model.reduced.stress_field import StressPoints
    from warpffrf.model.scene import Scene
    from warpffrf.model.small_sliding import SmallSliding
    from warpffrf.offline import ContactGrid, ReductionOptions, bases, half_space_body, reduce, rigid_film_body
    from warpffrf.offline.contact.contact_grid import contact_spacing
    from warpffrf.online import LocalModes
    from warpffrf.online.stages import Stage
    from warpffrf.output.campbell import campbell
    from warpffrf.output.comparison import compare
    from warpffrf.output.connector import Connector
    from warpffrf.output.modes_result import eigenmodes
    from warpffrf.output.options import RunOptions
    from warpffrf.output.recording.recorder import record
    from warpffrf.output.result import Result
    from warpffrf.output.simulate import equilibrium, simulate, static
    from warpffrf.output.simulation import Simulation
    from warpffrf.output.worlds import equilibria, simulate_worlds
    from warpffrf.scene_file import load_scene, run_scene

__version__ = "0.1.0"

__all__ = [
    "Connector",
    "Contact",
    "ContactGrid",
    "Film",
    "InputError",
    "LocalModes",
    "LumpedContact",
    "Material",
    "ReducedBody",
    "ReductionOptions",
    "Result",
    "RunError",
    "RunOptions",
    "Scene",
    "Simulation",
    "SmallSliding",
    "Stage",
    "Status",
    "StressPoints",
    "bases",
    "bearings",
    "campbell",
    "compare",
    "contact_spacing",
    "control",
    "damping",
    "eigenmodes",
    "equilibria",
    "equilibrium",
    "examples",
    "films",
    "forces",
    "gears",
    "half_space_body",
    "integrators",
    "joints",
    "laws",
    "load_scene",
    "mesh",
    "oils",
    "quiet",
    "record",
    "reduce",
    "rigid_film_body",
    "run_scene",
    "sensors",
    "signals",
    "simulate",
    "simulate_worlds",
    "static",
    "study",
    "surfaces",
]

# public name -> module, and the attribute there (None: the module itself)
_WHERE: dict[str, tuple[str, str | None]] = {
    "Connector": ("warpffrf.output.connector", "Connector"),
    "Contact": ("warpffrf.model.contact", "Contact"),
    "ContactGrid": ("warpffrf.offline", "ContactGrid"),
    "Film": ("warpffrf.model.films", "Film"),
    "half_space_body": ("warpffrf.offline", "half_space_body"),
    "InputError": ("warpffrf.model.errors", "InputError"),
    "LocalModes": ("warpffrf.online", "LocalModes"),
    "LumpedContact": ("warpffrf.model.lumped_contact", "LumpedContact"),
    "Material": ("warpffrf.model.material", "Material"),
    "ReducedBody": ("warpffrf.model.reduced.body", "ReducedBody"),
    "ReductionOptions": ("warpffrf.offline", "ReductionOptions"),
    "Result": ("warpffrf.output.result", "Result"),
    "RunError": ("warpffrf.model.errors", "RunError"),
    "RunOptions": ("warpffrf.output.options", "RunOptions"),
    "Scene": ("warpffrf.model.scene", "Scene"),
    "Simulation": ("warpffrf.output.simulation", "Simulation"),
    "SmallSliding": ("warpffrf.model.small_sliding", "SmallSliding"),
    "Stage": ("warpffrf.online.stages", "Stage"),
    "Status": ("warpffrf.model.messages.status", "Status"),
    "StressPoints": ("warpffrf.model.reduced.stress_field", "StressPoints"),
    "bases": ("warpffrf.offline.bases", None),
    "bearings": ("warpffrf.model.bearings", None),
    "campbell": ("warpffrf.output.campbell", "campbell"),
    "compare": ("warpffrf.output.comparison", "compare"),
    "contact_spacing": ("warpffrf.offline.contact.contact_grid", "contact_spacing"),
    "control": ("warpffrf.model.control", None),
    "damping": ("warpffrf.model.damping", None),
    "eigenmodes": ("warpffrf.output.modes_result", "eigenmodes"),
    "equilibria": ("warpffrf.output.worlds", "equilibria"),
    "equilibrium": ("warpffrf.output.simulate", "equilibrium"),
    "examples": ("warpffrf.examples", None),
    "films": ("warpffrf.model.films", None),
    "forces": ("warpffrf.model.forces", None),
    "gears": ("warpffrf.model.gears", None),
    "integrators": ("warpffrf.model.integrators", None),
    "joints": ("warpffrf.model.joints", None),
    "laws": ("warpffrf.model.laws", None),
    "load_scene": ("warpffrf.scene_file", "load_scene"),
    "mesh": ("warpffrf.model.mesh", None),
    "oils": ("warpffrf.model.oils", None),
    "quiet": ("warpffrf.model.messages.progress", "quiet"),
    "record": ("warpffrf.output.recording.recorder", "record"),
    "reduce": ("warpffrf.offline", "reduce"),
    "rigid_film_body": ("warpffrf.offline", "rigid_film_body"),
    "run_scene": ("warpffrf.scene_file", "run_scene"),
    "sensors": ("warpffrf.model.sensors", None),
    "signals": ("warpffrf.model.signals", None),
    "simulate": ("warpffrf.output.simulate", "simulate"),
    "simulate_worlds": ("warpffrf.output.worlds", "simulate_worlds"),
    "static": ("warpffrf.output.simulate", "static"),
    "study": ("warpffrf.study", None),
    "surfaces": ("warpffrf.model.surfaces", None),
}


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        from warpffrf.model.errors import no_attribute

        no_attribute(__name__, __all__)(name)
    module_name, attribute = _WHERE[name]
    module = importlib.import_module(module_name)
    value = module if attribute is None else getattr(module, attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
