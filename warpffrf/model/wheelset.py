r"""A wheelset on its track: two wheels on an axle, two rails, their contacts, and the kinematics of the rigid profiles.

The track lies along x, the left wheel at y > 0, rail tops at z = 0. A wheel's profile R(s), s away from the flange, has
its running circle s = 0 at the distance b from the middle of the axle. With the displacement y and the roll phi of the
axle, left wheel upwards, its lower edge lies at

    place = side y + (b + s) cos(phi) + side R sin(phi),      depth = R cos(phi) - side (b + s) sin(phi),

place outwards from the middle of the track; wheel and rail touch where rail height plus depth is largest, and phi(y)
is that for which both wheels touch. Rolling without slip means, with the yaw psi, the rolling radii r_l, r_r and the
places y_l, y_r of the contacts across the track,

    dy/dx = psi/(1 + r dphi/dy),      dpsi/dx = -(r_l - r_r)/(r (y_l - y_r)),

a wave of the length L for each amplitude (Klingel 1883), which for cones of the slope gamma is 2 pi sqrt(b r/gamma):
the equivalent conicity is (2 pi/L)^2 b r (UIC 519).
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.bodies import Body, SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Fixed
from warpffrf.model.material import Material
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces import Curve, Extruded
from warpffrf.model.surfaces.profiled_cylinder import RevolutionShape

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

Array = np.ndarray
SIDES = {"left": 1, "right": -1}
SAMPLES = 20001  # of a profile: 6 um, of which the square over the radii is the error of a height
ROLL = 0.05  # rad, bound
DISPLACEMENTS, AWAY, FAR = 46, 0.02, 200.0  # of half a wave; m, longest step along the track; m, longest wave


@dataclass(eq=False, repr=False)
class Wheelset(reprs.Shown):
    """A wheelset on its track, as made by `scene.add_wheelset`: `body`, with the surfaces "left" and "right", the
    surfaces of the `rails` and the `contacts` by side; and the kinematics of its rigid profiles, without yaw."""

    name: str
    body: Body
    rails: dict[str, SurfacePort]
    contacts: dict[str, Contact]
    running_circle: float  # m, from the middle of the axle
    profiles: tuple[Array, Array, Array, Array]  # s, R of a wheel; y, z of the left rail, its top at z = 0; (n,) m

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "rails": [rail.label for rail in self.rails.values()]}

    def touch(self, side: int, y: float, roll: float) -> Array:
        """Where a rigid wheel, `side` 1 of the left and -1 of the right one, touches its rail, the wheelset at y [m]
        with the roll [rad], (4,) [m]: height of the axle's middle, rolling radius, s along the profile, y across the
        track."""
        s, R, rail_y, rail_z = self.profiles
        place = side * y + (self.running_circle + s) * np.cos(roll) + side * R * np.sin(roll)
        below = side * (self.running_circle + s) * np.sin(roll) - R * np.cos(roll)
        height = np.interp(place, rail_y, rail_z, left=-1.0, right=-1.0) - below
        i = int(np.argmax(height))
        return np.array([height[i], R[i], s[i], side * place[i]])

    def roll(self, y: float) -> float:
        """The roll [rad] with which both wheels touch at the displacement y [m]; raises `InputError` for one at which a
        wheel has left its rail."""
        from scipy.optimize import brentq

        def apart(phi: float) -> float:
            return float(self.touch(1, y, phi)[0] - self.touch(-1, y, phi)[0])

        phi = np.nan
        if apart(-ROLL) * apart(ROLL) <= 0.0:
            phi = float(brentq(apart, -ROLL, ROLL, xtol=1e-12))  # pyright: ignore[reportArgumentType]
        rail_y = self.profiles[2]
        if not all(rail_y[0] < side * self.touch(side, y, phi)[3] < rail_y[-1] for side in SIDES.values()):
            raise InputError(
                f"wheelset {self.name!r}: at y = {y:g} m a wheel does not touch its rail; take a smaller y, or correct "
                "running_circle and gauge"
            )
        return phi

    def wave(self, amplitude: float) -> tuple[Array, Array]:
        """x and y (n,) [m] of half a wave of this `amplitude` [m], rolling without slip, from the middle of the track.
        Raises `InputError` where the profiles do not steer it back."""
        from scipy.integrate import solve_ivp

        top = require_number(amplitude, f"wheelset {self.name!r}: amplitude", positive=True)
        y = np.linspace(0.0, top, DISPLACEMENTS)
        phi = [self.roll(at) for at in y]
        _, radii, _, apart = np.array([self.touch(1, *at) - self.touch(-1, *at) for at in zip(y, phi, strict=True)]).T
        r = self._radius
        rolls = 1.0 + r * np.gradient(phi, y)

        def rates(_: float, state: Array) -> list[float]:
            return [state[1] / np.interp(state[0], y, rolls), -np.interp(state[0], y, radii / apart) / r]

        def middle(_: float, state: Array) -> float:
            return float(state[0])

        middle.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        found = solve_ivp(rates, (0.0, FAR), [top, 0.0], max_step=AWAY, events=middle)
        if not len(found.t_events[0]):
            raise InputError(
                f"wheelset {self.name!r}: its profiles do not steer it back from {top:g} m within {FAR:g} m"
            )
        end = found.t_events[0][0]
        x, down = np.append(found.t[found.t < end], end), np.append(found.y[0][found.t < end], 0.0)
        return np.concatenate([end - x[::-1], end + x[1:]]), np.concatenate([down[::-1], down[1:]])

    def conicity(self, amplitude: float) -> float:
        """Equivalent conicity [-] at this `amplitude` [m]. Raises `InputError` as `wave`."""
        return float((np.pi / self.wave(amplitude)[0][-1]) ** 2 * self.running_circle * self._radius)

    @cached_property
    def _radius(self) -> float:
        s, R, *_ = self.profiles
        return float(np.interp(0.0, s, R))


@named_arguments
def add_wheelset(
    scene: Scene,
    wheel: RevolutionShape,
    rail: Curve,
    *,
    name: str,
    mass: float,
    inertia_tensor: Vector | Matrix,
    material: Material,
    track: Vector,
    speed: float = 0.0,
    y: float = 0.0,
    yaw: float = 0.0,
    friction: FrictionLike = 0.0,
    cells: tuple[int, Any] | None = None,
    extent: Vector | None = None,
    running_circle: float = 0.75,
    gauge: float = 1.435,
    gauge_depth: float = 14e-3,
    inclination: float = 1.0 / 40.0,
    rigid_rails: bool = False,
) -> Wheelset:
    """Put a wheelset on a straight track along x: wheels and rails are half-spaces under their patches; returns them.

    scene: to add to; name: of the body, with the interface "center" and the surfaces "left" (y > 0) and "right"; its
    contacts are "NAME left" and "NAME right", the rails, fixed to the ground, "NAME left rail" and "right rail". wheel:
    a profile such as `surfaces.wheel_s1002(radius=...)`, z away from the flange and 0 on the running circle, without
    axis. rail: the section of its head, `surfaces.rail_uic60()`, y upwards, symmetric. mass [kg], inertia_tensor (3, 3)
    or its diagonal (3,) [kg m2], of the whole wheelset; material: of wheels and rails. track: (from, to) [m] along x;
    the wheelset begins at x = 0. speed [m/s], y [m] and yaw [rad] of the wheelset at the start, rolling, at the height
    and with the roll at which both profiles touch without yaw. friction, cells: as for `Contact`; boundaries of rows
    [m] count from the running circle. extent: (low, high) [m] of a wheel without a table. running_circle [m]: from the
    middle of the axle; gauge [m], measured `gauge_depth` [m] below the top of the rails; inclination of the rails
    towards the middle of the track. rigid_rails: rails are surfaces of the ground instead, without compliance. Loads
    are yours, on `wheelset.body["center"]`. Raises `InputError` for profiles that do not touch.
    """
    label = f"wheelset {name!r}"
    if not isinstance(wheel, RevolutionShape) or wheel.radius is None or wheel.axis_point is not None:
        raise InputError(
            f"{label}: wheel must be a surface of revolution with its radius and without axis_point, which both wheels "
            f"get here, such as surfaces.wheel_s1002(radius=0.46), got {wheel!r}"
        )
    if not isinstance(rail, Curve) or rail.closed:
        raise InputError(f"{label}: rail must be an open surfaces.Curve, such as surfaces.rail_uic60(), got {rail!r}")
    limits = require_array(track, f"{label}: track", (2,))
    if not limits[0] < 0.0 < limits[1]:
        raise InputError(f"{label}: track must contain x = 0, where the wheelset begins, got {limits.tolist()} m")
    b = require_number(running_circle, f"{label}: running_circle", positive=True)
    lean = require_number(inclination, f"{label}: inclination")
    shapes = {
        where: replace(wheel, axis_point=(0, side * b, 0), axis_direction=(0, side, 0)) for where, side in SIDES.items()
    }
    half_space_body = importlib.import_module("warpffrf.offline").half_space_body  # offline imports the model
    ends = None if extent is None else dict.fromkeys(shapes, extent)
    reduced = half_space_body(mass, inertia_tensor, material, contact=shapes, extent=ends, free_ends=False)
    grid = reduced.contact_surfaces["left"].grid.z
    s = np.linspace(grid[0], grid[-1], SAMPLES)
    depth = require_number(gauge_depth, f"{label}: gauge_depth", positive=True)
    rail_y, rail_z, origin = _rail(rail, lean, require_number(gauge, f"{label}: gauge", positive=True), depth, label)
    profiles = s, np.asarray(shapes["left"].radius_at(s)), rail_y, rail_z
    nowhere: Any = None
    found = Wheelset(name, nowhere, {}, {}, b, profiles)
    y, roll = require_number(y, f"{label}: y"), found.roll(y)
    turned = rot.quaternion(
        rot.rotation_vector_matrix(np.array([0.0, 0.0, require_number(yaw, f"{label}: yaw")]))
        @ rot.rotation_vector_matrix(np.array([roll, 0.0, 0.0]))
    )
    axes, v = rot.matrix(turned), require_number(speed, f"{label}: speed")
    found.body = body = scene.add_body(
        reduced, name=name, position=(0.0, y, found.touch(1, y, roll)[0]), rotation=turned, velocity=v * axes[:, 0],
        angular_velocity=v / float(wheel.radius) * axes[:, 1],
    )  # fmt: skip
    for where, side in SIDES.items():
        at, across = (0.0, side * origin[0], origin[1]), (0.0, 1.0, side * lean)
        head = Extruded(curve=rail, axis_point=at, axis_direction=(1, 0, 0), x_direction=across)
        if rigid_rails:
            port = scene.ground.surface(head, name=f"{name} {where} rail")
        else:
            iron = half_space_body(
                1.0, (1, 1, 1), material, contact={"head": head}, extent={"head": limits}, free_ends=False
            )
            held: Any = scene.add_body(iron, name=f"{name} {where} rail")
            scene.add(Fixed(scene.ground, held["center"], name=f"{name} {where} rail"))
            port = held["head"]
        found.rails[where] = port
        contact = Contact(body[where], port, friction=friction, cells=cells, name=f"{name} {where}")
        found.contacts[where] = scene.add(contact)
    scene.wheelsets.append(found)
    return found


def _rail(rail: Curve, lean: float, gauge: float, depth: float, label: str) -> tuple[Array, Array, Array]:
    """y and z (n,) [m] of the left rail, its top at 0, and the origin (2,) [m] of its curve."""
    e_x = np.array([1.0, lean]) / np.hypot(1.0, lean)
    y, z = (rail.at(np.linspace(rail.knots[0], rail.knots[-1], SAMPLES)) @ [e_x, [-e_x[1], e_x[0]]]).T
    if y[0] > y[-1]:
        y, z = y[::-1], z[::-1]
    top = int(np.argmax(z))
    if not z[0] < z[top] - depth:
        raise InputError(
            f"{label}: the gauge is measured {depth:g} m below the top of the rail, which its section does not reach; "
            "make it longer, or gauge_depth smaller"
        )
    origin = np.array([0.5 * gauge - np.interp(z[top] - depth, z[:top], y[:top]), -z[top]])
    return y + origin[0], z + origin[1], origin
