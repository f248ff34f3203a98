r"""Hertz patches of elements on raceways, from their loads, and truncation of an ellipse by a shoulder.

A ball's patch is an ellipse across the groove, whose half-axes a >= b follow from the load, from the relative
curvatures at the contact angle (`BallGeometry.curvatures`) and from E*. A roller has a line contact in every lamina:
with the load Q and width w of a lamina, p0 = sqrt(Q E*/(pi R w)), R the relative radius; the largest is used.

**Shoulder.** The groove of radius r ends at the height h over its bottom, at the angle arccos(1 - h/r) from there. The
patch is centred on the contact angle alpha and extends a/r to either side of it along the groove. The part beyond the
shoulder,

    t = r (arccos(1 - h/r) - |alpha|) < a,

is truncated: with s = t/a between -1 and 1, the fraction (2 + s)(1 - s)^2/4 of the force of the whole ellipse, whose
pressure has the section (3/4)(1 - s^2) across it, if the groove continued.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.output.contact.hertz import HertzLine, HertzPoint, Largest, hertz_ellipse, largest_below

SHAPES = 33  # evaluated between the least and the largest ratio of half-axes: errors below those of the search
SAME = 1e-6  # of ratios of half-axes


@dataclass(frozen=True)
class Patches:
    """Patches of all elements on one raceway (T, Z): half-axes [m], a along the axis of the bearing across a groove
    (nan for rollers) and b around it, and peak pressure [Pa]; 0 without load."""

    half_axis_across: np.ndarray
    half_axis_around: np.ndarray
    peak_pressure: np.ndarray


def ball_patches(geometry: BallGeometry, side: str, load: np.ndarray, angle: np.ndarray, modulus: float) -> Patches:
    """Patches for loads [N] and contact angles [rad] (T, Z); modulus E* [Pa]."""
    found = np.zeros((3, *load.shape))
    loaded = load > 0.0
    curvatures = geometry.curvatures(side, angle[loaded])
    found[:, loaded] = hertz_ellipse(load[loaded], *curvatures, modulus)[:3]
    return Patches(found[0], found[1], found[2])


def lamina_pressure(geometry: RollerGeometry, side: str, laminae: np.ndarray, modulus: float) -> np.ndarray:
    """Peak pressures [Pa] for loads [N] of laminae (T, Z, n); modulus E* [Pa]."""
    line = laminae / (geometry.roller_length / laminae.shape[-1])
    return np.sqrt(line * modulus * geometry.curvature(side) / np.pi)


def roller_patches(geometry: RollerGeometry, side: str, laminae: np.ndarray, modulus: float) -> Patches:
    """Patches of the most loaded laminae, for loads [N] of laminae (T, Z, n); modulus E* [Pa]."""
    peak = lamina_pressure(geometry, side, laminae, modulus).max(axis=-1)
    return Patches(np.full(peak.shape, np.nan), 2.0 * peak / (modulus * geometry.curvature(side)), peak)


def whole_peaks(
    geometry: BallGeometry | RollerGeometry, side: str, load: np.ndarray, angle: np.ndarray, modulus: float
) -> np.ndarray:
    """Peak pressures [Pa] for loads [N] and contact angles [rad] (T, Z), of rollers without tilt; modulus E* [Pa]."""
    if isinstance(geometry, BallGeometry):
        return ball_patches(geometry, side, load, angle, modulus).peak_pressure
    return lamina_pressure(geometry, side, load[..., None], modulus)[..., 0]


@dataclass(frozen=True)
class ShearBelow:
    """Largest shear stress [Pa] below the centre of patches (T, Z) and its depth [m]; nan without a load."""

    stress: np.ndarray
    depth: np.ndarray


def shear_below(patches: Patches, poisson_ratio: float) -> ShearBelow:
    """Of patches that are ellipses, or lines where the half-axis across is nan. Stress over pressure and depth over the
    smaller half-axis are functions of the ratio of the half-axes, interpolated between `SHAPES` values of it."""
    loaded = patches.peak_pressure > 0.0
    across, around = patches.half_axis_across[loaded], patches.half_axis_around[loaded]
    found = np.full((2, *loaded.shape), np.nan)
    if not loaded.any():
        return ShearBelow(*found)
    small = np.fmin(across, around)
    ratio = np.where(np.isnan(across), 0.0, small / np.fmax(across, around))
    at = np.linspace(ratio.min(), ratio.max(), SHAPES) if np.ptp(ratio) > SAME else ratio[:1]
    known = np.array([_largest_shear(float(k), poisson_ratio) for k in at])
    stress, depth = (CubicSpline(at, known)(ratio) if len(at) > 1 else np.broadcast_to(known, (len(ratio), 2))).T
    found[:, loaded] = stress * patches.peak_pressure[loaded], depth * small
    return ShearBelow(*found)


def _largest_shear(ratio: float, poisson_ratio: float) -> Largest:
    """Of a patch with a peak pressure and a smaller half-axis of 1; ratio: that over the larger one, 0 of a line."""
    one = (
        HertzPoint((1.0 / ratio, 1.0), 0.0, 1.0, 0.0, 0.0, (0.0, 0.0), 0.0)
        if ratio
        else HertzLine(1.0, 1.0, 0.0, 0.0, 0.0)
    )
    return largest_below(one, poisson_ratio)[1]


def cut_off(geometry: BallGeometry, side: str, patches: Patches, angle: np.ndarray, shoulder: float) -> np.ndarray:
    """Fraction (T, Z) of the ellipse's force beyond a shoulder of the height [m]; see the module."""
    r = geometry.groove(side)
    off = np.abs(angle) - (0.5 * np.pi if geometry.washers else 0.0)
    room = r * (np.arccos(np.clip(1.0 - shoulder / r, -1.0, 1.0)) - np.abs(off))
    a = patches.half_axis_across
    s = np.clip(np.divide(room, a, out=np.ones_like(a), where=a > 0.0), -1.0, 1.0)
    return np.where(a > 0.0, 0.25 * (2.0 + s) * (1.0 - s) ** 2, 0.0)
