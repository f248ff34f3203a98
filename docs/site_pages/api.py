"""Pages of the reference that are made from the package: one of each public name, the command line, the quantities."""

from __future__ import annotations

import inspect
from itertools import groupby
from pathlib import Path
from typing import Any

import public_names
import typer
from typer.cli import get_docs_for_click
from typer.main import get_command

from warpffrf.cli.program import app as command_line
from warpffrf.output.files import fields

RESULTS = "Classes of results"


def place(one: public_names.Public) -> tuple[str, str]:
    """The module and the name under which users write it; classes of results are written nowhere."""
    module, _, name = one.label.rpartition(".")
    return ("warpffrf" + module.removeprefix("wf") if module.split(".")[0] == "wf" else module), name


def page(one: public_names.Public) -> str:
    """Its page."""
    module, name = place(one)
    title = f"{module.removeprefix('warpffrf.')}.{name}" if module.count(".") == 1 else name
    out = [title, "=" * len(title), "", f".. py:currentmodule:: {module}", ""]
    if inspect.isclass(one.thing):
        out += [f".. autoclass:: {module}.{name}"]
        members = [m.name for m in public_names.members(one)]
        out += [f"    :members: {', '.join(members)}", "    :inherited-members:", ""] if members else [""]
    elif callable(one.thing):
        out += [f".. autofunction:: {module}.{name}", ""]
    else:
        out += [f".. autodata:: {module}.{name}", ""]
    return "\n".join(out)


def write(path: Path, text: str) -> None:
    """Only where it differs: an older page is not read again."""
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def first_paragraph(thing: Any) -> str:
    return " ".join((inspect.getdoc(thing) or "").split("\n\n")[0].split())


def first_sentence(one: public_names.Public) -> str:
    text = " ".join(one.text.split("\n\n")[0].split())
    return text.split(". ")[0].rstrip(".").replace("|", "\\|")


def import_of(module: str) -> Any:
    """The public module of this name, which is an attribute of the package."""
    last = module.rsplit(".", 1)[-1]
    return next(found for found in public_names.modules() if found.__name__.rsplit(".", 1)[-1] == last)


def write_module(folder: Path, module: str, ones: list[public_names.Public]) -> str:
    """A page of each name of a module, and their list; the name of the page with the list."""
    results = module == RESULTS
    title = RESULTS if results else module.replace("warpffrf", "wf", 1)
    stem = title.lower().replace(" ", "_")
    said = "What calls give back, and users hold without naming it." if results else first_paragraph(import_of(module))
    out = [f"# {title}", "", said, "", "| name | |", "|---|---|"]
    stems = []
    for one in sorted(ones, key=lambda one: one.name):
        stems.append(".".join(place(one)).removeprefix("warpffrf."))
        out += [f"| [`{one.name}`]({stems[-1]}.rst) | {first_sentence(one)} |"]
        write(folder / f"{stems[-1]}.rst", page(one))
    write(folder / f"{stem}.md", "\n".join([*out, "", "```{toctree}", ":hidden:", "", *stems, "```", ""]))
    return stem


def write_names(folder: Path) -> None:
    """The pages of all modules, and their list."""
    groups = [(module, list(ones)) for module, ones in groupby(public_names.top_level(), key=lambda one: place(one)[0])]
    stems = [write_module(folder, module, ones) for module, ones in [*groups, (RESULTS, [*public_names.results()])]]
    index = ["# Python API", "", "`import warpffrf as wf`; every name that a script may use has a page.", ""]
    write(folder / "index.md", "\n".join([*index, "```{toctree}", ":maxdepth: 1", "", *stems, "```", ""]))


def write_commands(path: Path) -> None:
    """The help of every command."""
    command = get_command(command_line)
    text = get_docs_for_click(obj=command, ctx=typer.Context(command), name="warpffrf", title="Command line")
    write(path, text)


def write_quantities(path: Path) -> None:
    """What a results file holds."""
    out = ["# Quantities of a results file", ""]
    out += ["Names in HDF5 files and of `result.to_xarray()`, for tables followed by the owner in brackets.", ""]
    out += ["| name | unit | dimensions | frame |", "|---|---|---|---|"]
    for name, table in vars(fields).items():
        if not name.endswith("_FIELDS") or not isinstance(table, tuple):
            continue
        for one in table:
            stacked = ("owner",) if one.stacked and table is not fields.RUN_FIELDS else ()
            dims = ", ".join(("time", *stacked, *one.dims))
            out += [f"| `{one.name}{'' if one.stacked else '/<owner>'}` | {one.units} | {dims} | {one.frame} |"]
    write(path, "\n".join(out) + "\n")


def generate(app: Any) -> None:
    """Handler of builder-inited."""
    folder = Path(app.srcdir) / "docs" / "made"
    for page in (folder / "api").glob("*.rst"):  # of names that are no more
        if page.stem not in {".".join(place(one)).removeprefix("warpffrf.") for one in public_names.everything()}:
            page.unlink()
    write_names(folder / "api")
    write_commands(folder / "commands.md")
    write_quantities(folder / "quantities.md")


def setup(app: Any) -> dict[str, Any]:
    app.connect("builder-inited", generate)
    return {"parallel_read_safe": True}
