r"""How right the stress below a line contact is: what the cells behind the surface can follow.

With n the spacings of nodes in the half-width, along the surface or into the depth, whichever is wider, von Mises
stress and the depth of its maximum err by no more than

    von Mises  0.01 + 0.23/n^2,        depth  0.03 + 1/n^2,

at any place of the mesh: the worst of two rollers of linear and quadratic hexahedra, from the mesh to the result, with
first layers as deep as the cells are long and up to twice as deep, n = 1.1 to 8, against the closed form
(tests/verification/test_hertz_stress.py). What n does not tell, the round body and the fit of the curve, is the 1 %.
Stresses under points, of tetrahedra and wedges, and away from contacts are not judged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.output.contact.hertz import flexible_sides

COARSEST = 1.1  # spacings in a half-width, the fewest that were measured


@dataclass(frozen=True)
class StressError:
    """Largest relative errors of the von Mises stress below a line contact, and of the `depth` of its maximum, with
    `spacings` of nodes in the half-width; NaN, and the `reason`, where they are not known."""

    spacings: float
    von_mises: float
    depth: float
    reason: str = ""


def error_with(spacings: float) -> StressError:
    """With so many spacings of nodes in the half-width."""
    return StressError(spacings, 0.01 + 0.23 / spacings**2, 0.03 + 1.0 / spacings**2)


def unknown(contact: Any, why: str) -> StressError:
    """NaN, and why."""
    nan = float("nan")
    return StressError(nan, nan, nan, f"contact '{contact.name}': the error of the stress is not known: {why}")


def stress_errors(contact: Any, i: int) -> dict[str, StressError]:
    """By flexible body of the pair, in saved step `i`. Bodies whose cells are no hexahedra are left out.

    NaN with a reason where nothing touches, where the contact is no line, and for fewer spacings in the half-width than
    the rule was measured with.
    """
    why = ""
    if not contact.touching[i]:
        why = f"nothing touches in saved step {i}; choose one of those where `touching` is true"
    elif contact.patch_kind != "line":
        why = "it was measured for lines across the width, and this is none"
    found = {}
    for body, surface in flexible_sides(contact.view):
        spacing = body.reduced.provenance.get("contact_node_spacings", {}).get(surface.name)
        if spacing is None:
            continue
        spacings = float(contact.half_width[i]) / spacing
        coarse = (
            f"nodes of '{body.name}' are {spacing:.3g} m apart, and the half-width is {contact.half_width[i]:.3g} m; "
            "use a finer mesh"
        )
        if why or spacings < COARSEST:
            found[body.name] = unknown(contact, why or coarse)
        else:
            found[body.name] = error_with(spacings)
    return found
