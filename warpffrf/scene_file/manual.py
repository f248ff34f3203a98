"""The reference page of scene files: docs/scene_file.md of a checkout; in a wheel, a file next to this module."""

from __future__ import annotations

from pathlib import Path

PAGE = "scene_file.md"


def reference() -> str:
    """The reference of scene files: tables, values, `--set`, stages, what a run writes, errors. Markdown."""
    installed = Path(__file__).with_name(PAGE)
    page = installed if installed.is_file() else Path(__file__).parents[2] / "docs" / PAGE
    return page.read_text(encoding="utf-8")
