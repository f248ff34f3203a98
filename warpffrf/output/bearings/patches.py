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

from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.output.contact.hertz import HertzLine, HertzPoint, hertz_point, largest_below


@dataclass(frozen=True)
class Patches:
    """Patches of all elements on one raceway (T, Z): half-axes [m], a along the axis of the bearing across a groove
    (nan for rollers) and b around it, and peak pressure [Pa]; 0 without load."""

    half_axis_across: np.ndarray
    half_axis_around: np.ndarray
    peak_pressure: np.ndarray


def ball_patches(geometry: BallGeometry, side: str, load: np.ndarray, angle: np.ndarray, modulus: float) -> Patches:
    """Patches for loads [N] and contact angles [rad] (T, Z); modulus E* [Pa]."""
    across, around, peak = (np.zeros(load.shape) for _ in range(3))
    for at in np.argwhere(load > 0.0):
        i = tuple(at)
        curvatures = geometry.curvatures(side, angle[i])
        found = hertz_point(float(load[i]), np.diag([float(c) for c in curvatures]), modulus)
        across[i], around[i] = found.half_width, found.half_width_along
        peak[i] = found.peak_pressure
    return Patches(across, around, peak)


def roller_patches(geometry: RollerGeometry, side: str, laminae: np.ndarray, modulus: float) -> Patches:
    """Patches for loads of laminae (T, Z, m) [N]; modulus E* [Pa]."""
    line = laminae.max(axis=-1) / (geometry.roller_length / laminae.shape[-1])
    curvature = geometry.curvature(side)
    peak = np.sqrt(line * modulus * curvature / np.pi)
    half = np.sqrt(4.0 * line / (curvature * np.pi * modulus))
    return Patches(np.full(half.shape, np.nan), half, peak)


@dataclass(frozen=True)
class ShearBelow:
    """Largest shear stress [Pa] below the centre of patches (T, Z) and its depth [m]; nan without a load."""

    stress: np.ndarray
    depth: np.ndarray


def shear_below(patches: Patches, poisson_ratio: float) -> ShearBelow:
    """Of patches that are ellipses, or lines where the half-axis across is nan."""
    found = np.full((2, *patches.peak_pressure.shape), np.nan)
    for at in np.argwhere(patches.peak_pressure > 0.0):
        i = tuple(at)
        a, b, p = (float(v[i]) for v in (patches.half_axis_across, patches.half_axis_around, patches.peak_pressure))
        one = (
            HertzLine(b, p, 0.0, 0.0, 0.0)
            if np.isnan(a)
            else HertzPoint((max(a, b), min(a, b)), 0.0, p, 0.0, 0.0, (0.0, 0.0), 0.0)
        )
        found[(slice(None), *i)] = largest_below(one, poisson_ratio)[1]
    return ShearBelow(*found)


def cut_off(geometry: BallGeometry, side: str, patches: Patches, angle: np.ndarray, shoulder: float) -> np.ndarray:
    """Fraction (T, Z) of the ellipse's force beyond a shoulder of the height [m]; see the module."""
    r = geometry.groove(side)
    room = r * (np.arccos(np.clip(1.0 - shoulder / r, -1.0, 1.0)) - np.abs(angle))
    a = patches.half_axis_across
    s = np.clip(np.divide(room, a, out=np.ones_like(a), where=a > 0.0), -1.0, 1.0)
    return np.where(a > 0.0, 0.25 * (2.0 + s) * (1.0 - s) ** 2, 0.0)
