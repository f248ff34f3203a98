"""What a run says of the errors of the figures that its report prints, compared with the errors that these have."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.closed_forms import PointContact, contact_modulus
from studies.accuracy.figure_errors import FACTOR, KINDS, compare, cover, nip
from studies.contact import coarse_points as points
from studies.contact import coarse_rollers as rollers
from studies.films import film_acceptance as films
from warpffrf.model.reduced.mesh_error import own_mesh_error
from warpffrf.online.history.history import BudgetLine
from warpffrf.output.budget import budget
from warpffrf.output.budget.balance import given_by_loads
from warpffrf.output.budget.figures import UNKNOWN, error_text, errors, figures, total

PAIR = f"contact {rollers.PAIR!r}"
APPROACH = 2e-5
MET = 0.85  # of the figures of a scene are right to FACTOR: docs/studies/error_budget.md has 9 of 10 of all


@pytest.fixture(scope="module")
def fine() -> Any:
    return rollers.reduced(rollers.hexahedra(4e-3))


@pytest.fixture(scope="module", params=["hex20", "tet10"])
def coarse(request: pytest.FixtureRequest) -> Any:
    return rollers.reduced(KINDS[request.param](lambda order: rollers.hexahedra(8e-3, order)))


@pytest.fixture(scope="module")
def pressed(coarse: Any) -> wf.Result:
    return wf.equilibrium(rollers.held(coarse, coarse, APPROACH), progress=False)


@pytest.fixture(scope="module")
def weighed() -> wf.Result:
    return points.weighed(points.ball(points.STEEL, points.PLAIN), points.LOAD, points.STEEL)


def test_a_mesh_knows_its_own_error(coarse: Any, fine: Any) -> None:
    """Compared with a second mesh, which itself errs by less than a third."""
    true = abs(coarse.mesh_error(fine, half_width=4e-4)["rim"])
    assert true / FACTOR < own_mesh_error(coarse, "rim", (4e-4, 0.01), line=True) < true * FACTOR


def test_a_finer_mesh_errs_less(coarse: Any, fine: Any) -> None:
    for widths, line in (((4e-4, 0.01), True), ((2e-4, 3e-4), False)):
        assert own_mesh_error(fine, "rim", widths, line=line) < own_mesh_error(coarse, "rim", widths, line=line)


def test_figures_of_an_equilibrium_are_right(pressed: wf.Result, fine: Any) -> None:
    exact = wf.equilibrium(rollers.held(fine, fine, APPROACH, cells=(25, 41)), progress=False)
    found = compare("rollers", pressed, exact)
    assert {f"{kind} of {PAIR}" for kind in ("force", "approach", "peak pressure", "half-widths")} <= {
        s.figure for s in found
    }
    assert all(np.isfinite(s.stated) for s in found)
    assert np.mean([s.right for s in found]) >= MET, [s for s in found if not s.right]


def test_an_equilibrium_has_no_step(pressed: wf.Result) -> None:
    assert not [line for line in pressed.error_budget() if line.source in ("time step", "energy ledger")]
    text = pressed.report(progress=False)
    assert "estimated error of each result" in text and "not made" not in text and "not found" not in text


def test_what_stands_still_has_no_error_of_its_step(coarse: Any) -> None:
    """Ways of 1e-17 m are no motion that a step may err in."""
    result = wf.simulate(
        rollers.held(coarse, coarse, APPROACH), 4e-3, step=1e-3, start="equilibrium", progress=False
    )  # fmt: skip
    sizes = [line.size for line in result.error_budget() if line.source == "time step"]
    assert sizes and max(sizes) < budget.FLOOR


def test_loads_give_a_force(weighed: wf.Result, pressed: wf.Result) -> None:
    """The force of a ball under its weight is that, on any mesh; its approach has the whole error."""
    assert given_by_loads(weighed) >= {PAIR} and PAIR not in given_by_loads(pressed)
    lines = weighed.error_budget()
    force = [line for line in lines if line.of == f"force of {PAIR}" and line.source in ("FE mesh", "contact grid")]
    assert [line.size for line in force] == [0.0, 0.0]
    assert weighed.contact("pair").force_magnitude[-1] == pytest.approx(points.LOAD, rel=1e-6)  # iteration
    stiffness = total([line for line in lines if line.of == f"stiffness of {PAIR}" and line.found])
    approach = total([line for line in lines if line.of == f"approach of {PAIR}" and line.found])
    assert approach == pytest.approx(stiffness / 1.5, rel=0.05)  # F ~ d^1.5; the iteration has a part


def test_a_ball_on_a_plane_is_right(weighed: wf.Result) -> None:
    """Compared with Hertz, and what a ball yields less than a half-space."""
    errors = points.ball_errors(points.ball(points.STEEL, points.PLAIN), points.LOAD, points.STEEL)
    for kind, true in (
        ("approach", errors.approach),
        ("half-widths", errors.half_width),
        ("peak pressure", errors.peak),
    ):
        stated = total([line for line in weighed.error_budget() if line.of == f"{kind} of {PAIR}" and line.found])
        assert abs(true) / FACTOR < stated < FACTOR * abs(true), kind


def test_the_stress_below_a_contact_is_right() -> None:
    """Compared with Hertz at the load of a ball; what lies deeper than a contact reaches is distinguished."""
    exact = PointContact(points.LOAD, points.BALL_RADIUS, contact_modulus(points.STEEL))
    depths = exact.half_width * np.append(points.DEPTHS, 20.0)
    result = points.weighed(points.ball(points.STEEL, points.PLAIN, depths), points.LOAD, points.STEEL)
    found = points.largest(points.DEPTHS, result.stress("ball", "below").von_mises[-1][:-1])[0]
    wanted = points.largest(points.DEPTHS, exact.von_mises(depths[:-1], points.STEEL.poisson_ratio))[0]
    lines = result.error_budget()
    stated = total([line for line in lines if line.of == "stress below 'pair' of body 'ball'" and line.found])
    assert abs(found / wanted - 1.0) / FACTOR < stated < FACTOR * abs(found / wanted - 1.0)
    away = [line.source for line in lines if line.of == "stress away from contacts of body 'ball'"]
    assert away == [UNKNOWN]


@pytest.mark.slow
def test_covers_know_what_few_cells_along_make_of_their_ends() -> None:
    exact = nip(cover(16), (25, 41))
    for axial in (4, 8):
        (force,) = (s for s in compare("cover", nip(cover(axial)), exact) if s.figure == f"force of {PAIR}")
        assert force.right, force


def test_no_figure_is_silent() -> None:
    """A film, of whose grid no one speaks, in rest and in motion."""
    scene = films.on_shaft((16, 5), 2e3, (0.0, 0.0))
    for result in (wf.equilibrium(scene, progress=False), wf.simulate(scene, 2e-4, step=1e-4, progress=False)):
        printed = set(figures(result.history, result.view))
        assert {f"{kind} of film 'film'" for kind in ("torque", "largest pressure", "end flow")} <= printed
        assert printed <= {line.of for line in result.error_budget()}


def test_a_source_is_one_line_of_a_registry(pressed: wf.Result, monkeypatch: pytest.MonkeyPatch) -> None:
    def source(run: budget.Run) -> list[BudgetLine]:
        return [BudgetLine("test", f"force of {PAIR}", 0.02, "found")]

    monkeypatch.setattr(budget, "SOURCES", (source,))
    own = {line.of: line for line in budget.error_budget(pressed) if line.source == "test"}
    peak = own[f"peak pressure of {PAIR}"].size
    assert peak == pytest.approx(0.01, rel=0.03)  # as the root of the force of a line; the wall is 60 half-widths thick
    assert own[f"half-widths of {PAIR}"].size == pytest.approx(0.01)
    assert own["reaction of joint 'fixed_1'"].size == pytest.approx(0.02)


def test_sources_are_independent() -> None:
    lines = [
        BudgetLine("a", "force of film 'x'", 0.03, ""),
        BudgetLine("b", "force of film 'x'", 0.04, ""),
        BudgetLine(UNKNOWN, "torque of film 'x'", np.nan, "no second grid"),
        BudgetLine("a", "work of friction", 0.01, ""),
    ]
    assert {owner: error_text(kinds) for owner, kinds in errors(lines).items()} == {
        "film 'x'": "force 5 % (b); not estimated: torque (no second grid)",
        "": "work of friction 1 % (a)",
    }


def test_micro_slip_is_not_rolling() -> None:
    """Of a patch that stays, which slips in an annulus thinner than a cell, nothing is said of what friction takes."""
    body = rollers.reduced(rollers.hexahedra(8e-3, 2, 0.05), 0.05, tangential=True)
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 2.0 * rollers.R - 1e-5))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 1, 0)))
    shift = wf.signals.Table(np.arange(4.0), 1e-6 * np.array([0.0, 1.0, 0.0, -1.0]))
    scene.add(wf.joints.Drive(guide, shift, quantity="position"))
    scene.add(
        wf.Contact(lower["rim"], upper["rim"], friction=0.3, grid="contact_fixed", cells=(7, 7), name=rollers.PAIR)
    )
    lines = wf.static(scene, 3.0, step=1.0, progress=False).error_budget()
    for name in ("work of friction", f"friction power of {PAIR}"):
        assert [line.source for line in lines if line.of == name and not line.found] == [UNKNOWN], name
