"""Oil films between two surfaces, what they are fed by, and how the surfaces deviate from their true shapes.

    Film                                the film of a pair of surfaces, `film`
    Groove  Ring  Hole                  feeds, `feeds`
    Lobes  Barrel  Worn  Measured       form deviations, `warpffrf.model.surfaces.form_deviations`; they add up
    Roughness                           of a wall, with flow factors, `roughness`
    CAVITATIONS                         what becomes of pressures below that of cavitation, `cavitation`

The oils are in `warpffrf.model.oils`.
"""

from __future__ import annotations

from warpffrf.model.films.cavitation import CAVITATIONS
from warpffrf.model.films.feeds import FEEDS, Feed, Groove, Hole, Ring
from warpffrf.model.films.film import EVALUATIONS, Film
from warpffrf.model.films.roughness import ROUGHNESSES, Roughness
from warpffrf.model.surfaces.form_deviations import FORMS, Barrel, Form, Lobes, Measured, Sum, Worn

__all__ = [
    "CAVITATIONS", "EVALUATIONS", "FEEDS", "FORMS", "ROUGHNESSES", "Barrel", "Feed", "Film", "Form", "Groove", "Hole",
    "Lobes", "Measured", "Ring", "Roughness", "Sum", "Worn",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__
