"""Bodies of a scene and their ports, to which joints, forces and contacts attach.

Points of a body are given in its *user frame* (the frame of its mesh file, or of its rigid-body data); a pose maps them
to the world, x = position + A(rotation) x_user.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Matrix, RotationLike, Vector
from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.surfaces import Shape
from warpffrf.model.surfaces.form_deviations import Form, RoundForm
from warpffrf.model.surfaces.worn import worn

if TYPE_CHECKING:
    from warpffrf.model.reduced.body import ReducedBody

GROUND_INDEX = -1
INERTIA_LEVELS = ("constant", "deformed", "gyroscopic", "full", "auto")


@dataclass(frozen=True, eq=False, repr=False)
class Port(reprs.Shown):
    """A port of a body: an interface, or a body-fixed point (3,) [m, user frame].

    `point` is None only for the bare ground: the joint's other port then defines the point.
    """

    body: Any  # Body or Ground
    interface_name: str | None
    point: np.ndarray | None

    def _facts(self) -> dict[str, Any]:
        return {"name": self.label}

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        if self.interface_name is not None:
            return f"{self.body.name}[{self.interface_name!r}]"
        return (
            self.body.name if self.point is None else f"{self.body.name}.at({', '.join(f'{x:g}' for x in self.point)})"
        )

    def world_point(self) -> np.ndarray:
        """The point (3,) [m] in the world at the initial pose, undeformed."""
        if self.point is None:
            raise InputError(f"{self.label}: a point is needed here, use {self.body.name}.at((x, y, z))")
        return self.body.to_world(self.point)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        point = None if self.point is None else self.point.tolist()
        return {"body": self.body.name, "interface": self.interface_name, "point": point}


@dataclass(frozen=True, eq=False, repr=False)
class SurfacePort(reprs.Shown):
    """A contact surface of a body, for `Contact`."""

    body: Any  # Body or Ground
    name: str

    def _facts(self) -> dict[str, Any]:
        return {"name": self.label}

    @property
    def label(self) -> str:
        return f"{self.body.name}[{self.name!r}]"

    @property
    def rigid(self) -> bool:
        """True where the surface has no compliance."""
        return self.body.reduced is None

    @property
    def matched(self) -> bool:
        """True where the surface was reduced as `surfaces.Matched`, for small-sliding contact."""
        return not self.rigid and self.name in self.body.reduced.matched

    @property
    def on_ground(self) -> bool:
        """True where the body is the ground, which is fixed."""
        return self.body.index == GROUND_INDEX

    @property
    def surface(self) -> Any:
        """The reduced contact surface or matched face, or the `RigidSurface` of a rigid body or the ground."""
        if self.rigid:
            return self.body.surfaces[self.name]
        return (self.body.reduced.matched if self.matched else self.body.reduced.contact_surfaces)[self.name]

    def add_form(self, form: Form) -> None:
        """Take the material of a form deviation of `warpffrf.films` off the surface, in this scene: of wear in an
        earlier run (`result.contact(name).wear`), of a measured or a desired profile.

        A surface of revolution with the material inside takes a form that depends on z alone, and becomes a
        `surfaces.ProfiledCylinder`; an extruded one a form that depends on the length u along its curve, the form's
        theta [m]. Raises `InputError` for other surfaces and forms.
        """
        label = f"{self.label}: add_form"
        if self.matched:
            raise InputError(f"{label}: faces in small sliding take no forms")
        surface = self.surface
        shape = worn(surface.shape, form, None if surface.grid is None else surface.grid.z[[0, -1]], label)
        if self.rigid:
            self.body.surfaces[self.name] = replace(surface, shape=shape)
        else:
            surfaces = {**self.body.reduced.contact_surfaces, self.name: replace(surface, shape=shape)}
            self.body.reduced = replace(self.body.reduced, contact_surfaces=surfaces)


if TYPE_CHECKING:

    class Place(Port, SurfacePort):
        """Result of `body[name]`: interface or contact surface, known only at run time."""

        point: np.ndarray


class _Posed(reprs.Shown):
    """A user frame with a pose in the world."""

    name: str
    index: int
    reduced: ReducedBody | None = None

    def __init__(self, name: str, position: Vector, rotation: RotationLike) -> None:
        self.name = name
        self.position = position
        self.rotation = rotation
        self.surfaces: dict[str, RigidSurface] = {}

    def surface(self, shape: Shape, *, name: str, form: Form | RoundForm | None = None) -> SurfacePort:
        """Give this rigid body, or the ground, a contact surface of `shape` (`warpffrf.surfaces`), in its user frame.

        form: form deviation around its axis, of `warpffrf.films`, positive where material is missing:
        `films.LobedForm(5e-6, 2)` makes it oval; only lumped contacts use it. Returns its port, later available as
        `body[name]`. Raises `InputError` for a flexible body, whose surfaces are defined by its reduction, and for a
        shape with parameters left to be fitted.
        """
        if self.reduced is not None:
            raise InputError(f"body {self.name!r} is flexible: name its surfaces in reduce(contact={{...}})")
        owner = self.name if self.index == GROUND_INDEX else f"body {self.name!r}"
        surface = RigidSurface.of(name, shape, owner, form)
        if name in self.surfaces:
            raise InputError(f"{owner}: the name {name!r} of a surface is taken, choose another")
        self.surfaces[name] = surface
        return SurfacePort(self, name)

    @property
    def position(self) -> np.ndarray:
        """World position of the user frame's origin at the start (3,) [m]."""
        return self._position

    @position.setter
    def position(self, value: Vector) -> None:
        self._position = require_array(value, f"{self.name}: position", (3,))

    @property
    def rotation(self) -> np.ndarray:
        """Unit quaternion (x, y, z, w), user frame to world, at the start; any form of `rotation` is accepted."""
        return self._rotation

    @rotation.setter
    def rotation(self, value: RotationLike) -> None:
        self._rotation = rot.orientation(value, f"{self.name}: rotation")

    def to_world(self, points: Vector | Matrix) -> np.ndarray:
        """Points (..., 3) [m] of the user frame in the world, at the initial pose."""
        return self.position + np.asarray(points, float) @ rot.matrix(self.rotation).T

    def to_user(self, points: Vector | Matrix) -> np.ndarray:
        """World points (..., 3) [m] in the user frame, at the initial pose."""
        return (np.asarray(points, float) - self.position) @ rot.matrix(self.rotation)


