"""One gear pair of a run: transmission error, and loads of its pairs of teeth.

With r_b the base radii, d the direction of the path of contact in which the flank of gear 1 pushes, theta the rotations
of the hubs in that sense, and x their displacements, the transmission error is

    TE = r_b2 theta_2 + x_2.d - (r_b1 theta_1 + x_1.d),

along the path of contact, from the angles at which undeformed flanks without relief touch: negative where gear 2 lags.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.gears.gear import Gear
from warpffrf.model.gears.mesh import places
from warpffrf.model.gears.pair import GearPair
from warpffrf.model.messages import reprs

Array = np.ndarray


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

    @property
    def place(self) -> Array:
        """g (T, n) [m], where each pair of teeth is on the path of contact, 0 at the pitch point; outside of
        `pair.path["A"]` to `["E"]` it cannot touch."""
        return np.stack([places(self.pair, self.angle, flank, k) for flank, k, _ in self.teeth], axis=1)

    # --- motion

    @cached_property
    def angle(self) -> Array:
        """Rotation (T,) [rad] of gear 1 from the line of centres about its axis: 0 where tooth 1 lies on it."""
        return self._angle(0)

    @property
    def transmission_error(self) -> Array:
        """TE (T,) [m], along the path of contact, of the first flank; negative where gear 2 lags."""
        flank = self.teeth[0][0]
        s = 1.0 if flank == "right" else -1.0
        lag = self._angle(1) - np.array([self.pair.mating_angle(float(angle), flank) for angle in self.angle])
        pitch = 2.0 * np.pi / self.pair.gear_2.teeth
        lag = np.remainder(lag + 0.5 * pitch, pitch) - 0.5 * pitch
        alpha, (e_0, e_1, _) = self.pair.working_pressure_angle, self._axes
        along = np.sin(alpha) * e_0 - s * np.cos(alpha) * e_1
        apart = (self._moved(1)[1] - self._moved(0)[1]) @ along
        return s * self.pair.side * self.pair.gear_2.base_radius * lag + apart

    @property
    def stiffness(self) -> Array:
        """Load over approach (T,) [N/m], along the path of contact: secant, with the clearance of relieved flanks."""
        error = self.transmission_error
        return np.divide(self.load.sum(axis=1), -error, out=np.full_like(error, np.nan), where=error < 0.0)

    def orders(self, count: int = 5) -> Array:
        """Amplitudes (count,) [m] of the transmission error at 1, 2, ... times the frequency of the teeth: the least
        squares over the angles of gear 1 of all saved steps, which should cover whole pitches."""
        phase = self.pair.gear_1.teeth * np.outer(self.angle, np.arange(1, count + 1))
        columns = np.column_stack([np.ones(len(self.angle)), np.cos(phase), np.sin(phase)])
        found = np.linalg.lstsq(columns, self.transmission_error, rcond=None)[0]
        return np.hypot(found[1 : count + 1], found[count + 1 :])

    # --- inside

    @property
    def _axes(self) -> Array:
        """Rows: direction of the line of centres, across it, axis; world."""
        return np.asarray(self.description["axes"])

    def _angle(self, i: int) -> Array:
        x, (e_0, e_1, _) = self._moved(i)[0], self._axes
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
