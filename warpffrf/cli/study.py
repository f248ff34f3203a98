"""The commands `warpffrf study ...`.

Sweep. The commands `warpffrf sweep` and `warpffrf sweep-plot`: a sweep, and pictures of one that has been run.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.asked import Asked
from warpffrf.cli.errors import INTERRUPTED, one_line_errors

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
                scene_file, parameters=named(settings or (), "--set", "upper.load=2000"),
                choices=choices_of(choice) if choice else None,
                measures=measure or None, rounds=rounds, out=folder, overwrite=overwrite, progress=not Asked.quiet,
            )  # fmt: skip
            found.write(folder, overwrite=True)
            print(found.report())

    return app


def named(texts: Sequence[str], option: str, example: str) -> dict[str, str]:
    """`NAME=VALUE` of all `texts` as name -> value. Raises `InputError` for other texts and names given twice."""
    from warpffrf.model.errors import InputError

    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise InputError(f"{option} {text!r}: write {option} NAME=VALUE, for example {option} {example}")
        if name.strip() in found:
            raise InputError(f"{option} {name.strip()!r} is given twice; give all its values in one")
        found[name.strip()] = value.strip()
    return found


def outputs_of(texts: Sequence[str]) -> dict[str, str]:
    """Outputs by name: `NAME=WHAT`, or WHAT alone, which is its own name. Raises `InputError`."""
    return named([text if "=" in text else f"{text}={text}" for text in texts], "--output", "peak=max(energy[kinetic])")


def workers_of(count: int, scheduler: str | None, devices: Sequence[str]) -> Any:
    """`workers` of a sweep: a scheduler, a number of processes, or the device of each. Raises `InputError`."""
    from warpffrf.model.errors import InputError

    if scheduler is not None and (count != 1 or devices):
        raise InputError(
            "--scheduler has its own workers; leave --workers out, and set the device of runs, "
            "--set simulate.device=cuda:0"
        )
    if count < len(devices):
        raise InputError(f"{len(devices)} --device need as many workers; give --workers {len(devices)}")
    return scheduler or ([devices[n % len(devices)] for n in range(count)] if devices else count)


def add_sweep_command(app: typer.Typer) -> None:
    """The command."""

    @app.command("sweep")
    def sweep(
        scene_file: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file, .toml.")],
        vary: Annotated[
            list[str],
            typer.Option(
                "--vary",
                metavar="NAME=VALUES",
                help="A parameter and its values: V1,V2,... or FIRST:LAST:COUNT, log:FIRST:LAST:COUNT, 'normal(MEAN, "
                "DEVIATION)', 'uniform(A, B)'. Repeat for more.",
            ),
        ],
        output: Annotated[
            list[str],
            typer.Option(
                "--output",
                metavar="[NAME=]WHAT",
                help="What to keep of each run: a history by its name, or taken over time, 'max(HISTORY)', min, mean, "
                "last, rms, amplitude. Repeat for more.",
            ),
        ],
        settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="As of run.")] = None,
        sample: Annotated[
            str | None,
            typer.Option(
                metavar="KIND:COUNT", help="Not all combinations, but latin:64, sobol:64, random:64, saltelli:64."
            ),
        ] = None,
        seed: Annotated[int, typer.Option(help="Of the sample.")] = 0,
        only_equilibrium: Annotated[
            bool, typer.Option("--equilibrium", help="Find equilibria, and simulate nothing.")
        ] = False,
        workers: Annotated[int, typer.Option(help="Processes of this machine.")] = 1,
        scheduler: Annotated[
            str | None, typer.Option(metavar="ADDRESS", help="Instead, a scheduler of dask: tcp://HOST:8786.")
        ] = None,
        device: Annotated[
            list[str] | None, typer.Option(help="cpu or cuda:0. Repeat to give workers several in turn.")
        ] = None,
        worlds: Annotated[
            int,
            typer.Option(help="Run so many rows at once, as worlds of one graph, where they differ in numbers only."),
        ] = 1,
        error_budget: Annotated[
            bool, typer.Option("--error-budget", help="Also the error budget of each run.")
        ] = False,
        out: Annotated[Path | None, typer.Option("--out", help="Folder; left out: out/NAME.sweep.")] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Begin anew.")] = False,
        resume: Annotated[bool, typer.Option("--resume", help="Go on with a sweep that was stopped.")] = False,
    ) -> None:
        """Run a scene at many values of its parameters; keep what is wanted of each run in one table, table.h5.

        Rows that cannot be run are rows with their message. Ctrl-C keeps what has been run; --resume goes on. Exit code
        1 where a row has failed.

        Example: warpffrf sweep pendulum.toml --vary arm=0.2:0.4:5 --output "min(body_position_z[bob])"
        """
        with one_line_errors():
            import warpffrf
            from warpffrf.study import sweep as run
            from warpffrf.study.sweeps.job import ERROR_BUDGET

            outputs = outputs_of(output) | ({ERROR_BUDGET: ERROR_BUDGET} if error_budget else {})
            found = run(
                scene_file, named(vary, "--vary", "upper.load=1000:5000:5"), outputs=outputs,
                store=Path("out") / f"{scene_file.stem}.sweep" if out is None else out,
                sample=f"{sample}:{seed}" if sample and ":" in sample else sample, settings=settings or (),
                run=warpffrf.equilibrium if only_equilibrium else None,
                workers=workers_of(workers, scheduler, device or ()), worlds=worlds, overwrite=overwrite, resume=resume,
                progress=not Asked.quiet,
            )  # fmt: skip
            if not Asked.quiet:
                print(found.report())
            if found.status == "unfinished":
                raise typer.Exit(INTERRUPTED)
            if found.failed():
                raise typer.Exit(1)


def add_sweep_plot_command(app: typer.Typer) -> None:
    """Add `sweep-plot` to `app`."""

    @app.command("sweep-plot")
    def plot_sweep(
        folder: Annotated[Path, typer.Argument(metavar="SWEEP", help="Folder of a sweep.")],
        output: Annotated[str, typer.Argument(metavar="OUTPUT", help="What to draw; `info SWEEP` lists outputs.")],
        out: Annotated[Path, typer.Option("--out", metavar="PNG", help="The picture to write: .png, .pdf or .svg.")],
        x: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter along; left out: the first.")] = None,
        y: Annotated[str | None, typer.Option(metavar="NAME", help="Draw a map; parameter upwards.")] = None,
        hue: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter by colour.")] = None,
        style: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter by dashes.")] = None,
        col: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter with a panel a value.")] = None,
        component: Annotated[str | None, typer.Option(help="Of a vector: x, y or z.")] = None,
        where: Annotated[
            list[str] | None, typer.Option("--where", metavar="NAME=VALUE", help="These rows alone. Repeat for more.")
        ] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
    ) -> None:
        """Draw an output of a sweep over a parameter, over time, or as a map of two parameters.

        Example: warpffrf sweep-plot press.sweep peak --x upper.load --hue friction --out peak.png
        """
        with one_line_errors():
            from warpffrf.model.errors import InputError
            from warpffrf.study import open_sweep
            from warpffrf.study.sweeps.parameters import values_of

            chosen = {}
            for name, text in named(where or (), "--where", "friction=0.2").items():
                values = values_of(text)
                if len(values) != 1:
                    raise InputError(f"--where {name}={text}: give one value of it, or draw all with --hue {name}")
                chosen[name] = values[0]
            entry = int(component) if component is not None and component.isdecimal() else component
            open_sweep(folder).plot(
                output, x=x, y=y, hue=hue, style=style, col=col, component=entry, where=chosen, path=out,
                overwrite=overwrite,
            )  # fmt: skip
            print(f"written to {out}")
