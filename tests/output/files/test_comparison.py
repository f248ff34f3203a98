"""Two runs side by side: differences in closed form, other times, quaternions of either sign, what is reported."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from synthetic_run import PEAK, make_history

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import SensorHistory
from warpffrf.output.files.unfinished import different
from warpffrf.output.result import Result

ROUND_OFF = 1e-12
PAIR = "lower-upper"


def run_on(body: ReducedBody, time: np.ndarray | None = None, factor: float = 1.0, **options: str) -> Result:
    """The synthetic run with a sensor `factor` times sin t on times of its own and options of its own."""
    history = make_history(body)
    history.options = options
    if time is not None:
        kept = replace(history, time=time, contacts={}, bodies={}, joints={}, energy={})
        kept.step_size = np.diff(time, prepend=time[0])
        kept.iterations = kept.factorisations = np.ones(len(time), dtype=int)
        history = kept
    t = history.time
    values = factor * np.stack([np.sin(t), 0.0 * t, np.cos(t)], axis=1)
    history.sensors = {"tip": SensorHistory("position", "m", "world", ("x", "y", "z"), values)}
    return Result(history)


def test_a_run_is_itself(body: ReducedBody) -> None:
    same = wf.compare(run_on(body), run_on(body))
    assert not same.settings and all(d.relative == 0.0 and d.largest == 0.0 for d in same.differences)
    assert "no settings differ" in same.report()


def test_differences_in_closed_form(body: ReducedBody) -> None:
    a, b = run_on(body, step="0.001"), run_on(body, factor=1.03, step="0.002")
    force = b.history.contacts[PAIR].force
    force[:, 2] *= 1.5
    b.history.contacts[PAIR].pressure *= 2.0
    for motion in b.history.bodies.values():
        motion.rotation = motion.rotation * np.where(np.arange(len(b.time)) % 2, -1.0, 1.0)[:, None]  # q and -q
    found = wf.compare(a, b)
    by_label = {d.label: d for d in found.differences}
    assert by_label["sensor[tip]"].relative == pytest.approx(0.03, rel=1e-10)  # 0.03 with 14 digits behind it
    pressed = by_label[f"contact_force[{PAIR}]"]
    assert pressed.relative == pytest.approx(0.5, rel=ROUND_OFF)
    assert pressed.at == a.time[-1] and pressed.size == pytest.approx(np.abs(a.contact(PAIR).force).max())
    assert pressed.largest == pytest.approx(0.5 * pressed.size, rel=ROUND_OFF)
    assert by_label[f"contact_peak_pressure[{PAIR}]"].relative == pytest.approx(1.0, rel=ROUND_OFF)
    assert by_label["body_rotation[upper]"].largest < ROUND_OFF
    assert found.settings == {"step": ("0.001", "0.002")}
    share = [d.share for d in found.differences if not d.same]
    assert share == sorted(share, reverse=True) and len(share) > 3
    assert all(d.same for d in found.differences[len(share) :])
    assert not [label for label in by_label if "column" in label or label in ("iterations", "step_size")]
    assert PEAK > 0.0 and "... and" in found.report(3) and len(found.report(None)) > len(found.report(3))


def test_interpolation_is_of_second_order_and_said(body: ReducedBody) -> None:
    """sin and cos between rows h apart: an error of at most h^2/8 in each point of a unit circle."""
    a = run_on(body, np.linspace(0.0, 2.0, 64))
    errors = []
    for rows in (41, 81):
        found = wf.compare(a, run_on(body, np.linspace(0.0, 2.0, rows)))
        (tip,) = [d for d in found.differences if d.label == "sensor[tip]"]
        assert tip.largest <= (2.0 / (rows - 1)) ** 2 / 8.0
        assert any("interpolated linearly" in note for note in found.notes)
        errors.append(tip.relative)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)  # times of A fall on other places between rows


def test_only_common_times_count(body: ReducedBody) -> None:
    a, b = run_on(body, np.linspace(0.0, 2.0, 21)), run_on(body, np.linspace(0.0, 1.0, 11))
    found = wf.compare(a, b)
    assert found.differences[0].largest < ROUND_OFF
    assert any(note.startswith("11 of the 21 rows of A") for note in found.notes)
    assert not any("interpolated" in note for note in found.notes)
    with pytest.raises(InputError, match="no time in common"):
        wf.compare(a, run_on(body, np.linspace(3.0, 4.0, 5)))


def test_round_off_and_what_one_lacks_are_reported(body: ReducedBody) -> None:
    a, b = run_on(body), run_on(body)
    b.history.contacts[PAIR].torque[:] = 1.0  # compared with nothing of its quantity: A is zero
    del b.history.energy["potential"]
    b.history.energy["kinetic"][3] = np.nan
    found = wf.compare(a, b)
    (torque,) = [d for d in found.differences if d.label == f"contact_torque[{PAIR}]"]
    assert torque.relative == np.inf and "A is 0" in found.report()
    assert any("only in A, the first energy[potential]" in note for note in found.notes)
    assert any("only one run has a value, the first energy[kinetic]" in note for note in found.notes)
    assert any("zero, or round-off, in both" in note for note in found.notes)


def test_files_are_compared_and_drawn(body: ReducedBody, tmp_path: Path) -> None:
    paths = [run_on(body, factor=f).save(tmp_path / f"{name}.h5") for name, f in (("one", 1.0), ("two", 2.0))]
    found = wf.compare(*paths)
    assert found.names == ("one.h5", "two.h5")
    (tmp_path / "other").mkdir()
    twin = run_on(body).save(tmp_path / "other" / "one.h5")
    assert wf.compare(paths[0], twin).names == (str(paths[0]), str(twin))
    assert wf.compare(twin, twin).names == (f"{twin} (A)", f"{twin} (B)")
    figure = found.figure()
    for axes in figure.axes:
        first, second = axes.get_lines()
        assert np.isfinite(first.get_ydata()).all() and len(second.get_xdata()) == len(found.b.time)
        assert "[" in axes.get_ylabel()
    # the component that differs most of (sin, 0, cos) near t = 0
    assert figure.axes[0].get_title("right").startswith("sensor_z[tip]: differs by 100 %")
    assert len(found.figure(["sensor[tip]"]).axes) == 1
    assert found.save_figure(tmp_path / "both.png").stat().st_size > 10_000
    with pytest.raises(InputError, match="did you mean 'sensor"):
        found.figure(["sensor[tib]"])


def test_round_off_is_no_difference(body: ReducedBody) -> None:
    """What differs by less than 1e-6 of its quantity, motions 1e-9, or of what the machine has of its unit, is neither
    listed nor drawn; bodies that stand still have velocities of round-off alone, which go by the machine's size."""
    a, b = run_on(body), run_on(body)
    force = b.history.contacts[PAIR].force
    force *= 1.0 + 1e-8
    for run, noise in ((a, 1e-15), (b, -2e-15)):
        for motion in run.history.bodies.values():
            motion.velocity[:] = noise  # of 0.1 m in 0.02 s
    found = wf.compare(a, b)
    by_label = {d.label: d for d in found.differences}
    assert by_label["body_velocity[lower]"].relative == pytest.approx(3.0)
    assert all(d.same for d in found.differences) and "no histories differ" in found.report()
    assert f"histories that are the same to 1e-06 of their size, motions to 1e-09: {len(by_label)}" in found.notes
    axes = found.figure(["body_velocity[lower]"]).axes[0]
    assert "the same to 1e-09 of its size" in axes.get_title("right")
    low, high = axes.get_ylim()
    assert high - low > 100.0 * 3e-15 and len(found.figure().axes) == 6
    b.history.contacts[PAIR].force[3] *= 1.0 + 1e-4
    found = wf.compare(a, b)
    assert [d.label for d in found.differences if not d.same] == [f"contact_force[{PAIR}]"]
    (axes,) = found.figure().axes  # the rest is the same
    apart = axes.get_lines()[0]  # both curves would coincide
    moved = np.asarray(apart.get_ydata())
    assert "B - A" in str(apart.get_label()) and np.flatnonzero(np.abs(moved) > 0.5 * np.abs(moved).max()).tolist() == [
        3
    ]
    low, high = found.figure(["energy[kinetic]"]).axes[0].get_ylim()
    assert high - low >= 1e-6


