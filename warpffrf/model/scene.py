"""`Scene`: bodies, joints, drives, forces, contacts and oil films; it describes and checks a model, computes
nothing."""

from __future__ import annotations

import hashlib
import importlib
import json
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from warpffrf.model.arguments import Matrix, RotationLike, Vector
from warpffrf.model.bearings import Bearing
from warpffrf.model.bearings.build import add_bearing
from warpffrf.model.bodies import INERTIA_LEVELS, Body, Ground, PortLike, as_port
from warpffrf.model.cam_pair import CamPair, add_cam
from warpffrf.model.checks.contacts import refuse_double_claims, refuse_double_small_sliding
from warpffrf.model.checks.plausibility import gravity_doubts, warn
from warpffrf.model.contact import Contact
from warpffrf.model.damping import Damping, damping_ratios
from warpffrf.model.errors import (
    InputError,
    require_array,
    require_direction,
    require_inertia,
    require_number,
    unknown_name,
)
from warpffrf.model.films import Film
from warpffrf.model.films.journal_bearing import JournalBearing, add_journal_bearing
from warpffrf.model.films.thrust_bearing import add_thrust_bearing
from warpffrf.model.forces import Pretension
from warpffrf.model.gears.mesh import GearMesh, add_gear_pair
from warpffrf.model.joints import Drive, Joint
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.placement.gap import closing_distance, passed
from warpffrf.model.placement.nearest import joined_bodies, shift_bodies
from warpffrf.model.released import NOTHING
from warpffrf.model.sensors import Sensor
from warpffrf.model.wheelset import Wheelset, add_wheelset

if TYPE_CHECKING:
    from warpffrf.model.checks.scene import SceneCheck
    from warpffrf.model.reduced.body import ReducedBody
    from warpffrf.model.surfaces import Shape

_LISTS = ("joints", "drives", "forces", "contacts")
_LATER_LISTS = ("lumped_contacts", "films")  # described only if present: scenes without them keep their hash
_ADDED = (*_LISTS, *_LATER_LISTS, "sensors")  # sensors do not affect a run, so they are not hashed
Item = TypeVar("Item")


