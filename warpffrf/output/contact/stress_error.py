r"""Accuracy of the stress below a line contact: resolution of the elements behind the surface.

With n node spacings in the half-width, along the surface or into the depth, whichever spacing is larger, the errors of
the von Mises stress and of the depth of its maximum are at most

    von Mises  0.01 + 0.23/n^2,        depth  0.03 + 1/n^2,

at any position in the mesh: the largest error of two rollers of linear and quadratic hexahedra, from the mesh to the
result, with first layers as deep as the elements are long and up to twice as deep, n = 1.1 to 8, against the closed
form (tests/verification/contact/test_hertz_stress.py). The constant 1 % covers effects that do not depend on n, the
round body and the fit of the curve. Stresses under point contacts, of tetrahedra and wedges, and away from contacts are
not estimated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.output.contact.hertz import flexible_sides

COARSEST = 1.1  # spacings in a half-width, the fewest measured


@dataclass(frozen=True)
class StressError:
    """Largest relative errors of the von Mises stress below a line contact, and of the `depth` of its maximum, with
    `spacings` of nodes in the half-width; NaN, with the `reason`, if unknown."""

    spacings: float
    von_mises: float
    depth: float
    reason: str = ""


def error_with(spacings: float) -> StressError:
    """Errors for a number of node spacings in the half-width."""
    return StressError(spacings, 0.01 + 0.23 / spacings**2, 0.03 + 1.0 / spacings**2)


def unknown(contact: Any, why: str) -> StressError:
    """NaN with the reason."""
    nan = float("nan")
    return StressError(nan, nan, nan, f"contact '{contact.name}': the error of the stress is not known: {why}")


def stress_errors(contact: Any, i: int) -> dict[str, StressError]:
    """Errors by flexible body of the contact, in saved step `i`. Bodies whose elements are not hexahedra are omitted.

    NaN with a reason without contact, if the contact is not a line, and for fewer spacings in the half-width than the
    rule was measured with.
    """
    why = ""
    if not contact.touching[i]:
        why = f"nothing touches in saved step {i}; choose one of those where `touching` is true"
    elif contact.patch_kind != "line":
        why = "the rule is for lines across the width, and this is another kind"
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
