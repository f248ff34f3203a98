"""Writes docs/licences.md: the licences of what warpffrf needs, as the metadata of the installed packages say them.

A package that is not installed keeps its line of the page. Run: python .ci/licences.py
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "licences.md"
UNREAD = "not read: not installed where this page was made"
HEAD = """\
# Licences of what warpffrf needs

warpffrf itself is Apache-2.0 ([LICENSE](../LICENSE)); it contains no code of these packages and is installed next to
them. Made by `python .ci/licences.py` from the metadata of installed packages: an SPDX expression, or the classifier or
first line that a package has in place of one. What these packages need in turn is not listed.

| package | needed by | version | licence |
|---|---|---|---|
"""


@dataclass(frozen=True)
class Line:
    """A row of the page."""

    package: str
    needed_by: str
    version: str
    licence: str

    def __str__(self) -> str:
        return f"| {self.package} | {self.needed_by} | {self.version} | {self.licence} |"


def needed() -> dict[str, str]:
    """Package -> what needs it: "warpffrf", or the extras but for that of developers."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = dict.fromkeys(map(_name, project["dependencies"]), "warpffrf")
    for extra, requirements in project["optional-dependencies"].items():
        if extra != "dev":
            found |= dict.fromkeys(map(_name, requirements), f"extra `{extra}`")
    return found


def _name(requirement: str) -> str:
    return re.split(r"[\[<>=!~; ]", requirement, maxsplit=1)[0]


def installed(package: str) -> tuple[str, str] | None:
    """Version and licence by the metadata of an installed package; None of one that is not."""
    try:
        said = metadata(package)
    except PackageNotFoundError:
        return None
    classifiers = [c.split(" :: ")[-1] for c in said.get_all("Classifier") or [] if c.startswith("License ::")]
    first = (said.get("License") or "").strip().splitlines()[:1]
    licence = said.get("License-Expression") or ", ".join(classifiers) or (first[0] if first else "")
    return said["Version"], licence or "none said"


def written() -> dict[str, Line]:
    """The rows that the page has, by package."""
    text = PAGE.read_text(encoding="utf-8") if PAGE.is_file() else ""
    rows = (Line(*row) for row in re.findall(r"^\| (\S+) \| (.+?) \| (.+?) \| (.+?) \|$", text, re.MULTILINE))
    return {row.package: row for row in rows if row.package != "package"}


def lines() -> list[Line]:
    """What the page must have: what needs a package from pyproject.toml, versions and licences where they are known."""
    known = written()
    found = []
    for package, needed_by in needed().items():
        old = known.get(package)
        version, licence = installed(package) or ((old.version, old.licence) if old else ("-", UNREAD))
        found.append(Line(package, needed_by, version, licence))
    return found


if __name__ == "__main__":
    PAGE.write_text(HEAD + "\n".join(map(str, lines())) + "\n", encoding="utf-8")
