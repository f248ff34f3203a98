"""The lowest versions in pyproject.toml are those that `make test-floor` installs, and those of constraints.txt fit."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def numbers(version: str) -> tuple[int, ...]:
    """Of a version, without zeros at the end: 2.0 and 2.0.0 are the same one."""
    found = [int(part) for part in version.split(".")]
    while found and not found[-1]:
        found.pop()
    return tuple(found)


def bounds() -> dict[str, str]:
    """Name -> lowest version of every run-time dependency."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    found = [re.fullmatch(r"([\w-]+)>=([\d.]+)(?:,<[\d.]+)?", text) for text in project["dependencies"]]
    assert all(found), project["dependencies"]
    return {match[1]: match[2] for match in found if match}


def pinned(file: str) -> dict[str, list[str]]:
    """Name -> versions of a file of constraints."""
    found: dict[str, list[str]] = {}
    for name, version in re.findall(r"^([\w-]+)==([\d.]+)", (ROOT / file).read_text(), re.MULTILINE):
        found.setdefault(name.replace("_", "-"), []).append(version)
    return found


def test_the_floor_is_that_of_the_project() -> None:
    floor = {name: numbers(versions[0]) for name, versions in pinned("constraints-floor.txt").items()}
    assert {name: numbers(version) for name, version in bounds().items()} == floor


def test_tested_versions_are_allowed() -> None:
    tested = pinned("constraints.txt")
    below = [name for name, low in bounds().items() if any(numbers(v) < numbers(low) for v in tested[name])]
    assert below == []
