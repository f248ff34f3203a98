"""The commands that a user begins with: `warpffrf example`, and `warpffrf scene-file`, the reference of scene files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpffrf.cli.errors import one_line_errors

ABOUT = "List files to begin with (scene files, a deck, meshes) and the commands that use them, or copy them."


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
        name: Annotated[str, typer.Argument(metavar="NAME", help="Which example; warpffrf example lists them.")],
        folder: Annotated[
            Path, typer.Argument(metavar="FOLDER", help="Where to copy its files; made if missing.")
        ] = Path(),
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the files of an earlier copy.")] = False,
    ) -> None:
        """Copy the files of an example into this folder, or another one, and say how they are run.

        Example: warpffrf example copy press
        """
        with one_line_errors():
            from warpffrf import examples

            print("\n".join(str(file) for file in examples.copy(name, folder, overwrite=overwrite)))
            print("\n".join(f"  {command}" for command in examples.get(name).commands))

    @app.command("scene-file")
    def scene_file_reference() -> None:
        """Print what may stand in a scene file: tables, values, --set, stages, what a run writes, errors."""
        with one_line_errors():
            from warpffrf.scene_file import reference

            print(reference())


def listed_examples() -> str:
    """Every example: its name, one sentence, its files, and the commands to run where they lie."""
    from warpffrf import examples

    lines = ["warpffrf example copy NAME [FOLDER] copies the files of an example; the commands run where they lie."]
    for name in examples.names():
        example = examples.get(name)
        lines += ["", f"{name}: {example.about}", f"  files: {', '.join(example.files)}"]
        lines += [f"  {command}" for command in example.commands]
    return "\n".join(lines)
