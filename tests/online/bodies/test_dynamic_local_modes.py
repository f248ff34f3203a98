"""Local modes with inertia in the step: against the exact oscillator, and compared with the quasi-static treatment."""

# Warp kernels use annotations that type checkers do not know
# pyright: reportInvalidTypeForm=false, reportArgumentType=false, reportOperatorIssue=false
from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointForce
from warpffrf.model.joints import Fixed, Prismatic
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.signals import SmoothStep
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.run import run
from warpffrf.online.vibrations.eigenmodes import find_modes

TREATMENTS = ("hht", "exponential")


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=90, layers=3, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        max_frequency=12e3, options=wf.ReductionOptions(local_dynamics=True), grid=wf.ContactGrid(contact_fixed=False),
        cache=False, progress=False,
    )  # fmt: skip


def pressed(body: ReducedBody, force: object) -> Scene:
    """Two rollers, the lower one clamped, the upper one on a vertical guide, pressed together by `force` [N]."""
    scene = Scene()
    radius = body.contact_surfaces["rim"].shape.radius
    lower = scene.add_body(body, name="lower", damping=0.2)
    upper = scene.add_body(body, name="upper", damping=0.2, position=(0.0, 0.0, 2.0 * radius))
    scene.add(Fixed(scene.ground, lower["bore"]))
    scene.add(Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0)))
    scene.add(PointForce(upper["bore"], (0.0, 0.0, force)))
    scene.add(Contact(lower["rim"], upper["rim"], name="pair"))
    return scene


def contact_force(history: History) -> np.ndarray:
    return history.contacts["pair"].force[:, 2]


@pytest.mark.parametrize("treatment", TREATMENTS)
@pytest.mark.parametrize("frequency", [30e3, 80e3, None])
def test_static_response_is_exact_at_any_cut(body: ReducedBody, treatment: str, frequency: float | None) -> None:
    """Force, approach and pressure of the equilibrium are those of the quasi-static treatment."""
    expected = run(pressed(body, -2000.0), 1e-6, step=1e-6, start="equilibrium", progress=False)
    local = LocalModes(treatment, max_frequency=frequency)
    found = run(pressed(body, -2000.0), 1e-6, step=1e-6, start="equilibrium", local_modes=local, progress=False)
    assert found.status == expected.status == "completed"
    for name in ("approach", "pressure", "force"):
        a, b = (np.asarray(getattr(h.contacts["pair"], name)[0]) for h in (found, expected))
        assert np.abs(a - b).max() <= 1e-8 * np.abs(b).max(), name


@pytest.mark.parametrize("treatment", TREATMENTS)
def test_slow_loads_are_followed_like_static_ones(body: ReducedBody, treatment: str) -> None:
    """The slower the load, the nearer to quasi-static: the difference falls with the rate of the load."""
    away = []
    for duration in (2e-3, 8e-3):
        force = SmoothStep(-200.0, -2000.0, duration=duration)
        step = 2e-5
        runs = [
            run(pressed(body, force), duration, step=step, start="equilibrium", local_modes=local, progress=False)
            for local in (treatment, "quasi_static")
        ]
        assert all(history.status == "completed" for history in runs)
        a, b = (history.contacts["pair"].approach for history in runs)
        away.append(np.abs(a - b).max() / np.abs(b).max())
    assert away[1] < 0.5 * away[0] and away[1] < 1e-3


def exact(omega: float, zeta: float, t: np.ndarray, rise: float, h: float) -> np.ndarray:
    """q of q'' + 2 zeta omega q' + omega^2 q = f(t), f linear from 0 to 1 over `rise`, by the matrix exponential."""
    from scipy.linalg import expm

    A = np.array([[0.0, 1.0, 0.0, 0.0], [-(omega**2), -2.0 * zeta * omega, 1.0, 0.0], [0, 0, 0, 1.0], [0, 0, 0, 0]])
    E = expm(A * h)
    y = np.array([0.0, 0.0, 0.0, 1.0 / rise])
    found = [y[0]]
    for _ in t[1:]:
        y = E @ y
        found.append(y[0])
    return np.array(found)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.6])
