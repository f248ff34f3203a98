"""A law that the package does not know: one class, for both solvers, their notes and what describes them in scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.integrate import quad

from references.monolithic import results as monolithic
from scenes.rollers import roller_body
from warpffrf.model import joints, laws, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.laws import curves
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.simulate import simulate

RADIUS, ACROSS = 0.05, (0.0, 1.0, 0.0)
BEGINS = 4.0  # standard deviations: no asperity is higher
POINTS = 200
NODES_AND_NODES = 0.02  # of the force: what nodes and weak gaps discretise, as for the layers of the package


@pytest.fixture(scope="module")
def fine_roller() -> ReducedBody:
    return roller_body(150, layers=4, axial=2, grading=1.6, order=1, max_frequency=15e3, cache=False)


@dataclass(frozen=True)
class GaussianAsperities(laws.Law):
    """Greenwood and Williamson (Proc. R. Soc. A 295, 1966) for heights of a normal distribution of deviation sigma [m],
    p = c int_u^inf (s - u)^(3/2) phi(s) ds, u = g/sigma; as a table of the gap, from BEGINS inwards."""

    c: float
    sigma: float
    kind: ClassVar[str] = "gaussian_asperities"

    @property
    def curve(self) -> curves.Table:
        u = np.linspace(BEGINS, -3.0, POINTS)
        p = np.array([quad(lambda s, v=v: (s - v) ** 1.5 * np.exp(-0.5 * s * s), v, BEGINS)[0] for v in u])
        return curves.Table(-self.sigma * u, self.c * p / np.sqrt(2.0 * np.pi))

    @property
    def remark(self) -> str:
        return f"its asperities are no higher than {BEGINS:g} deviations"


def pressed(body: ReducedBody, at_nodes: bool) -> Any:
    """A roller held above the ground, asperities alone between them; the run."""
    scene = Scene()
    roller = scene.add_body(body, name="roller", position=(0.0, 0.0, RADIUS - 6e-4))
    scene.add(joints.Fixed(scene.ground, roller["bore"], name="hold"))
    plane = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=ACROSS)
    floor = scene.ground.surface(plane, name="floor")
    law = GaussianAsperities(2e8, 2e-5)
    scene.add(Contact(roller["rim"], floor, law=law, name="pair", overlap=1.0))
    options: dict[str, Any] = {"step": 1e-6, "start": "equilibrium", "progress": False}
    if at_nodes:
        result = monolithic.simulate(scene, 1e-6, variant="low_rank", at_nodes=True, **options)
    else:
        result = simulate(scene, 1e-6, **options)
    assert result.status == "completed", result.message
    return result


@pytest.mark.slow
def test_both_solvers_take_a_law_that_is_one_class(fine_roller: ReducedBody) -> None:
    nodal, full = (pressed(fine_roller, at_nodes) for at_nodes in (True, False))
    force = [r.history.contacts["pair"].force[0, 2] for r in (nodal, full)]
    assert force[0] == pytest.approx(force[1], rel=NODES_AND_NODES) and force[1] > 0.0
    assert full.history.contacts["pair"].pressure.max() > 1e4
    assert "contact 'pair': its asperities are no higher than 4 deviations" in full.history.notes


def test_a_law_is_described_by_its_parameters() -> None:
    one, other = GaussianAsperities(1e6, 3e-4), GaussianAsperities(1e6, 2e-4)
    assert one.describe() == {"kind": "gaussian_asperities", "c": 1e6, "sigma": 3e-4} != other.describe()


def refused(name: str) -> Any:
    """A law that cannot be used."""
    attributes: dict[str, Any] = {
        "no curve": {"curve": property(lambda law: lambda depth: 1e9 * depth)},
        "bent down": {
            "curve": property(lambda law: curves.Table(np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0, 3.0]))),
            "chi": property(lambda law: 1.0),
        },
        "folded": {"curve": property(lambda law: curves.Table(np.array([0.0, 2.0, 1.0]), np.array([0.0, 2.0, 3.0])))},
    }[name]
    return dataclass(frozen=True)(type("Odd", (laws.Law,), {"kind": "odd", **attributes}))()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no curve", r"'pair': the law odd has no curve, .*; return one of laws.curves, or None"),
        ("bent down", r"'pair': the law odd is damped, which requires a curve whose slope never falls"),
        ("folded", r"Table: .* is not monotonic .*; depths and pressures must rise"),
    ],
)
def test_what_is_refused(name: str, message: str, fine_roller: ReducedBody) -> None:
    scene = Scene()
    roller = scene.add_body(fine_roller, name="roller", position=(0.0, 0.0, RADIUS))
    floor = scene.ground.surface(surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0)), name="floor")
    with pytest.raises(InputError, match=message):
        Contact(roller["rim"], floor, law=refused(name), name="pair")
    with pytest.raises(InputError, match=r"law must be one of laws.Unilateral, .*, or a laws.Law of your own"):
        Contact(roller["rim"], floor, law=1e9, name="pair")  # pyright: ignore[reportArgumentType]
