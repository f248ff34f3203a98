"""Second-order motion in pictures: a cantilever's skin compared with the elastica, its ends, and small motions about
it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from references.closed_forms.large_deflections import Elastica
from vtkhdf_reader import read_vtkhdf
from warpffrf.model import joints, sensors
from warpffrf.model.forces import PointForce
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import interface_motion, skin_displacement, skin_variation
from warpffrf.model.reduced.stress_field import skin_strain
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.output.geometry.places import rotate
from warpffrf.output.modes_result import eigenmodes
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium

LENGTH, WIDTH, THICK = 1.0, 0.03, 0.01  # m
MATERIAL = Material(210e9, 0.0, 7850.0)  # as a beam: sections are not stiffened by their width
LOAD = MATERIAL.youngs_modulus * WIDTH * THICK**3 / 12.0 / LENGTH**2  # N, P L^2/(E I) = 1
SHARE = 0.003  # of the largest second-order motion, `TRUNCATION`


@pytest.fixture(scope="module")
def beam() -> ReducedBody:
    mesh = box((LENGTH, WIDTH, THICK), (30, 1, 1))
    return reduce(
        mesh, MATERIAL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=6,
        options=ReductionOptions(stiffening="membrane"), cache=False, progress=False,
    )  # fmt: skip


def cantilever(beam: ReducedBody) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(beam, name="beam", stiffening=True, inertia="constant")
    scene.add(joints.Fixed(scene.ground, body["x_min"], name="root"))
    scene.add(PointForce(body["x_max"], (0.0, 0.0, LOAD), name="push"))
    scene.add(sensors.Position(body["x_max"], name="tip"))
    return scene


@pytest.fixture(scope="module")
def bent(beam):
    result = equilibrium(cantilever(beam))
    assert result.status == "completed"
    return result


def test_skin_of_a_cantilever_is_the_elastica(beam, bent) -> None:
    """The middle of its end at P L^2/(E I) = 1: deflection 30 %, shortening 5.6 % of the length; without the part of
    second order the skin ends a twentieth of the shortening off."""
    elastica, motion = Elastica(1.0), bent.history.bodies["beam"]
    end = np.abs(beam.surface.points[:, 0] - 0.5 * LENGTH) < 1e-9
    u = bent.skins()["beam"].displacement(-1)
    place = (motion.position[-1] + rotate(motion.rotation[-1], beam.surface.points + u))[end].mean(axis=0)
    print("w/L", place[2] / LENGTH, "u/L", 0.5 - place[0] / LENGTH)
    assert place[2] / LENGTH == pytest.approx(elastica.deflection, rel=0.01)
    assert 0.5 - place[0] / LENGTH == pytest.approx(elastica.shortening, rel=0.01)
    np.testing.assert_allclose(place, bent.sensor("tip").values[-1], atol=1e-3 * elastica.shortening * LENGTH)
    linear = dataclasses.replace(bent.view.bodies["beam"], stiffening=False)
    u = skin_displacement(linear, motion.modal[-1])
    place = (motion.position[-1] + rotate(motion.rotation[-1], beam.surface.points + u))[end].mean(axis=0)
    print("linear skin u/L", 0.5 - place[0] / LENGTH)
    assert abs(0.5 - place[0] / LENGTH - elastica.shortening) > 0.05 * elastica.shortening


def test_files_for_pictures_have_it(beam, bent, tmp_path) -> None:
    """VTKHDF files hold the places of the skin, and the results file what they are made of."""
    blocks, _ = read_vtkhdf(bent.to_vtkhdf(tmp_path / "run.vtkhdf"), 0)
    mesh = blocks["beam"]
    end = np.abs(beam.surface.points[:, 0] - 0.5 * LENGTH) < 1e-9
    place = (mesh.points + mesh.point_data["displacement"])[end].mean(axis=0)
    np.testing.assert_allclose(place, bent.sensor("tip").values[-1], atol=1e-3 * Elastica(1.0).shortening * LENGTH)
    again = Result.load(bent.save(tmp_path / "run.h5"))
    np.testing.assert_allclose(again.skins()["beam"].displacement(-1), bent.skins()["beam"].displacement(-1))


@pytest.mark.parametrize("name", ["x_min", "x_max"])
def test_ends_of_the_skin_move_with_their_interfaces(beam, bent, name) -> None:
    """t + theta x r + theta x (theta x r)/2 at the nodes of a rigid interface, to what was left out of the motion."""
    view, q = bent.view.bodies["beam"], bent.history.bodies["beam"].modal[-1]
    interface = beam.interfaces[name]
    nodes = np.abs(beam.surface.points[:, 0] - interface.point[0]) < 1e-9
    r = beam.surface.points[nodes] - interface.point
    motion, theta = interface_motion(view, name, q), q @ interface.modes[:, 3:]
    expected = motion[:3] + np.cross(motion[3:], r) + 0.5 * np.cross(theta, np.cross(theta, r))
    found = skin_displacement(view, q)
    second = found - np.tensordot(q, beam.surface.modes, 1)
    largest = np.linalg.norm(second, axis=1).max()
    error = np.abs(found[nodes] - expected).max() / largest
    print(name, "error", error, "of", largest)
    assert largest > 0.005 * LENGTH and error < SHARE


def test_strain_of_the_skin_is_that_of_bending(beam, bent) -> None:
    """P (L - u) t/(2 E I) in the middle of the first cell, to 0.9 % of the stretching that Theta relieves: theta^2/2 is
    ten times as large as the strain."""
    view, q = bent.view.bodies["beam"], bent.history.bodies["beam"].modal[-1]
    arm = (1.0 - Elastica(1.0).shortening) * (1.0 - 0.5 / 30)
    found = np.abs(skin_strain(view, q)).max()
    print("strain", found, "beam", 0.5 * THICK / LENGTH * arm)
    turned = np.abs(bent.history.bodies["beam"].modal[-1] @ beam.interfaces["x_min"].modes[:, 4])
    assert found == pytest.approx(0.5 * THICK / LENGTH * arm, abs=3.0 * SHARE * 0.5 * turned**2)


def test_variation_is_the_derivative(beam, bent) -> None:
    """Of real and complex directions, by differences, exact for what is quadratic."""
    view, q = bent.view.bodies["beam"], bent.history.bodies["beam"].modal[-1]
    rng = np.random.default_rng(1)
    dq = rng.standard_normal(len(q)) * np.abs(q).max()
    difference = 0.5 * (skin_displacement(view, q + dq) - skin_displacement(view, q - dq))
    found = skin_variation(view, q, dq)
    np.testing.assert_allclose(found, difference, atol=1e-5 * np.abs(found).max())  # single precision
    both = skin_variation(view, q, dq + 2.0j * dq)
    np.testing.assert_allclose(both, (1.0 + 2.0j) * found, atol=1e-6 * np.abs(found).max())


def test_modes_about_the_bent_state_keep_their_length(beam, bent) -> None:
    """The lowest mode of the bent cantilever moves its end across the bent beam; linear, along z alone."""
    modes = eigenmodes(cantilever(beam), 4, about=bent)
    end = np.abs(beam.surface.points[:, 0] - 0.5 * LENGTH) < 1e-9
    moved = [np.real(modes.displacement(i, "beam")[end].mean(axis=0)) for i in range(4)]
    flap = next(m for m in moved if abs(m[2]) > 10.0 * abs(m[1]))
    slope = np.tan(np.arctan2(-flap[0], flap[2]))
    # of the elastica the end goes along (-du, dw) as the load grows
    more, less = Elastica(1.01), Elastica(0.99)
    expected = (more.shortening - less.shortening) / (more.deflection - less.deflection)
    print("slope", slope, "elastica", expected)
    assert slope == pytest.approx(expected, rel=0.1)  # the shape of the mode is not quite that of the load's
