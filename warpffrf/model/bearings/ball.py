"""Ball bearings: deep-groove and angular-contact ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpffrf.model import laws, surfaces
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.bearing import ELEMENT_SURFACE, Bearing
from warpffrf.model.bearings.build import (
    assemble,
    checked_deviations,
    checked_laws,
    checked_materials,
    checked_shoulders,
    refuse_name,
)
from warpffrf.model.bearings.cage import STANDING, Cage
from warpffrf.model.bearings.elements import RigidElements, checked_elements
from warpffrf.model.bearings.geometry import BallRaceways
from warpffrf.model.bearings.parts import BALL_WIDTH, STEEL, Losses, Place, RingSize, solid_ball
from warpffrf.model.bearings.preload import Preload, checked_preload, sense_of
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
    (`warpffrf.model.bearings.parts`). cage: `bearings.PrescribedCage()`, balls at equal angles that stand still,
    `bearings.PocketCage(...)` or None.

    law: of the contacts, or (inner, outer), None for laws.HertzPoint of the materials; friction: as of `LumpedContact`,
    laws.RegularisedCoulomb for a traction that grows with the slip speed up to its bound. rolling_resistance, spin: of
    lumped contacts with the raceways, moments against rolling and pivoting, as of `LumpedContact`; distributed contact
    has the friction of pivoting in its tractions.
    inner_form, outer_form: how a raceway deviates around its axis, of `warpffrf.films`, positive where material is
    missing, angles from the first ball: films.LobedForm(5e-6, 2) is oval; of rigid rings. diameter_deviations
    (elements,) [m]: what each ball is thicker by. material: of rings and balls, element_material: of other balls.
    element_body: the reduced body of every ball, None for rigid ones (`warpffrf.model.bearings.elements`); its contact
    is distributed. shoulders [m]: height over the bottom of the groove, one or (inner, outer), with which results say
    how much of a patch is cut off.

    Raises `InputError` for what does not fit together (`warpffrf.model.bearings.geometry`).
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
