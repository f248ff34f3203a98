"""Oil films: gaps, pressures and forces, the resulting loads on bodies and modes, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.films import flow, heat, history, increments, sampling, second_surface, system

WARM = Participant("temperatures of films", when="film_heat_node", keep=[blocks(heat.warm_film, "film")])

SECOND = Participant(
    "second surfaces of films that yield",
    when="film_second_node",
    load=[blocks(second_surface.load_second, "film")],
    record=[blocks(history.record_second, "film")],
)

FILM = Participant(
    "films",
    when="film",
    predict=[blocks(sampling.open_film, "film"), blocks(sampling.guard_prediction)],
    load=[blocks(sampling.sample_film, "film"), blocks(flow.balance_film, "film"), blocks(flow.push_films)],
    assemble=[blocks(system.assemble_film, "film"), blocks(system.stiffen_by_films)],
    recover=[blocks(increments.limit_films)],
    advance=[blocks(increments.take_film, "film")],
    book=[blocks(flow.book_films)],
    keep=[blocks(history.keep_film, "film")],
    record=[blocks(history.record_film, "film")],
)
