"""What is said of the package outside pyproject.toml: licences, the recipe for conda, versions and schemas."""

from __future__ import annotations

import re
import runpy
import tomllib
from pathlib import Path

import pytest

import warpffrf

ROOT = Path(__file__).resolve().parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
RECIPE = (ROOT / ".ci" / "conda" / "meta.yaml").read_text(encoding="utf-8")
CONDA_NAMES = {"matplotlib": "matplotlib-base"}  # without its windows, which warpffrf does not open


def test_the_page_of_licences_is_up_to_date() -> None:
    """Rows of the packages of pyproject.toml, and, where the version is the one of the page, the licence it says."""
    script = runpy.run_path(str(ROOT / ".ci" / "licences.py"))
    rows = script["written"]()
    assert {name: row.needed_by for name, row in rows.items()} == script["needed"]()
    for name, row in rows.items():
        found = script["installed"](name)
        if found is not None and found[0] == row.version:
            assert found[1] == row.licence, f"{name}: run python .ci/licences.py"
    assert sum(script["installed"](name) is not None for name in rows) >= len(PROJECT["dependencies"])


def conda_requirements(section: str) -> dict[str, str]:
    """Name -> bounds of a section of the recipe's requirements."""
    block = re.search(rf"^  {section}:\n((?:    - .*\n)+)", RECIPE, re.MULTILINE)
    assert block is not None
    return dict(re.findall(r"- (\S+) ?(\S*)\n", block[1]))


def bounds(requirements: list[str]) -> dict[str, str]:
    """Name -> bounds of requirements of pyproject.toml, by the names that conda has."""
    found = (re.fullmatch(r"([\w-]+)(.*)", text) for text in requirements)
    return {CONDA_NAMES.get(match[1], match[1]): match[2] for match in found if match}


def test_the_recipe_has_the_requirements_of_the_project() -> None:
    python = {"python": PROJECT["requires-python"]}
    assert len(bounds(PROJECT["dependencies"])) == len(PROJECT["dependencies"])
    assert conda_requirements("run") == python | bounds(PROJECT["dependencies"])
    assert conda_requirements("host") == python | {"pip": ""} | bounds(PYPROJECT["build-system"]["requires"])
    (entry,) = PROJECT["scripts"].items()
    assert f"- {entry[0]} = {entry[1]}\n" in RECIPE


def test_one_version_everywhere() -> None:
    assert f'version = "{warpffrf.__version__}"' in RECIPE
    assert f"version: {warpffrf.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.fullmatch(r"\d+\.\d+\.\d+", warpffrf.__version__)


def test_the_licence_is_spdx_and_no_classifier() -> None:
    assert PROJECT["license"] == "Apache-2.0"
    assert not [c for c in PROJECT["classifiers"] if c.startswith("License")]
    lowest = PROJECT["requires-python"].removeprefix(">=")
    named = [c.split(" :: ")[-1] for c in PROJECT["classifiers"] if re.search(r":: Python :: 3\.\d+$", c)]
    assert named[0] == lowest and "Typing :: Typed" in PROJECT["classifiers"]
    assert (ROOT / "warpffrf" / "py.typed").is_file() and (ROOT / "kernels" / "warpffrf_kernels" / "py.typed").is_file()


@pytest.mark.parametrize("name", ["reduced bodies", "results", "tables of sweeps"])
def test_schemas_in_the_page_are_those_of_the_code(name: str) -> None:
    from warpffrf.model.reduced.file import SCHEMA
    from warpffrf.output.files.results import SCHEMA_VERSION
    from warpffrf.study.sweeps.table import SCHEMA as TABLE

    now = {"reduced bodies": SCHEMA, "results": SCHEMA_VERSION, "tables of sweeps": TABLE}[name]
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert f"| {name} | {now} |" in page
