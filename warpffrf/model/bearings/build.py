"""Common part of the builders of ball and roller bearings: rings, elements, contacts, cage, in this order.

Ball bearings: deep-groove and angular-contact ones.

Roller. Cylindrical roller bearings.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import laws, surfaces
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.bearing import ELEMENT_SURFACE, Bearing
from warpffrf.model.bearings.elements import STANDING, Cage, Elements, RigidElements, checked_elements
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.geometry import BallRaceways, Raceways, RollerRaceways
from warpffrf.model.bearings.parts import (
    BALL_WIDTH,
    ROLLER_OVERHANG,
    SIDES,
    STEEL,
    Losses,
    Place,
    Preload,
    RingSize,
    checked_preload,
    contact_of,
    hollow_cylinder,
    ring_surface,
    sense_of,
    solid_ball,
)
from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.laws.lumped import LumpedLaw, as_lumped_law
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import RollingResistance
from warpffrf.model.reduced.body import ReducedBody
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
            f"{label}: diameter_deviations are deviations from the nominal diameter, some micrometres, got "
            f"{found[np.argmax(np.abs(found))]:g} m, more than {most:.3g} m"
        )
    return found


def refuse_name(scene: Scene, name: Any) -> None:
    """Raises `InputError` for a name that is not a text, or is used by another bearing."""
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


OSCULATION = 0.52  # of groove radius over ball diameter, where nothing is given: a deep-groove bearing's

KINDS = ("sphere", "crowned_cylinder")  # of surfaces of flexible elements


@named_arguments
def add_ball_bearing(
    scene: Scene,
    name: str,
    *,
    elements: int,
    ball_diameter: float,
    pitch_diameter: float,
    osculation: float | tuple[float, float] = OSCULATION,
    contact_angle: float = 0.0,
    clearance: float = 0.0,
    preload: Preload | None = None,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    inner: Body | Ground | SurfacePort | None = None,
    outer: Body | Ground | SurfacePort | None = None,
    cage: Cage | None = STANDING,
    law: LumpedLaw | tuple[LumpedLaw, LumpedLaw] | None = None,
    friction: FrictionLike = 0.0,
    rolling_resistance: RollingResistance | None = None,
    spin: bool = False,
    inner_form: Form | None = None,
    outer_form: Form | None = None,
    diameter_deviations: Any = None,
    material: Material = STEEL,
    element_material: Material | None = None,
    element_body: ReducedBody | None = None,
    shoulders: float | tuple[float, float] | None = None,
    width: float | None = None,
    bore: float | None = None,
    outside_diameter: float | None = None,
) -> Bearing:
    """Add a ball bearing: rings, `elements` balls, their contacts and a cage; returns them as a `Bearing`.

    ball_diameter, pitch_diameter [m]. osculation: groove radius over ball diameter, above 0.5, one number or (inner,
    outer). contact_angle [rad], at which the balls just touch both rings, positive where thrust on the inner ring along
    the axis presses the bearing together; or clearance [m], diametral, negative for an interference, a
    radial preload. preload: an axial one, `bearings.PreloadForce(newtons)` or `bearings.PreloadOffset(metres)`.

    position (3,) [m]: the centre, axis (3,), first (3,): direction of the first ball from the axis, world axes at the
    initial pose; first None: +x made perpendicular to the axis. inner, outer: a rigid body or `scene.ground`, which get
    a raceway; a contact surface `body["rim"]` of a flexible body, whose contact is then distributed; None: a rigid
    ring, free, "<name> inner ring", of `material`, with bore, outside_diameter and width [m]
    (`warpffrf.model.bearings.parts`). cage: `bearings.PrescribedCage()`, stationary balls at equal angles,
    `bearings.PocketCage(...)` or None.

    law: of the contacts, or (inner, outer), None for laws.HertzPoint of the materials; friction: as of `LumpedContact`,
    laws.RegularisedCoulomb for a traction that grows with the slip speed up to its bound. rolling_resistance, spin: of
    lumped contacts with the raceways, moments against rolling and pivoting, as of `LumpedContact`; distributed contact
    has the friction of pivoting in its tractions.
    inner_form, outer_form: form deviation of a raceway around its axis, of `warpffrf.films`, positive where material is
    missing, angles from the first ball: films.LobedForm(5e-6, 2) is oval; of rigid rings. diameter_deviations
    (elements,) [m]: excess diameter of each ball. material: of rings and balls, element_material: of other balls.
    element_body: the reduced body of every ball, None for rigid ones (`warpffrf.model.bearings.elements`); its contact
    is distributed. shoulders [m]: height over the bottom of the groove, one or (inner, outer), from which results
    compute the truncated fraction of a patch.

    Raises `InputError` for inconsistent dimensions (`warpffrf.model.bearings.geometry`).
    """
    label = f"bearing {name!r}"
    refuse_name(scene, name)
    D = require_number(ball_diameter, f"{label}: ball_diameter [m]", positive=True)
    pair = osculation if isinstance(osculation, (tuple, list)) else (osculation, osculation)
    if len(pair) != 2:
        raise InputError(f"{label}: osculation is one number, or two, (inner, outer), got {len(pair)}")
    f_i, f_e = (require_number(f, f"{label}: osculation", positive=True) for f in pair)
    raceways = BallRaceways(
        label, elements, D, pitch_diameter, clearance, inner_groove=f_i * D, outer_groove=f_e * D,
        contact_angle=contact_angle,
    )  # fmt: skip
    pressed, sense = checked_preload(label, preload), sense_of(raceways.contact_angle)
    off = {"inner": sense * pressed.offset(label), "outer": 0.0}
    place = Place.of(label, position, axis, first)
    materials = checked_materials(label, material, element_material)
    bearing = Bearing(name, "ball", raceways, place, materials, checked_shoulders(label, shoulders))

    def raceway_of(side: str, body: Body | Ground) -> Any:
        kind = surfaces.Groove if side == "inner" else surfaces.Ring
        where = place.in_user(body, raceways.centre(side)[1] + off[side])
        return kind(radius=raceways.bottom(side), groove_radius=raceways.groove(side), **where)

    def element_of(diameter: float) -> tuple[float, Any, Any]:
        ball = surfaces.Sphere(radius=0.5 * diameter, axis_point=(0.0, 0.0, 0.0), axis_direction=place.axis)
        return (*solid_ball(diameter, materials[0]), ball)

    breadth = BALL_WIDTH * D if width is None else require_number(width, f"{label}: width [m]", positive=True)
    different = checked_deviations(label, raceways, diameter_deviations)
    rigid = RigidElements(ELEMENT_SURFACE, element_of)
    made = checked_elements(label, element_body, rigid, D, KINDS, different, raceways.contact_angle)
    assemble(
        scene, bearing, rings={"inner": inner, "outer": outer}, raceway_of=raceway_of,
        forms={"inner": inner_form, "outer": outer_form},
        deviations=different,
        size=RingSize(label, raceways.pitch_diameter, D, bore, outside_diameter, breadth), elements=made,
        laws=checked_laws(label, law, laws.HertzPoint(*materials)), losses=Losses(friction, rolling_resistance, spin),
        cage=cage,
    )  # fmt: skip
    pressed.press(scene, bearing, sense)
    return bearing


ROLLER_KINDS = ("cylinder", "crowned_cylinder", "profiled_cylinder")  # of surfaces of flexible elements


@named_arguments
def add_roller_bearing(
    scene: Scene,
    name: str,
    *,
    elements: int,
    roller_diameter: float,
    roller_length: float,
    pitch_diameter: float,
    clearance: float = 0.0,
    profile: float | Any | None = None,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    inner: Body | Ground | SurfacePort | None = None,
    outer: Body | Ground | SurfacePort | None = None,
    cage: Cage | None = STANDING,
    flanges: Flanges | None = None,
    law: LumpedLaw | tuple[LumpedLaw, LumpedLaw] | None = None,
    friction: FrictionLike = 0.0,
    rolling_resistance: RollingResistance | None = None,
    inner_form: Form | None = None,
    outer_form: Form | None = None,
    diameter_deviations: Any = None,
    material: Material = STEEL,
    element_material: Material | None = None,
    element_body: ReducedBody | None = None,
    width: float | None = None,
    bore: float | None = None,
    outside_diameter: float | None = None,
) -> Bearing:
    """Add a cylindrical roller bearing: rings, `elements` rollers, their contacts and a cage; returns them as a
    `Bearing`.

    roller_diameter, roller_length, pitch_diameter [m]; roller_length is the effective one. clearance [m], diametral,
    negative for an interference. profile: of the rollers beside what the law says: the crown radius [m], a table (z,
    drop), two arrays (n,) [m] from the middle, as of `surfaces.ProfiledCylinder`, or None for straight ones. law: of
    the contacts, or (inner, outer), None for laws.IsoLamina(roller_length), which has the profile of ISO/TS 16281
    unless one is given here. flanges: `bearings.Flanges(...)`, ribs that stop the rollers along their axes, None for
    rollers that are free along them. As of `add_ball_bearing`: scene, name, position [m], axis and first (3,),
    directions in the world, inner, outer, cage, friction, rolling_resistance, inner_form, outer_form,
    diameter_deviations (elements,) [m], material, element_material, element_body, which has a profile of its own, and
    width, bore and outside_diameter [m]. Raises `InputError` for what does not fit together
    (`warpffrf.model.bearings.geometry`).
    """
    label = f"bearing {name!r}"
    refuse_name(scene, name)
    D = require_number(roller_diameter, f"{label}: roller_diameter [m]", positive=True)
    raceways = RollerRaceways(label, elements, D, pitch_diameter, clearance, length=roller_length)
    place = Place.of(label, position, axis, first)
    materials = checked_materials(label, material, element_material)
    bearing = Bearing(name, "roller", raceways, place, materials)

    def raceway_of(side: str, body: Body | Ground) -> Any:
        kind = surfaces.Cylinder if side == "inner" else surfaces.Bore
        return kind(radius=raceways.bottom(side), **place.in_user(body))

    def element_of(diameter: float) -> tuple[float, Any, Any]:
        return (
            *hollow_cylinder(0.0, diameter, raceways.length, materials[0], place.axis),
            _roller(0.5 * diameter, profile, {"axis_point": (0.0, 0.0, 0.0), "axis_direction": place.axis}),
        )

    breadth = raceways.length + ROLLER_OVERHANG * D
    breadth = breadth if width is None else require_number(width, f"{label}: width [m]", positive=True)
    default = laws.IsoLamina(raceways.length, profile=profile is None)
    if flanges is not None and not isinstance(flanges, Flanges):
        raise InputError(f"{label}: flanges must be bearings.Flanges(...) or None, got {flanges!r}")
    different = checked_deviations(label, raceways, diameter_deviations)
    rigid = RigidElements(ELEMENT_SURFACE, element_of)
    made = checked_elements(label, element_body, rigid, D, ROLLER_KINDS, different)
    assemble(
        scene, bearing, rings={"inner": inner, "outer": outer}, raceway_of=raceway_of,
        forms={"inner": inner_form, "outer": outer_form},
        deviations=different,
        size=RingSize(label, raceways.pitch_diameter, D, bore, outside_diameter, breadth), elements=made,
        laws=checked_laws(label, law, default), losses=Losses(friction, rolling_resistance), cage=cage,
    )  # fmt: skip
    if flanges is not None:
        flanges.hold(scene, bearing)
    return bearing


def _roller(radius: float, profile: Any, where: dict[str, Any]) -> surfaces.Shape:
    """The surface of a roller."""
    if profile is None:
        return surfaces.Cylinder(radius=radius, **where)
    if isinstance(profile, (int, float)):
        return surfaces.CrownedCylinder(radius=radius, crown_radius=float(profile), **where)
    return surfaces.ProfiledCylinder(radius=radius, table=profile, **where)
