"""The commands `warpffrf study ...`."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.asked import Asked
from warpffrf.cli.errors import one_line_errors

IN_FILE = "simulate."  # before an option of the run, as `--set` names it


def choice_of(text: str) -> tuple[str, list[Any]]:
    """`NAME=V1,V2` as a name and values: numbers and truth values as TOML has them, else texts. Raises `InputError`."""
    from warpffrf.model.errors import InputError

    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise InputError(f"--choice {text!r}: write --choice NAME=V1,V2, for example --choice step=2e-4,1e-4")
    try:
        return name.strip(), list(tomllib.loads(f"v = [{values}]")["v"])
    except tomllib.TOMLDecodeError:
        return name.strip(), [value.strip() for value in values.split(",")]


def choices_of(texts: Sequence[str]) -> dict[str, list[Any]]:
    """All `--choice` of a command. Options of the run may be written as the scene file has them, `simulate.step`, and
    integrators and local treatments as its kinds: `hht`, `{kind="hht", alpha=-0.3}`. Raises `InputError`."""
    from warpffrf.model.errors import InputError
    from warpffrf.study.speed_against_error.choices import RUN

    found: dict[str, list[Any]] = {}
    for name, values in map(choice_of, texts):
        short = name.removeprefix(IN_FILE)
        name = short if short in RUN else name
        if name in found:
            raise InputError(f"--choice {name!r} is given twice; give all its values in one, NAME=V1,V2")
        found[name] = [_made(name, value) for value in values] if name in RUN else values
    return found


def _made(name: str, value: Any) -> Any:
    """The object that a kind of scene files stands for; other values as they are."""
    from warpffrf.model.errors import InputError, unknown_name
    from warpffrf.model.integrators import INTEGRATORS
    from warpffrf.scene_file.forms import value_kinds

    table = {"kind": value} if name == "integrator" and isinstance(value, str) else value
    if not isinstance(table, dict):
        return value
    kind, kinds = table.get("kind"), value_kinds()
    known = [k for k in kinds if k in INTEGRATORS] if name == "integrator" else list(kinds)
    if kind not in known:
        raise unknown_name(f"--choice {name}: kind", kind, known)
    try:
        return kinds[kind].call(**{key: entry for key, entry in table.items() if key != "kind"})
    except TypeError as error:
        raise InputError(f"--choice {name}: {table} cannot be used: {error}") from error


def study_app() -> typer.Typer:
    """The commands."""
    app = typer.Typer(help="Speed against error.", no_args_is_help=True, rich_markup_mode=None)
    app.callback()(lambda: None)

    @app.command("speed-error")
    def speed_error(
        scene_file: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file, .toml.")],
        settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="As of run.")] = None,
        choice: Annotated[
            list[str] | None,
            typer.Option("--choice", metavar="NAME=V1,V2", help="Values to combine, coarse to fine. Repeat for more."),
        ] = None,
        measure: Annotated[list[str] | None, typer.Option("--measure", help="Errors to measure; all if none.")] = None,
        rounds: Annotated[int, typer.Option(help="How often every setting is run.")] = 3,
        out: Annotated[Path | None, typer.Option("--out", help="Folder; left out: out/NAME_speed_error.")] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Begin anew.")] = False,
    ) -> None:
        """Run a scene with many settings beside a reference. A study that was stopped goes on in its folder."""
        with one_line_errors():
            from warpffrf.study import speed_error as run

            folder = Path("out") / f"{scene_file.stem}_speed_error" if out is None else out
            found = run(
                scene_file, settings=settings or (), choices=choices_of(choice) if choice else None,
                measures=measure or None, rounds=rounds, out=folder, overwrite=overwrite, progress=not Asked.quiet,
            )  # fmt: skip
            found.write(folder, overwrite=True)
            print(found.report())

    return app
