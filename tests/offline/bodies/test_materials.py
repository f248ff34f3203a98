"""Several materials in one body: a bar of two materials against its closed form, and cells left out or taken twice."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.offline import reduce
from warpffrf.offline.fe import assign

LENGTH, SIDE, CELLS = 1.0, 0.05, 20
# no lateral contraction: the bar is one-dimensional, and rigid ends do not hold it back
SOFT, HARD = Material(70e9, 0.0, 2700.0, name="soft"), Material(210e9, 0.0, 7850.0, name="hard")


def bar(kind: str = "hex8") -> Mesh:
    """A square bar along x, cell sets `left` (40 %) and `right`, facet sets `start` and `end`."""
    cell = cell_kind(kind)
    steps = 2 if cell.degree == 2 else 1
    number: dict[tuple[int, ...], int] = {}
    cells = []
    for i in range(CELLS):
        at = np.rint(steps * ((cell.nodes + 1.0) / 2.0 + np.array([i, 0, 0]))).astype(int)
        cells.append([number.setdefault(tuple(x), len(number)) for x in at.tolist()])
    scale = np.array([LENGTH / CELLS, SIDE, SIDE]) / steps
    nodes = np.array(cells)
    ((facet, faces),) = cell.faces.items()
    ends = {"start": FacetSet({facet: nodes[:1, faces[0]]}), "end": FacetSet({facet: nodes[-1:, faces[1]]})}
    split = int(0.4 * CELLS)
    sets = {"left": np.arange(split), "right": np.arange(split, CELLS)}
    return Mesh(np.array(list(number)) * scale, {kind: nodes}, ends, name="bar", cell_sets=sets)


def reduced_bar(material, **settings):
    interfaces = {"start": "rigid", "end": "rigid"}
    return reduce(bar("hex20"), material, interfaces=interfaces, cache=False, progress=False, **settings)


def test_bar_of_two_materials_stretches_like_two_springs_in_series() -> None:
    body = reduced_bar({"left": SOFT, "right": HARD}, modes=4)
    pull = body.interfaces["end"].modes[:, 0] - body.interfaces["start"].modes[:, 0]
    omega = 2.0 * np.pi * body.frequencies
    stretch = np.sum((pull / omega) ** 2)
    area = SIDE**2
    exact = 0.4 * LENGTH / (SOFT.youngs_modulus * area) + 0.6 * LENGTH / (HARD.youngs_modulus * area)
    assert stretch == pytest.approx(exact, rel=1e-9)  # the solution is linear in each cell: only round-off is left
    mass = area * LENGTH * (0.4 * SOFT.density + 0.6 * HARD.density)
    assert body.mass == pytest.approx(mass, rel=1e-12)
    center = area * LENGTH**2 * (SOFT.density * 0.4 * 0.2 + HARD.density * 0.6 * 0.7) / mass
    assert body.center_of_mass[0] == pytest.approx(center, rel=1e-12)


def test_bar_of_two_materials_rings_at_its_closed_form() -> None:
    """Longitudinal waves: Z1 tan(k1 l1) + Z2 tan(k2 l2) = 0 with k = omega/c, Z = rho c, both ends free."""
    body = reduced_bar({"left": SOFT, "right": HARD}, max_frequency=6000.0)
    c = [np.sqrt(m.youngs_modulus / m.density) for m in (SOFT, HARD)]
    Z = [m.density * v for m, v in zip((SOFT, HARD), c, strict=True)]

    def residual(f: float) -> float:
        # multiplied by both cosines: no poles
        a, b = (2.0 * np.pi * f * length / v for length, v in zip((0.4, 0.6), c, strict=True))
        return Z[0] * np.sin(a) * np.cos(b) + Z[1] * np.sin(b) * np.cos(a)

    grid = np.linspace(100.0, 6000.0, 400)
    signs = np.sign([residual(f) for f in grid])
    exact = [brentq(residual, grid[i], grid[i + 1]) for i in np.flatnonzero(signs[1:] != signs[:-1])]
    assert len(exact) == 2
    for f in exact:
        nearest = body.frequencies[np.argmin(np.abs(body.frequencies - f))]
        # nu = 0 and a bending family next to it: 20 quadratic cells leave (k h)^4/720 of a wave of 0.8 m, below 1e-4
        assert nearest == pytest.approx(f, rel=1e-4)


def test_one_material_in_two_sets_is_one_material() -> None:
    whole, parts = reduced_bar(HARD, modes=4), reduced_bar({"left": HARD, "right": HARD}, modes=4)
    assert parts.frequencies == pytest.approx(whole.frequencies, rel=1e-9)
    assert parts.mass == pytest.approx(whole.mass, rel=1e-12)


def test_every_cell_has_one_material() -> None:
    mesh = bar()
    with pytest.raises(InputError, match="12 of 20 cells are in none of the sets left, the first is number 8"):
        assign(mesh, {"left": SOFT})
    with pytest.raises(InputError, match="cell set 'middle'"):
        assign(mesh, {"left": SOFT, "middle": HARD})
    twice = Mesh(mesh.points, mesh.cells, cell_sets={**mesh.cell_sets, "all": np.arange(CELLS)})
    with pytest.raises(InputError, match="'left' and 'all': 8 cells are in both"):
        assign(twice, {"left": SOFT, "all": HARD})
    with pytest.raises(InputError, match="a Material is needed"):
        assign(mesh, {"left": SOFT, "right": 210e9})  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="a material is needed"):
        assign(mesh, None)
    with pytest.raises(InputError, match="cell numbers"):
        Mesh(mesh.points, mesh.cells, cell_sets={"odd": np.array([20])})
