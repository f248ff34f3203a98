"""What the builders of ball and roller bearings have in common: rings, elements, contacts, cage, in this order."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.bearings.bearing import Bearing
from warpffrf.model.bearings.cage import Cage
from warpffrf.model.bearings.elements import Elements
from warpffrf.model.bearings.geometry import Raceways
from warpffrf.model.bearings.parts import SIDES, Losses, RingSize, contact_of, ring_surface
from warpffrf.model.bodies import Body, Ground
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.laws.lumped import LumpedLaw, as_lumped_law
from warpffrf.model.material import Material
from warpffrf.model.surfaces.form_deviations import Form

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene
LARGEST_DEVIATION = 1e-2  # of the diameter: beyond, it is the diameter itself


def checked_materials(label: str, material: Any, element_material: Any) -> tuple[Material, Material]:
    """Of the elements and of the rings. Raises `InputError`."""
    element = material if element_material is None else element_material
    for name, value in (("material", material), ("element_material", element)):
        if not isinstance(value, Material):
            raise InputError(f"{label}: {name} must be a Material, got {value!r}")
    return element, material


def checked_laws(label: str, law: Any, default: LumpedLaw) -> tuple[LumpedLaw, LumpedLaw]:
    """On the inner and on the outer ring. Raises `InputError`."""
    pair = (default, default) if law is None else law if isinstance(law, (tuple, list)) else (law, law)
    if len(pair) != 2:
        raise InputError(f"{label}: law is one of warpffrf.laws, or two, (inner, outer), got {len(pair)}")
    first, second = (as_lumped_law(one, label) for one in pair)
    return first, second


def checked_shoulders(label: str, shoulders: Any) -> tuple[float | None, float | None]:
    """Heights [m] of the inner and outer ring's. Raises `InputError`."""
    if shoulders is None:
        return None, None
    pair = shoulders if isinstance(shoulders, (tuple, list)) else (shoulders, shoulders)
    if len(pair) != 2:
        raise InputError(f"{label}: shoulders is one height [m], or two, (inner, outer), got {len(pair)}")
    first, second = (require_number(h, f"{label}: shoulders [m]", positive=True) for h in pair)
    return first, second


def checked_deviations(label: str, raceways: Raceways, deviations: Any) -> np.ndarray:
    """(count,) m, of the elements' diameters. Raises `InputError`."""
    if deviations is None:
        return np.zeros(raceways.count)
    found = require_array(deviations, f"{label}: diameter_deviations [m]", (raceways.count,))
    most = LARGEST_DEVIATION * raceways.diameter
    if np.max(np.abs(found)) > most:
        raise InputError(
            f"{label}: diameter_deviations are what the elements differ by from their diameter, some micrometres, got "
            f"{found[np.argmax(np.abs(found))]:g} m, more than {most:.3g} m"
        )
    return found


def refuse_name(scene: Scene, name: Any) -> None:
    """Raises `InputError` for a name that is no text, or that another bearing has."""
    if not isinstance(name, str) or not name or "/" in name:
        raise InputError(f"scene: the name of a bearing must be a non-empty text without '/', got {name!r}")
    if name in [bearing.name for bearing in scene.bearings]:
        raise InputError(f"scene: the name {name!r} of a bearing is taken, choose another")


def assemble(
    scene: Scene,
    bearing: Bearing,
    *,
    rings: dict[str, Any],
    forms: dict[str, Form | None],
    deviations: np.ndarray,
    raceway_of: Callable[[str, Body | Ground], Any],
    size: RingSize,
    elements: Elements,
    laws: tuple[LumpedLaw, LumpedLaw],
    losses: Losses,
    cage: Cage | None,
) -> Bearing:
    """Add the parts of `bearing` to the scene and return it.

    raceway_of: shape of the raceway of a side in user axes of the ring's body, forms: deviations of them; deviations:
    of the elements' diameters.
    """
    if cage is not None and not isinstance(cage, Cage):
        raise InputError(
            f"bearing {bearing.name!r}: cage must be bearings.PrescribedCage(...), bearings.PocketCage(...) or None, "
            f"got {cage!r}"
        )
    place, raceways = bearing.place, bearing.raceways
    bearing.element_surface = elements.surface
    ports = {}
    for side in SIDES:
        body, ports[side] = ring_surface(
            scene, bearing.name, side, rings[side], lambda body, side=side: raceway_of(side, body), size, place,
            bearing.materials[1], forms[side],
        )  # fmt: skip
        setattr(bearing, side, body)
    if bearing.inner is bearing.outer:
        raise InputError(f"bearing {bearing.name!r}: inner and outer are both {bearing.inner.name!r}; name two bodies")
    for i, angle in enumerate(raceways.angles, start=1):
        element = elements.add(
            scene, f"{bearing.name} {bearing.kind} {i}", place, 0.5 * raceways.pitch_diameter, float(angle),
            raceways.diameter + float(deviations[i - 1]),
        )  # fmt: skip
        bearing.elements.append(element)
        for side, law in zip(SIDES, laws, strict=True):
            name = f"{bearing.name} {side} {i}"
            contact = contact_of(element[bearing.element_surface], ports[side], law, losses, name)
            bearing.contacts[f"{side}_{i}"] = scene.add(contact)
    if cage is not None:
        cage.hold(scene, bearing)
    scene.bearings.append(bearing)
    return bearing