@named_arguments
class Scene(reprs.Shown):
    """A multibody model: bodies with poses, and the elements that connect and load them.

    gravity: (3,) [m/s2], world. `bodies`, `joints`, `drives`, `forces`, `contacts`, `lumped_contacts`, `films`,
    `sensors` are lists in the order of adding; `bearings`, `gears`, `cams`, `wheelsets` and `journal_bearings` are
    assemblies, whose parts are in the other lists, too; `ground` is the world as a body. SI units, world axes,
    quaternions (x, y, z, w).

    >>> scene = wf.Scene(gravity=(0, 0, -9.81))  # m/s2
    >>> arm = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="arm", position=(0.1, 0, 0))  # kg, kg m2, m
    >>> pin = scene.add(wf.joints.Revolute(scene.ground, arm.at((-0.1, 0, 0)), axis=(0, 1, 0), name="pin"))
    >>> result = wf.simulate(scene, 0.1, step=1e-3, progress=False)
    >>> round(float(result.joint("pin").coordinate[-1]), 2)  # rad
    0.24
    """

    def __init__(self, *, gravity: Vector = (0.0, 0.0, 0.0)) -> None:
        self.gravity = require_array(gravity, "scene: gravity", (3,))
        warn(gravity_doubts(self.gravity))
        self.ground = Ground()
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self.drives: list[Drive] = []
        self.forces: list[Any] = []
        self.contacts: list[Contact] = []
        self.lumped_contacts: list[LumpedContact] = []
        self.films: list[Film] = []
        self.sensors: list[Sensor] = []
        self.bearings: list[Bearing] = []
        self.gears: list[GearMesh] = []
        self.cams: list[CamPair] = []
        self.wheelsets: list[Wheelset] = []
        self.journal_bearings: list[JournalBearing] = []
        self.released = NOTHING  # of a part of a run, `Stage`
        self._numbers: dict[str, int] = {}  # kind -> last number given to an unnamed item

    add_bearing = add_bearing
    add_gear_pair = add_gear_pair
    add_cam = add_cam
    add_wheelset = add_wheelset
    add_journal_bearing = add_journal_bearing
    add_thrust_bearing = add_thrust_bearing

    @property
    def finite_sliding(self) -> list[Contact]:
        """The contacts with finite sliding, in the order of `contacts`."""
        return [contact for contact in self.contacts if contact.sliding is None]

    @property
    def small_sliding(self) -> list[Contact]:
        """The contacts with small sliding, in the order of `contacts`."""
        return [contact for contact in self.contacts if contact.sliding is not None]

    def _facts(self) -> dict[str, Any]:
        kinds = ("bodies", *_ADDED, "bearings", "gears", "cams", "wheelsets", "journal_bearings")
        return {kind: reprs.names(getattr(self, kind)) for kind in kinds if getattr(self, kind)}

    def _picture(self) -> str:
        """The bodies at their initial pose; the output package is imported by name, as it imports the model."""
        if not self.bodies:
            return ""
        return importlib.import_module("warpffrf.output.initial_pose").initial_pose(self)._picture()

    def add_body(
        self,
        body: ReducedBody,
        *,
        name: str,
        position: Vector = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0, 1.0),
        velocity: Vector = (0.0, 0.0, 0.0),
        angular_velocity: Vector = (0.0, 0.0, 0.0),
        damping: Damping = None,
        inertia: str = "auto",
        stiffening: bool = False,
    ) -> Body:
        """Add a flexible body (one `ReducedBody` may be added many times), called `name`; returns its handle.

        position [m], rotation: pose of the user frame (the frame of the mesh file), rotation a quaternion (x, y, z, w),
        a matrix (3, 3), {"axis": (0, 1, 0), "angle": 0.3} [rad], Euler angles {"xyz": (0.1, 0.2, 0.3)} [rad] or a scipy
        Rotation (`warpffrf.model.rotation`); velocity [m/s] of its origin and angular_velocity [rad/s]. damping: ratios
        of the global modes, a number, an array (m,), a function of the frequencies [Hz] such as DampingBands or
        Rayleigh (`warpffrf.model.damping`), "1/10/100" for 1 % below 100 Hz, 10 % below 1 kHz and 100 % above, or None
        for 10 % above half the highest retained frequency and none below: the highest modes oscillate against the
        massless contact compliance after a load step. The energy ledger includes its dissipation. It is internal
        (rotating) damping: above a critical speed it drives whirl, which dampers to the ground (`forces.BearingSpring`)
        suppress.

        inertia: coupling of rotation and deformation, "constant" (none), "deformed" (inertia of the deformed body,
        centrifugal forces), "gyroscopic" (centrifugal load, Coriolis and Euler forces), "full", or "auto", the simplest
        admissible level by an estimate from the speeds of the scene, stated in the result's report; a run in which the
        body rotates faster than this level allows restarts with "full". stiffening: first-order geometric stiffening by
        centrifugal load and interface forces; the body must be reduced with `stiffening=True`. Raises `InputError` for
        a name in use and arguments that do not fit the body.

        With `roller` as in `reduce`:

        >>> scene = wf.Scene(gravity=(0, 0, 0))
        >>> lower = scene.add_body(roller, name="lower")
        >>> upper = scene.add_body(roller, name="upper", position=(0, 0, 0.04))  # m
        >>> upper.mass == roller.mass
        True
        """
        self._check_new_name(name, {b.name for b in self.bodies}, "body")
        if not hasattr(body, "contact_surfaces") or not hasattr(body, "frequencies"):
            raise InputError(f"body {name!r}: a reduced body is needed (reduce(mesh, material, ...)), got {body!r}")
        handle = Body(
            name,
            len(self.bodies),
            float(body.mass),
            np.array(body.center_of_mass, dtype=np.float64),
            np.array(body.inertia, dtype=np.float64),
            reduced=body,
            damping=damping_ratios(damping, body.frequencies, name),
            level=_level(inertia, name),
            stiffening=bool(stiffening),
            position=position,
            rotation=rotation,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        self.bodies.append(handle)
        return handle

    def add_rigid_body(
        self,
        mass: float,
        inertia_tensor: Vector | Matrix,
        *,
        name: str,
        center_of_mass: Vector = (0.0, 0.0, 0.0),
        position: Vector = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0, 1.0),
        velocity: Vector = (0.0, 0.0, 0.0),
        angular_velocity: Vector = (0.0, 0.0, 0.0),
        surfaces: Mapping[str, Shape] | None = None,
    ) -> Body:
        """Add a rigid body; returns its handle.

        mass [kg]; inertia_tensor (3, 3), or its diagonal (3,) [kg m2], about the centre of mass, user axes;
        center_of_mass (3,) [m, user frame]; position, rotation, velocity and angular_velocity as in `add_body`.
        surfaces: contact surfaces by name, shapes of `warpffrf.surfaces` in the user frame with all parameters given,
        `{"tread": Cylinder(...)}`.

        >>> scene = wf.Scene()
        >>> tread = wf.surfaces.Cylinder(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
        >>> shaft = scene.add_rigid_body(0.5, (1e-4, 5e-5, 1e-4), name="shaft", surfaces={"tread": tread})  # kg, kg m2
        >>> tilted = scene.add_rigid_body(
        ...     0.5, (1e-4, 5e-5, 1e-4), name="tilted", position=(0, 0, 0.1), rotation={"axis": (1, 0, 0), "angle": 0.3}
        ... )
        """
        self._check_new_name(name, {b.name for b in self.bodies}, "body")
        handle = Body(
            name,
            len(self.bodies),
            require_number(mass, f"body {name!r}: mass", positive=True),
            require_array(center_of_mass, f"body {name!r}: center_of_mass", (3,)),
            require_inertia(inertia_tensor, f"body {name!r}: inertia_tensor"),
            reduced=None,
            damping=np.zeros(0),
            position=position,
            rotation=rotation,
            velocity=velocity,
            angular_velocity=angular_velocity,
        )
        for label, shape in _surfaces(surfaces, name):
            handle.surface(shape, name=label)
        self.bodies.append(handle)
        return handle

    def add(self, item: Item) -> Item:
        """Add an `item` (joint, drive, force, contact, film or sensor) and return it; an unnamed item
        gets a name (`revolute_1`). Raises `InputError` for anything else, a name in use, and a body of another
        scene."""
        where = getattr(item, "scene_list", None)
        if where not in _ADDED or isinstance(item, type):
            raise InputError(
                f"scene: {item!r} cannot be added; joints, drives, forces, contacts, films and sensors can"
            )
        thing: Any = item
        if not thing.kind:
            raise InputError(f"scene: {type(thing).__name__} has no kind; give the class one, as kind = 'power'")
        members = getattr(self, where)
        names = {member.name for member in members}
        if thing.name in names and any(member is thing for member in members):
            raise InputError(f"scene: {thing.kind} {thing.name!r} is in the scene already")
        for port in thing.ports:
            if port.body is not self.ground and not any(port.body is b for b in self.bodies):
                raise InputError(self._stranger(thing, port))
        if isinstance(getattr(thing, "joint", None), Joint):
            self._check_joint_of(thing)
        if isinstance(thing, Contact) and thing.sliding is not None:
            refuse_double_small_sliding(thing, self.small_sliding)
        elif isinstance(thing, (Contact, LumpedContact, Film)):
            refuse_double_claims(thing, (*self.finite_sliding, *self.lumped_contacts, *self.films))
        if thing.name is None:
            number = self._numbers.get(thing.kind, 0) + 1
            while f"{thing.kind}_{number}" in names:
                number += 1
            self._numbers[thing.kind], thing.name = number, f"{thing.kind}_{number}"
        self._check_new_name(thing.name, names, thing.kind)
        members.append(thing)
        return item

    def body(self, name: str) -> Body:
        """The body called `name`; `InputError` lists those that exist."""
        return _named(self.bodies, name, "body")

    def joint(self, name: str) -> Joint:
        """The joint called `name`; `InputError` lists those that exist."""
        return _named(self.joints, name, "joint")

    def contact(self, name: str) -> Contact:
        """The contact called `name`; `InputError` lists those that exist."""
        return _named(self.contacts, name, "contact")

    def lumped_contact(self, name: str) -> LumpedContact:
        """The lumped contact called `name`; `InputError` lists those that exist."""
        return _named(self.lumped_contacts, name, "lumped contact")

    def film(self, name: str) -> Film:
        """The oil film called `name`; `InputError` lists those that exist."""
        return _named(self.films, name, "film")

    def bearing(self, name: str) -> Bearing:
        """The bearing called `name`; `InputError` lists those that exist."""
        return _named(self.bearings, name, "bearing")

    def place(self, port: PortLike, *, onto: PortLike) -> None:
        """Translate the body of `port` so that the port's point coincides with that of `onto` (orientation unchanged).
        Raises `InputError` for the ground, and for two ports of one body."""
        moved, target = as_port(port, "place: port"), as_port(onto, "place: onto")
        if isinstance(moved.body, Ground):
            raise InputError("place: the ground cannot be moved; swap the two ports")
        if moved.body is target.body:
            raise InputError(f"place: both ports are on body {moved.body.name!r}")
        moved.body.position = moved.body.position + (target.world_point() - moved.world_point())

    def close_gap(
        self,
        contact: Contact,
        *,
        along: Vector = (0.0, 0.0, 1.0),
        gap: float = 0.0,
        with_bodies: Sequence[Body] | None = None,
    ) -> float:
        """Translate the second body of `contact` along `along` (world) until the smallest undeformed gap is `gap` [m].

        A negative gap is an interference, accommodated by deformation. Returns the distance moved [m]. The true
        surfaces are used; of several solutions the first one from far out on the side of `along` is taken, with a
        warning where the body passes the other one, for a pin in a bore the first one from its position. If the second
        body is the ground, the first body is moved in the opposite direction.

        with_bodies: bodies that move with it. None: those that joints carry along, so that an assembly stays together:
        a follower with its roller, but not the guide along which it slides (`assembly.joined_bodies`). If joints also
        lead to the other body of the contact, and with `()`, it moves alone. Raises `InputError` where surfaces do not
        meet in that direction, and for two that cannot be moved.
        """
        if not isinstance(contact, Contact) or contact.sliding is not None:
            raise InputError(
                f"close_gap: a contact with finite sliding is needed, got {contact!r}; place bodies with matched faces "
                "by position, or scene.place(...)"
            )
        distance = closing_distance(contact, along, gap)
        warn(passed(contact, along, distance))
        shift = distance * require_direction(along, "close_gap: along")
        a, b = (port.body for port in contact.ports)
        body, stays, shift = (a, b, -shift) if isinstance(b, Ground) else (b, a, shift)
        if with_bodies is None:
            moved = joined_bodies(self, body, stays, shift)
        else:
            moved = [body, *self._along(contact, body, stays, with_bodies)]
        shift_bodies(self, moved, shift)
        return distance

    def _along(self, contact: Contact, body: Body, stays: Body | Ground, others: Any) -> list[Body]:
        """The other bodies that `close_gap` moves."""
        given = list(others) if isinstance(others, (list, tuple, set)) else [others]
        for other in given:
            if not any(other is known for known in self.bodies):
                names = ", ".join(repr(known.name) for known in self.bodies)
                raise InputError(
                    f"close_gap: with_bodies takes bodies of this scene, scene.body(name) with name one of {names}; "
                    f"got {getattr(other, 'name', None) or other!r}"
                )
            if other is stays:
                raise InputError(
                    f"close_gap: moving both bodies of contact {contact.name!r} never closes its gap; leave "
                    f"{stays.name!r} out of with_bodies"
                )
        return [other for other in given if other is not body]

    def check(self) -> SceneCheck:
        """Masses, degrees of freedom, redundant constraints and initial gaps; printed as a table.

        Raises `InputError` for a scene without bodies and for joints whose ports do not meet.
        """
        from warpffrf.model.checks.scene import check_scene

        return check_scene(self)

    def describe(self) -> dict[str, Any]:
        """All inputs of a run as plain data, except the arrays of reduced bodies."""
        description = {
            "gravity": self.gravity.tolist(),
            "bodies": [body.describe() for body in self.bodies],
            **{where: [item.describe() for item in getattr(self, where)] for where in _LISTS},
        }
        for where in _LATER_LISTS:
            if items := getattr(self, where):
                description[where] = [item.describe() for item in items]
        if self.ground.surfaces:
            description["ground"] = {name: surface.describe() for name, surface in self.ground.surfaces.items()}
        return description

    def content_hash(self) -> str:
        """sha256 of all inputs of a run: different scenes have different hashes."""
        digest = hashlib.sha256()
        digest.update(json.dumps(self.describe(), sort_keys=True).encode())
        for body in self.bodies:
            if body.reduced is not None:
                _add_reduced(digest, body.reduced)
        return digest.hexdigest()

    def _stranger(self, thing: Any, port: Any) -> str:
        """Error message for a port of a body that is not in this scene, with the cure."""
        label = f"{thing.kind} {thing.name!r}" if thing.name else f"{thing.kind}, without a name yet,"
        where, name = port.label, port.body.name
        if any(name == body.name for body in self.bodies):
            cure = f"this scene has a body of that name, take its port: scene.body({name!r})[...]"
        else:
            known = ", ".join(repr(body.name) for body in self.bodies) or "none"
            cure = f"add it with scene.add_body(..., name={name!r}), or take a body of this one: {known}"
        return f"{label}: body {name!r} belongs to another scene, with its port {where}; {cure}"

    @staticmethod
    def _check_new_name(name: str, taken: Collection[str], kind: str) -> None:
        if not isinstance(name, str) or not name or "/" in name:
            raise InputError(f"{kind}: the name must be a non-empty text without '/', got {name!r}")
        if name in taken or name == "ground":
            raise InputError(f"{kind} {name!r}: the name is taken, choose another")

    def _check_joint_of(self, item: Any) -> None:
        if not any(item.joint is joint for joint in self.joints):
            raise InputError(f"{item.kind}: add its joint {item.joint.name!r} to the scene first")
        if isinstance(item, (Drive, Pretension)):
            for other in (*self.drives, *(f for f in self.forces if isinstance(f, Pretension))):
                if other.joint is item.joint and other.coordinate == item.coordinate:
                    what = f"the {item.coordinate} of joint {item.joint.name!r}"
                    if isinstance(item, Drive) and isinstance(other, Drive):
                        raise InputError(f"drive: {what} is driven already")
                    held = {True: "driven", False: "under pretension"}[isinstance(other, Drive)]
                    raise InputError(f"{item.kind}: {what} is {held} already, by {other.name!r}; remove one of them")


