"""Plots of friction: tractions along the rolling direction, stick and slip on the patch, creepages, spin, T-gamma,
power, wear.

Depth. Stress below the centre of a patch against depth, with the depths of the Hertz maxima.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.bodies.stress_below import poisson_ratios, stress_below
from warpffrf.output.contact.friction import OPEN, SLIP, STATES, STICK
from warpffrf.output.contact.hertz import HertzLine, HertzPoint, largest_below, largest_of
from warpffrf.output.contact.hertz import hertz as hertz_contact
from warpffrf.output.plots.colors import HEADROOM, LEAST, STATE_COLORS, about_zero, from_zero, instant, largest
from warpffrf.output.plots.panels import load_ratio
from warpffrf.output.plots.restyle import BELOW

SHOWN_WIDTHS = 1.6  # half-widths to either side of the middle of the patch
TRACE = 0.02  # of the tractions of one sign: smaller ones of the other sign are not visible
LEGEND_ROOM = 1.35  # of the range of tractions
NO_ARROWS = 1e-3  # of the largest bound: smaller tractions are drawn without arrows
MOST_ARROWS = 24  # tractions drawn in a map in either direction; more cannot be distinguished in a panel
PRESSURE, BOUND, TRACTION, ACROSS, SECOND = "#8a94a3", "#d1495b", "#1b6ca8", "#2a9d6f", "#b57f00"


def rubbing(result: Any) -> Any:
    """The first contact with finite sliding and friction; raises `InputError` if there is none."""
    for name in result.finite_sliding_names:
        if result.contact(name).has_friction:
            return result.contact(name)
    raise InputError("plot: no contact pair of the run has friction; give Contact(..., friction=mu) and run again")


def _last_touching(contact: Any) -> int:
    touching = np.flatnonzero(contact.touching)
    return int(touching[-1]) if len(touching) else len(contact.touching) - 1


def _at(result: Any, i: int) -> str:
    return f"t = {instant(result.time[i])}"


def _coefficient(contact: Any) -> float | None:
    return contact.view.friction or None


def full_slip(contact: Any) -> dict[str, float]:
    """Upper bound of each friction history for full slip; `LEAST` of it is round-off. A coefficient that depends on
    speed counts as 1."""
    friction, size = contact.friction, np.sqrt(largest([contact.patch_area]) / np.pi)
    force = (_coefficient(contact) or 1.0) * largest([contact.force_magnitude])
    speed = largest([np.abs(friction.rolling_velocity), np.abs(friction.creep_velocity)])
    return {
        "creepage": 1.0, "traction_coefficient": 1.0, "creep_force": force, "t_gamma": force,
        "spin_creepage": 1.0 / size if size > 0.0 else 0.0, "spin_moment": force * size,
        "friction_power": force * speed, "wear": largest([contact.peak_pressure]) * speed * 1e-6,  # W/mm2
    }  # fmt: skip


def _seen(values: np.ndarray, *beside: np.ndarray) -> bool:
    """True if a curve is more than round-off of the others; false for a direction that is not driven."""
    most = largest([np.abs(v) for v in (values, *beside)])
    return largest([np.abs(values)]) > LEAST * most


def _both_signs(tau: np.ndarray) -> bool:
    """True if tractions in either direction exceed a trace of those in the other."""
    most = np.nanmax(tau, initial=0.0), -np.nanmin(tau, initial=0.0)
    return min(most) > TRACE * max(most)


def traction(result: Any, ax: Any) -> None:
    """Pressure, the bound mu p and the tractions along the rolling direction at mid-width (point contact: through its
    centre), with stick and slip."""
    contact = rubbing(result)
    i = _last_touching(contact)
    profile = contact.friction.profile(i, _coefficient(contact))
    x, lines = profile["arc"] * 1e3, _lines(contact, i)[0]
    tau, bound = profile["traction"] * 1e-6, profile["bound"] * 1e-6
    for state in (STICK, SLIP):
        cells = np.flatnonzero(profile["state"] == state)
        for n, c in enumerate(cells):
            ax.axvspan(
                lines[c], lines[c + 1], color=STATE_COLORS[state], alpha=0.18, lw=0.0,
                label=STATES[state] if n == 0 else None,
            )  # fmt: skip
    sign = -1.0 if np.nansum(tau) < 0.0 else 1.0
    mu = _coefficient(contact)
    both = _both_signs(tau)
    if mu is not None:
        ax.plot(x, sign * bound, "--", lw=1.1, color=BOUND, label=f"±{mu:g} p" if both else f"{sign * mu:g} p")
        if both:
            ax.plot(x, -sign * bound, "--", lw=1.1, color=BOUND)
    ax.step(x, tau, where="mid", lw=1.3, color=TRACTION, label="traction along e_theta, on the first body")
    if _seen(profile["across"], profile["traction"], profile["bound"]):
        ax.step(x, profile["across"] * 1e-6, where="mid", lw=1.0, color=ACROSS, label="along the axis")
    ax.axhline(0.0, color="0.7", lw=0.6)
    speed = float(contact.friction.rolling_velocity[i])
    if np.isfinite(speed) and speed != 0.0:
        lead = "left" if speed > 0.0 else "right"
        ax.annotate(
            "material enters", (0.02 if lead == "left" else 0.98, 0.5), xycoords="axes fraction", ha=lead, fontsize=8,
            color="0.35",
        )  # fmt: skip
    bounds = (bound, -bound) if both else (sign * bound,)
    drawn = [v[np.isfinite(v)] for v in (*bounds, tau, profile["across"] * 1e-6)]
    low, high = (float(f(np.concatenate(drawn), initial=0.0)) for f in (np.min, np.max))
    room = (LEGEND_ROOM - 1.0) * (high - low)  # for the legend, on the side of the larger tractions
    least = (HEADROOM - 1.0) * (high - low)  # keeps a curve at zero off the frame
    low, high = min(HEADROOM * low, -least), max(HEADROOM * high, least)
    ax.set_ylim(low - room * (sign < 0.0), (high + room * (sign > 0.0)) or 1.0)
    _around(ax, contact, i)
    ax.set(xlabel="arc along e_theta from the line of centres [mm]", ylabel="traction [MPa]")
    where = "through the centre" if contact.patch_kind == "point" else "at mid-width"
    ratio = load_ratio(contact.friction, i)
    ax.set_title(f"Tractions {where}, {_at(result, i)}\ntangential over normal load {ratio}", fontsize=10)
    ax.legend(frameon=False, fontsize=7, ncols=2, loc="upper center" if sign > 0.0 else "lower center")


def _lines(contact: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Lines between the cells of saved step `i` [mm], ascending: along e_theta from the line of centres, and z."""
    arc, z = contact.cell_lines(i)
    return np.sort(contact.side * arc) * 1e3, z * 1e3


