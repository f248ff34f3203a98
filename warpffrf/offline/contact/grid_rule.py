r"""How fine must a contact grid be for a patch of a given half-width?

Against the exact elastic half-space, a pressure made of the functions of a grid of spacing s misses, for the worst
position of the patch (half-width b) over the grid and the worst position of the other body's grid,

    error <= c (s/b)^p.

**Rates.** A Hertz pressure ends in a square root at the edge of the patch. There, over a length s, the grid misses a
pressure of order sqrt(s), which carries an energy of order (sqrt(s) s)^2 = s^3: by so much the *compliance* (the
energy, or the mean approach, under a given pressure) is too small, p = 3. Cells miss s^3 from every length s beside
the edge too, s^3 ln(b/s) together, for which p = 2.5 is written. The contact on the grid is a minimum over the
pressures that the grid has; its energy over the approach d is `W(d) (1 - k s^3)` with a k that varies as the edges of
the patch pass the lines of the grid. The *force* is dW/dd, and that derivative costs a factor 1/s: p = 2, with a sign
that changes with position and size. Around an ellipse the edge passes the lines at all phases and only the stretches
along a line add up, of length sqrt(s): p = 2.5. The *half-width*, which is that of the second moment of the pressure,
goes with the force. Inside the patch the mean over a function misses s^2 times the curvature of the pressure: *peak
pressure*, p = 2. The *pressure* as a field, in the L2 norm: a square root that ends inside a length s is missed by
sqrt(s) over s, which is s^2 in the square of the norm, p = 1.

**Factors** c are the largest found by `studies.contact.contact_grid`, which sweeps sizes, positions and positions of
the opposite grid (docs/studies/contact_grid.md), rounded up. They hold for b/s >= 1; the rule gives no coarser grid.
On an ellipse b is the half-width *in the direction of the spacing*: ask once for each semi-axis, or take the smaller
one for both directions, which is safer. Errors of compliance and force of a line contact depend on how deep the body
is, because the rest of its compliance does: the factors are those of a depth of 10 half-widths, at 100 they are six
tenths.
"""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments

FINER_BEHIND = "let its layers grow more slowly (mesh.roller: more layers, grading=1.2), or use quadratic cells"
QUANTITIES = ("compliance", "force", "peak_pressure", "half_width", "pressure")
RULES: dict[tuple[str, str], dict[str, tuple[float, float]]] = {  # (c, p) by (traction, patch), written from the study
    ("hats", "line"): {
        "compliance": (0.012, 3.0),
        "force": (0.062, 2.0),
        "peak_pressure": (0.35, 2.0),
        "half_width": (0.34, 2.0),
        "pressure": (0.46, 1.0),
    },
    ("hats", "ellipse"): {
        "compliance": (0.062, 3.0),
        "force": (0.22, 2.5),
        "peak_pressure": (0.66, 2.0),
        "half_width": (0.56, 2.5),
        "pressure": (0.67, 1.0),
    },
    ("cells", "line"): {
        "compliance": (0.024, 2.5),
        "force": (0.058, 2.0),
        "peak_pressure": (0.22, 2.0),
        "half_width": (0.36, 2.0),
        "pressure": (0.63, 1.0),
    },
    ("cells", "ellipse"): {
        "compliance": (0.13, 2.5),
        "force": (0.31, 2.5),
        "peak_pressure": (0.48, 2.0),
        "half_width": (0.67, 2.5),
        "pressure": (0.86, 1.0),
    },
}
PATCHES = ("line", "ellipse")
TRACTIONS = ("hats", "cells")
ROUND_OFF = 1e-12  # a spacing of one half-width up to round-off is one half-width
COARSEST = 1.0  # spacing in half-widths: beyond it a patch is a hat or two, and the errors follow no rate


@named_arguments
def contact_spacing(
    half_width: float,
    *,
    error: float = 0.01,
    quantity: str = "force",
    patch: str = "line",
    traction: str = "hats",
) -> float:
    """Spacing [m] of a contact grid, for `reduce(..., traction_spacing=)`, that keeps the error of the grid below
    `error` wherever on the grid the patch lies.

    Parameters
    ----------
    half_width [m]: expected half-width b of the patch in the direction of the spacing. With a load that varies, the
        smallest that shall be right.
    error: relative, between 0 and 1.
    quantity: what `error` is of. "force": contact force at a given approach; "compliance": mean approach under a given
        pressure; "peak_pressure"; "half_width" of the patch; "pressure": all pressures, in the L2 norm.
    patch: "line" (long beside its width; along it the pressure varies slowly and the spacing may be far larger) or
        "ellipse" (circle included).
    traction: "hats" (normal pressure) or "cells" (friction).

    `s = b (error/c)^(1/p)`, at most b; c and p in the module docstring. It is the error of the grid alone: the mesh
    under it must be as fine, `reduce` refuses others. Raises `InputError` for impossible numbers and unknown names.
    """
    b = require_number(half_width, "contact_spacing: half_width", positive=True)
    error = require_number(error, "contact_spacing: error", positive=True)
    if error >= 1.0:
        raise InputError(f"contact_spacing: error is a fraction below 1, got {error:g}; for one per cent give 0.01")
    factor, rate = rule(quantity, patch, traction)
    return b * min((error / factor) ** (1.0 / rate), COARSEST)