def _named(members: list, name: str, kind: str) -> Any:
    for member in members:
        if member.name == name:
            return member
    raise unknown_name(kind, name, [member.name for member in members])


def _level(inertia: Any, name: str) -> str:
    if inertia not in INERTIA_LEVELS:
        raise unknown_name(f"body {name!r}: inertia", inertia, INERTIA_LEVELS)
    return inertia


def _surfaces(surfaces: Any, name: str) -> list[tuple[Any, Any]]:
    if surfaces is None:
        return []
    if not isinstance(surfaces, Mapping):
        raise InputError(
            f"body {name!r}: surfaces must be a mapping of names to shapes, {{'tread': surfaces.Cylinder(...)}}, got "
            f"{surfaces!r}"
        )
    return list(surfaces.items())


def _add_reduced(digest: Any, body: ReducedBody) -> None:
    """Hash the arrays that a simulation uses."""

    def add(label: str, array: Any) -> None:
        array = np.ascontiguousarray(array, dtype=np.float64)
        digest.update(f"{label}|{array.shape}|".encode())
        digest.update(array.tobytes())

    add("mass", [body.mass])
    add("center_of_mass", body.center_of_mass)
    add("inertia", body.inertia)
    add("frequencies", body.frequencies)
    for name, interface in sorted(body.interfaces.items()):
        add(f"interface|{name}|{interface.kind}", interface.point)
        add("modes", interface.modes)
        if interface.nodes is not None and interface.node_modes is not None:  # used by nodal loads
            add("nodes", interface.nodes)
            add("node_modes", interface.node_modes)
    for name, surface in sorted(body.contact_surfaces.items()):
        digest.update(json.dumps(surface.shape.describe(), sort_keys=True).encode())
        grid = surface.grid
        numbers = (grid.theta_start, grid.pitch, grid.columns, grid.periodic, grid.columns_per_sector)
        add(f"surface|{name}", numbers)
        add("e_0", grid.e_0)
        add("z", grid.z)
        add("lags", surface.lags)
        if surface.slope_lags is not None:
            add("slope_lags", surface.slope_lags)
        add("mode_normal", surface.mode_normal)
