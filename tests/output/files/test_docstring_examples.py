"""The examples in docstrings run as they stand, in the order of a user's work, and the most used names have one.

Later examples go on with what earlier ones have made, as they say; all share one pair of small rollers.
"""

from __future__ import annotations

import doctest
import inspect
import re
from collections import Counter
from pathlib import Path
from typing import Any

import matplotlib
import pytest

import warpffrf as wf
from warpffrf.scene_file import run_scene

ROOT = Path(__file__).resolve().parents[3]
ORDER: list[Any] = [
    wf.Material, wf.mesh.roller, wf.mesh.box, wf.mesh.sleeve, wf.mesh.read, wf.surfaces.Cylinder, wf.reduce,
    wf.ReducedBody.info, wf.Scene, wf.Scene.add_rigid_body, wf.Scene.add_body, wf.Contact, wf.joints.Fixed,
    wf.joints.Prismatic, wf.forces.JointSpringDamper, wf.forces.PointForce, wf.sensors.Position, wf.signals.Table,
    wf.signals.SmoothStep, wf.equilibrium, wf.equilibria, wf.RunOptions, wf.simulate, wf.static, wf.Result.contact,
    wf.Result.body, wf.Scene.add_bearing,
    wf.Result.force, wf.Result.sensor, wf.Result.report,
    wf.Result.plot, wf.Result.to_dataframe, wf.compare, wf.joints.Revolute, wf.joints.Drive,
    wf.integrators.GeneralizedAlpha, run_scene,
]  # fmt: skip
MOST_USED = 20


def label(thing: Any) -> str:
    return f"{thing.__module__}.{thing.__qualname__}"


def test_they_run_as_they_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib.use("agg")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path / "cache"))
    page = (ROOT / "docs" / "scene_file.md").read_text(encoding="utf-8")
    pendulum = re.search(r"^    title = \"pendulum\"\n(?:(?:    .*)?\n)*", page, re.M)
    assert pendulum is not None
    (tmp_path / "pendulum.toml").write_text(inspect.cleandoc(pendulum.group()), encoding="utf-8")
    names: dict[str, Any] = {"wf": wf}
    runner, parser, told = doctest.DocTestRunner(verbose=False), doctest.DocTestParser(), []
    for thing in ORDER:
        text = inspect.getdoc(thing) or ""
        assert "+SKIP" not in text
        example = parser.get_doctest(text, names, label(thing), None, 0)
        assert example.examples, f"{label(thing)} has no example"
        example.globs = names  # the parser makes a copy
        runner.run(example, out=told.append, clear_globs=False)
    assert runner.summarize(verbose=False).failed == 0, "".join(told)


def test_the_most_used_names_have_one() -> None:
    """By how often demos, README and pages call them; a name that several classes have counts for none."""
    pages = [*(ROOT / "docs").glob("*.md"), ROOT / "README.md", *(ROOT / "demos").glob("*.py")]
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    calls = Counter(re.findall(r"(?<![\w.])([\w.]+)\(", text))  # "wf.mesh.roller", "scene.add_body", ...
    of_method = Counter()
    for call, count in calls.items():
        of_method[call.rsplit(".", 1)[-1]] += count if "." in call and not call.startswith(("log.", "wf.")) else 0
    used: dict[Any, int] = {}
    for module in (wf, *(getattr(wf, name) for name in wf.__all__ if inspect.ismodule(getattr(wf, name)))):
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isclass(thing) or inspect.isfunction(thing):
                called = name if module is wf else f"{module.__name__.rsplit('.', 1)[-1]}.{name}"
                alone = {name} if name[0].isupper() else set()  # a class that is imported by its name
                used[thing] = sum(calls[way] for way in {called, f"wf.{called}"} | alone)
    methods = [(kind, n) for kind in (wf.Scene, wf.Result, wf.ReducedBody) for n in vars(kind) if not n.startswith("_")]
    for kind, name in methods:
        if [n for _, n in methods].count(name) == 1 and inspect.isfunction(vars(kind)[name]) and name != "add":
            used[getattr(kind, name)] = of_method[name]
    first = sorted(used, key=lambda thing: -used[thing])[:MOST_USED]
    without = [label(thing) for thing in first if ">>>" not in (inspect.getdoc(thing) or "")]
    assert not without, without
    assert used[first[-1]] >= 5
    assert "scene.add(" in (inspect.getdoc(wf.Contact) or "")  # the most used of all, in most of the others' examples
