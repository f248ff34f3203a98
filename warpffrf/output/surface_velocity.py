r"""Velocity of a body's surface by orders of a rotation, for the acoustics of housings.

Over the whole turns of a shaft that end with the run, at N equal angles alpha_j [turns] to which the rows are
interpolated linearly, the amplitude of order n of a history s is

    s_n = 2/N sum_j s(alpha_j) e^(-2 pi i n alpha_j),      s(t) = Re sum_n s_n e^(2 pi i n alpha(t)),

exact for what repeats with the turns; interpolation with m rows per period reduces it by (2 pi/m)^2/12. Sums are taken
of the velocity of the user origin, the angular velocity and the rates of the global modes, since for a body that does
not turn itself the velocity of the place X of the surface is linear in them,

    v_n(X) = rd_n + omega_n x A X + A Phi(X) qd_n,

A its attitude. Neglected are products of motion and deformation, and the local modes of its contact surfaces and faces
in joints. The equivalent radiated power of order n is that of plane waves, rho c/2 int |v_n . n|^2 dA: an upper
estimate, approached where the wavelength in air is shorter than that on the surface.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.messages import reprs
from warpffrf.output.files.universal import header_151, nodes_2411, spectrum_55, triangles_2412, units_164
from warpffrf.output.spectrum import whole_turns

Array = np.ndarray
LABEL = "surface_velocity"
FIXED = 0.02  # rad: a body that turns by less does not turn
WHOLE = 1e-9  # of a turn: deviation of an order times the turns from a whole number


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceVelocity(reprs.Rows):
    """Complex amplitudes `velocity` (k, n, 3) [m/s] of the `orders` (k,) at the `points` (n, 3) [m] of a body's skin,
    world axes, at mean `frequencies` (k,) [Hz]; `triangles` (t, 3) face outward. `body` and `rotor` are its name and
    that of the body whose turns count; phases refer to the start of the run."""

    body: str
    rotor: str
    orders: Array
    frequencies: Array
    points: Array
    triangles: Array
    velocity: Array

    @property
    def normals(self) -> Array:
        """Outward unit normals (n, 3) at the points, of the areas of the triangles around them."""
        total = np.zeros_like(self.points)
        area = self._areas()
        for corner in range(3):
            np.add.at(total, self.triangles[:, corner], area)
        size = np.linalg.norm(total, axis=1, keepdims=True)
        return np.divide(total, size, out=np.zeros_like(total), where=size > 0.0)

    @property
    def normal(self) -> Array:
        """Amplitudes (k, n) [m/s] of the normal velocity, outward."""
        return np.einsum("knc,nc->kn", self.velocity, self.normals)

    def radiated_power(self, density: float = 1.204, speed_of_sound: float = 343.2) -> Array:
        """Equivalent radiated power (k,) [W] into air of 20 C, or a medium of this density [kg/m3] and speed of sound
        [m/s]: an upper estimate (module docstring)."""
        rho = require_number(density, "radiated_power: density", positive=True)
        c = require_number(speed_of_sound, "radiated_power: speed_of_sound", positive=True)
        area = self._areas()
        size = np.linalg.norm(area, axis=1)
        unit = np.divide(area, size[:, None], out=np.zeros_like(area), where=size[:, None] > 0.0)
        corners = np.einsum("ktic,tc->kti", self.velocity[:, self.triangles], unit)
        # int of a linear function squared over a triangle: A/12 (sum of squares + square of the sum)
        squares = np.sum(np.abs(corners) ** 2, axis=2) + np.abs(corners.sum(axis=2)) ** 2
        return 0.5 * rho * c * squares @ size / 12.0

    def to_uff(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write a universal file: nodes and triangles of the skin (2411, 2412, SI units, world axes) and for each order
        a dataset 55, complex velocity by frequency, six digits; returns the path. Raises `InputError` for a file that
        is not to be replaced."""
        check_ending(path, "to_uff", (".uff", ".unv"))
        target = checked_output_path(path, "to_uff", overwrite=overwrite)
        title = f"velocity of {self.body!r}, order {{:g}} of {self.rotor!r}"
        parts = [header_151(f"surface velocity of {self.body!r} by orders"), units_164(), nodes_2411(self.points)]
        parts.append(triangles_2412(self.triangles, np.ones(len(self.triangles), dtype=int)))
        for k, (order, f) in enumerate(zip(self.orders.tolist(), self.frequencies.tolist(), strict=True)):
            parts.append(spectrum_55(k + 1, f, self.velocity[k], title.format(order)))
        with written_whole(target) as partial:
            partial.write_text("".join(parts))
        return target

    def _areas(self) -> Array:
        """Normals (t, 3) of the triangles, as long as their areas."""
        a, b, c = np.moveaxis(self.points[self.triangles], 1, 0)
        return 0.5 * np.cross(b - a, c - a)