def _around(ax: Any, contact: Any, i: int) -> None:
    """The range of x about the patch."""
    reach = SHOWN_WIDTHS * contact.half_width[i] * 1e3
    if reach > 0.0:
        middle = contact.side * contact.center[i] * 1e3
        ax.set_xlim(middle - reach, middle + reach)


def stick_slip(result: Any, ax: Any, row: int | None = None) -> None:
    """State of every cell on the unwrapped patch, with arrows of the tractions on the first body, in saved step `row`;
    None: the last one in contact."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    contact = rubbing(result)
    i = _last_touching(contact) if row is None else row
    friction, step = contact.friction, 1 if contact.side > 0.0 else -1
    lines = _lines(contact, i)
    x, z = (0.5 * (v[1:] + v[:-1]) for v in lines)
    state = np.asarray(friction.state[i])[::step]
    ax.pcolormesh(*lines, state.T, cmap=ListedColormap(STATE_COLORS), vmin=OPEN - 0.5, vmax=SLIP + 0.5)
    tau = friction.traction[i][:, ::step]
    shown = np.zeros(state.shape, dtype=bool)
    every = [max(1, -(-int(np.any(state != OPEN, axis=axis).sum()) // MOST_ARROWS)) for axis in (1, 0)]
    shown[every[0] // 2 :: every[0], every[1] // 2 :: every[1]] = True
    bound = (_coefficient(contact) or 1.0) * float(contact.peak_pressure[i])
    j, k = np.nonzero(shown & np.any(tau != 0.0, axis=0) & (np.abs(tau).max(initial=0.0) > NO_ARROWS * bound))
    if len(j):
        ax.quiver(x[j], z[k], tau[0, j, k], tau[1, j, k], angles="uv", pivot="middle", width=0.004, color="0.1")
    _around(ax, contact, i)
    if contact.patch_kind == "point":
        reach, middle = SHOWN_WIDTHS * contact.half_widths[i, 1] * 1e3, contact.center_of_pressure[i, 1] * 1e3
        if reach > 0.0:
            ax.set_ylim(middle - reach, middle + reach)
    ax.set(xlabel="arc along e_theta from the line of centres [mm]", ylabel="along the axis [mm]")
    shares = friction.stick_area[i], friction.slip_area[i]
    share = shares[0] / sum(shares) if sum(shares) > 0.0 else np.nan
    ax.set_title(f"Stick and slip, {_at(result, i)}, area of adhesion {share:.0%}", fontsize=10)
    ax.legend(
        handles=[Patch(color=c, label=n) for n, c in zip(STATES, STATE_COLORS, strict=True)], fontsize=8, ncols=3,
        loc="upper center", bbox_to_anchor=(0.5, BELOW), frameon=False,
    )  # fmt: skip


@dataclass(frozen=True)
class StickSlipMap:
    """`stick_slip` in saved step `row` of `result` with its own title, as a panel for `panels.save_panels`."""

    title: str
    result: Any
    row: int

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        stick_slip(self.result, ax, self.row)
        ax.set_title(self.title, fontsize=10)


def creepage(result: Any, ax: Any) -> None:
    """Longitudinal and lateral creepage, and tangential over normal load, against time."""
    contact = rubbing(result)
    time, friction = result.time * 1e3, contact.friction
    ax.plot(time, friction.creepage[:, 0], color=TRACTION, label="longitudinal, along e_theta")
    if _seen(friction.creepage[:, 1], friction.creepage[:, 0]):
        ax.plot(time, friction.creepage[:, 1], color=ACROSS, label="lateral, along the axis")
    ax.axhline(0.0, color="0.7", lw=0.6)
    right = ax.twinx()
    right.plot(time, friction.traction_coefficient, color=BOUND)
    if _coefficient(contact) is not None:
        right.axhline(_coefficient(contact), color=BOUND, lw=0.8, ls="--")
    most = max(float(np.nanmax(friction.traction_coefficient, initial=0.0)), _coefficient(contact) or 0.0)
    right.set_ylim(0.0, LEGEND_ROOM * max(most, LEAST))
    ax.set(xlabel="time [ms]")
    ax.set_ylabel("creepage [-]", color=TRACTION)
    right.set_ylabel("tangential over normal load [-]", color=BOUND)
    ax.set_title("Creepage and traction coefficient (dashed: coefficient of friction)", fontsize=10)
    ax.margins(y=0.25)
    about_zero(ax, LEAST)
    ax.legend(frameon=False, fontsize=8, loc="upper right")


def spin(result: Any, ax: Any) -> None:
    """Spin creepage and the moment of the tractions about the normal against time."""
    contact = rubbing(result)
    time, friction = result.time * 1e3, contact.friction
    right, most = ax.twinx(), full_slip(contact)
    curves = (
        (ax, friction.spin_creepage, most["spin_creepage"], TRACTION),
        (right, friction.spin_moment, most["spin_moment"], SECOND),
    )
    for axes, values, beside, color in curves:
        axes.plot(time, values, color=color)
        top = HEADROOM * max(largest([np.abs(values)]), LEAST * beside) or 1.0
        axes.set_ylim(-top, top)  # both zeros at one height
    ax.axhline(0.0, color="0.7", lw=0.6)
    ax.set(xlabel="time [ms]")
    ax.set_ylabel("spin creepage [rad/m]", color=TRACTION)
    right.set_ylabel("spin moment Mz on the first body [N m]", color=SECOND)
    ax.set_title("Spin about the outward normal: creepage and moment", fontsize=10)


def t_gamma(result: Any, ax: Any) -> None:
    """T-gamma against time, with the friction power over the rolling speed."""
    contact = rubbing(result)
    time, friction = result.time * 1e3, contact.friction
    per_metre = friction.power_per_metre
    ax.plot(time, per_metre, "--", color=SECOND, label="friction power over rolling speed")
    ax.plot(time, friction.t_gamma, color=TRACTION, label="T-gamma, by forces and creepages")
    low = min(0.0, float(np.nanmin(friction.t_gamma, initial=0.0)))
    high = max(largest([friction.t_gamma, per_metre]), LEAST * full_slip(contact)["t_gamma"])
    ax.set_ylim(HEADROOM * min(low, -(HEADROOM - 1.0) * high), LEGEND_ROOM * high or 1.0)
    ax.set(xlabel="time [ms]", ylabel="energy per metre rolled [N]")
    ax.set_title("T-gamma", fontsize=10)
    ax.legend(frameon=False, fontsize=8, loc="upper right")


def power(result: Any, ax: Any) -> None:
    """Friction power and the largest wear index against time."""
    contact = rubbing(result)
    time, friction = result.time * 1e3, contact.friction
    ax.plot(time, friction.power, color=TRACTION)
    right = ax.twinx()
    right.plot(time, friction.wear_peak * 1e-6, "--", color=SECOND)
    ax.set(xlabel="time [ms]")
    ax.set_ylabel("friction power [W]", color=TRACTION)
    right.set_ylabel("largest wear index [W/mm²]", color=SECOND)
    most = full_slip(contact)
    from_zero(ax, friction.power, least=LEAST * most["friction_power"])
    from_zero(right, friction.wear_peak * 1e-6, least=LEAST * most["wear"])
    ax.set_title("Friction power, and wear index: pressure times slip speed", fontsize=10)


FRICTION_PLOTS: dict[str, Callable[[Any, Any], None]] = {
    "traction": traction,
    "stick_slip": stick_slip,
    "creepage": creepage,
    "spin": spin,
    "t_gamma": t_gamma,
    "power": power,
}


MISES, SHEAR, REFERENCE = "#1b6ca8", "#2a9d6f", "#d1495b"
STYLES = ("-", "--")  # of the two bodies if Poisson's ratios differ
DEPTH_HEADROOM = 1.35  # of the largest stress: room for the legend above the curves, which decrease with depth
NOTE_WIDTH = 36  # characters per line


def has_material(contact: Any) -> bool:
    """True if the bodies have material data, so that the stress below the surface can be computed."""
    try:
        return bool(poisson_ratios(contact.view))
    except InputError:
        return False


def draw_depth(contact: Any, ax: Any, i: int, at: str) -> None:
    """Draw von Mises and largest shear stress below the patch of saved step `i`, and the Hertz maxima or the reason why
    there are none; `at`: the time, as text."""
    title = f"Below the centre of the patch, {at}"
    ax.set(xlabel="stress [MPa]", ylabel="depth [mm]")
    if not contact.touching[i]:
        ax.set_title(f"{title}: nothing touches", fontsize=10)
        return
    found = stress_below(contact, i)
    hertz, why = _hertz(contact, i)
    most = 0.0
    for n, below in enumerate(found):
        depth, whose = below.depth * 1e3, f", {' and '.join(below.bodies)}" if len(found) > 1 else ""
        for name, values, color in (("von Mises", below.von_mises, MISES), ("largest shear", below.max_shear, SHEAR)):
            ax.plot(values * 1e-6, depth, STYLES[n], color=color, label=name + whose)
        most = max(most, float(below.von_mises.max()) * 1e-6)
        if hertz is not None:
            size = hertz.half_width if isinstance(hertz, HertzLine) else hertz.semi_axes[1]
            for name, largest in zip(("von Mises", "shear"), largest_below(hertz, below.poisson_ratio), strict=True):
                label = f"Hertz: {largest.stress / hertz.peak_pressure:.3f} p0 at {largest.depth / size:.3f} b"
                ax.plot(
                    largest.stress * 1e-6, largest.depth * 1e3, "o" if name == "von Mises" else "s", ms=7.0,
                    mfc="none", color=REFERENCE, label=label + whose,
                )  # fmt: skip
                ax.axhline(largest.depth * 1e3, color=REFERENCE, lw=0.6, ls=":")
            most = max(most, largest_below(hertz, below.poisson_ratio)[0].stress * 1e-6)
    ax.set_xlim(0.0, DEPTH_HEADROOM * most or 1.0)
    ax.set_ylim(float(found[0].depth[-1]) * 1e3 or 1.0, 0.0)
    top = largest_of(found[0].depth, found[0].von_mises)
    title += f"\nlargest von Mises {top.stress * 1e-6:.4g} MPa at {top.depth * 1e3:.3g} mm"
    ax.set_title(title + (", without tractions" if contact.has_friction else ""), fontsize=10)
    if why:
        ax.annotate(
            textwrap.fill(f"no marks: {why}", NOTE_WIDTH), (0.98, 0.32), xycoords="axes fraction", ha="right", va="top",
            fontsize=7, color="0.35",
        )  # fmt: skip
    ax.legend(frameon=False, fontsize=7, loc="lower right")


def _hertz(contact: Any, i: int) -> tuple[HertzLine | HertzPoint | None, str]:
    """The Hertz solution, or the reason why it does not apply."""
    try:
        return hertz_contact(contact, i), ""
    except InputError as error:
        return None, str(error).partition(": ")[2] or str(error)
