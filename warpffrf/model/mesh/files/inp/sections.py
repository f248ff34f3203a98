"""*Solid Section and *Material -> {cell set: Material} in SI units.

A deck has no units: its numbers form the consistent system that follows from the unit of length (`units`).
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.files.inp.body import OWN, Body
from warpffrf.model.mesh.files.inp.model import Deck, MaterialText, Section, fold
from warpffrf.model.mesh.files.inp.solid import Solid
from warpffrf.model.mesh.files.units import system_of


def sections_of(deck: Deck, body: Body, solid: Solid) -> list[tuple[str, MaterialText]]:
    """Element sets (their names) that hold cells, with their materials.

    Raises `InputError` for an unknown set or material and for a set with two sections.
    """
    found: dict[str, tuple[str, MaterialText]] = {}
    for scope in body.own:
        for section in scope.sections:
            material = _material(deck, section)
            members = body.members(OWN, "elset", section.elset, section.place)
            definition = body.definition(OWN, "elset", section.elset)
            if definition is None or not len(solid.cell_numbers(members)):
                continue
            key = fold(section.elset)
            if key in found and found[key][1] is not material:
                raise section.place.fault(f"element set {section.elset!r} has a section of another material already")
            found[key] = (definition.name, material)
    return list(found.values())


def _material(deck: Deck, section: Section) -> MaterialText:
    material = deck.materials.get(fold(section.material))
    if material is None:
        known = ", ".join(repr(m.name) for m in deck.materials.values()) or "none"
        raise section.place.fault(f"there is no material {section.material!r}; known: {known}")
    return material


def materials_of(sections: list[tuple[str, MaterialText]], length_unit: str, notes: list[str]) -> dict[str, Material]:
    """{cell set: Material} [SI] of the sections; what cannot be taken over is said in `notes`."""
    if not sections:
        return {}
    system = system_of(length_unit, notes)
    if system is None:
        return {}
    stress, density, units = system
    made: dict[str, Material] = {}
    for elset, text in sections:
        for note in dict.fromkeys(text.notes):
            notes.append(f"material {text.name!r}: {note}")
        material = _si(text, stress, density, notes)
        if material is not None:
            made[elset] = material
    if made:
        notes.append(f"materials are read in {units}, the system that goes with lengths in {length_unit}")
    return made


def _si(text: MaterialText, stress: float, density: float, notes: list[str]) -> Material | None:
    faults = list(text.faults)
    if text.elastic is None and not faults:
        faults.append("it has no *Elastic")
    if text.density is None:
        faults.append("it has no *Density")
    if text.elastic is not None and text.density is not None and not faults:
        try:
            with np.errstate(over="ignore"):
                return Material(stress * text.elastic[0], text.elastic[1], density * text.density, name=text.name)
        except InputError as error:
            faults.append(str(error))
    notes.append(f"material {text.name!r} ({text.place}) is not taken over: {'; '.join(faults)}")
    return None