def test_sensors_of_other_units_share_no_axes(body: ReducedBody) -> None:
    """0.5 m is no round-off of 1e9 Pa."""
    a, b = run_on(body), run_on(body, factor=0.5)
    for run in (a, b):
        stress = np.full((len(run.time), 1), 1e9)
        run.history.sensors["root"] = SensorHistory("von_mises", "Pa", "none", ("",), stress)
    assert wf.compare(a, b).differences[0].label == "sensor[tip]"


def swing(
    *, mass: float = 1.0, x: float = 0.5, friction: float = 0.1, pull: float = 2.0, spring: bool = False
) -> wf.Scene:
    scene = wf.Scene(gravity=(0, 0, -9.81))
    bob = scene.add_rigid_body(mass, (0.01, 0.01, 0.01), name="bob", position=(x, 0, 0))
    hinge = scene.add(wf.joints.Revolute(scene.ground, bob.at((-x, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.forces.RevoluteFriction(hinge, friction, pin_radius=0.01, name="rub"))
    scene.add(wf.forces.PointForce(bob.at((0, 0, 0)), (0.0, 0.0, pull), name="pull"))
    if spring:
        scene.add(wf.forces.SpringDamper(scene.ground.at((0, 0, 1)), bob.at((0, 0, 0)), 10.0, 1.0, name="spring"))
    return scene


def short(scene: wf.Scene, step: float = 1e-3, **options: Any) -> Result:
    return wf.simulate(scene, 2e-3, step=step, progress=False, **options)


def test_settings_are_shown_by_what_they_are(tmp_path: Path) -> None:
    """Each change by its own name and values, of results and of their files, and no content hash."""
    first = short(swing())
    other = short(swing(mass=2.0, x=0.75, friction=0.2, pull=3.0, spring=True), step=5e-4)
    for pair in ((first, other), (first.save(tmp_path / "a.h5"), other.save(tmp_path / "b.h5"))):
        found = wf.compare(*pair)
        assert found.settings == {
            "step": ("0.001", "0.0005"),
            "rows": ("3", "5"),
            "body bob: mass": ("1", "2"),
            "body bob: position": ("0.5, 0, 0", "0.75, 0, 0"),
            "joint hinge: b.point": ("-0.5, 0, 0", "-0.75, 0, 0"),
            "force rub: friction.coefficient": ("0.1", "0.2"),
            "force pull: components[2].coefficients": ("2 (number 1 of 8)", "3"),
            "force spring": ("-", "spring_damper"),
        }
        assert not re.search(r"[0-9a-f]{12}", found.report())
    close = wf.compare(first, short(swing(mass=1.0 + 1e-15)))
    assert not close.settings and any("round-off: 1, the first body bob: mass" in note for note in close.notes)
    goes_on = wf.compare(short(swing(), start=first), short(swing(), start=short(swing(), step=5e-4)))
    assert goes_on.settings == {"start": ("a state at 0.002 s", "another state at 0.002 s")}


def test_items_that_only_one_run_has_are_named_together() -> None:
    """Compared with a single one, which is a setting of its own."""
    scene = swing(spring=True)
    bob = scene.body("bob")
    for n in range(5):
        scene.add(wf.forces.PointForce(bob.at((0, 0, 0)), (0.0, 0.0, 1.0), name=f"push {n}"))
    scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="stone")
    with_more, without = short(scene), short(swing(spring=True))
    many = "push 0, push 1, push 2 and 2 more"
    assert wf.compare(with_more, without).settings == {"force: only in A": (many, "-"), "body stone": ("given", "-")}
    assert wf.compare(without, with_more).settings["force: only in B"] == ("-", many)


def test_what_is_small_compared_with_its_like_comes_last(body: ReducedBody) -> None:
    """A torque of 1e-5 of what the largest force makes about the machine, after a force that differs by 1 %."""
    a, b = run_on(body), run_on(body)
    contact = b.history.contacts[PAIR]
    contact.force[:, 2] *= 1.01
    contact.torque[:] = 1e-5 * 0.1 * np.abs(contact.force).max()
    labels = [d.label for d in wf.compare(a, b).differences if not d.same]
    assert labels.index(f"contact_force[{PAIR}]") < labels.index(f"contact_torque[{PAIR}]")


def test_a_run_that_cannot_go_on_says_no_hash() -> None:
    options = {"scene": "ab" * 32, "start": f"a state at 0.002 s, {'12' * 16}", "step": "0.1"}
    others = {"scene": "cd" * 32, "start": f"a state at 0.001 s, {'34' * 16}", "step": "0.2"}
    said = "scene differs, start was a state at 0.001 s, is a state at 0.002 s, step was 0.2, is 0.1"
    assert different(options, others) == said


def test_reductions_that_differ_are_shown_by_their_settings(body: ReducedBody) -> None:
    """Else by how far their numbers are apart."""

    def run(**changed: Any) -> Result:
        return run_on(replace(body, **changed))

    settings = {"mesh": "ab" * 32, "modes": 2, "contact": {"rim": {"kind": "cylinder", "radius": 0.05}}}
    finer = {**settings, "mesh": "cd" * 32, "modes": 4}
    made = [{**body.provenance, "settings": one, "mesh_name": "roller"} for one in (settings, finer)]
    found = wf.compare(run(provenance=made[0]), run(provenance=made[1])).settings
    assert found == {}  # bodies are what their arrays are
    other = {"inertia": 2.0 * body.inertia}
    found = wf.compare(run(provenance=made[0]), run(provenance=made[1], **other)).settings
    nodes = f"a mesh 'roller', {len(body.surface.points)} nodes on its skin"
    for name in ("lower", "upper"):
        assert found[f"body {name}: reduce.mesh"] == (nodes, "another mesh" + nodes.removeprefix("a mesh"))
        assert found[f"body {name}: reduce.modes"] == ("2", "4")
    found = wf.compare(run(provenance=made[0]), run(provenance=made[0], **other)).settings
    said = "differ by up to 5.0e-01 of the largest, in inertia"
    assert found["body lower: numbers of the reduced body"] == ("-", said)
