"""Stress below the centre of a patch against depth, with the depths at which Hertz has his largest."""

from __future__ import annotations

import textwrap
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.output.bodies.stress_below import poisson_ratios, stress_below
from warpffrf.output.contact.hertz import hertz as hertz_contact
from warpffrf.output.contact.hertz_patch import HertzLine, HertzPoint
from warpffrf.output.contact.hertz_stress import largest_below, largest_of

MISES, SHEAR, REFERENCE = "#1b6ca8", "#2a9d6f", "#d1495b"
STYLES = ("-", "--")  # of the two bodies where Poisson's ratios differ
HEADROOM = 1.35  # of the largest stress: room for the legend beside the curves, which go back below
NOTE_WIDTH = 36  # characters a line


def has_material(contact: Any) -> bool:
    """True where the bodies of the pair say of what they are made, so that the stress below is known."""
    try:
        return bool(poisson_ratios(contact.view))
    except InputError:
        return False


def draw_depth(contact: Any, ax: Any, i: int, at: str) -> None:
    """Draw von Mises and largest shear stress below the patch of saved step `i`, and Hertz's marks or why there are
    none; `at`: the time, in words."""
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
    ax.set_xlim(0.0, HEADROOM * most or 1.0)
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
    """Hertz's contact, or why he does not apply."""
    try:
        return hertz_contact(contact, i), ""
    except InputError as error:
        return None, str(error).partition(": ")[2] or str(error)