def surface_velocity(result: Any, body: str, rotor: str, orders: Sequence[float], axis: Any = None) -> SurfaceVelocity:
    """See `Result.surface_velocity`."""
    history, turning = result.body(body), result.body(rotor)
    reduced = result.view.bodies[body].reduced
    if reduced is None or not len(reduced.surface.triangles):
        raise InputError(f"{LABEL}: body {body!r} is rigid or has no skin; a flexible body is needed")
    n = require_array(orders, f"{LABEL}: orders", (None,))
    turns, even, whole = whole_turns(result.time, turning.angular_velocity, rotor, axis)
    count = len(even)
    if not len(n) or np.any(n <= 0.0) or np.any(np.abs(n * whole - np.round(n * whole)) > WHOLE * whole):
        raise InputError(
            f"{LABEL}: orders must be positive multiples of 1/{whole}, as the run has {whole} whole turns of "
            f"{rotor!r}, got {n.tolist()}"
        )
    if np.any(2.0 * n * whole >= count):
        raise InputError(
            f"{LABEL}: order {n.max():g} needs more than {2.0 * n.max():g} rows per turn of {rotor!r}, there are "
            f"{count / whole:.4g}; save more rows, save_every=1"
        )
    rows = turns >= even[0] - WHOLE
    A = rot.matrix(history.rotation[rows])
    turned = float(np.arccos(np.clip(0.5 * (np.einsum("ij,tij->t", A[0], A) - 1.0), -1.0, 1.0)).max())
    if turned > FIXED:
        raise InputError(
            f"{LABEL}: body {body!r} turns by {turned:.3g} rad, more than {FIXED:g}; surface velocities are those of "
            "bodies that do not turn, such as housings"
        )
    rates = np.concatenate([history.velocity, history.angular_velocity, history.modal_velocity], axis=1)
    if not np.all(np.isfinite(rates)):
        raise InputError(f"{LABEL}: the rates of body {body!r} were not recorded in this run; run it again")
    sampled = np.stack([np.interp(even, turns, column) for column in rates.T], axis=1)
    amplitude = 2.0 / count * np.exp(-2.0j * np.pi * n[:, None] * even) @ sampled
    skin = reduced.surface
    local = np.asarray(skin.points, dtype=np.float64)
    Phi = np.asarray(skin.modes, dtype=np.float64)
    elastic = np.einsum("km,mnc->knc", amplitude[:, 6:], Phi)
    velocity = amplitude[:, None, :3] + np.cross(amplitude[:, None, 3:6], local @ A[0].T) + elastic @ A[0].T
    span = result.time[-1] - np.interp(even[0], turns, result.time)
    origin = history.position[rows][0]
    return SurfaceVelocity(
        body, rotor, n, n * whole / span, origin + local @ A[0].T, _outward(local, skin.triangles), velocity
    )


def _outward(points: Array, triangles: Array) -> Array:
    """The triangles of a closed skin, in the order that gives a positive volume."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return triangles if np.sum(a * np.cross(b, c)) >= 0.0 else triangles[:, ::-1]
