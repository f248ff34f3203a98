"""One bearing of a run: one column per rolling element, and quantities of the whole bearing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from warpffrf.model import rotation as rot
from warpffrf.model.bearings.flanges import ENDS
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, from_description
from warpffrf.model.bearings.life import BasicLife, ReferenceLife, basic_life, reference_life
from warpffrf.model.bearings.lubrication import CONDUCTIVITY
from warpffrf.model.bearings.modified_life import (
    DutyLife,
    ModifiedLife,
    fatigue_load_limit,
    modified_life,
    static_safety,
)
from warpffrf.model.bearings.rating import is_thrust, static_load_factors
from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.model.oils import Oil
from warpffrf.online.history.history import BodyHistory, History
from warpffrf.output.bearings import cage
from warpffrf.output.bearings.duty import duty_life
from warpffrf.output.bearings.films import Films, film_thickness
from warpffrf.output.bearings.patches import (
    Patches,
    ShearBelow,
    ball_patches,
    cut_off,
    lamina_pressure,
    roller_patches,
    shear_below,
    whole_peaks,
)

LOADED = 1e-9  # of the largest load: an element below is unloaded, without a direction of force
GROUND = "ground"
MM, UM, MPA = 1e3, 1e6, 1e-6
ROUND_OFF = 1e-9  # of the largest value of a column: smaller ones are shown as 0
NO_TILT = 1e-9  # rad


class BearingResult(reprs.Shown):
    """A bearing as returned by `result.bearing(name)`; SI units, arrays (T, Z): one row per saved step, one column per
    element, of a double-row bearing those of the first row first, of a four-point one per ball and arc.

    Directions are those of the bearing's frame, which is fixed to the outer ring: towards the initial position of the
    first element, 90 degrees further, and along the axis. Distributed contact, of flexible rings or elements, has
    loads, contact angles, peak pressures and friction losses here, its patches in `result.contact(name)`.
    """

    _hidden = frozenset({"history", "description"})

    def __init__(self, history: History, description: Mapping[str, Any]) -> None:
        self.history, self.description = history, description
        self.name, self.kind = str(description["name"]), str(description["kind"])
        self.geometry = from_description(description["geometry"])
        self.time = history.time  # (T,) s
        self.elements = list(description["elements"])

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "elements": f"{len(set(self.elements))} {self.kind}s", "rows": len(self.time)}

    # --- frame

    @cached_property
    def axes(self) -> np.ndarray:
        """(T, 3, 3): rows are the directions of the bearing's frame, world axes."""
        first = np.asarray(self.description["axes"])
        return np.einsum("tij,kj->tki", self._turned(self.description["outer"]), first)

    @cached_property
    def center(self) -> np.ndarray:
        """(T, 3) m: the centre, fixed to the outer ring, world axes."""
        return self._carried(self.description["outer"])

    @cached_property
    def angle(self) -> np.ndarray:
        """(T, Z) rad: positions of the elements about the axis, from the initial position of the first one, between -pi
        and pi."""
        d = self._directions
        return np.arctan2(d[..., 1], d[..., 0])

    @cached_property
    def _directions(self) -> np.ndarray:
        """(T, Z, 3): unit vectors from the axis to the elements, bearing's frame."""
        place = np.stack([self.history.bodies[name].position for name in self.elements], axis=1)
        local = np.einsum("tki,tzi->tzk", self.axes, place - self.center[:, None])
        local[..., 2] = 0.0
        return local / np.linalg.norm(local, axis=-1, keepdims=True)

    # --- elements

    @cached_property
    def inner_load(self) -> np.ndarray:
        """(T, Z) N, normal force between element and inner ring."""
        return self._loads_of("inner")

    @cached_property
    def outer_load(self) -> np.ndarray:
        """(T, Z) N, normal force between element and outer ring."""
        return self._loads_of("outer")

    @cached_property
    def inner_angle(self) -> np.ndarray:
        """(T, Z) rad, contact angle on the inner ring, of the normal force (of distributed contact the whole force),
        positive if that ring is pushed back against the axis; nan without a load."""
        return self._angles_of("inner")

    @cached_property
    def outer_angle(self) -> np.ndarray:
        """(T, Z) rad, contact angle on the outer ring, with the same sign convention."""
        return self._angles_of("outer")

    @cached_property
    def inner_patches(self) -> Patches:
        """Hertz half-axes and peak pressures (T, Z) on the inner ring; lumped contact only."""
        return self._patches_of("inner")

    @cached_property
    def outer_patches(self) -> Patches:
        """Hertz half-axes and peak pressures (T, Z) on the outer ring; lumped contact only."""
        return self._patches_of("outer")

    @cached_property
    def peak_pressure(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z) Pa: largest of distributed contact; Hertz's at the load of rigid elements."""
        return {side: self._patches(side).peak_pressure if self._lumped(side) else self._peaks(side) for side in SIDES}

    def _peaks(self, side: str) -> np.ndarray:
        pairs, none = self.history.contacts, np.zeros((len(self.time), 1, 1))
        patches = [pairs[name].pressure if name in pairs else none for name in self._names(side)]
        found = np.stack([pressure.max(axis=(1, 2)) for pressure in patches], axis=1)
        if (rigid := self.description.get("rigid_elements")) is not None:
            at, load, angle = rigid["columns"], self._loads(side), np.nan_to_num(self._angles(side))
            found[:, at] = whole_peaks(self.geometry, side, load[:, at], angle[:, at], rigid["moduli"][side])
        return found

    @cached_property
    def lamina_load(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z, n) N, normal force of each lamina of the rollers, in their order along the
        axis; for sides of roller bearings in lumped contact."""
        rollers = isinstance(self.geometry, RollerGeometry)
        return {side: self._of_lumped(side, "lamina_force") for side in SIDES if rollers and self._lumped(side)}

    @cached_property
    def lamina_pressure(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z, n) Pa, Hertz peak pressure in each lamina, as `lamina_load`: under a tilt
        largest towards an end of the roller."""
        geometry: Any = self.geometry
        return {side: lamina_pressure(geometry, side, Q, self._modulus) for side, Q in self.lamina_load.items()}

    @cached_property
    def slip_speed(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z) m/s, of the element's surface against the raceway at the point of force; for
        sides in lumped contact."""
        return {side: self._of_lumped(side, "slip_velocity", norm=True) for side in SIDES if self._lumped(side)}

    @cached_property
    def orbit_speed(self) -> np.ndarray:
        """(T, Z) rad/s, of the elements about the axis in the world, counted about the outer ring's centre."""
        moved, place = self._element_motion
        around = np.cross(self.axes[:, None, 2], place)
        return np.einsum("tzi,tzi->tz", moved, around) / np.einsum("tzi,tzi->tz", around, around)

    @cached_property
    def spin(self) -> np.ndarray:
        """(T, Z, 3) rad/s: angular velocity of the elements in the world; components outward, around and along the
        axis."""
        turning = np.stack([self.history.bodies[name].angular_velocity for name in self.elements], axis=1)
        return np.einsum("tzki,tzi->tzk", self._element_axes, turning)

    @cached_property
    def spin_to_roll(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z): spin-to-roll ratio of an element on the raceway, components of its angular
        velocity against the ring along and normal to the line of contact; nan without a load."""
        found = {}
        for side in SIDES:
            body = self._body(self.description[side])
            ring = np.zeros((len(self.time), 1, 3)) if body is None else body.angular_velocity[:, None]
            against = self.spin - np.einsum("tzki,tzi->tzk", self._element_axes, np.broadcast_to(ring, self.spin.shape))
            angle = self._angles(side)
            line = np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=-1)
            pivoting = np.einsum("tzk,tzk->tz", against, line)
            found[side] = pivoting / np.linalg.norm(against - pivoting[..., None] * line, axis=-1)
        return found

    @cached_property
    def gyroscopic_moment(self) -> np.ndarray:
        """(T, Z) N m, about the circumferential direction: changes the rotation axis of an element along its orbit, I
        w_c w_r."""
        return np.array(self.description["inertia"]) * self.orbit_speed * self.spin[..., 0]

    @cached_property
    def _element_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocities of the elements [m/s] and positions from the axis [m] relative to the outer ring's centre (T, Z,
        3)."""
        bodies = [self.history.bodies[name] for name in self.elements]
        center = self._carried_velocity(self.description["outer"])
        moved = np.stack([body.velocity for body in bodies], axis=1) - center[:, None]
        place = np.stack([body.position for body in bodies], axis=1) - self.center[:, None]
        along = self.axes[:, None, 2]
        return moved, place - np.einsum("tzi,tzi->tz", place, np.broadcast_to(along, place.shape))[..., None] * along

    @cached_property
    def _element_axes(self) -> np.ndarray:
        """(T, Z, 3, 3): rows are the directions outward, around and along the axis at each element, world axes."""
        outward = np.einsum("tzk,tki->tzi", self._directions, self.axes)
        along = np.broadcast_to(self.axes[:, None, 2], outward.shape)
        return np.stack([outward, np.cross(along, outward), along], axis=2)

    @cached_property
    def cage_force(self) -> np.ndarray:
        """(T, Z) N, of the cage on the elements in the circumferential direction, positive if it drives them forward; 0
        without cage."""
        return cage.force(self)

    @cached_property
    def cage_deflection(self) -> dict[str, np.ndarray]:
        """Interface with walls of a flexible cage, "bar_3" -> (T, 3) m: its displacement against the mean motion of the
        cage, outward, around and along the axis; empty for other cages."""
        return cage.deflections(self)

    @cached_property
    def cut_off(self) -> dict[str, np.ndarray]:
        """ "inner" and "outer" -> (T, Z) -, fraction of the ellipse beyond the ring's shoulder, if known, for sides in
        lumped contact."""
        found: dict[str, np.ndarray] = {}
        if not isinstance(self.geometry, BallGeometry):
            return found
        for side, height in zip(SIDES, self.geometry.shoulders, strict=True):  # pyright: ignore[reportArgumentType]
            if height is not None and self._lumped(side):
                angle = np.nan_to_num(self._angles(side))
                found[side] = cut_off(self.geometry, side, self._patches(side), angle, height)
        return found

    # --- rings

    @cached_property
    def displacement(self) -> np.ndarray:
        """(T, 3) m, displacement of the inner ring's centre against the outer ring since the initial pose, bearing's
        frame."""
        moved = self._carried(self.description["inner"]) - self.center
        return np.einsum("tki,ti->tk", self.axes, moved)

    @cached_property
    def tilt(self) -> np.ndarray:
        """(T, 3) rad, rotation vector of the inner ring against the outer one since the initial pose, bearing's frame;
        the third component is the rotation about the axis."""
        inner, outer = (self._turned(self.description[side]) for side in SIDES)
        relative = np.einsum("tji,tjk->tik", outer, inner)
        return Rotation.from_matrix(relative).as_rotvec() @ np.asarray(self.description["axes"]).T

    @cached_property
    def force(self) -> np.ndarray:
        """(T, 3) N, of the elements on the inner ring, at its raceway and its ribs, bearing's frame."""
        ribs = [self.history.lumped_contacts[name].force for each in self._ribs("inner") for name in each]
        total = -sum([*self._forces("inner"), *ribs], np.zeros((len(self.time), 3)))
        return np.einsum("tki,ti->tk", self.axes, total)

    @cached_property
    def friction_torque(self) -> np.ndarray:
        """(T,) N m, friction torque of the elements on the inner ring about its axis, including ribs, rolling
        resistance and pivoting, negative if it opposes a positive speed."""
        body = self._body(self.description["inner"])
        along = self._turned(self.description["inner"]) @ np.asarray(self.description["axes"])[2]
        center = self._carried(self.description["inner"])
        total = np.zeros((len(self.time), 3))
        for name in [*self._names("inner"), *(name for each in self._ribs("inner") for name in each)]:
            if name in self.history.lumped_contacts:
                contact = self.history.lumped_contacts[name]
                total -= np.cross(contact.place - center, contact.friction_force) + contact.moment
            else:
                force, torque = self._on_ring(name)
                origin = np.zeros(3) if body is None else body.position
                total += torque + np.cross(origin - center, force)
        return np.einsum("ti,ti->t", along, total)

    @cached_property
    def friction_power(self) -> dict[str, np.ndarray]:
        """ "inner", "outer", "cage" and "flange" -> (T, Z) W: friction power, force times slip speed and moment times
        angular velocity, for distributed contact integrated over its patch. The cage acts in its pockets, flanges at
        the ribs of both rings; 0 without them."""
        names = {side: [[name] for name in self._names(side)] for side in SIDES}
        known = self.description["contacts"]
        names["cage"] = [
            [known[key] for key in known if key == f"pocket_{i + 1}" or key.startswith(f"pocket_{i + 1}_")]
            for i in range(len(self.elements))
        ]
        names["flange"] = [inner + outer for inner, outer in zip(*map(self._ribs, SIDES), strict=True)]
        found = {side: np.zeros((len(self.time), len(self.elements))) for side in names}
        for side, each in names.items():
            for i, contacts in enumerate(each):
                for name in contacts:
                    if name in self.history.lumped_contacts:
                        one = self.history.lumped_contacts[name]
                        found[side][:, i] -= np.einsum("ti,ti->t", one.friction_force, one.slip_velocity)
                        if side in SIDES:
                            found[side][:, i] -= np.einsum("ti,ti->t", one.moment, self._turning(i, side))
                    elif (friction := self.history.contacts[name].friction) is not None:
                        found[side][:, i] += friction.power
        return found

    def _turning(self, i: int, side: str) -> np.ndarray:
        """(T, 3) rad/s, of an element against a ring, world axes."""
        ring = self._body(self.description[side])
        element = self.history.bodies[self.elements[i]].angular_velocity
        return element if ring is None else element - ring.angular_velocity

    # --- the whole

    def basic_life(
        self, capacity: float | None = None, row: int = -1, *, X: float | None = None, Y: float | None = None
    ) -> BasicLife:
        """Basic rating life of ISO 281 at the load of the saved step `row`: capacity [N], factors X and Y of a
        catalogue, None for those of the geometry, `dynamic_rating` and `load_factors`.

        Raises `InputError` if the equivalent load is zero.
        """
        capacity = self.geometry.dynamic_rating if capacity is None else capacity
        radial, axial = float(np.hypot(*self.force[row, :2])), float(self.force[row, 2])
        if X is None or Y is None:
            own = self.geometry.load_factors(radial, axial)
            X, Y = (known if given is None else given for known, given in zip(own, (X, Y), strict=True))
        return basic_life(self.kind, capacity, radial, axial, X=X, Y=Y)

    def reference_life(self, capacity: float | None = None, row: int = -1, *, turning: str = "inner") -> ReferenceLife:
        """Reference rating life of ISO/TS 16281 from the loads of the balls, or of the rollers' laminae, at the saved
        step `row`; capacity [N], None for `dynamic_rating` of the geometry; turning: the ring that rotates relative to
        the load. Raises `InputError` for rollers in distributed contact, which have no laminae."""
        capacity = self.geometry.dynamic_rating if capacity is None else capacity
        if isinstance(self.geometry, BallGeometry):
            return reference_life(self.geometry, capacity, self.inner_load[row], self.outer_load[row], turning=turning)
        inner, outer = (self._laminae(side)[row] for side in SIDES)
        return reference_life(self.geometry, capacity, inner, outer, turning=turning)

    def modified_life(
        self, capacity: float | None = None, static_capacity: float | None = None, *, kappa: float,
        contamination: float, reliability: float = 90.0, row: int = -1, turning: str = "inner",
    ) -> ModifiedLife:  # fmt: skip
        """Modified reference life of ISO/TS 16281, a_1 a_ISO L_10r, at the saved step `row`: capacity and
        static_capacity C_0 [N], None for the ratings of the geometry; kappa [-]: viscosity ratio,
        `bearings.viscosity_ratio` or the film parameter to the power 1.3; contamination [-]: e_C,
        `bearings.contamination_factor`; reliability [%]; turning: the ring that rotates relative to the load. Raises
        `InputError`."""
        found = self.reference_life(capacity, row, turning=turning)
        static_capacity = self.geometry.static_rating if static_capacity is None else static_capacity
        limit = fatigue_load_limit(self.kind, static_capacity, self.geometry.pitch_diameter)
        thrust = is_thrust(self.geometry.contact_angle)
        return modified_life(self.kind, found, limit, kappa, contamination, reliability=reliability, thrust=thrust)

    def duty_life(
        self, shares: ArrayLike, speed: ArrayLike, capacity: float | None = None,
        static_capacity: float | None = None, *, kappa: ArrayLike | None = None,
        contamination: ArrayLike | None = None, reliability: float = 90.0, turning: str = "inner",
    ) -> DutyLife:  # fmt: skip
        """Life under a load spectrum whose points are the saved steps, by the rule of Palmgren and Miner from the
        reference life at each, or the modified one with `kappa` and `contamination`.

        shares (T,) [-]: of the time, with the sum 1; speed [rad/s] of the rings against each other; kappa [-], the
        viscosity ratio, and contamination [-], e_C; the three one number or (T,). capacity and static_capacity [N],
        reliability [%] and turning as of `modified_life`. A step without load or speed does no damage. `wf.static`
        makes such steps: with loads as signals over the number of the point, from 0 on, and a step of 1. Raises
        `InputError`.
        """
        return duty_life(self, shares, speed, capacity, static_capacity, kappa, contamination, reliability, turning)

    def static_safety(
        self, static_capacity: float | None = None, row: int = -1, *, X: float | None = None, Y: float | None = None
    ) -> float:
        """s_0 = C_0/P_0 [-] of ISO 76 at the load of the saved step `row`: static_capacity C_0 [N]; X, Y [-]:
        factors X_0 and Y_0; None for those of the geometry (`model.bearings.rating`). Raises `InputError` without a
        load."""
        geometry, F = self.geometry, self.force[row]
        tabulated = isinstance(geometry, BallGeometry) and not geometry.self_aligning
        own = static_load_factors(geometry.contact_angle, geometry.rows, tabulated=tabulated)
        X, Y = (known if given is None else given for known, given in zip(own, (X, Y), strict=True))
        static_capacity = geometry.static_rating if static_capacity is None else static_capacity
        return static_safety(static_capacity, float(np.hypot(F[0], F[1])), float(F[2]), X=X, Y=Y)

    # --- lubrication, below the raceways

    def film_thickness(
        self, oil: Oil, *, roughness: float | Sequence[float] | None = None, thinning: float | None = None,
        conductivity: float = CONDUCTIVITY, inlet: float | None = None,
    ) -> dict[str, Films]:  # fmt: skip
        """ "inner" and "outer" -> films (T, Z) [m] of the contacts, by Hamrock and Dowson (1977) of balls, by Dowson
        (1968) of rollers (`model.bearings.lubrication`), from loads and motion of the run.

        oil: oils.Barus or oils.Roelands, with the viscosity at the temperature of the inlet. roughness [m]: Rq of
        elements and raceways, (0.05e-6, 0.1e-6), or one number of both together, for the film parameter. thinning
        [1/K]: -d ln(viscosity)/dT, for the effect of heat with the conductivity [W/(m K)] of the oil; None: isothermal.
        inlet [m]: distance from the centre of a ball's contact where the oil begins; None: fully flooded. Raises
        `InputError`.
        """
        return film_thickness(self, oil, roughness, thinning, conductivity, inlet)

    def shear_below(self, poisson_ratio: float = 0.3) -> dict[str, ShearBelow]:
        """ "inner" and "outer" -> largest shear stress [Pa] below the centres of the Hertz patches, and its depth [m]
        (T, Z), without friction; poisson_ratio [-]. Lumped contact only."""
        return {side: shear_below(self._patches(side), poisson_ratio) for side in SIDES}

    def table(self, row: int = -1) -> dict[str, np.ndarray]:
        """Values of every element at the saved step `row`: column name with unit -> (Z,)."""
        columns = {
            "angle [deg]": np.degrees(self.angle[row]),
            "inner load [N]": self.inner_load[row], "outer load [N]": self.outer_load[row],
            "inner angle [deg]": np.degrees(self.inner_angle[row]),
            "outer angle [deg]": np.degrees(self.outer_angle[row]),
        }  # fmt: skip
        for side in SIDES:
            columns[f"{side} peak [MPa]"] = MPA * self.peak_pressure[side][row]
            if self._lumped(side):
                patches = self._patches(side)
                columns[f"{side} a [mm]"] = MM * patches.half_axis_across[row]
                columns[f"{side} b [mm]"] = MM * patches.half_axis_around[row]
                columns[f"{side} slip [m/s]"] = self.slip_speed[side][row]
        columns["friction [W]"] = np.sum([power[row] for power in self.friction_power.values()], axis=0)
        columns["cage force [N]"] = self.cage_force[row]
        columns |= {f"{side} cut off [%]": 100.0 * share[row] for side, share in self.cut_off.items()}
        return columns

    def report(self, row: int = -1) -> str:
        """The table at the saved step `row` as text, with the motion of the inner ring. Raises `InputError` without
        saved steps."""
        if not len(self.time):
            raise InputError(
                f"bearing {self.name!r}: no step was saved ({self.history.status}: {self.history.message})"
            )
        lines, shown = printed(self, row)
        lines.append("  ".join([f"{'':>3}", *(f"{name:>17}" for name in shown)]))
        for i in range(len(self.elements)):
            lines.append("  ".join([f"{i + 1:>3}", *(f"{cells[i]:>17}" for cells in shown.values())]))
        return "\n".join(lines)

    def _warnings(self, row: int, loaded: int) -> list[str]:
        """Warnings about a bearing without load, or loaded on flanks that are not designed for it."""
        if not loaded:
            return ["no element is loaded: the inner ring is free within the play, or the load unloads all elements"]
        tracks = self.geometry.tracks
        nominal = self.geometry.contact_angle * np.array([tracks[i].sense for _, i in self.geometry.contacts])
        turned = np.count_nonzero(np.nan_to_num(self.inner_angle[row]) * nominal < 0.0)
        if not turned:
            return []
        return [
            f"{turned} {self.kind}s press on the flanks against the sense of the contact angle, "
            f"{np.degrees(self.geometry.contact_angle):.4g} deg, which an angular contact bearing has no shoulder for; "
            "mount the bearing the other way, or preload it"
        ]

    # --- from the histories

    def _lumped(self, side: str) -> bool:
        return all(name in self.history.lumped_contacts for name in self._names(side))

    def _names(self, side: str) -> list[str]:
        return [self.description["contacts"][f"{side}_{i + 1}"] for i in range(len(self.elements))]

    def _ribs(self, side: str) -> list[list[str]]:
        """Names of the contacts of each element with the ribs of a ring."""
        known = self.description["contacts"]
        keys = [[f"flange_{side}_{end}_{i + 1}" for end in ENDS] for i in range(len(self.elements))]
        return [[known[key] for key in each if key in known] for each in keys]

    def _loads(self, side: str) -> np.ndarray:
        return self.inner_load if side == "inner" else self.outer_load

    def _angles(self, side: str) -> np.ndarray:
        return self.inner_angle if side == "inner" else self.outer_angle

    def _patches(self, side: str) -> Patches:
        return self.inner_patches if side == "inner" else self.outer_patches

    def _forces(self, side: str) -> list[np.ndarray]:
        """(T, 3) N each, on the elements, world axes."""
        found = []
        for name in self._names(side):
            if name in self.history.lumped_contacts:
                found.append(self.history.lumped_contacts[name].force)
            else:
                found.append(-self._on_ring(name)[0])
        return found

    def _on_ring(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """(T, 3) N, N m about its origin, world axes: of a distributed contact on the ring; files written before
        flexible elements have the ring first."""
        contact = self.history.contacts[name]
        if name in self.description.get("rings_first", [name]):
            return contact.force, contact.torque
        return contact.force_second, contact.torque_second

    def _loads_of(self, side: str) -> np.ndarray:
        lumped, pairs = self.history.lumped_contacts, self.history.contacts
        loads = [
            lumped[name].normal_force if name in lumped else np.linalg.norm(pairs[name].force, axis=1)
            for name in self._names(side)
        ]
        return np.stack(loads, axis=1)

    def _angles_of(self, side: str) -> np.ndarray:
        sign = 1.0 if side == "inner" else -1.0
        lumped = self.history.lumped_contacts
        rubbed = [lumped[name].friction_force if name in lumped else 0.0 for name in self._names(side)]
        normal = [force - friction for force, friction in zip(self._forces(side), rubbed, strict=True)]
        F = np.einsum("tki,tzi->tzk", self.axes, np.stack(normal, axis=1))
        load = self._loads(side)
        outward = np.einsum("tzk,tzk->tz", F, self._directions)
        angle = np.arctan2(sign * F[..., 2], sign * outward)
        return np.where(load > LOADED * load.max(initial=0.0), angle, np.nan)

    def _patches_of(self, side: str) -> Patches:
        if not self._lumped(side):
            raise InputError(
                f"bearing {self.name!r}: patches of distributed contact are those of the pairs, result.contact(name)"
            )
        if isinstance(self.geometry, BallGeometry):
            load = np.where(np.isnan(self._angles(side)), 0.0, self._loads(side))
            return ball_patches(self.geometry, side, load, np.nan_to_num(self._angles(side)), self._modulus)
        return roller_patches(self.geometry, side, self._laminae(side), self._modulus)

    @property
    def _modulus(self) -> float:
        """E* [Pa] of elements and raceways."""
        return 1.0 / sum(1.0 / E for E in self.description["moduli"])

    def _laminae(self, side: str) -> np.ndarray:
        """(T, Z, n) N, loads of the rollers' laminae."""
        if side not in self.lamina_load:
            raise InputError(f"bearing {self.name!r}: rollers in distributed contact have no laminae; take basic_life")
        return self.lamina_load[side]

    def _of_lumped(self, side: str, what: str, *, norm: bool = False) -> np.ndarray:
        found = np.stack([getattr(self.history.lumped_contacts[name], what) for name in self._names(side)], axis=1)
        return np.linalg.norm(found, axis=-1) if norm else found

    def _body(self, name: str) -> BodyHistory | None:
        return None if name == GROUND else self.history.bodies[name]

    def _turned(self, name: str) -> np.ndarray:
        """(T, 3, 3): rotation of a ring's body since the initial pose."""
        body = self._body(name)
        if body is None:
            return np.broadcast_to(np.eye(3), (len(self.time), 3, 3))
        return rot.matrix(body.rotation) @ rot.matrix(self.description["poses"][name]["rotation"]).T

    def _carried_velocity(self, name: str) -> np.ndarray:
        """(T, 3) m/s, velocity of the bearing's centre as fixed to a ring's body."""
        body = self._body(name)
        if body is None:
            return np.zeros((len(self.time), 3))
        return body.velocity + np.cross(body.angular_velocity, self._carried(name) - body.position)

    def _carried(self, name: str) -> np.ndarray:
        """(T, 3) m: the centre of the bearing as fixed to a ring's body."""
        center = np.asarray(self.description["center"])
        body = self._body(name)
        if body is None:
            return np.broadcast_to(center, (len(self.time), 3))
        lever = center - np.asarray(self.description["poses"][name]["position"])
        return body.position + np.einsum("tij,j->ti", self._turned(name), lever)


def _rounded(values: np.ndarray, least: float = 0.0) -> np.ndarray:
    """`values` with round-off of the largest, and values below `least`, set to zero."""
    size = np.abs(values)
    return np.where(size <= max(ROUND_OFF * np.nan_to_num(size).max(initial=0.0), least), 0.0, values)


def printed(bearing: BearingResult, row: int) -> tuple[list[str], dict[str, list[str]]]:
    """What a report states of a saved step: load, motion of the inner ring, warnings and friction as sentences, and the
    columns of the table that are not zero, name with unit -> text of each element."""
    shown = {name: _rounded(v, NO_TILT if "deg" in name else 0.0) for name, v in bearing.table(row).items()}
    shown = {name: values for name, values in shown.items() if np.any(np.nan_to_num(values))}
    moved = UM * _rounded(bearing.displacement[row])
    tilt = 1e3 * _rounded(bearing.tilt[row][:2], NO_TILT)
    carrying = np.flatnonzero(_rounded(bearing.outer_load[row]))
    count, loaded = len(set(bearing.elements)), len({bearing.elements[i] for i in carrying})
    lines = [
        f"bearing {bearing.name!r} at {bearing.time[row]:.6g} s: {loaded} of {count} {bearing.kind}s loaded",
        f"inner ring moved against the outer one since the start by ({', '.join(f'{x:.5g}' for x in moved)}) um, "
        f"tilted by ({', '.join(f'{x:.4g}' for x in tilt)}) mrad",
        *bearing._warnings(row, loaded),
    ]
    if "friction [W]" in shown:
        torque = f"{bearing.friction_torque[row]:.5g} N m on the inner ring"
        lines.append(f"friction: {torque}, {shown['friction [W]'].sum():.5g} W")
    lines += cage.sentences(bearing, row)
    return lines, {name: ["-" if np.isnan(x) else f"{x:.5g}" for x in values] for name, values in shown.items()}
