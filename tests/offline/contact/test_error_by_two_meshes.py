"""The error that a mesh makes, by another mesh: compared with forces of contacts on both."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.user_meshes import cut_into_tets, serendipity, straight
from studies.contact import coarse_rollers as cr
from warpffrf.model.errors import InputError
from warpffrf.online.run import find_equilibrium

APPROACH = 2e-5
ESTIMATE = 1e-3  # of the force: other half-widths and pressures along the surface; 0.2 to 0.9e-3 measured


@pytest.fixture(scope="module")
def fine():
    return cr.reduced(cr.hexahedra(4e-3))


def force(body, other=None, **made) -> float:
    found = find_equilibrium(cr.held(body, other or body, APPROACH, **made))
    return float(np.linalg.norm(found.contacts[cr.PAIR].force[-1]))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hex8", "hex20", "tet4"])
def test_error_of_a_line_contact(kind, fine) -> None:
    """Elements of 8 mm against 4 mm, the force of two rollers at a given approach."""
    mesh = {
        "hex8": lambda: cr.hexahedra(8e-3, 1),
        "hex20": lambda: serendipity(cr.hexahedra(8e-3)),
        "tet4": lambda: straight(cut_into_tets(cr.hexahedra(8e-3))),
    }[kind]()
    body = cr.reduced(mesh)
    said = body.mesh_error(fine, half_width=4e-4)
    assert list(said) == ["rim"]
    true = force(body) / force(fine) - 1.0
    assert abs(true) > 2.0 * ESTIMATE
    assert said["rim"] == pytest.approx(true, abs=ESTIMATE)


@pytest.mark.slow
def test_error_of_a_point_contact() -> None:
    """A crown of 0.14 m: less of the displacement is the mesh's."""
    coarse, fine = (cr.reduced(cr.hexahedra(h, 2, 0.14), 0.14) for h in (8e-3, 4e-3))
    true = force(coarse) / force(fine) - 1.0
    assert coarse.mesh_error(fine, half_width=6e-4)["rim"] == pytest.approx(true, abs=2.0 * ESTIMATE)


@pytest.mark.slow
def test_nothing_between_a_mesh_and_itself(fine) -> None:
    assert fine.mesh_error(fine) == {"rim": 0.0}
    assert fine.mesh_error(cr.reduced(cr.hexahedra(2.5e-3)))["rim"] == pytest.approx(0.0, abs=ESTIMATE)


def test_bad_input(fine) -> None:
    plain = cr.reduced(cr.hexahedra(8e-3, 1), contact_fixed=False)
    with pytest.raises(InputError, match="contact_fixed=True"):
        fine.mesh_error(plain)
    with pytest.raises(InputError, match="interface"):
        fine.mesh_error(fine, interface="hub")
    with pytest.raises(InputError, match="half_width"):
        fine.mesh_error(fine, half_width=-1.0)
    wide = wf.mesh.roller(cr.R, cr.BORE, 2.0 * cr.WIDTH, sectors=40, layers=4, axial=5, order=1)
    with pytest.raises(InputError, match="another surface"):
        fine.mesh_error(cr.reduced(wide))
