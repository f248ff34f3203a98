r"""Hertz's patches of elements on raceways, from their loads, and how much of an ellipse a shoulder cuts off.

A ball's patch is an ellipse across the groove, whose half-axes a >= b follow from the load, from the relative
curvatures at the contact angle (`BallRaceways.curvatures`) and from E*. A roller's is that of a line in every lamina:
with a load Q of a lamina of the width w, p0 = sqrt(Q E*/(pi R w)), R the relative radius; the largest counts.

**Shoulder.** The groove of radius r ends where it has risen by h over its bottom, at the angle arccos(1 - h/r) from
there. The patch is centred on the contact angle alpha and reaches a/r to either side of it along the groove. What lies
beyond,

    t = r (arccos(1 - h/r) - |alpha|) < a,

is cut off: with s = t/a between -1 and 1, a share (2 + s)(1 - s)^2/4 of the force of the whole ellipse, whose pressure
has the section (3/4)(1 - s^2) across it, if it went on as in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.bearings.geometry import BallRaceways, RollerRaceways
from warpffrf.output.contact.hertz_patch import hertz_point


@dataclass(frozen=True)
class Patches:
    """Of all elements on one raceway (T, Z): half-axes [m], a along the axis of the bearing across a groove (nan of
    rollers) and b around it, and peak pressure [Pa]; 0 where nothing is carried."""

    half_axis_across: np.ndarray
    half_axis_around: np.ndarray
    peak_pressure: np.ndarray


def ball_patches(raceways: BallRaceways, side: str, load: np.ndarray, angle: np.ndarray, modulus: float) -> Patches:
    """Of loads [N] and contact angles [rad] (T, Z); modulus E* [Pa]."""
    across, around, peak = (np.zeros(load.shape) for _ in range(3))
    for at in np.argwhere(load > 0.0):
        i = tuple(at)
        curvatures = raceways.curvatures(side, angle[i])
        found = hertz_point(float(load[i]), np.diag([float(c) for c in curvatures]), modulus)
        across[i], around[i] = found.half_width, found.half_width_along
        peak[i] = found.peak_pressure
    return Patches(across, around, peak)


def roller_patches(raceways: RollerRaceways, side: str, laminae: np.ndarray, modulus: float) -> Patches:
    """Of loads of laminae (T, Z, m) [N]; modulus E* [Pa]."""
    line = laminae.max(axis=-1) / (raceways.length / laminae.shape[-1])
    curvature = raceways.curvature(side)
    peak = np.sqrt(line * modulus * curvature / np.pi)
    half = np.sqrt(4.0 * line / (curvature * np.pi * modulus))
    return Patches(np.full(half.shape, np.nan), half, peak)


def cut_off(raceways: BallRaceways, side: str, patches: Patches, angle: np.ndarray, shoulder: float) -> np.ndarray:
    """Share (T, Z) of the ellipse's force that lies beyond a shoulder of the height [m]; see the module."""
    r = raceways.groove(side)
    room = r * (np.arccos(np.clip(1.0 - shoulder / r, -1.0, 1.0)) - np.abs(angle))
    a = patches.half_axis_across
    s = np.clip(np.divide(room, a, out=np.ones_like(a), where=a > 0.0), -1.0, 1.0)
    return np.where(a > 0.0, 0.25 * (2.0 + s) * (1.0 - s) ** 2, 0.0)
