"""The skin of a body as pictures and recordings draw it: thinned, coloured by one field."""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.bodies.skin import VON_MISES, Skin
from warpffrf.output.geometry.thinning import thinned

DISPLACEMENT = "displacement"  # the field that every flexible body has


def known_fields(skins: dict[str, Skin]) -> list[str]:
    """What the skins of a run can be coloured by: the displacement, and what at least one of them has."""
    return [DISPLACEMENT, *dict.fromkeys(field for skin in skins.values() for field in skin.fields)]


def require_field(skins: dict[str, Skin], field: str, what: str) -> None:
    """Raises `InputError` naming `what` for a field that no skin has."""
    known = known_fields(skins)
    if field == VON_MISES and field not in known:
        notes = "; ".join(skin.stress.note for skin in skins.values())
        raise InputError(f"{what} '{VON_MISES}': {notes or 'no body is flexible'}")
    if field not in known:
        raise unknown_name(what, field, known)


class ShownSkin:
    """A skin of at most `max_points` points: `points` (n, 3) [m, user frame], `triangles` (t, 3), `size` [m], the
    largest extent of the whole skin."""

    def __init__(self, skin: Skin, max_points: int) -> None:
        sectors = max((s.recovery.sectors for s in skin.body.reduced.contact_surfaces.values()), default=1)
        self.skin = skin
        self.kept, self.triangles = thinned(skin.points, skin.triangles, max_points, sectors)
        self.points = skin.points[self.kept]
        self.size = float(np.ptp(skin.points, axis=0).max())

    def displacement(self, i: int) -> np.ndarray:
        """Elastic displacement (n, 3) [m], user axes, at saved step `i`."""
        return self.skin.displacement(i)[self.kept]

    def values(self, field: str, i: int) -> np.ndarray:
        """One of `Skin.fields` (n,) in SI units at saved step `i`; of a body without it zero, as nothing touches it,
        and NaN for its stress, which is not known."""
        if field not in self.skin.fields:
            return np.full(len(self.kept), np.nan if field == VON_MISES else 0.0)
        return self.skin.field(field, i)[self.kept]