@pytest.mark.parametrize("product", [0.05, 1.0, 50.0])
def test_exponential_is_exact_for_a_linear_load(zeta: float, product: float) -> None:
    """The kernel's formula, from omega h = 0.05 to 50, damped and not."""
    import warp as wp

    from warpffrf_kernels.bodies.motion import exact_step, write_exact

    @wp.kernel
    def steps(
        w2: wp.float64,
        c: wp.float64,
        h: wp.float64,
        slope: wp.float64,
        table: wp.array3d(dtype=wp.float64),
        q: wp.array(dtype=wp.float64),
    ):
        write_exact(w2, c, h, table, 0, 0)
        x = wp.float64(0.0)
        v = wp.float64(0.0)
        for i in range(q.shape[0]):
            q[i] = x
            f0 = slope * h * wp.float64(i)
            held, D, slid, S = exact_step(table, 0, 0, x, v, f0)
            x = held + D * (f0 + slope * h)
            v = slid + S * (f0 + slope * h)

    omega, n = 2.0e5, 40
    h = product / omega
    q = wp.zeros(n, dtype=wp.float64, device="cpu")
    table = wp.zeros((1, 1, 9), dtype=wp.float64, device="cpu")
    inputs = [omega**2, 2.0 * zeta * omega, h, 1.0 / (n * h)]
    wp.launch(steps, dim=1, inputs=inputs, outputs=[table, q], device="cpu")
    expected = exact(omega, zeta, np.arange(n) * h, n * h, h)
    assert np.abs(q.numpy() - expected).max() < 1e-9 * np.abs(expected).max()


def test_energy_is_kept_by_a_fine_step(body: ReducedBody) -> None:
    """A load that comes on suddenly excites the local modes: the ledger closes to second order of the step."""
    left = []
    for step in (2e-7, 1e-7):
        history = run(
            pressed(body, SmoothStep(-500.0, -1000.0, duration=2e-5)), 4e-5, step=step, start="equilibrium",
            local_modes=LocalModes("exponential", max_frequency=150e3), progress=False,
        )  # fmt: skip
        energy = history.energy
        left.append(np.abs(energy["numerical"][-1]) / np.abs(energy["force_work"]).max())
    assert left[1] < 0.5 * left[0] or left[1] < 1e-6


def test_auto_splits_at_five_times_the_load(body: ReducedBody) -> None:
    scene = pressed(body, -100.0)
    plan = Engine(scene, local_modes=LocalModes("auto", load_frequency=12e3)).compiled.local
    everything = Engine(scene, local_modes=LocalModes("hht")).compiled.local
    omega = everything.omega(0)
    assert plan.count(0) == np.count_nonzero(omega <= 5.0 * 2.0 * np.pi * 12e3) > 0
    assert any("local modes are dynamic (auto)" in note for note in plan.notes)
    assert any("pictures and stresses" in note for note in plan.notes)
    assert not any("pictures" in note for note in Engine(scene).compiled.local.notes)


def test_another_treatment_cannot_go_on_and_cannot_be_linearised(body: ReducedBody) -> None:
    """The number of coordinates differs: the message says why; the notes of a run say what its own local modes do."""
    scene = pressed(body, -500.0)
    static, dynamic = (
        run(scene, 2e-6, step=1e-6, start="equilibrium", local_modes=local, progress=False)
        for local in ("quasi_static", LocalModes("hht", max_frequency=150e3))
    )
    with pytest.raises(InputError, match="local modes were treated in another way; use the same local_modes="):
        run(scene, 1e-6, step=1e-6, start=static, local_modes="hht", progress=False)
    with pytest.raises(InputError, match="eigenmodes: .*must come from a run with .*local_modes='quasi_static'"):
        find_modes(scene, about=dynamic)
    assert any("the inertia of its local modes is neglected" in note for note in static.notes)
    assert not any("neglected" in note and "local" in note for note in dynamic.notes)


def test_wrong_options_are_refused(plain_body: ReducedBody) -> None:
    with pytest.raises(InputError, match="known: 'quasi_static', 'hht'"):
        LocalModes("htt")
    for options, words in (
        ({"damping": 1.0}, "below 1"), ({"alpha": 0.2}, "alpha"), ({"max_frequency": -1.0}, "max_frequency"),
        ({"load_frequency": 1e3}, "auto"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            LocalModes("hht", **options)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="gives no mode inertia"):
        LocalModes(max_frequency=1e4)
    with pytest.raises(InputError, match="local_dynamics=True"):
        Engine(pressed(plain_body, -1.0), local_modes=LocalModes("hht"))


def test_stages_step_the_same_modes(body: ReducedBody) -> None:
    """Refused before anything is computed; two treatments of the same modes are fine."""
    scene = pressed(body, -500.0)
    some, fewer = (LocalModes("hht", max_frequency=f) for f in (60e3, 30e3))
    for other in (fewer, "quasi_static"):
        stages = [wf.Stage("a", 1e-5, 1e-6), wf.Stage("b", 1e-5, 1e-6, {"local_modes": other})]
        with pytest.raises(InputError, match="stage 'b': local_modes .* the modes of a run cannot change"):
            wf.simulate(scene, stages, options=wf.RunOptions(local_modes=some), start="equilibrium", progress=False)
    same = LocalModes("exponential", max_frequency=60e3)
    stages = [wf.Stage("a", 1e-5, 1e-6), wf.Stage("b", 1e-5, 1e-6, {"local_modes": same})]
    assert (
        wf.simulate(scene, stages, options=wf.RunOptions(local_modes=some), start="equilibrium", progress=False).status
        == "completed"
    )