@named_arguments
class Ground(_Posed):
    """The world as a body: it does not move. Use it directly in a joint, or `ground.at(point)`; `ground.surface(...)`
    for contact."""

    index = GROUND_INDEX
    mode_count = 0

    def __init__(self) -> None:
        super().__init__("ground", np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))

    def _facts(self) -> dict[str, Any]:
        return {"surfaces": reprs.names(self.surfaces)} if self.surfaces else {}

    def at(self, point: Vector) -> Port:
        """A point (3,) [m] of the world."""
        return Port(self, None, require_array(point, "ground: point", (3,)))

    def __getitem__(self, name: str) -> SurfacePort:
        """The `SurfacePort` of the surface called `name`."""
        if name in self.surfaces:
            return SurfacePort(self, name)
        raise InputError(
            f"the ground has no interface or surface {name!r}; {_known(self.surfaces)}use scene.ground, "
            "scene.ground.at((x, y, z)), or scene.ground.surface(shape, name=...)"
        )


@named_arguments
class Body(_Posed):
    """One body of a scene, created by `Scene.add_body` and `Scene.add_rigid_body`.

    A rigid body is a port at the origin of its user frame; `at` is a port at another point.

    mass [kg], center_of_mass (3,) [m, user frame], inertia (3, 3) [kg m2, about the centre of mass, user axes],
    `reduced` (None for a rigid body), damping (m,) [-] ratio of each global mode, initial `position`, `rotation` (may
    be changed), `velocity` of the user origin [m/s] and `angular_velocity` [rad/s], world axes; `level` of the inertia
    terms (one of INERTIA_LEVELS) and `stiffening`: whether loads stiffen it geometrically.
    """

    def __init__(
        self,
        name: str,
        index: int,
        mass: float,
        center_of_mass: np.ndarray,
        inertia: np.ndarray,
        *,
        reduced: ReducedBody | None,
        damping: np.ndarray,
        position: Vector,
        rotation: RotationLike,
        velocity: Vector,
        angular_velocity: Vector,
        level: str = "constant",
        stiffening: bool = False,
    ) -> None:
        super().__init__(name, position, rotation)
        self.index = index
        self.mass = mass
        self.center_of_mass = center_of_mass
        self.inertia = inertia
        self.reduced = reduced
        self.damping = damping
        self.level = level
        self.stiffening = stiffening
        self.velocity = require_array(velocity, f"body {name!r}: velocity", (3,))
        self.angular_velocity = require_array(angular_velocity, f"body {name!r}: angular_velocity", (3,))

    def _facts(self) -> dict[str, Any]:
        kind = "rigid" if self.reduced is None else f"{self.mode_count} modes"
        x, y, z = self.position
        facts = {"name": self.name, "kind": kind, "mass": f"{self.mass:.5g} kg", "position": f"({x:g}, {y:g}, {z:g}) m"}
        places = self.surfaces if self.reduced is None else self._places
        return {**facts, "places": reprs.names(places)} if places else facts

    @property
    def _places(self) -> list[str]:
        return [*self.flexible.interfaces, *self.flexible.contact_surfaces, *self.flexible.matched]

    @property
    def mode_count(self) -> int:
        """Number of global modes; 0 for a rigid body."""
        return 0 if self.reduced is None else len(self.reduced.frequencies)

    @property
    def flexible(self) -> ReducedBody:
        """`reduced`, where the body has one; raises `InputError` for a rigid one."""
        if self.reduced is None:
            raise InputError(f"body {self.name!r} is rigid; add it with scene.add_body and a reduced body")
        return self.reduced

    def __getitem__(self, name: str) -> Place:
        """The `Port` of an interface or the `SurfacePort` of a contact surface called `name`."""
        place: Any = self._place(name)
        return place

    def _place(self, name: str) -> Port | SurfacePort:
        if self.reduced is None:
            if name in self.surfaces:
                return SurfacePort(self, name)
            raise InputError(
                f"rigid body {self.name!r} has no interface or surface {name!r}; {_known(self.surfaces)}use "
                ".at((x, y, z)), or give it surfaces={...}"
            )
        if name in self.reduced.interfaces:
            return Port(self, name, np.array(self.reduced.interfaces[name].point, dtype=np.float64))
        if name in self.reduced.contact_surfaces or name in self.reduced.matched:
            return SurfacePort(self, name)
        error = unknown_name(f"body {self.name!r}: interface or contact surface", name, self._places)
        cure = f"to have it, add interfaces={{{name!r}: ...}} or contact={{{name!r}: ...}} to wf.reduce"
        raise InputError(f"{error}; {cure}")

    def at(self, point: Vector) -> Port:
        """A body-fixed point (3,) [m, user frame] of a rigid body."""
        if self.reduced is not None:
            names = ", ".join(repr(n) for n in self.reduced.interfaces) or "none"
            raise InputError(
                f"body {self.name!r} is flexible: a single point has no rigid frame; name an interface, body[name], "
                f"with name one of {names}"
            )
        return Port(self, None, require_array(point, f"body {self.name!r}: point", (3,)))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing; the reduced body is hashed by its arrays elsewhere."""
        fields = ("center_of_mass", "inertia", "damping", "position", "rotation", "velocity", "angular_velocity")
        options: dict[str, Any] = {"inertia_level": self.level, "stiffening": self.stiffening}
        if self.surfaces:
            options["surfaces"] = {name: surface.describe() for name, surface in self.surfaces.items()}
        return {"name": self.name, "mass": self.mass, **options, **{f: getattr(self, f).tolist() for f in fields}}


def _known(surfaces: dict[str, RigidSurface]) -> str:
    """The existing surfaces, for the error message about an unknown one."""
    return f"known surfaces: {', '.join(map(repr, surfaces))}; " if surfaces else ""


# The bare ground is a port whose point the other port defines; a rigid body one at the origin of its user frame.
PortLike: TypeAlias = Port | Ground | Body


def as_port(value: Any, name: str) -> Port:
    """`value` as a port: the bare ground is one without a point, a rigid body one at the origin of its user frame.
    `InputError` for anything else."""
    if isinstance(value, Port):
        return value
    if isinstance(value, Ground):
        return Port(value, None, None)
    if isinstance(value, SurfacePort):
        raise InputError(f"{name}: {value.label} is a contact surface; name an interface of the body instead")
    if isinstance(value, Body):
        if value.reduced is None:
            return value.at((0.0, 0.0, 0.0))
        raise InputError(f"{name}: body {value.name!r} is flexible: name one of its interfaces, body['interface']")
    raise InputError(
        f"{name}: a port is needed (body['interface'], a rigid body, body.at(point) or scene.ground), got {value!r}"
    )


def require_relative_motion(a: Port, b: Port, label: str) -> None:
    """Raise `InputError` naming `label` where two ports have no relative motion: both on the ground or on one rigid
    body, at one interface, or on a body without modes. Two interfaces of a flexible body move relative to each other by
    its modes."""
    if a.body is not b.body:
        return
    if a.body.mode_count == 0:
        what = "does not deform" if a.body.reduced is None else "was reduced without modes"
        raise InputError(
            f"{label}: both ports are on {a.body.name!r}, which {what}: there is no relative motion; use a port of "
            "another body, or two interfaces of one flexible body"
        )
    if a.interface_name == b.interface_name:
        raise InputError(
            f"{label}: both ports are {a.label}; take two interfaces of the body, or a port of another one"
        )
