"""Beams: exact static solutions of one element, rigid motion, mass, frequencies."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.shells import dofs, matrices, solved
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Beam, BeamSection
from warpffrf.offline.structure.assembly import rigid_motions

STEEL = Material(210e9, 0.3, 7850.0)
ROUND_OFF = 1e-10  # relative, of solutions of twelve equations


def slanted(count: int, length: float = 0.8) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes of a row of beams, its elements, and its axes (rows: along, y, z)."""
    e_x = np.array([2.0, 1.0, 2.0]) / 3.0
    e_y = np.array([1.0, 2.0, -2.0]) / 3.0
    points = np.linspace(0.0, length, count + 1)[:, None] * e_x
    return points, np.stack([np.arange(count), np.arange(1, count + 1)], 1), np.stack([e_x, e_y, np.cross(e_x, e_y)])


@pytest.mark.parametrize("shear", [0.0, 5.0 / 6.0])
def test_a_cantilever_of_one_element_is_exact(shear: float) -> None:
    """Tip under a unit force along each axis and a unit moment about each one: F L^3/(3 E I) + F L/(k G A), and so on;
    the direction of the section need not be square to the beam."""
    L = 0.8
    points, nodes, axes = slanted(1, L)
    s = BeamSection(3e-4, 4e-9, 9e-9, 7e-9, shear_y=shear, shear_z=shear)
    E, G = 210e9, 210e9 / 2.6
    soft = L / (shear * G * s.area) if shear else 0.0
    part = Beam(nodes, s, STEEL, axes[1] + 0.3 * axes[0])
    exact = np.diag(
        [L / (E * s.area), L**3 / (3 * E * s.I_z) + soft, L**3 / (3 * E * s.I_y) + soft]
        + [L / (G * s.J), L / (E * s.I_y), L / (E * s.I_z)]
    )
    exact[1, 5] = exact[5, 1] = L**2 / (2 * E * s.I_z)
    exact[2, 4] = exact[4, 2] = -(L**2) / (2 * E * s.I_y)
    turn = np.kron(np.eye(2), axes)
    found = np.zeros((6, 6))
    for i in range(6):
        load = np.zeros(12)
        load[dofs(2, [1], range(6))] = turn[i]
        found[:, i] = turn @ solved(points, part, dofs(2, [0], range(6)), load)[dofs(2, [1], range(6))]
    assert np.abs(found - exact).max() < ROUND_OFF * np.abs(exact).max()


def test_an_offset_moves_the_section() -> None:
    """A beam at an offset is one between other nodes that rigid arms connect with these: the same energy."""
    points, nodes, axes = slanted(1)
    s = BeamSection.rectangle(0.02, 0.03)
    offset = 0.05 * axes[1] - 0.02 * axes[2] + 0.01 * axes[0]
    K = matrices(points, [Beam(nodes, s, STEEL, axes[1], offset=offset)])
    there = matrices(points + offset, [Beam(nodes, s, STEEL, axes[1])])
    arm = np.eye(12)
    for node in range(2):
        block = np.array([[0, offset[2], -offset[1]], [-offset[2], 0, offset[0]], [offset[1], -offset[0], 0]])
        arm[3 * node : 3 * node + 3, 6 + 3 * node : 9 + 3 * node] = block
    for mine, other in ((K.K, there.K), (K.M, there.M)):
        expected = arm.T @ other.toarray() @ arm
        assert np.abs(mine.toarray() - expected).max() < ROUND_OFF * np.abs(expected).max()


def test_mass_and_inertia_of_a_rod_are_exact_and_rigid_motion_is_free() -> None:
    """m, m L^2/12 and the moments of the section; J of torsion has no mass."""
    L = 0.8
    points, nodes, axes = slanted(3, L)
    s = BeamSection.rectangle(0.02, 0.03)
    body = matrices(points, [Beam(nodes, s, STEEL, axes[1])])
    R = rigid_motions(points, body.rotating, points.mean(axis=0))
    assert np.abs(body.K @ R).max() < ROUND_OFF * abs(body.K).max()
    turn = np.kron(np.eye(2), axes)
    J = turn @ (R.T @ (body.M @ R)) @ turn.T
    m = 7850.0 * 0.02 * 0.03 * L
    moments = [(0.02**2 + 0.03**2) / 12, (L * L + 0.03**2) / 12, (L * L + 0.02**2) / 12]
    assert np.abs(J - m * np.diag([1.0, 1.0, 1.0, *moments])).max() < ROUND_OFF * m


def test_frequencies_converge_with_the_fourth_power() -> None:
    """First frequency of bending of a slender free beam: (4.730041/L)^2 root(E I/(rho A)) (Bernoulli and Euler)."""
    s = BeamSection(3e-4, 4e-9, 9e-9, 7e-9)
    L = 10.0  # slender: rotary inertia is 1e-6 of the frequency
    theirs = (4.7300407449 / L) ** 2 * np.sqrt(210e9 * s.I_y / (7850.0 * s.area))
    off = []
    for count in (4, 8, 16):
        points, nodes, axes = slanted(count, L)
        body = matrices(points, [Beam(nodes, s, STEEL, axes[1])])
        K, M = body.K.toarray(), body.M.toarray()
        values = np.sort(np.real(np.linalg.eigvals(np.linalg.solve(M, K))))
        off.append(np.sqrt(values[6]) / theirs - 1.0)
    assert np.all(np.log2(np.abs(off[:-1]) / np.abs(off[1:])) > 3.5) and abs(off[-1]) < 1e-5


def test_sections_by_their_shape() -> None:
    """A square's torsion constant is 0.1406 a^4 (Saint-Venant), that of a pipe its polar moment."""
    assert BeamSection.rectangle(0.01, 0.01).J == pytest.approx(0.1406e-8, rel=5e-3)
    assert BeamSection.rectangle(0.1, 0.001).J == pytest.approx(0.1 * 0.001**3 / 3.0, rel=1e-2)
    pipe = BeamSection.circle(0.02, 0.01)
    assert pipe.I_y == pytest.approx(0.25 * np.pi * (0.02**4 - 0.01**4), rel=ROUND_OFF)
    assert pipe.J == pytest.approx(2.0 * pipe.I_y, rel=ROUND_OFF)
    assert BeamSection.circle(0.02).shear_y == pytest.approx(0.8864, rel=1e-3)  # 6 (1 + nu)/(7 + 6 nu), Cowper


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"direction": (2.0, 1.0, 2.0)}, "parallel"),
        ({"direction": (0.0, 0.0, 0.0)}, "zero length"),
        ({"section": 3.0}, "BeamSection"),
    ],
)
def test_a_beam_without_axes_is_refused(change: dict, text: str) -> None:
    points, nodes, _ = slanted(1)
    given = {"section": BeamSection.circle(0.01), "direction": (0.0, 0.0, 1.0), **change}
    with pytest.raises(InputError, match=text):
        matrices(points, [Beam(nodes, given["section"], STEEL, given["direction"])])
