"""The commands `warpffrf study ...`.

Sweep. The commands `warpffrf sweep` and `warpffrf sweep-plot`: a sweep, and pictures of its results.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.errors import INTERRUPTED, one_line_errors
from warpffrf.cli.global_options import Asked
from warpffrf.cli.results import THEME, WIDTH

IN_FILE = "simulate."  # prefix of options of the run in `--set`


def choice_of(text: str) -> tuple[str, list[Any]]:
    """`NAME=V1,V2` as a name and values: numbers and Booleans as in TOML, else texts. Raises `InputError`."""
    from warpffrf.model.errors import InputError

    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise InputError(f"--choice {text!r}: write --choice NAME=V1,V2, for example --choice step=2e-4,1e-4")
    try:
        return name.strip(), list(tomllib.loads(f"v = [{values}]")["v"])
    except tomllib.TOMLDecodeError:
        return name.strip(), [value.strip() for value in values.split(",")]


def choices_of(texts: Sequence[str]) -> dict[str, list[Any]]:
    """All `--choice` of a command. Options of the run may be named as in the scene file, `simulate.step`; integrators
    and treatments of local modes as its kinds: `hht`, `{kind="hht", alpha=-0.3}`. Raises `InputError`."""
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
    """The object of a kind of the scene file; other values unchanged."""
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
    """The commands `study ...`."""
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
        measure: Annotated[list[str] | None, typer.Option("--measure", help="Errors to measure; default: all.")] = None,
        rounds: Annotated[int, typer.Option(help="Number of runs of every setting.")] = 3,
        out: Annotated[Path | None, typer.Option("--out", help="Folder; default: out/NAME_speed_error.")] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Restart and replace the results.")] = False,
    ) -> None:
        """Run a scene with many settings and compare with a reference. An interrupted study continues in its folder."""
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
    """`NAME=VALUE` of all `texts` as name -> value. Raises `InputError` for other texts and repeated names."""
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
    """Outputs by name: `NAME=WHAT`, or WHAT alone, which is also the name. Raises `InputError`."""
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
    """Add `sweep` to `app`."""

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
                help="Outputs of each run: a history by its name, or a value over time, 'max(HISTORY)', min, mean, "
                "last, rms, amplitude. Repeat for more.",
            ),
        ],
        settings: Annotated[list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="As of run.")] = None,
        sample: Annotated[
            str | None,
            typer.Option(
                metavar="KIND:COUNT", help="Instead of all combinations: latin:64, sobol:64, random:64, saltelli:64."
            ),
        ] = None,
        seed: Annotated[int, typer.Option(help="Seed of the sample.")] = 0,
        only_equilibrium: Annotated[bool, typer.Option("--equilibrium", help="Find equilibria only.")] = False,
        workers: Annotated[int, typer.Option(help="Processes of this machine.")] = 1,
        scheduler: Annotated[
            str | None, typer.Option(metavar="ADDRESS", help="Instead, a scheduler of dask: tcp://HOST:8786.")
        ] = None,
        device: Annotated[
            list[str] | None, typer.Option(help="cpu or cuda:0. Repeat to distribute workers over several.")
        ] = None,
        worlds: Annotated[
            int,
            typer.Option(help="Number of rows run at once, as worlds of one graph, if they differ in numbers only."),
        ] = 1,
        error_budget: Annotated[
            bool, typer.Option("--error-budget", help="Also compute the error budget of each run.")
        ] = False,
        out: Annotated[Path | None, typer.Option("--out", help="Folder; default: out/NAME.sweep.")] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Restart and replace the results.")] = False,
        resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted sweep.")] = False,
    ) -> None:
        """Run a scene at many values of its parameters; save the outputs of each run in one table, table.h5.

        Rows that fail keep their message. Ctrl-C keeps the completed rows; --resume continues. Exit code 1 if a row has
        failed.

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
        x: Annotated[
            str | None, typer.Option(metavar="NAME", help="Parameter of the x axis; default: the first.")
        ] = None,
        y: Annotated[str | None, typer.Option(metavar="NAME", help="Draw a map; parameter of the y axis.")] = None,
        hue: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter shown by colour.")] = None,
        style: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter shown by line style.")] = None,
        col: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter with one panel per value.")] = None,
        component: Annotated[str | None, typer.Option(help="Of a vector: x, y or z.")] = None,
        where: Annotated[
            list[str] | None, typer.Option("--where", metavar="NAME=VALUE", help="Only these rows. Repeat for more.")
        ] = None,
        theme: Annotated[str, THEME] = "light",
        width: Annotated[float | None, WIDTH] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing picture.")] = False,
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
                output, x=x, y=y, hue=hue, style=style, col=col, component=entry, where=chosen, theme=theme,
                width=width, path=out, overwrite=overwrite,
            )  # fmt: skip
            print(f"written to {out}")
