"""One gear pair of a run: transmission error, and loads of its pairs of teeth.

With r_b the base radii, d the direction of the path of contact in which the flank of gear 1 pushes, a that of the axis,
theta the rotations of the hubs in that sense, and x their displacements, the transmission error is

    TE = r_b2 theta_2 + x_2.(d + s tan beta_b1 a) - (r_b1 theta_1 + x_1.(d + s tan beta_b1 a)),

along the path of contact, in the transverse section, s = 1 on right and -1 on left flanks, from the angles at which
undeformed flanks without relief touch: negative where gear 2 lags.
The first flank of `teeth` is the one that drives; contacts of the other one, of a pair with `flank="both"`, touch on
the back side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bearings.lubrication import CONDUCTIVITY
from warpffrf.model.errors import unknown_name
from warpffrf.model.gears.gear import Gear
from warpffrf.model.gears.mesh import Teeth, advance, places
from warpffrf.model.gears.pair import GearPair
from warpffrf.model.messages import reprs
from warpffrf.model.oils import Oil
from warpffrf.output.gears import flanks
from warpffrf.output.gears.flanks import ContactPath, FlankFilms, FlankMap
from warpffrf.output.gears.orders import MeshOrders, mesh_orders

Array = np.ndarray
LEAST = 1e-9  # m: smaller approaches have no stiffness


class GearResult(reprs.Shown):
    """A gear pair as returned by `result.gear(name)`; arrays (T,) per saved step, (T, n) per pair of teeth.

    pair: its `GearPair`; teeth: flank and teeth of gears 1 and 2 of each pair of teeth, ("right", 1, 13); contacts:
    names of their contacts, `result.contact(name)`; time (T,) [s].
    """

    _hidden = frozenset({"result", "description"})

    def __init__(self, result: Any, description: Mapping[str, Any]) -> None:
        self.result, self.description = result, description
        self.name, self.time = str(description["name"]), result.time
        one, two = (Gear(**gear) for gear in description["gears"])
        self.pair = GearPair(one, two, float(description["center_distance"]))
        self.teeth = [(str(flank), int(k), int(t)) for flank, k, t, _ in description["contacts"]]
        self.contacts = [str(name) for *_, name in description["contacts"]]

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "pairs of teeth": len(self.teeth), "rows": len(self.time)}

    # --- directions

    @property
    def axes(self) -> Array:
        """(3, 3): rows are the directions of the line of centres, from gear 1 to the teeth in mesh, across it, and of
        the axis; world."""
        return np.asarray(self.description["axes"])

    @property
    def line_of_action(self) -> Array:
        """(3,): direction of the line of action, that of the force of the driving flank of gear 1 in the transverse
        section; world."""
        alpha, s = self.pair.working_pressure_angle, self._signs[0]
        return np.sin(alpha) * self.axes[0] - s * np.cos(alpha) * self.axes[1]

    # --- loads

    @cached_property
    def load(self) -> Array:
        """Normal force (T, n) [N] of each pair of teeth."""
        return np.stack([self.result.contact(name).normal_load for name in self.contacts], axis=1)

    @property
    def load_share(self) -> Array:
        """Share (T, n) of each pair of teeth in the sum of their loads; NaN without load."""
        total = self.load.sum(axis=1, keepdims=True)
        return np.divide(self.load, total, out=np.full_like(self.load, np.nan), where=total > 0.0)

    @cached_property
    def peak_pressure(self) -> Array:
        """Largest pressure (T, n) [Pa] of each pair of teeth."""
        return np.stack([self.result.contact(name).peak_pressure for name in self.contacts], axis=1)

    @cached_property
    def place(self) -> Array:
        """g (T, n) [m], where each pair of teeth is on the path of contact, 0 at the pitch point; outside of
        `pair.path["A"]` to `["E"]` it cannot touch. Of helical gears in the section y = 0, others have touched before
        and touch later (`within`)."""
        return np.stack([places(self.pair, self.angle, flank, k) for flank, k, _ in self.teeth], axis=1)

    @cached_property
    def within(self) -> Array:
        """Whether (T, n) each pair of teeth is on the path of contact, of helical gears in any section."""
        path, found = self.pair.path, []
        for (flank, *_), name, g in zip(self.teeth, self.contacts, self.place.T, strict=True):
            early = advance(self.pair, flank, np.asarray(self.result.contact(name).view.first.grid.z)[[0, -1]])
            found.append((g + early.max() >= path["A"]) & (g + early.min() <= path["E"]))
        return np.stack(found, axis=1)

    @property
    def roll_angle(self) -> Array:
        """xi_1 (T, n) [rad] of gear 1, where each pair of teeth is on the path of contact."""
        return self.pair.roll_angle(self.place)

    # --- motion

    @cached_property
    def angle(self) -> Array:
        """Rotation (T,) [rad] of gear 1 from the line of centres about its axis: 0 where tooth 1 lies on it."""
        return self._angle(0)

    @cached_property
    def transmission_error(self) -> Array:
        """TE (T,) [m], along the path of contact, of the first flank; negative where gear 2 lags."""
        flank, s = self.teeth[0][0], self._signs[0]
        lag = self._angle(1) - np.array([self.pair.mating_angle(float(angle), flank) for angle in self.angle])
        pitch = 2.0 * np.pi / self.pair.gear_2.teeth
        lag = np.remainder(lag + 0.5 * pitch, pitch) - 0.5 * pitch
        lean = s * np.tan(self.pair.base_helix_angle) * self.axes[2]
        apart = (self._moved(1)[1] - self._moved(0)[1]) @ (self.line_of_action + lean)
        return s * self.pair.side * self.pair.gear_2.base_radius * lag + apart

    @property
    def stiffness(self) -> Array:
        """Load over approach (T,) [N/m] of the driving flanks, along their normal: secant, with the clearance of
        relieved flanks; NaN below an approach of a nanometre."""
        error, driving = self.transmission_error * np.cos(self.pair.base_helix_angle), self._driving
        return np.divide(driving, -error, out=np.full_like(error, np.nan), where=error < -LEAST)

    def orders(self, count: int = 5) -> MeshOrders:
        """Mean, peak to peak and amplitudes of the transmission error at 1, 2, ... `count` times the frequency of the
        teeth, with their errors, over the last whole pitches of the run (`orders.MeshOrders`). Raises `InputError` for
        a count below 1."""
        return mesh_orders(self.time, self.angle, self.transmission_error, self.pair.gear_1.teeth, count)

    # --- loss of contact

    def open_intervals(self, teeth: Teeth | None = None) -> Array:
        """Intervals (k, 2) [s], from the first to the last saved step in which a pair of `teeth`, one of `self.teeth`,
        carries nothing within the path of contact; None: in which no pair of the driving flank carries, so that it has
        lifted off. To within a saved step. Raises `InputError` for teeth that the pair does not have."""
        if teeth is None:
            return _intervals(self.time, ~np.any(self._loaded[:, self._signs == self._signs[:1]], axis=1))
        if teeth not in self.teeth:
            raise unknown_name(f"gear pair {self.name!r}: teeth", str(teeth), [*map(str, self.teeth)])
        i = self.teeth.index(teeth)
        return _intervals(self.time, self.within[:, i] & ~self._loaded[:, i])

    def back_intervals(self) -> Array:
        """Intervals (k, 2) [s], from the first to the last saved step in which a pair of teeth carries on the back
        side; to within a saved step. Without any for a pair that has contacts on one flank only."""
        return _intervals(self.time, np.any(self._loaded[:, self._signs != self._signs[:1]], axis=1))

    # --- on the flanks

    def sliding(self, speed: float | None = None) -> Array:
        """v_g (T, n) [m/s], velocity of flank 1 against flank 2 along the flank, positive towards the root of gear 1:
        0 at the pitch point. speed [rad/s]: of gear 1, positive in the direction in which it pushes, for load steps of
        a static run, which have none; None: the speeds of the run. Raises `InputError`."""
        return flanks.sliding(self, speed)

    def flank_map(self, flank: str | None = None, speed: float | None = None) -> FlankMap:
        """Pressure, sliding and wear index over the `flank` of gear 1, "right" or "left", None: the driving one, by
        roll angle and width (`flanks.FlankMap`). speed: as of `sliding`. Raises `InputError` for a flank that the pair
        does not have."""
        sides = tuple(dict.fromkeys(side for side, _, _ in self.teeth))
        if flank is not None and flank not in sides:
            raise unknown_name(f"gear pair {self.name!r}: flank", flank, sides)
        return flanks.flank_map(self, flank or sides[0], speed)

    def contact_path(self, *, nearest: bool = False) -> ContactPath:
        """Where the centres of pressure of the pairs of teeth are on both flanks, against the line of action
        (`flanks.ContactPath`); nearest: the points of least distance of the undeformed flanks instead. Local
        deflections of flexible teeth, and of their hubs, are left out."""
        return flanks.contact_path(self, nearest=nearest)

    def film_thickness(
        self, oil: Oil, *, roughness: float | Sequence[float] | None = None, speed: float | None = None,
        thinning: float | None = None, conductivity: float = CONDUCTIVITY,
    ) -> FlankFilms:  # fmt: skip
        """Films (T, n) of the pairs of teeth by Dowson (1968), NaN without load: thickness [m], entrainment and sliding
        [m/s], film parameter Lambda [-] (`flanks`); on tip roundings films are thinner than these.

        oil: oils.Barus or oils.Roelands, with the viscosity at the temperature of the flanks. roughness [m]: Rq of both
        flanks, (0.4e-6, 0.4e-6), or one number of both together, for the film parameter. speed: as of `sliding`.
        thinning [1/K]: -d ln(viscosity)/dT, for the effect of heat with the conductivity [W/(m K)] of the oil; None:
        isothermal. Raises `InputError`.
        """
        return flanks.film_thickness(self, oil, roughness, speed, thinning, conductivity)

    # --- inside

    @property
    def _signs(self) -> Array:
        """s (n,) of the flank of each pair of teeth: 1 right, -1 left."""
        return np.array([1.0 if flank == "right" else -1.0 for flank, _, _ in self.teeth])

    @property
    def _driving(self) -> Array:
        """Sum (T,) [N] of the loads of the driving flanks."""
        return self.load[:, self._signs == self._signs[:1]].sum(axis=1)

    @property
    def _loaded(self) -> Array:
        return self.load > 0.0

    def _angle(self, i: int) -> Array:
        x, (e_0, e_1, _) = self._moved(i)[0], self.axes
        return np.arctan2(x @ e_1, x @ e_0)

    def _moved(self, i: int) -> tuple[Array, Array]:
        """Direction (T, 3) of tooth 1, and displacement (T, 3) [m] of the gear's centre with its hub."""
        name, start = self.description["bodies"][i], np.asarray(self.description["centers"][i])
        motion, body = self.result.history.bodies[name], self.result.view.bodies[name]
        turned, moved = np.zeros((len(self.time), 3)), np.zeros((len(self.time), 3))
        if body.reduced is not None:
            interface = body.reduced.interfaces[self.description["interfaces"][i]]
            both = motion.modal @ interface.modes
            turned = both[:, 3:]
            moved = both[:, :3] - np.cross(turned, interface.point)
        axes = np.reshape([rot.matrix(q) for q in motion.rotation], (-1, 3, 3))
        tooth = np.array([1.0, 0.0, 0.0]) + np.cross(turned, [1.0, 0.0, 0.0])
        return np.einsum("tij,tj->ti", axes, tooth), motion.position + np.einsum("tij,tj->ti", axes, moved) - start


def _intervals(time: Array, where: Array) -> Array:
    """First and last times (k, 2) of the runs of True in `where` (T,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(int)))
    return time[np.stack([edges[::2], edges[1::2] - 1], axis=1)]
