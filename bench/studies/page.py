"""The harness of all study pages: which there are, and how one is made.

A study is a module. `compute(*cases)` computes its figures. `page(figures)` returns the Markdown of the page, heading
first. `picture(figures, path)`, optional, draws a picture. They go to FOLDER/studies/NAME.md and NAME.png.
A study of several pages has `write(folder, cases, quick)` instead, which returns the paths of its files.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from warpffrf.model.errors import InputError, unknown_name

MODULES = {
    "accuracy": "studies.accuracy.measured",
    "bases": "studies.bodies.bases",
    "carter": "studies.rolling.carter",
    "carter_rollers": "studies.rolling.carter_rollers",
    "coarse_points": "studies.contact.coarse_points_page",
    "coarse_rollers": "studies.contact.coarse_rollers",
    "colliding_bars": "studies.contact.colliding_bars",
    "contact_grid": "studies.contact.contact_grid",
    "contact_problem": "studies.rolling.contact_problem",
    "error_budget": "studies.accuracy.budget_check",
    "film_acceptance": "studies.films.film_acceptance",
    "flexible_bearings": "studies.bodies.flexible_bearings",
    "free_flight": "studies.bodies.free_flight",
    "hertz_and_ripple": "studies.contact.straight_rollers",
    "inertia_levels": "studies.bodies.inertia_levels",
    "joint_bases": "studies.small_sliding.joint_bases",
    "mixed_bearings": "studies.bodies.mixed_bearings",
    "oil_film": "studies.films.oil_film",
    "patch_cells": "studies.contact.patch_cells",
    "patch_rolling": "studies.rolling.patch_rolling",
    "pressure_ends": "studies.contact.pressure_ends",
    "roller_end": "studies.contact.roller_end",
    "rolling_patches": "studies.rolling.rolling_patches",
    "small_sliding_acceptance": "studies.small_sliding.acceptance",
    "small_sliding_nodes": "studies.small_sliding.nodes",
    "speed_error": "studies.speed_error_pages.page",
    "stability": "studies.hard_cases",
    "validate": "studies.validate",
}


def listed() -> str:
    """Names of all studies, each with the first line of its module."""
    return "\n".join(f"{name:26}{_first_line(module)}" for name, module in MODULES.items())


def make(name: str, folder: str | Path, cases: Sequence[str] = (), *, quick: bool = False) -> list[Path]:
    """Run a study and write its page below `folder`; returns the paths of its files. `cases`: some cases alone, of
    studies that have named ones; a single page of these is printed, not written. Raises `InputError` for a name that
    does not exist and for cases or `quick` where a study has none."""
    if name not in MODULES:
        raise unknown_name("study", name, MODULES)
    module = import_module(MODULES[name])
    if hasattr(module, "write"):
        return module.write(folder, cases, quick=quick)
    if quick:
        raise InputError(f"study '{name}' has no quick version")
    if cases and "cases" not in module.compute.__code__.co_varnames:
        raise InputError(f"study '{name}' has no named cases")
    figures = module.compute(*cases)
    text = made(module.page(figures), name)
    if cases:
        print(text)
        return []
    return _written(module, name, figures, text, Path(folder) / "studies")


def made(text: str, name: str) -> str:
    """The page with the command that made it below its heading."""
    heading, rest = text.split("\n", 1)
    return f"{heading}\n\nMade by `python -m studies {name}`; do not edit.\n{rest}"


def _written(module: ModuleType, name: str, figures: object, text: str, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name}.md"]
    paths[0].write_text(text, encoding="utf-8")
    if hasattr(module, "picture"):
        paths.append(folder / f"{name}.png")
        module.picture(figures, paths[1])
    return paths


def _first_line(module: str) -> str:
    """Of the docstring, without importing the module."""
    spec = find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(module)
    return (ast.get_docstring(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))) or "").split("\n", 1)[0]
