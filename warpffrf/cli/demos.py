"""`warpffrf demo NAME`: runs a script of the folder demos/, which a wheel has within the package."""

from __future__ import annotations

import ast
import importlib
import sys
from contextlib import nullcontext, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.asked import Asked
from warpffrf.cli.errors import one_line_errors

PACKAGE = Path(__file__).resolve().parents[1]


def folder() -> Path:
    """Where the scripts are: in the package as a wheel has it, beside it in a checkout."""
    inside = PACKAGE / "demos"
    return inside if inside.is_dir() else PACKAGE.parent / "demos"


def names() -> dict[str, Path]:
    """The scripts of demos by the names of the command line, `two-rollers`."""
    return {path.stem.replace("_", "-"): path for path in sorted(folder().glob("[a-z]*.py"))}


def about(script: Path) -> str:
    """The first line of its docstring."""
    return (ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or "").partition("\n")[0]


def demo(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="Of a demo; left out: list them.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results; left out: out/NAME.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A coarser, shorter version.")] = False,
) -> None:
    """Run a complete example, print its figures and write results, recording and picture to a folder."""
    scripts = names()
    if name is None:
        for known, script in scripts.items():
            print(f"{known:<22}{about(script)}")
        return
    with one_line_errors():
        from warpffrf.model.errors import unknown_name

        if name not in scripts:
            raise unknown_name("demo", name, list(scripts))
        sys.path.insert(0, str(folder()))  # as `python demos/NAME.py` has it, in processes of its own too
        module: Any = importlib.import_module(scripts[name].stem)
        with redirect_stdout(StringIO()) if Asked.quiet else nullcontext():
            code = module.main(out or Path("out") / scripts[name].stem, quick=quick, progress=not Asked.quiet)
    raise typer.Exit(code)
