r"""Thrust bearings in one call: sectors of an annulus, with a taper or tilting, under a flat runner.

**Polar coordinates.** Films are on charts (theta, z) of surfaces of revolution, with the radius R(z). The face of a pad
has the chart of a cone of half angle b = 90 degrees - d, d = 0.02 degrees, on which z moves by dr/tan(b) as the radius
does by dr; so its nodes are at radii and angles. The cone falls by z below the plane of the faces at R(0), the mean
radius; a form of -z, material added, makes the face flat. What remains of the cone is the direction of its normals: a
part d = 3.5e-4 of the pressure is radial, and lengths are off by d^2/2.

**Gap.** A fixed pad tapers from `taper` at the leading edge to the beginning of its land, which is the part `land` of
its arc, and is parallel to the runner from there on. A tilting pad is flat. Its pivot is behind the mean radius and the
fraction `offset` of its arc from the leading edge.
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.parts import Place
from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.films.feeds import AxialGroove
from warpffrf.model.films.film import Film
from warpffrf.model.films.heat import FilmTemperature
from warpffrf.model.films.journal_bearing import LIGHT, SLACK, SOFT, Pad, TiltingPads, downstream, refuse_overlap
from warpffrf.model.films.roughness import MixedLubrication
from warpffrf.model.forces import Bushing
from warpffrf.model.joints import Fixed, Revolute, Universal
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils import Oil
from warpffrf.model.surfaces import Cone, Plane
from warpffrf.model.surfaces.form_deviations import MeasuredForm

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

Array = np.ndarray
STEEPNESS = np.radians(89.98)  # of the cone that is the chart of a face


@named_arguments
def add_thrust_bearing(
    scene: Scene,
    name: str,
    runner: SurfacePort,
    pads: Sequence[Pad],
    *,
    inner_radius: float,
    outer_radius: float,
    oil: Oil,
    taper: float = 0.0,
    land: float = 0.0,
    tilting: TiltingPads | None = None,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    sense: int = 1,
    support: Body | Ground | None = None,
    nodes: tuple[int, int] = (24, 13),
    feed_pressure: float = 0.0,
    ambient_pressure: float = 0.0,
    cavitation: str = "jfo",
    mixed: MixedLubrication | None = None,
    temperature: FilmTemperature | None = None,
) -> list[Film]:
    """Add a thrust bearing of pads that are sectors of an annulus, and return their films, called "NAME pad 1" and so
    on: fixed pads on one rigid body called `name`, tilting ones each on its own, with its pivot, called as its film.

    runner: a plane of the shaft, `shaft["collar"]`, whose normal points against `axis` at the initial pose. pads:
    `films.pads(...)`, or a list of `films.Pad(...)`, without preload and dams. inner_radius, outer_radius [m]. taper
    [m]: depth of fixed pads at their leading edge, which falls linearly to zero at the land; land [-]: the fraction of
    the arc from there to the trailing edge. tilting: `films.TiltingPads(...)`, None for fixed pads; with a "line" pivot
    they tilt about a radius, with a "point" also about the direction around; tilt_stiffness None: a thousandth of mu w
    R^2 (R arc)^4/h^3, h the smallest gap at the initial pose. position (3,) [m]: of the centre of the faces, axis (3,):
    from the faces to the runner, first (3,): direction from which angles count, to `axis` x first; world axes at the
    initial pose; first None: +x made perpendicular to the axis. sense: 1 if the runner rotates to greater angles, -1
    otherwise. support: a rigid body or the ground, None: the ground. nodes: (columns, rows) of each film, around and
    along the radius. feed_pressure [Pa]: at the leading edges; ambient_pressure [Pa]: at the other ones. cavitation,
    mixed, temperature: as of `Film`; pads are each downstream of the one before. Raises `InputError`.

    >>> scene = wf.Scene()
    >>> collar = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, -1, 0))
    >>> shaft = scene.add_rigid_body(5.0, (0.1,) * 3, name="shaft", position=(0, 4e-5, 0), surfaces={"collar": collar})
    >>> films = scene.add_thrust_bearing(
    ...     "thrust", shaft["collar"], wf.films.pads(6, 0.9), inner_radius=0.04, outer_radius=0.08,
    ...     taper=3e-5, land=0.2, oil=wf.oils.iso_vg(46, temperature=50),
    ... )
    >>> len(films)
    6
    """
    label = f"thrust bearing {name!r}"
    shape = getattr(getattr(runner, "surface", None), "shape", None)
    if not isinstance(runner, SurfacePort) or not isinstance(shape, Plane):
        raise InputError(f"{label}: runner must be a plane of the shaft, shaft['collar'], got {runner!r}")
    if not isinstance(pads, Sequence) or not pads or not all(isinstance(pad, Pad) for pad in pads):
        raise InputError(f"{label}: pads must be films.pads(...) or a list of films.Pad(...), got {pads!r}")
    if any(pad.preload or pad.dam is not None for pad in pads):
        raise InputError(f"{label}: preload and dams are of journal bearings; leave them out, and take taper and land")
    refuse_overlap(pads, label)
    if sense not in (1, -1):
        raise InputError(f"{label}: sense must be 1 or -1, got {sense!r}")
    low = require_number(inner_radius, f"{label}: inner_radius [m]", positive=True)
    high = require_number(outer_radius, f"{label}: outer_radius [m]", positive=True)
    depth = require_number(taper, f"{label}: taper [m]", non_negative=True)
    flat = require_number(land, f"{label}: land [-]", non_negative=True)
    if low >= high or flat >= 1.0:
        raise InputError(
            f"{label}: inner_radius must be below outer_radius, and land below 1, got {low:g} m, {high:g} m, {flat:g}"
        )
    if tilting is not None and (depth or not isinstance(tilting, TiltingPads)):
        raise InputError(f"{label}: tilting must be films.TiltingPads(...) without a taper, or None for fixed pads")
    place = Place.of(label, position, axis, first)
    held: Any = scene.ground if support is None else support
    R, names = 0.5 * (low + high), [f"{name} pad {number}" for number in range(1, len(pads) + 1)]
    face = Cone(radius=R, axis_point=(0, 0, 0), axis_direction=(0, -1, 0), half_angle=STEEPNESS)
    z = (np.array([low, high]) - R) / np.tan(STEEPNESS)
    extents = [((-pad.middle - 0.5 * pad.arc, -pad.middle + 0.5 * pad.arc), tuple(z)) for pad in pads]
    axes = np.stack([place.axes[0], place.axis, -place.axes[1]], axis=1)
    where: dict[str, Any] = {"position": place.center, "rotation": rot.quaternion(axes)}
    of_films = importlib.import_module("warpffrf.offline").rigid_film_body
    ports: list[SurfacePort] = []
    behind: list[Any] = []  # pivots of tilting pads, on what holds them
    if tilting is None:
        reduced = of_films(
            LIGHT, (LIGHT * high**2,) * 3, contact=dict.fromkeys(names, face),
            extent=dict(zip(names, extents, strict=True)), nodes=nodes,
        )  # fmt: skip
        body = scene.add_body(reduced, name=name, **where)
        scene.add(Fixed(held.at(held.to_user(place.center)), body["center"], name=name))
        ports = [body[called] for called in names]
    else:
        for called, pad, extent in zip(names, pads, extents, strict=True):
            at = pad.narrowest(sense)
            back = np.array([R * np.cos(at), -tilting.thickness, -R * np.sin(at)])
            mass, center, inertia = _sector(pad, low, high, tilting)
            reduced = of_films(
                mass, inertia, contact={"pad": face}, extent=extent, nodes=nodes, points={"pivot": back},
                center_of_mass=center, thickness=tilting.thickness,
            )  # fmt: skip
            body = scene.add_body(reduced, name=called, **where)
            behind.append(held.at(held.to_user(place.center + axes @ back)))
            outward, around = place.outward(at), place.around(at)
            line = tilting.pivot == "line"
            joint = Revolute(behind[-1], body["pivot"], axis=outward, name=called) if line else Universal(
                behind[-1], body["pivot"], axis=outward, second_axis=around, name=called
            )  # fmt: skip
            scene.add(joint)
            ports.append(body["pad"])
    film = partial(Film, oil=oil, ambient_pressure=ambient_pressure, cavitation=cavitation, mixed=mixed)
    warm, found = downstream(temperature, pads, names, sense), []
    for i, (called, pad, port) in enumerate(zip(names, pads, ports, strict=True)):
        inlet = AxialGroove(-pad.middle + 0.5 * sense * pad.arc, SLACK * R, feed_pressure)
        made = film(port, runner, name=called, form_a=_face(pad, sense, depth, flat, z), feeds=[inlet],
                    temperature=warm[i])  # fmt: skip
        found.append(scene.add(made))
        if tilting is not None:
            k = tilting.tilt_stiffness
            if k is None:
                speed = float(np.linalg.norm(getattr(runner.body, "angular_velocity", 0.0)))
                k = SOFT * float(oil.viscosity) * speed * R**6 * pad.arc**4 / float(made.initial_gap().min()) ** 3
            if k:
                scene.add(Bushing(behind[i], port.body["pivot"], (0.0, 0.0, 0.0, k, k, k), name=called))
    return found


def _face(pad: Pad, sense: int, depth: float, land: float, z: Array) -> MeasuredForm:
    """What makes the cone a plane, with the taper of a fixed pad."""
    leading, trailing = -pad.middle + 0.5 * sense * pad.arc, -pad.middle - 0.5 * sense * pad.arc
    theta = np.array([leading, leading + (1.0 - land) * (trailing - leading)])
    order = np.argsort(theta)
    missing = np.array([depth, 0.0])[order]
    return MeasuredForm(theta[order], z, missing[:, None] - z[None, :], periodic=False)


def _sector(pad: Pad, low: float, high: float, tilting: TiltingPads) -> tuple[float, Array, Array]:
    """Mass [kg], centre of mass (3,) [m] and inertia (3, 3) [kg m2] about it, user frame."""
    x, w = np.polynomial.legendre.leggauss(16)
    r, angle = 0.5 * (low + high) + 0.5 * (high - low) * x, pad.middle + 0.5 * pad.arc * x
    m = tilting.density * tilting.thickness * np.outer(0.5 * (high - low) * w * r, 0.5 * pad.arc * w).ravel()
    flat = np.outer(r, np.cos(angle)).ravel(), 0.0 * m, -np.outer(r, np.sin(angle)).ravel()
    at = np.stack(flat, axis=1)
    mass = float(m.sum())
    center = m @ at / mass
    off = at - center
    through = np.diag([1.0, 0.0, 1.0]) * tilting.thickness**2 / 12.0 * mass
    inertia = (m @ np.sum(off**2, axis=1)) * np.eye(3) - (off.T * m) @ off + through
    return mass, center - np.array([0.0, 0.5 * tilting.thickness, 0.0]), inertia
