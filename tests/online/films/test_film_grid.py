"""What the grid of a film leaves of load, flow and torque, as a run says it, compared with a film of four times the
nodes each way at the same place: an implementation of its own, in the verification."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from film_scenes import CLEARANCE, LENGTH, RADIUS, SPEED, VISCOSITY, bearing, bore_body, place

from references.films.journal import JournalFilm
from warpffrf.model import films
from warpffrf.online import find_equilibrium
from warpffrf.output.result import Result

TRUE = 3.0  # an estimate is good for the figure's order: within this factor


def _figures(at: Any, columns: int, rows: int) -> np.ndarray:
    """Force (2,) [N], flow in through the groove [m3/s], torque on the shaft [N m]."""
    film = JournalFilm(RADIUS, LENGTH, CLEARANCE, VISCOSITY, SPEED, columns, rows, feeds=(columns // 2,))
    state, grid = film.steady(at), film.grid
    h, w = film.gap(at), grid.weights
    k = h**3 / (12.0 * VISCOSITY)
    rest = grid.slope_x.T @ (w * (k * (grid.slope_x @ state.pressure) - h * film.carried_with))
    rest = rest + grid.slope_z.T @ (w * k * (grid.slope_z @ state.pressure)) - film.outflow @ state.void
    flow = rest.reshape(columns, rows)[columns // 2].sum()
    return np.array([*film.force(state), flow, film.torques(at, state)[0]])


@pytest.mark.parametrize("load", [300.0, 2e3])
def test_errors_of_the_grid_are_true_within_a_factor(load: float) -> None:
    history = find_equilibrium(bearing((load, 0.0), body=bore_body(modulus=1e3 * 210e9)), progress=False)
    found, at = history.film_grids["film"], place(history) * CLEARANCE
    coarse, fine = _figures(at, 32, 7), _figures(at, 128, 25)
    true = np.abs(coarse - fine) / np.abs(fine)
    for said, size in (
        (found.load, np.linalg.norm(coarse[:2] - fine[:2]) / np.linalg.norm(fine[:2])),
        (found.flow, true[2]),
        (found.torque, true[3]),
    ):
        assert size / TRUE < said < size * TRUE
    assert any("its grid of 32 columns and 7 rows has an error of about" in note for note in history.notes)


def test_every_rule_of_cavities_has_an_estimate() -> None:
    """Of rules that differ little, errors that do; profiles have no rows."""
    found = {
        rule: find_equilibrium(bearing((300.0, 0.0), cavitation=rule), progress=False).film_grids["film"]
        for rule in ("jfo", "reynolds", "half_sommerfeld")
    }
    loads = np.array([errors.load for errors in found.values()])
    assert np.all((loads > 1e-3) & (loads < 0.2))
    wide = films.AxialGroove(np.pi, 0.01, 1e5)
    fed = find_equilibrium(bearing((300.0, 0.0), feeds=[wide]), progress=False).film_grids["film"]
    assert np.isfinite([fed.load, fed.flow, fed.torque]).all()
    assert not find_equilibrium(bearing((300.0, 0.0), quadrature="reduced"), progress=False).film_grids


def test_the_force_of_a_film_that_the_loads_give_has_no_error() -> None:
    """A shaft under 300 N that a joint holds along its axis and square to it: what its grid does is of the gap."""
    scene = bearing((300.0, 0.0))
    sizes = {line.of: line.size for line in Result(find_equilibrium(scene, progress=False)).error_budget()}
    assert sizes["force of film 'film'"] == 0.0 < sizes["stiffness of film 'film'"]
