r"""Journal bearings in one call: plain, lemon, offset-halves, multi-lobe and pressure-dam bearings, and tilting pads.

A bearing is a list of pads around a journal of radius R. With the clearance c of a pad, its radius of curvature is
R + c; its centre of curvature lies m c off the bearing's axis, m the preload, away from the angle theta_p at the
fraction `offset` of its arc from the leading edge. The gap of a journal at e is

    h = c - m c cos(theta - theta_p) - e.n(theta),

and the least one of a centred journal (1 - m) c. Two pads with a preload are a lemon bearing, two with an offset near 1
offset halves, three and more a multi-lobe bearing; a dam is a pocket from the leading edge on, which ends in a step.
Grooves lie between fixed pads, which are one bore with these forms. A tilting pad is a body of its own, whose pivot is
behind theta_p, on its back.
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.parts import Place
from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.errors import InputError, require_count, require_number, unknown_name
from warpffrf.model.films.feeds import AxialGroove
from warpffrf.model.films.film import Film
from warpffrf.model.films.heat import FilmTemperature
from warpffrf.model.films.roughness import MixedLubrication
from warpffrf.model.forces import Bushing
from warpffrf.model.joints import Fixed, Joint, Revolute, Universal
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils import Oil
from warpffrf.model.surfaces import Bore
from warpffrf.model.surfaces.form_deviations import Form, PadForm, PocketForm

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

Array = np.ndarray
TURN = 2.0 * np.pi
SLACK = 1e-6  # of an angle or a width: round-off at the edges of pads, where nodes lie
WALL = 0.25  # of the radius: the wall of a bore in pictures
LIGHT = 1e-3  # kg: a bore that its support carries
PIVOTS = ("line", "point")
SOFT = 1e-3  # of the stiffness of a film against tilting


@named_arguments
@dataclass(frozen=True)
class Dam:
    """A pressure dam: a pocket `depth` [m] deep from the leading edge of its pad over `arc` [rad], `width` [-] of the
    length of the bearing wide, in its middle. Raises `InputError`."""

    depth: float
    arc: float
    width: float = 0.75

    def __post_init__(self) -> None:
        for name, unit in (("depth", "[m]"), ("arc", "[rad]"), ("width", "[-]")):
            value = require_number(getattr(self, name), f"films.Dam: {name} {unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.width >= 1.0:
            raise InputError(f"films.Dam: width must be below 1, as land remains at both ends, got {self.width:g}")


@named_arguments
@dataclass(frozen=True)
class Pad:
    """A pad of a journal bearing: the angle of its `middle` and its `arc` [rad], `preload` [-] below 1, 0 for a pad
    that is concentric; offset [-]: fraction of the arc from the leading edge to the narrowest gap, or to the pivot of a
    tilting pad; dam: `films.Dam(...)` of a fixed pad. Angles are those around the axis of the bearing. Raises
    `InputError`."""

    middle: float
    arc: float
    preload: float = 0.0
    offset: float = 0.5
    dam: Dam | None = None

    def __post_init__(self) -> None:
        for name, unit in (("middle", "[rad]"), ("arc", "[rad]"), ("preload", "[-]"), ("offset", "[-]")):
            value = require_number(getattr(self, name), f"films.Pad: {name} {unit}", positive=name == "arc")
            object.__setattr__(self, name, value)
        if self.arc > TURN or self.preload >= 1.0:
            raise InputError(
                f"films.Pad: arc must be at most 2 pi and preload below 1, got {self.arc:g} rad and {self.preload:g}"
            )
        if self.dam is not None and not isinstance(self.dam, Dam):
            raise InputError(f"films.Pad: dam must be films.Dam(...) or None, got {self.dam!r}")
        if self.dam is not None and self.dam.arc >= self.arc:
            raise InputError(f"films.Pad: its dam ends at {self.dam.arc:g} rad, beyond its arc of {self.arc:g} rad")

    @property
    def within(self) -> tuple[float, float]:
        """Its edges [rad], with some slack."""
        half = 0.5 * self.arc * (1.0 + SLACK)
        return self.middle - half, self.middle + half

    def narrowest(self, sense: int) -> float:
        """theta_p [rad]; sense: as of a bearing."""
        return self.middle + sense * (self.offset - 0.5) * self.arc

    def pocket(self, sense: int) -> tuple[float, float]:
        """Angles [rad] of its dam; sense: as of a bearing."""
        assert self.dam is not None
        edge = self.middle - 0.5 * sense * self.arc
        low, high = sorted((edge, edge + sense * self.dam.arc))
        return low, high


@named_arguments
def pads(count: int, arc: float, *, first: float = 0.0, preload: float = 0.0, offset: float = 0.5) -> list[Pad]:
    """`count` equal pads of `arc` [rad] evenly around, the middle of one at the angle `first` [rad]; preload, offset as
    of `films.Pad`. Raises `InputError` for pads that overlap.

    >>> lemon = wf.films.pads(2, 2.8, first=1.571, preload=0.5)
    >>> [round(pad.middle, 2) for pad in lemon]
    [1.57, 4.71]
    """
    count = require_count(count, "films.pads: count", 1)
    found = [Pad(first + k * TURN / count, arc, preload=preload, offset=offset) for k in range(count)]
    refuse_overlap(found, "films.pads")
    return found


@named_arguments
@dataclass(frozen=True)
class TiltingPads:
    """Rigid pads that tilt: their `thickness` [m] and `density` [kg/m3]; the `pivot` is on their back, behind the point
    at the fraction `offset` of the arc: "line", a hinge along the axis, or "point", which also admits tilting along the
    axis. tilt_stiffness [N m/rad] of the pivots holds pads that carry no load, which would otherwise tilt until they
    touch (spragging); None: a thousandth of mu w R^5 L/c^3, the size of that of a film, w the speed of the shaft at the
    start. Raises `InputError`."""

    thickness: float
    pivot: str = "line"
    tilt_stiffness: float | None = None
    density: float = 7850.0

    def __post_init__(self) -> None:
        label = "films.TiltingPads"
        for name, unit in (("thickness", "[m]"), ("density", "[kg/m3]")):
            object.__setattr__(
                self, name, require_number(getattr(self, name), f"{label}: {name} {unit}", positive=True)
            )
        if self.pivot not in PIVOTS:
            raise unknown_name(f"{label}: pivot", self.pivot, PIVOTS)
        if self.tilt_stiffness is not None:
            k = require_number(self.tilt_stiffness, f"{label}: tilt_stiffness [N m/rad]", non_negative=True)
            object.__setattr__(self, "tilt_stiffness", k)


@dataclass(eq=False, repr=False)
class JournalBearing(reprs.Shown):
    """A journal bearing, as made by `scene.add_journal_bearing`: its `place`, its `pads`, the `bodies` that carry the
    `films`, of one bore or by pad, and the `pivots` of tilting pads with their tilt_stiffness [N m/rad]."""

    name: str
    pads: list[Pad]
    place: Place
    bodies: list[Body] = field(default_factory=list)
    films: list[Film] = field(default_factory=list)
    pivots: list[Joint] = field(default_factory=list)
    tilt_stiffness: float = 0.0  # N m/rad, of tilting pads

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "pads": len(self.pads), "films": reprs.names(self.films)}


@named_arguments
def add_journal_bearing(
    scene: Scene,
    name: str,
    journal: SurfacePort,
    pads: Sequence[Pad],
    *,
    clearance: float,
    length: float,
    oil: Oil,
    tilting: TiltingPads | None = None,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    sense: int = 1,
    support: Body | Ground | None = None,
    nodes: tuple[int, int] | None = None,
    feed_pressure: float = 0.0,
    ambient_pressure: float = 0.0,
    cavitation: str = "jfo",
    mixed: MixedLubrication | None = None,
    temperature: FilmTemperature | None = None,
) -> JournalBearing:
    """Add a journal bearing, and return it: with fixed pads a rigid bore with their form, its film, and grooves between
    the pads, with the `name` of the bearing; with `tilting` ones a body, a film and a pivot for each, called "NAME pad
    1" and so on.

    journal: a round surface of the shaft, `shaft["journal"]`, about `axis` at the initial pose. pads:
    `films.pads(...)`, or a list of `films.Pad(...)`; one of 2 pi is a bore without a groove. tilting:
    `films.TiltingPads(...)`, None for fixed pads. clearance [m]: of the pads, their radius of curvature minus that of
    the journal; (1 - preload) of it remains at the pivots of tilting pads. length [m]. position (3,) [m]: of its
    centre, axis (3,), first (3,): direction from which angles count, to `axis` x first; world axes at the initial pose;
    first None: +x made perpendicular to the axis. sense: 1 if the shaft rotates to greater angles, -1 otherwise, which
    decides where pads begin. support: a rigid body or the ground, None: the ground. nodes: (columns, rows) of each
    film, None: 72 x 9 of a bore, 32 x 9 of a tilting pad; edges of pads and dams should lie on columns. feed_pressure
    [Pa]: in the grooves, at the leading edges of tilting pads. ambient_pressure [Pa], cavitation, mixed, temperature:
    as of `Film`; tilting pads are each downstream of the one before. Raises `InputError`.

    >>> scene = wf.Scene()
    >>> round_ = wf.surfaces.Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    >>> shaft = scene.add_rigid_body(1.0, (0.1,) * 3, name="shaft", surfaces={"journal": round_})
    >>> lobes = wf.films.pads(3, 1.745, preload=0.5)
    >>> bearing = scene.add_journal_bearing(
    ...     "b", shaft["journal"], lobes, clearance=1e-4, length=0.1, oil=wf.oils.iso_vg(32, temperature=50)
    ... )
    >>> len(bearing.films)
    1
    """
    at = _Frame.of(f"journal bearing {name!r}", journal, pads, clearance, length, (position, axis, first), sense)
    refuse_overlap(at.pads, at.label)
    held: Any = scene.ground if support is None else support
    bearing = JournalBearing(name, at.pads, at.place)
    film = partial(Film, oil=oil, ambient_pressure=ambient_pressure, cavitation=cavitation, mixed=mixed)
    if tilting is None:
        body = _bore(scene, bearing, at, held, (72, 9) if nodes is None else nodes)
        feeds = [
            AxialGroove(middle, width * at.radius * (1.0 + SLACK), feed_pressure) for middle, width in at.grooves()
        ]
        one = film(body["bore"], journal, name=name, form_a=at.form(), feeds=feeds, temperature=temperature)
        bearing.films.append(scene.add(one))
    elif isinstance(tilting, TiltingPads):
        k = tilting.tilt_stiffness
        if k is None:
            speed = float(np.linalg.norm(getattr(journal.body, "angular_velocity", 0.0)))
            k = SOFT * float(oil.viscosity) * speed * at.radius**5 * at.length / at.clearance**3
        bearing.tilt_stiffness = k
        names = [f"{name} pad {number}" for number in range(1, len(at.pads) + 1)]
        warm = downstream(temperature, at.pads, names, sense)
        for i, pad in enumerate(at.pads):
            body = _tilting_pad(scene, bearing, at, i, tilting, held, (32, 9) if nodes is None else nodes)
            inlet = AxialGroove(pad.middle - 0.5 * sense * pad.arc, SLACK * at.radius, feed_pressure)
            one = film(body["pad"], journal, name=names[i], feeds=[inlet], temperature=warm[i])
            bearing.films.append(scene.add(one))
    else:
        raise InputError(f"{at.label}: tilting must be films.TiltingPads(...) or None for fixed pads, got {tilting!r}")
    scene.journal_bearings.append(bearing)
    return bearing


def _bore(scene: Scene, bearing: JournalBearing, at: _Frame, held: Any, nodes: tuple[int, int]) -> Body:
    """The body of fixed pads, in `held`."""
    hole = Bore(radius=at.radius, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    reduced = at.rigid_film_body(
        LIGHT, (LIGHT * at.radius**2,) * 3, contact={"bore": hole}, extent=at.ends, nodes=nodes,
        thickness=WALL * at.radius,
    )  # fmt: skip
    body = scene.add_body(reduced, name=bearing.name, position=at.place.center, rotation=at.rotation)
    scene.add(Fixed(held.at(held.to_user(at.place.center)), body["center"], name=bearing.name))
    bearing.bodies.append(body)
    return body


def _tilting_pad(
    scene: Scene, bearing: JournalBearing, at: _Frame, i: int, tilting: TiltingPads, held: Any, nodes: tuple[int, int]
) -> Body:
    """The body of pad i, on its pivot on `held`."""
    pad, called, t = at.pads[i], f"{bearing.name} pad {i + 1}", tilting.thickness
    if pad.dam is not None:
        raise InputError(f"{at.label}: pad {i + 1} has a dam, which fixed pads have; leave it out")
    towards = at.outward(pad.narrowest(at.sense))
    back = (at.radius + t) * towards
    shape = Bore(radius=at.radius, axis_point=-pad.preload * at.clearance * towards, axis_direction=(0, 1, 0))
    mass, center, inertia = at.sector(pad, t, tilting.density)
    edges = (pad.middle - 0.5 * pad.arc, pad.middle + 0.5 * pad.arc)
    reduced = at.rigid_film_body(
        mass, inertia, contact={"pad": shape}, extent=(edges, at.ends), nodes=nodes, points={"pivot": back},
        center_of_mass=center, thickness=t,
    )  # fmt: skip
    body = scene.add_body(reduced, name=called, position=at.place.center, rotation=at.rotation)
    behind = held.at(held.to_user(at.place.center + at.world(back)))
    if tilting.pivot == "line":
        joint: Joint = Revolute(behind, body["pivot"], axis=at.place.axis, name=called)
    else:
        around = at.place.around(pad.narrowest(at.sense))
        joint = Universal(behind, body["pivot"], axis=at.place.axis, second_axis=around, name=called)
    bearing.pivots.append(scene.add(joint))
    if k := bearing.tilt_stiffness:
        scene.add(Bushing(behind, body["pivot"], (0.0, 0.0, 0.0, k, k, k), name=called))
    bearing.bodies.append(body)
    return body


@dataclass(frozen=True)
class _Frame:
    """Checked arguments; user frames of bores and pads have the bearing's axis along +y, angles from +x to -z."""

    label: str
    pads: list[Pad]
    clearance: float  # m
    length: float  # m
    radius: float  # m, of curvature of the pads
    place: Place
    sense: int

    @classmethod
    def of(
        cls, label: str, journal: Any, pads: Any, clearance: float, length: float, where: tuple, sense: int
    ) -> _Frame:
        shape = getattr(getattr(journal, "surface", None), "shape", None)
        if not isinstance(journal, SurfacePort) or shape is None or shape.profile().planar or shape.side < 0.0:
            raise InputError(
                f"{label}: journal must be a round surface of the shaft, shaft['journal'], got {journal!r}"
            )
        if not isinstance(pads, Sequence) or not pads or not all(isinstance(pad, Pad) for pad in pads):
            raise InputError(f"{label}: pads must be films.pads(...) or a list of films.Pad(...), got {pads!r}")
        if sense not in (1, -1):
            raise InputError(f"{label}: sense must be 1 or -1, got {sense!r}")
        c = require_number(clearance, f"{label}: clearance [m]", positive=True)
        L = require_number(length, f"{label}: length [m]", positive=True)
        return cls(label, list(pads), c, L, float(shape.radius_at(0.0)) + c, Place.of(label, *where), sense)

    @property
    def rigid_film_body(self) -> Any:
        """That of `warpffrf.offline`, which imports the model."""
        return importlib.import_module("warpffrf.offline").rigid_film_body

    @property
    def ends(self) -> tuple[float, float]:
        return -0.5 * self.length, 0.5 * self.length

    @property
    def axes(self) -> Array:
        """Columns (3, 3): directions of the user frame in the world."""
        first, around, axis = self.place.axes
        return np.stack([first, axis, -around], axis=1)

    @property
    def rotation(self) -> Array:
        return rot.quaternion(self.axes)

    def world(self, vector: Array) -> Array:
        return self.axes @ vector

    @staticmethod
    def outward(angle: float) -> Array:
        """Unit vector (3,) of the user frame."""
        return np.array([np.cos(angle), 0.0, -np.sin(angle)])

    def form(self) -> Form | None:
        """Of fixed pads."""
        form: Form | None = None
        for pad in self.pads:
            parts: list[Form] = []
            if pad.preload:
                parts.append(PadForm(pad.preload * self.clearance, pad.narrowest(self.sense), pad.within))
            if pad.dam is not None:
                half = 0.5 * pad.dam.width * self.length * (1.0 + SLACK)
                parts.append(PocketForm(pad.dam.depth, pad.pocket(self.sense), (-half, half)))
            for part in parts:
                form = part if form is None else form + part
        return form

    def grooves(self) -> list[tuple[float, float]]:
        """Middle and arc [rad] between pads."""
        edges = sorted((pad.middle - 0.5 * pad.arc, pad.middle + 0.5 * pad.arc) for pad in self.pads)
        following = [begin for begin, _ in edges[1:]] + [edges[0][0] + TURN]
        gaps = [(0.5 * (end + begin), begin - end) for (_, end), begin in zip(edges, following, strict=True)]
        return [(middle, arc) for middle, arc in gaps if arc > SLACK]

    def sector(self, pad: Pad, thickness: float, density: float) -> tuple[float, Array, Array]:
        """Mass [kg], centre of mass (3,) [m] and inertia (3, 3) [kg m2] about it, user frame."""
        x, w = np.polynomial.legendre.leggauss(16)
        r = self.radius + 0.5 * thickness * (x + 1.0)
        angle = pad.middle + 0.5 * pad.arc * x
        m = density * self.length * np.outer(0.5 * thickness * w * r, 0.5 * pad.arc * w).ravel()
        at = (r[:, None, None] * np.stack([self.outward(a) for a in angle])).reshape(-1, 3)
        mass = float(m.sum())
        center = m @ at / mass
        off = at - center
        along = np.diag([1.0, 0.0, 1.0]) * self.length**2 / 12.0 * mass
        return mass, center, (m @ np.sum(off**2, axis=1)) * np.eye(3) - (off.T * m) @ off + along


def refuse_overlap(found: Sequence[Pad], label: str) -> None:
    edges = sorted((pad.middle - 0.5 * pad.arc, pad.middle + 0.5 * pad.arc) for pad in found)
    following = [begin for begin, _ in edges[1:]] + [edges[0][0] + TURN]
    for (_, end), begin in zip(edges, following, strict=True):
        if begin < end - SLACK:
            raise InputError(f"{label}: pads overlap at {end:.4g} rad; give them smaller arcs, or move them apart")


def downstream(
    temperature: FilmTemperature | None, pads: Sequence[Pad], names: Sequence[str], sense: int
) -> list[FilmTemperature | None]:
    """Of the films called `names` of all pads, each downstream of the one before it."""
    if temperature is None or len(pads) == 1:
        return [temperature] * len(pads)
    order = sorted(range(len(pads)), key=lambda i: pads[i].middle)
    before = [order[(order.index(i) - sense) % len(pads)] for i in range(len(pads))]
    return [replace(temperature, upstream=names[i]) for i in before]
