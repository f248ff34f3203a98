"""Plots of gear pairs: transmission error and its orders, stiffness and force of the mesh, load shares, maps of the
flanks, path of contact."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.gears.gear_result import GearResult
from warpffrf.output.plots.colors import FINEST, from_zero, largest, no_finer
from warpffrf.output.plots.flanks import LINE, along, flank_field

SECOND, MARK = "#d1495b", "0.55"
MOST_NAMED = 6  # pairs of teeth in a legend
UM, MM, KN, MS = 1e6, 1e3, 1e-3, 1e3
STANDS = 1e-3  # pitches: gear 1 of a run that rotates by less stands still


def transmission_error(gear: GearResult, ax: Any) -> None:
    """Transmission error over the rotation of gear 1, against time where it stands still, with its mean over whole mesh
    cycles."""
    error, found = UM * gear.transmission_error, gear.orders()
    _line(gear, ax, error)
    title = f"'{gear.name}': transmission error"
    if found.cycles:
        ax.axhline(UM * found.mean, color=SECOND, lw=0.9, ls="--")
        title += f"\nmean {UM * found.mean:.3g} µm (dashed), range {UM * found.peak_to_peak:.3g} µm"
    no_finer(ax, FINEST * largest([np.abs(error)]))
    ax.set(ylabel="transmission error [µm]")
    ax.set_title(title, fontsize=10)


def mesh_orders(gear: GearResult, ax: Any) -> None:
    """Amplitudes of the transmission error at multiples of the frequency of the teeth, over whole mesh cycles, with
    their standard errors."""
    found = gear.orders()
    if not np.any(np.isfinite(found.amplitude)):
        raise InputError(
            f"plot: orders of gear pair {gear.name!r}: {found.reason or 'a pitch has fewer than three saved steps'}; "
            "rotate over whole pitches, in some 20 saved steps each"
        )
    size, error = UM * found.amplitude, np.nan_to_num(UM * found.error)
    ax.bar(found.order, np.nan_to_num(size), width=0.6, color=LINE, yerr=error, capsize=3.0, ecolor="0.3")
    ax.set_xticks(found.order)
    cycles = f"{found.cycles} mesh cycle" + "s" * (found.cycles > 1)
    from_zero(ax, [0.0, *(size + error)])
    ax.set(xlabel="order of the tooth frequency [-]", ylabel="amplitude [µm]")
    ax.set_title(f"Orders of the transmission error, {cycles}", fontsize=10)


def mesh_stiffness(gear: GearResult, ax: Any) -> None:
    """Secant stiffness of the mesh over the rotation of gear 1, against time where it stands still."""
    stiffness = 1e-6 * gear.stiffness
    _line(gear, ax, stiffness)
    ax.set(ylabel="load over approach [N/µm]")
    ax.set_title("Secant stiffness of the mesh", fontsize=10)
    from_zero(ax, stiffness)


def mesh_force(gear: GearResult, ax: Any) -> None:
    """Normal forces of the driving flanks and, where it has contacts, of the back side, against time; shaded where the
    driving flanks have lifted off."""
    back, time = gear._signs != gear._signs[:1], MS * gear.time
    driving, behind = KN * gear.load[:, ~back].sum(axis=1), KN * gear.load[:, back].sum(axis=1)
    mark = "o" if len(time) == 1 else None
    ax.plot(time, driving, lw=1.3, color=LINE, marker=mark, label="driving flanks")
    if np.any(back):
        ax.plot(time, behind, lw=1.3, color=SECOND, marker=mark, label="back side")
        ax.legend(frameon=False, fontsize=8)
    ax.set(xlabel="time [ms]", ylabel="normal force [kN]")
    ax.set_title(f"'{gear.name}': normal forces", fontsize=10)
    from_zero(ax, driving, behind)
    for ends in gear.open_intervals():
        ax.axvspan(*(MS * ends), color="0.85", zorder=0)


def load_share(gear: GearResult, ax: Any) -> None:
    """Share of each pair of teeth in the load over the roll angle of gear 1, with the ends of single contact, B and
    D."""
    share, angle = gear.load_share, np.degrees(gear.roll_angle)
    carrying = np.flatnonzero(np.any(gear.load > 0.0, axis=0))
    for i in carrying:
        rows = np.argsort(angle[:, i])
        rows = rows[_on_path(gear)[rows, i]]
        flank, k, t = gear.teeth[i]
        name = f"{flank} {k} and {t}" if len(carrying) <= MOST_NAMED else None
        mark = "o" if len(rows) == 1 else None
        ax.plot(angle[rows, i], share[rows, i], lw=1.3, marker=mark, label=name)
    if 1 < len(carrying) <= MOST_NAMED:
        ax.legend(frameon=False, fontsize=8)
    _path_marks(gear, ax, lambda g: np.degrees(gear.pair.roll_angle(g)))
    ax.set(xlabel="roll angle of gear 1 [degrees]", ylabel="share of the load [-]", ylim=(0.0, 1.05))
    ax.set_title("Load shares of the pairs of teeth", fontsize=10)


def flank_pressure(gear: GearResult, ax: Any) -> None:
    """Largest pressure across the patch over roll angle and width of the driving flank of gear 1, all pairs of teeth
    superposed."""
    gear.flank_map().draw(ax)
    ax.set_title(f"'{gear.name}': pressure, flank of gear 1", fontsize=10)


def flank_wear(gear: GearResult, ax: Any) -> None:
    """Pressure times sliding velocity over roll angle and width of the driving flank of gear 1, at the speeds of the
    run."""
    flank_field(gear.flank_map(), ax, "wear_index")
    ax.set_title(f"'{gear.name}': pressure times sliding", fontsize=10)


def contact_path(gear: GearResult, ax: Any) -> None:
    """Distance of the centres of pressure from the line of action, away from the axis of gear 1, over the place on
    it."""
    found = gear.contact_path()
    place, offset = MM * found.place[..., 0], UM * found.offset[..., 0]
    for i in range(len(gear.teeth)):
        along(ax, place[:, i], offset[:, i])
    ax.axhline(0.0, color="0.7", lw=0.6, zorder=0)
    no_finer(ax, 1.0)
    _path_marks(gear, ax, lambda g: MM * g)
    ax.set(xlabel="place on the line of action [mm]", ylabel="distance from the line of action [µm]")
    ax.set_title("Path of contact on gear 1", fontsize=10)


GEAR_PLOTS: dict[str, Callable[[GearResult, Any], None]] = {
    "transmission_error": transmission_error,
    "mesh_orders": mesh_orders,
    "mesh_stiffness": mesh_stiffness,
    "mesh_force": mesh_force,
    "load_share": load_share,
    "flank_pressure": flank_pressure,
    "flank_wear": flank_wear,
    "contact_path": contact_path,
}


def gear_kinds(gear: GearResult) -> list[str]:
    """The kinds that a run of several rows has data for."""
    found, loaded = gear.orders(), np.count_nonzero(gear.load > 0.0) > 1
    has = {"mesh_orders": bool(np.any(np.isfinite(found.amplitude)))}
    has |= {kind: loaded for kind in ("flank_pressure", "contact_path", "load_share")}
    has["flank_wear"] = loaded and bool(np.any(gear.sliding()))
    return [kind for kind in GEAR_PLOTS if has.get(kind, True)]


def the_gear(result: Any, name: str | None) -> GearResult:
    """The gear pair called `name`, the first one if None; raises `InputError` if there is none."""
    if name is None and not result.gear_names:
        raise InputError("plot: the scene has no gear pair; make one with scene.add_gear_pair(...), and run again")
    return result.gear(result.gear_names[0] if name is None else name)


def _on_path(gear: GearResult) -> np.ndarray:
    """Where (T, n) a pair of teeth is within the path of contact, or carries beyond it."""
    return gear.within | (gear.load > 0.0)


def _line(gear: GearResult, ax: Any, values: np.ndarray) -> None:
    """`values` (T,) over the rotation of gear 1 since the start, in the direction in which it pushes, or over time."""
    angle = np.unwrap(gear.angle)
    x = -gear._signs[0] * (angle - angle[:1]) * gear.pair.gear_1.teeth / (2.0 * np.pi)
    stands = np.ptp(x) < STANDS and len(x) > 1
    mark = "o" if len(x) == 1 else None
    ax.plot(MS * gear.time if stands else x, values, lw=1.3, color=LINE, marker=mark)
    ax.set(xlabel="time [ms]" if stands else "rotation of gear 1 [pitches]")


def _path_marks(gear: GearResult, ax: Any, place: Callable[[float], float]) -> None:
    """Lines at the points A to E of the path of contact."""
    for name, g in gear.pair.path.items():
        at = float(place(g))
        ax.axvline(at, color=MARK, lw=0.7, ls=":")
        ax.annotate(name, (at, 1.0), (2.0, -9.0), xycoords=("data", "axes fraction"), textcoords="offset points",
                    fontsize=8)  # fmt: skip
