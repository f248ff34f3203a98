"""Oil films between two surfaces, their feeds, and the form deviations of the surfaces.

    Film            the film of a pair of surfaces, `film`
    feeds           AxialGroove, CircumferentialGroove, SupplyHole, `feeds`
    forms           LobedForm, BarrelForm, WornForm, PadForm, PocketForm, MeasuredForm, deviations from the true
                    shape that add up, `warpffrf.model.surfaces.form_deviations`
    bearings        Pad, Dam, pads, TiltingPads, JournalBearing: `scene.add_journal_bearing`, `journal_bearing`
    roughness       Roughness of a wall, with flow factors; MixedLubrication, asperities in addition, `roughness`
    temperature     FilmTemperature, `heat`; BodyTemperature, of the bodies next to it, `warpffrf.model.thermal`
    CAVITATIONS     treatment of pressures below that of cavitation, `cavitation`

The oils are in `warpffrf.model.oils`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.errors import no_attribute
from warpffrf.model.films.feeds import FEEDS, AxialGroove, CircumferentialGroove, Feed, SupplyHole
from warpffrf.model.films.film import CAVITATIONS, QUADRATURES, Film
from warpffrf.model.films.heat import FilmTemperature
from warpffrf.model.films.journal_bearing import Dam, JournalBearing, Pad, TiltingPads, pads
from warpffrf.model.films.roughness import ROUGHNESSES, MixedLubrication, Roughness
from warpffrf.model.surfaces.form_deviations import (
    FORMS,
    BarrelForm,
    CompositeForm,
    Form,
    LobedForm,
    MeasuredForm,
    PadForm,
    PocketForm,
    WornForm,
)
from warpffrf.model.thermal import BodyTemperature

__all__ = [
    "CAVITATIONS", "QUADRATURES", "FEEDS", "FORMS", "ROUGHNESSES", "BarrelForm", "Feed", "Film", "Form",
    "AxialGroove", "SupplyHole", "FilmTemperature", "BodyTemperature",
    "LobedForm", "MeasuredForm", "MixedLubrication", "CircumferentialGroove", "Roughness", "CompositeForm", "WornForm",
    "PadForm", "PocketForm", "Pad", "Dam", "pads", "TiltingPads", "JournalBearing",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
