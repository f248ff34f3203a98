"""Cylindrical roller bearings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpffrf.model import laws, surfaces
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.bearing import ELEMENT_SURFACE, Bearing
from warpffrf.model.bearings.build import assemble, checked_deviations, checked_laws, checked_materials, refuse_name
from warpffrf.model.bearings.cage import STANDING, Cage
from warpffrf.model.bearings.elements import RigidElements, checked_elements
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.geometry import RollerRaceways
from warpffrf.model.bearings.parts import ROLLER_OVERHANG, STEEL, Losses, Place, RingSize, hollow_cylinder
from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.laws.lumped import LumpedLaw
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import RollingResistance
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces.form_deviations import Form

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

KINDS = ("cylinder", "crowned_cylinder", "profiled_cylinder")  # of surfaces of flexible elements


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
    unless one is given here. flanges: `bearings.Flanges(...)`, ribs that stop the rollers
    along their axes, None for rollers that are free along them.
    As of `add_ball_bearing`: scene, name, position [m], axis and first (3,), directions in the world, inner, outer,
    cage, friction, rolling_resistance, inner_form, outer_form, diameter_deviations (elements,) [m], material,
    element_material, element_body, which has a profile of its own, and width, bore and outside_diameter [m]. Raises
    `InputError` for what does not fit together (`warpffrf.model.bearings.geometry`).
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
    made = checked_elements(label, element_body, rigid, D, KINDS, different)
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
