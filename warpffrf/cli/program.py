"""The command line: `warpffrf demo | example | run | modes | campbell | reduce | info | report | compare | plot |
spectrum | view | picture | study | sweep | fmu`.

Wrong input ends with one line on stderr and exit code 1, wrong usage with exit code 2, Ctrl-C or SIGTERM with exit
code 130 if no results are kept; none prints a traceback. Results are printed to stdout, progress and warnings to
stderr. With --quiet there is no report either: the exit code states the outcome. Commands that only print information,
such as `info` and `modes`, print it in any case.
"""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from io import TextIOBase
from typing import Annotated, TextIO

import typer

import warpffrf
from warpffrf.cli.bodies import reduce_mesh
from warpffrf.cli.errors import know_options
from warpffrf.cli.fmu import fmu_of_scene_file
from warpffrf.cli.global_options import Asked
from warpffrf.cli.info import add_example_commands, demo, info
from warpffrf.cli.pictures import add_picture_commands
from warpffrf.cli.results import add_result_commands
from warpffrf.cli.scenes import campbell_of_scene_file, modes_of_scene_file, run_scene_file
from warpffrf.cli.study import add_sweep_command, add_sweep_plot_command, study_app
from warpffrf.model.messages.reprs import printable

# Set before NumPy is loaded: on the many small matrices of a reduction, the threads of a BLAS wait for each other (on
# two busy cores 16 times slower than a single thread).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


log = logging.getLogger("warpffrf")


class Printable(TextIOBase):
    """A text stream that passes printable text on to `stream`."""

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        if not isinstance(text, str):
            raise TypeError(f"a text is required, got {type(text).__name__}")
        self.stream.write(printable(text))
        return len(text)

    def flush(self) -> None:
        self.stream.flush()

    def isatty(self) -> bool:
        return self.stream.isatty()

    def fileno(self) -> int:
        return self.stream.fileno()


app = typer.Typer(
    name="warpffrf",
    help="Simulate machines of flexible bodies with contact. Start with: warpffrf demo two-rollers, or warpffrf "
    "example",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"warpffrf {warpffrf.__version__}")
        raise typer.Exit


@app.callback()
def options(
    context: typer.Context,
    verbose: Annotated[
        bool,
        typer.Option("--verbose", "-v", help="Print more: the scene, times, tracebacks, every contact of a group."),
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print neither progress nor reports, only warnings and errors.")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    Asked.quiet, Asked.pairs = quiet, "all" if verbose else "folded"
    know_options(context)
    from warpffrf.model.messages.progress import Lines, notes

    for old in [h for h in log.handlers if isinstance(h, Lines)]:
        log.removeHandler(old)
    handler = Lines("[%(relativeCreated)7.0f ms] %(message)s" if verbose else "%(message)s")
    handler.addFilter(lambda record: record.name != notes.name)  # they are in the report
    log.addHandler(handler)
    log.setLevel(logging.DEBUG if verbose else logging.WARNING if quiet else logging.INFO)


app.add_typer(study_app(), name="study")


app.command("demo")(demo)
app.command("run")(run_scene_file)
app.command("modes")(modes_of_scene_file)
app.command("campbell")(campbell_of_scene_file)
app.command("fmu")(fmu_of_scene_file)
app.command("reduce")(reduce_mesh)
app.command("info")(info)
add_result_commands(app)
add_example_commands(app)
add_picture_commands(app)
add_sweep_command(app)
add_sweep_plot_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with `arguments` (None: those of the process); returns the exit code.

    Output of commands passes through `printable`: names in files, and of files, may contain control sequences.
    """
    try:
        with redirect_stdout(Printable(sys.stdout)):
            app(list(arguments) if arguments is not None else None, prog_name="warpffrf")
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else 1
    return 0