def grid_error(
    spacing: float, half_width: float, *, quantity: str = "force", patch: str = "line", traction: str = "hats"
) -> float | None:
    """Error that a grid of `spacing` [m] stays below on a patch of `half_width` [m]: `c (s/b)^p`, or None where the
    spacing is larger than the half-width and the rule does not hold."""
    s = require_number(spacing, "grid_error: spacing", positive=True)
    b = require_number(half_width, "grid_error: half_width", positive=True)
    factor, rate = rule(quantity, patch, traction)
    return None if s > b * COARSEST * (1.0 + ROUND_OFF) else factor * (s / b) ** rate


def rule(quantity: str, patch: str, traction: str) -> tuple[float, float]:
    """Factor c and rate p of the rule; raises `InputError` for names it does not know."""
    if quantity not in QUANTITIES:
        raise InputError(f"contact_spacing: quantity {quantity!r} is not available, use one of {', '.join(QUANTITIES)}")
    if patch not in PATCHES:
        raise InputError(f"contact_spacing: patch {patch!r} is not available, use one of {', '.join(PATCHES)}")
    if traction not in TRACTIONS:
        raise InputError(f"contact_spacing: traction {traction!r} is not available, use one of {', '.join(TRACTIONS)}")
    return RULES[traction, patch][quantity]


@dataclass(frozen=True)
class GridChoice:
    """Spacing of a contact grid for an expected patch, and what it promises.

    `error`: for `quantity`, of the grid and of the mesh behind it; None where the patch is smaller than the spacing.
    `limited_by_mesh`: the wanted error needs a finer grid than the mesh can carry. `mesh_error`: the part of the mesh,
    None where it is not known (`mesh_error.line_mesh_error`).
    """

    spacing: float  # m
    error: float | None
    quantity: str
    half_width: float  # m, expected
    wanted_error: float
    wanted_spacing: float  # m, that the rule asks for
    limited_by_mesh: bool
    mesh_error: float | None = None

    def facts(self) -> dict[str, float | str | bool | None]:
        """Plain data for the report of a reduced body."""
        return {
            "spacing": self.spacing,
            "promised_error": self.error,
            "mesh_error": self.mesh_error,
            "promised_quantity": self.quantity,
            "wanted_error": self.wanted_error,
            "expected_half_width": self.half_width,
            "limited_by_mesh": self.limited_by_mesh,
        }

    def warning(self, name: str) -> str | None:
        """What to tell the user where the mesh of contact surface `name` cannot keep the wanted error, else None."""
        behind = self.mesh_error or 0.0
        wanted = (
            f"contact {name!r}: an error of {self.wanted_error:g} in {self.quantity.replace('_', ' ')} at a half-width "
            f"of {self.half_width:.3g} m"
        )
        if not self.limited_by_mesh:
            kept = self.error is None or self.error <= self.wanted_error
            if kept or behind <= 0.5 * self.wanted_error:  # what else is missing is a spacing that was rounded up
                return None
            return f"{wanted} is not kept: the cells behind the surface alone err by about {behind:.2g}; {FINER_BEHIND}"
        left = "is larger than the half-width" if self.error is None else f"keeps it below {self.error:.2g} only"
        return (
            f"{wanted} needs a contact grid of {self.wanted_spacing:.3g} m, finer than the mesh can carry; its "
            f"{self.spacing:.3g} m {left}; refine the surface mesh"
            + (f", and behind it, where the cells err by about {behind:.2g}" if behind > self.wanted_error else "")
        )


def choose_spacing(
    half_width: float,
    finest: float,
    *,
    error: float = 0.01,
    quantity: str = "force",
    patch: str = "line",
    traction: str = "hats",
) -> GridChoice:
    """The rule's spacing, but not below `finest` [m], the smallest that the surface mesh can carry; `error` of the
    choice is what the spacing then promises. Other arguments as in `contact_spacing`."""
    finest = require_number(finest, "choose_spacing: finest", positive=True)
    wanted = contact_spacing(half_width, error=error, quantity=quantity, patch=patch, traction=traction)
    spacing = max(wanted, finest)
    promised = grid_error(spacing, half_width, quantity=quantity, patch=patch, traction=traction)
    return GridChoice(spacing, promised, quantity, float(half_width), float(error), wanted, spacing > wanted)
