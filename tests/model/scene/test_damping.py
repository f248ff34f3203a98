"""Damping of the global modes: rules, names, bad input, and from a scene file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenes.rollers import roller_body
from warpffrf.model.damping import DampingBands, Rayleigh, damping_ratios
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.scene_file import load_scene

FREQUENCIES = np.array([20.0, 99.999, 100.0, 640.0, 1000.0, 5e4])


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    return roller_body(24, layers=2, axial=1, modes=6, cache=False)


def test_bands_give_each_mode_the_ratio_below_whose_limit_it_lies() -> None:
    bands = DampingBands([(100, 0.01), (1000, 0.1), (np.inf, 1.0)])
    np.testing.assert_array_equal(bands(FREQUENCIES), [0.01, 0.01, 0.1, 0.1, 1.0, 1.0])
    np.testing.assert_array_equal(damping_ratios("1/10/100", FREQUENCIES, "b"), bands(FREQUENCIES))
    assert len(bands(np.zeros(0))) == 0


def test_rayleigh_is_alpha_M_plus_beta_K() -> None:
    """2 zeta omega is the diagonal of alpha M + beta K in M-orthonormal modes: alpha + beta omega^2."""
    rule = Rayleigh(alpha=3.0, beta=2e-6)
    omega = 2.0 * np.pi * FREQUENCIES
    np.testing.assert_allclose(2.0 * rule(FREQUENCIES) * omega, 3.0 + 2e-6 * omega**2, rtol=1e-14)
    lowest = np.sqrt(3.0 / 2e-6)  # rad/s, where the ratio is least: sqrt(alpha beta)
    np.testing.assert_allclose(rule([lowest / (2.0 * np.pi)]), np.sqrt(3.0 * 2e-6), rtol=1e-14)


def test_numbers_arrays_and_functions() -> None:
    np.testing.assert_array_equal(damping_ratios(0.02, FREQUENCIES, "b"), np.full(6, 0.02))
    np.testing.assert_array_equal(damping_ratios(np.arange(6) / 10, FREQUENCIES, "b"), np.arange(6) / 10)
    np.testing.assert_allclose(damping_ratios(lambda f: 1e-5 * f, FREQUENCIES, "b"), 1e-5 * FREQUENCIES)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (-0.1, "body 'b': damping ratios must not be negative, the smallest is -0.1"),
        ([0.1, 0.2], r"body 'b': damping must have shape \(6\)"),
        (np.nan, "body 'b': damping must be finite"),
        ("usual", "body 'b': damping 'usual' does not exist; known: '1/10/100'"),
        (object(), "body 'b': damping must be a number"),
    ],
)
def test_wrong_damping_is_refused(given: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        damping_ratios(given, FREQUENCIES, "b")


@pytest.mark.parametrize(
    ("bands", "words"),
    [
        ([(100, 0.01), (1000, 0.1)], "the last limit must be inf, got 1000 Hz"),
        ([(1000, 0.01), (100, 0.1), (np.inf, 1.0)], "the limits must rise"),
        ([(0.0, 0.01), (np.inf, 1.0)], "the limits must rise from above 0 Hz"),
        ([(100, -0.01), (np.inf, 1.0)], "must not be negative"),
        ([(100, np.nan), (np.inf, 1.0)], "NaN or infinite"),
        ([], "pairs"),
        ([(1, 2, 3)], "pairs"),
        (0.1, "pairs"),
    ],
)
def test_wrong_bands_are_refused(bands: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        DampingBands(bands)  # pyright: ignore[reportArgumentType]


def test_rayleigh_refuses_negative_coefficients() -> None:
    with pytest.raises(InputError, match="Rayleigh: beta must not be negative, got -1"):
        Rayleigh(1.0, -1.0)


def test_a_body_of_a_scene_has_the_ratios(body: ReducedBody) -> None:
    rule = Rayleigh(5.0, 1e-7)
    handle = Scene().add_body(body, name="roller", damping=rule)
    np.testing.assert_array_equal(handle.damping, rule(body.frequencies))
    hashes = set()
    for damping in (None, 0.01, "1/10/100", rule):
        scene = Scene()
        scene.add_body(body, name="roller", damping=damping)
        hashes.add(scene.content_hash())
    assert len(hashes) == 4  # other damping is another scene


def test_scene_file_says_the_same(body: ReducedBody, tmp_path: Path) -> None:
    body.save(tmp_path / "roller.h5")
    cases = {
        '"1/10/100"': "1/10/100",
        '{ kind = "damping_bands", bands = [[2e4, 0.01], [inf, 0.1]] }': DampingBands([(2e4, 0.01), (np.inf, 0.1)]),
        '{ kind = "rayleigh", alpha = 2.0, beta = 1e-6 }': Rayleigh(2.0, 1e-6),
        "0.03": 0.03,
    }
    for text, damping in cases.items():
        path = tmp_path / "scene.toml"
        path.write_text(
            f'[reduced_bodies.roller]\npath = "roller.h5"\n[bodies.one]\nbody = "roller"\ndamping = {text}\n'
        )
        handle = load_scene(path).scene.body("one")
        np.testing.assert_array_equal(handle.damping, damping_ratios(damping, body.frequencies, "one"))
    path.write_text(
        '[reduced_bodies.roller]\npath = "roller.h5"\n[bodies.one]\nbody = "roller"\n'
        'damping = { kind = "rayleigh", alfa = 2.0 }\n'
    )
    with pytest.raises(InputError, match=r"scene.toml:5.*unknown key 'alfa'; did you mean 'alpha'"):
        load_scene(path)
