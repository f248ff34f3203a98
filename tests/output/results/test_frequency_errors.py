"""What modes of a machine say of the errors that the bases of bodies make in their frequencies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.output.budget.budget import FLOOR

FACTOR, MET = 3.0, 0.9  # 9 of 10 within a factor of three
MESH = wf.mesh.box((0.5, 0.03, 0.02), (10, 1, 1), order=1)
STEEL = wf.Material(210e9, 0.3, 7800.0)


def beam(**basis: Any) -> wf.ReducedBody:
    """A beam with such a basis."""
    ends = {"x_min": "rigid", "x_max": "rigid"}
    return wf.reduce(MESH, STEEL, interfaces=ends, cache=False, progress=False, **basis)


def modes(body: wf.ReducedBody, mass: float = 0.0, count: int = 10) -> wf.Modes:
    """Of a beam that is held at one end, with a `mass` [kg] at the other one."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    placed = scene.add_body(body, name="beam")
    scene.add(wf.joints.Fixed(scene.ground, placed["x_min"]))
    if mass:
        tip = scene.add_rigid_body(mass, (1e-3, 1e-3, 1e-3), name="tip", position=(0.25, 0.0, 0.0))
        scene.add(wf.joints.Fixed(placed["x_max"], tip.at((0.0, 0.0, 0.0))))
    return wf.eigenmodes(scene, count, about="initial", progress=False)


def like(found: wf.Modes, exact: wf.Modes) -> np.ndarray:
    """Which of the `exact` modes each of those found is, by their shapes."""
    one, two = (np.array([m.displacement(i, "beam").ravel() for i in range(len(m))]) for m in (found, exact))
    one, two = (u / np.linalg.norm(u, axis=1, keepdims=True) for u in (one, two))
    return np.argmax(np.abs(one.conj() @ two.T), axis=1)


@pytest.fixture(scope="module")
def compared() -> tuple[np.ndarray, np.ndarray]:
    """True and stated errors of bodies with few vibration modes; the true ones compared with one with 40."""
    true, stated = [], []
    few, many = [beam(modes=count) for count in (2, 4, 8)], beam(modes=40)
    for mass in (0.0, 1.0):
        exact = modes(many, mass, 16)
        for body in few:
            found = modes(body, mass)
            true.append(found.frequencies / exact.frequencies[like(found, exact)] - 1.0)
            stated.append(found.frequency_errors)
    return np.concatenate(true), np.concatenate(stated)


def test_errors_of_frequencies_are_known(compared: tuple[np.ndarray, np.ndarray]) -> None:
    true, stated = compared
    large = true > FLOOR
    assert large.sum() > 10
    right = (stated < FACTOR * true) & (true < FACTOR * stated)
    assert np.mean(right[large]) >= MET, np.stack([true, stated])[:, large & ~right]
    assert np.all(stated[~large] < FACTOR * FLOOR)


def test_what_a_basis_does_not_say_is_not_estimated() -> None:
    found = modes(beam(basis="craig_bampton", modes=4))
    assert np.all(np.isnan(found.frequency_errors))
    assert "not estimated: those of modes 0, 1" in found.report()


def test_the_report_has_the_errors() -> None:
    found = modes(beam(modes=2))
    worst = int(np.argmax(found.frequency_errors))
    assert f"{worst}: {100.0 * found.frequency_errors[worst]:.2g} %" in found.report()
    assert "not estimated: mesh errors of frequencies" in found.report()
