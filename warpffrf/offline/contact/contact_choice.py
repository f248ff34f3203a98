r"""How coarse may a contact be for a wanted error: the spacing of its grid, and its sampling points.

A contact force is wrong by what the grid of hats misses and by what few points miss of all of them. The wanted
error is shared, half to each. The spacing follows from the rule of `grid_rule`, error <= c (s/b)^p. Of the points, an
error e of the integrals over training patches moves the gap of a patch by at most e of its depth; force over approach
is a power of at most 3/2 (an ellipse; 1 of a line), so that e = share/(3/2) keeps it. That is safe: on rollers the
force moved by a tenth of it (`tests/offline/test_contact_choice.py`, `bench/evaluations.py`).

The mesh must be as fine as the grid; `reduce` refuses a finer grid.
"""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.errors import InputError, require_number
from warpffrf.offline.contact.grid_rule import contact_spacing, grid_error

GRID_SHARE = 0.5  # of the wanted error
POWERS = {"line": 1.0, "ellipse": 1.5}  # of the force in the approach: Hertz, line (up to a logarithm) and point


@dataclass(frozen=True)
class ContactChoice:
    """What to give `reduce`: traction_spacing [m] and sampling_error; `grid_error` and `sampling_share` are the parts
    of the wanted error that they take, None where the patch is smaller than the spacing."""

    traction_spacing: float
    sampling_error: float
    grid_error: float | None
    sampling_share: float

    def settings(self) -> dict[str, float]:
        """Arguments for `reduce`."""
        return {"traction_spacing": self.traction_spacing, "sampling_error": self.sampling_error}


def contact_choice(half_width: float, *, error: float = 0.01, patch: str = "line") -> ContactChoice:
    """Grid and points for a contact force right to `error` on patches of `half_width` [m] or larger.

    patch: "line" or "ellipse", as in `contact_spacing`. Raises `InputError` for impossible numbers and unknown names.
    """
    b = require_number(half_width, "contact_choice: half_width", positive=True)
    error = require_number(error, "contact_choice: error", positive=True)
    if error >= 1.0:
        raise InputError(f"contact_choice: error is a fraction below 1, got {error:g}; for one per cent give 0.01")
    spacing = contact_spacing(b, error=GRID_SHARE * error, quantity="force", patch=patch)
    share = (1.0 - GRID_SHARE) * error
    return ContactChoice(spacing, share / POWERS[patch], grid_error(spacing, b, quantity="force", patch=patch), share)
