"""The command `warpffrf info`: contents of a file.

Demos. `warpffrf demo NAME` runs a script of the folder demos/, which is inside the package in a wheel.

Examples. `warpffrf example` lists and copies examples; `warpffrf scene-file` prints the reference of scene files.
"""

from __future__ import annotations

import ast
import importlib
import sys
from contextlib import nullcontext, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked


def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Mesh, reduced body or results (.h5), sweep (folder).")],
    length_unit: Annotated[
        str | None,
        typer.Option(metavar="UNIT", help="For a mesh: unit of the lengths in the file: m, cm, mm, um, in or ft."),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option(
            help="For a mesh: body to read, if there are several: instance, part or group, or a number from 0."
        ),
    ] = None,
    density: Annotated[
        float | None,
        typer.Option(help="For a mesh: density in kg/m3; default: that of the file's materials, or steel."),
    ] = None,
    page: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also write a page here: a picture of a reduced body's quality, of a sweep .html with its pictures.",
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing picture.")] = False,
) -> None:
    """Describe a file: size, mass, inertia, named sets, modes, or the report of a run or a sweep."""
    with one_line_errors():
        from warpffrf.cli.describe import describe_file

        print(
            describe_file(
                file,
                length_unit=length_unit,
                part=part_of(part),
                density=density,
                page=page,
                overwrite=overwrite,
                pairs=Asked.pairs,
            )  # fmt: skip
        )


def part_of(text: str | None) -> int | str | None:
    """Value of `--part`: the number of a connected part, or a name."""
    return int(text) if text is not None and text.isdecimal() else text


PACKAGE = Path(__file__).resolve().parents[1]


def folder() -> Path:
    """The folder of the scripts: inside the package in a wheel, next to it in a checkout."""
    inside = PACKAGE / "demos"
    return inside if inside.is_dir() else PACKAGE.parent / "demos"


def names() -> dict[str, Path]:
    """Name on the command line, `two-rollers`, -> script."""
    return {path.stem.replace("_", "-"): path for path in sorted(folder().glob("[a-z]*.py"))}


def about(script: Path) -> str:
    """The first line of its docstring."""
    return (ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or "").partition("\n")[0]


def demo(
    name: Annotated[str | None, typer.Argument(metavar="NAME", help="Name of a demo; default: list them.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results; default: out/NAME.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A coarser, shorter version.")] = False,
) -> None:
    """Run a complete example, print its results and write results, recording and picture to a folder."""
    scripts = names()
    if name is None:
        for known, script in scripts.items():
            print(f"{known:<22}{about(script)}")
        return
    with one_line_errors():
        from warpffrf.model.errors import InputError, unknown_name

        if name not in scripts:
            raise unknown_name("demo", name, list(scripts))
        results = out or Path("out") / scripts[name].stem
        try:
            results.mkdir(parents=True, exist_ok=True)  # fails before the run, not after it
        except OSError as error:
            raise InputError(f"demo: cannot write to {results}: {error}; choose another folder with --out") from None
        sys.path.insert(0, str(folder()))  # as with `python demos/NAME.py`; workers of a sweep get this path as well
        module: Any = importlib.import_module(scripts[name].stem)
        with redirect_stdout(StringIO()) if Asked.quiet else nullcontext():
            found = module.main(results, quick=quick, progress=not Asked.quiet)
    failed = [result for result in found if result.status != "completed"]
    for result in failed:
        print(f"error: {result.status}: {result.message}", file=sys.stderr)
    raise typer.Exit(1 if failed else 0)


ABOUT = "List the examples (scene files, a deck, meshes) and the commands that use them, or copy them."


def add_example_commands(app: typer.Typer) -> None:
    """Add `example`, with `example copy`, and `scene-file` to `app`."""
    example = typer.Typer(help=ABOUT, rich_markup_mode=None)
    app.add_typer(example, name="example")

    @example.callback(invoke_without_command=True)
    def list_examples(context: typer.Context) -> None:
        if context.invoked_subcommand is None:
            print(listed_examples())

    @example.command("copy")
    def copy_example(
        name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the example; warpffrf example lists them.")],
        folder: Annotated[
            Path, typer.Argument(metavar="FOLDER", help="Folder for its files; created if missing.")
        ] = Path(),
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the files of an earlier copy.")] = False,
    ) -> None:
        """Copy the files of an example into this folder, or another one, and print the commands that run them.

        Example: warpffrf example copy press
        """
        with one_line_errors():
            from warpffrf import examples

            print("\n".join(str(file) for file in examples.copy(name, folder, overwrite=overwrite)))
            print("\n".join(f"  {command}" for command in examples.get(name).commands))

    @app.command("scene-file")
    def scene_file_reference() -> None:
        """Print the reference of scene files: tables, values, --set, stages, output files, errors."""
        with one_line_errors():
            from warpffrf.scene_file import reference

            print(reference())


def listed_examples() -> str:
    """Every example: its name, one sentence, its files, and the commands to run in its folder."""
    from warpffrf import examples

    lines = ["warpffrf example copy NAME [FOLDER] copies the files of an example; the commands run in that folder."]
    for name in examples.names():
        example = examples.get(name)
        lines += ["", f"{name}: {example.about}", f"  files: {', '.join(example.files)}"]
        lines += [f"  {command}" for command in example.commands]
    return "\n".join(lines)
