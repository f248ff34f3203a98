"""What results files of an older schema lack, and what is read in its place.

`LATER` has the quantities that some files lack: the schema from which on every file has them, and what their numbers
were before the program knew them, NaN where that cannot be told. A file of an older schema without one gets an array of
that, whose axes are as long as those of the same name in what the file has of the owner, and of no length where nothing
tells. What was filled in is said in a note of the run. A file that lacks anything else is damaged, and refused by who
needs it.

A new quantity is a row in `fields.py`, a line here, and a schema version one higher.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.output.files.fields import SIZES, Field

LATER: dict[str, tuple[int, float]] = {
    "contact_cell_column_second": (3, np.nan),
    "film_asperity": (3, 0.0),  # films had none
    "film_asperity_force": (3, 0.0),
    "film_largest_asperity_pressure": (3, 0.0),
    "lap_partner": (3, np.nan),
    "lap_partner_frame": (3, np.nan),
    "lap_share": (3, 0.0),
    "lap_share_cell": (3, 0),
    "lumped_moment": (4, 0.0),  # lumped contacts had none
}


class Older:
    """Fills in what a file of the schema `version` with `steps` saved rows lacks, and remembers what it was."""

    def __init__(self, version: int, steps: int) -> None:
        self.version, self.steps = version, steps
        self.lacking: dict[str, str] = {}  # name of a quantity -> what was read in its place, in words

    def complete(
        self, fields: tuple[Field, ...], found: dict[str, np.ndarray], *, fixed: bool = False
    ) -> dict[str, Any]:
        """`found` of one owner, attribute -> array, with what an older file may lack of `fields`; fixed: of quantities
        that are the same in all steps."""
        begin = () if fixed else (self.steps,)
        sizes = _sizes(fields, found, len(begin))
        whole = dict(found)
        for field in fields:
            since, absent = LATER.get(field.name, (1, np.nan))
            if field.attribute in found or self.version >= since:
                continue
            shape = *begin, *(SIZES.get(dim, sizes.get(dim, 0)) for dim in field.dims)
            whole[field.attribute] = np.full(shape, absent)
            self.lacking[field.name] = "none" if 0 in shape else "not known" if np.isnan(absent) else f"{absent:g}"
        return whole

    def notes(self) -> list[str]:
        """What was filled in, in one note."""
        if not self.lacking:
            return []
        said = ", ".join(f"{name} (read as {words})" for name, words in self.lacking.items())
        return [f"the results file is of the older schema {self.version} and lacks {said}; run it again to have them"]


def _sizes(fields: tuple[Field, ...], found: Mapping[str, np.ndarray], before: int) -> dict[str, int]:
    """Lengths of the axes by name, where `before` axes stand in front of those that fields name."""
    known = [(field.dims, np.shape(found[field.attribute])[before:]) for field in fields if field.attribute in found]
    return {dim: length for dims, shape in known for dim, length in zip(dims, shape, strict=False)}
