"""Notes in the results on springs and dampers with characteristics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from warpffrf.model.forces.characteristics import ROUND_OFF, Characteristic
from warpffrf.model.forces.laws import Coordinate, SpringLaw

DIRECTIONS = ("d_x", "d_y", "d_z", "phi_x", "phi_y", "phi_z")
LENGTHS = ("translation", "distance")


def characteristic_notes(
    laws: Mapping[str, SpringLaw], values: Mapping[str, np.ndarray], time: np.ndarray
) -> list[str]:
    """Notes on dampers whose force and rate have opposite signs somewhere, and on tables whose range a run has left.

    laws by name; values (T, n): their coordinates at the saved times (T,) [s]. Rates are those from one saved step to
    the next.
    """
    notes = []
    between = np.diff(time)
    for name, law in laws.items():
        off = values[name] - law.reference
        rates = np.diff(off, axis=0)[between > 0.0] / between[between > 0.0, None]
        for curve, _, direction, unit in _curves(law, law.viscous):
            rate = _feeds(curve)
            if rate is not None:
                notes.append(
                    f"force {name!r}: its damping{direction} acts in the direction of motion, for example at "
                    f"{rate:.3g} {unit}/s, and adds energy"
                )
        for what, curves, x, per in (("stiffness", law.elastic, off, ""), ("damping", law.viscous, rates, "/s")):
            for curve, i, direction, unit in _curves(law, curves):
                (low, high), x_i = curve.ends, x[:, i]
                if len(x_i) and (np.min(x_i) < low or np.max(x_i) > high):
                    notes.append(
                        f"force {name!r}: the table of its {what}{direction} covers {low:.4g} to {high:.4g} "
                        f"{unit}{per}, the run had {np.min(x_i):.4g} to {np.max(x_i):.4g}; beyond its ends it is "
                        "extrapolated linearly"
                    )
    return notes


def _curves(
    law: SpringLaw, curves: tuple[Characteristic | None, ...]
) -> Iterator[tuple[Characteristic, int, str, str]]:
    """All characteristics: with their coordinate, its name where there are several, its unit."""
    for i, (curve, coordinate) in enumerate(zip(curves, law.coordinates, strict=False)):
        if curve is not None:
            direction, unit = _named(coordinate)
            yield curve, i, direction, unit


def _named(coordinate: Coordinate) -> tuple[str, str]:
    if coordinate.kind == "bushing":
        at = int(np.argmax(np.abs(coordinate.vector)))
        return f" in {DIRECTIONS[at]}", "m" if at < 3 else "rad"
    return "", "m" if coordinate.kind in LENGTHS else "rad"


def _feeds(curve: Characteristic) -> float | None:
    """The smallest of some rates x at which F(x) x < 0, None where there is none."""
    at = curve.sign_changes()
    reach = max(at[-1] - at[0], 1.0)
    tried = np.concatenate([[at[0] - reach], 0.5 * (at[1:] + at[:-1]), [at[-1] + reach]])
    force = curve.force(tried)
    wrong = tried[np.sign(tried) * force < -ROUND_OFF * np.abs(force).max()]
    return float(wrong[np.argmin(np.abs(wrong))]) if len(wrong) else None
