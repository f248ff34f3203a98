"""The command line: `warpffrf demo | example | run | modes | campbell | reduce | info | compare | plot | spectrum |
view | picture | study | sweep`.

Wrong input ends with one line on stderr and exit code 1, wrong usage with exit code 2, Ctrl-C or SIGTERM where nothing
is to be kept with exit code 130; no traceback for any. What a command finds goes to stdout, progress and warnings go to
stderr. With --quiet there is no report either: the exit code says how it went, and only `info` and `modes`, which do
nothing but tell, print what they are asked for.
"""

from __future__ import annotations

import importlib
import logging
import os
from collections.abc import Sequence
from contextlib import nullcontext, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import warpffrf
from warpffrf.cli_errors import know_options, one_line_errors
from warpffrf.cli_examples import add_example_commands
from warpffrf.cli_pictures import add_picture_commands
from warpffrf.cli_results import add_result_commands
from warpffrf.cli_study import study_app
from warpffrf.cli_sweep import add_sweep_command, add_sweep_plot_command
from warpffrf.demos import DEMOS

# Set before anything loads NumPy: on the many small matrices of a reduction the threads of a BLAS wait for each other
# (on two busy cores 16 times longer than one thread alone).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

SCENE = typer.Argument(metavar="SCENE", help="Scene file, .toml; what may stand in it: warpffrf scene-file.")
EQUILIBRIUM = "equilibrium"  # the state that modes are about if nothing else is said

log = logging.getLogger("warpffrf")

app = typer.Typer(
    name="warpffrf",
    help="Simulate machines of flexible bodies that touch. Start with: warpffrf demo two-rollers, or warpffrf example",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
demo = typer.Typer(
    help="Run a complete example, print its figures beside what they must be, and write its results to a folder.",
    rich_markup_mode=None,
)
app.add_typer(demo, name="demo")


@demo.callback(invoke_without_command=True)
def list_demos(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())


class _State:
    """Options of the main command that the others read."""

    quiet = False
    pairs: Literal["folded", "all"] = "folded"  # of reports


def _version(wanted: bool) -> None:
    if wanted:
        print(f"warpffrf {warpffrf.__version__}")
        raise typer.Exit


@app.callback()
def options(
    context: typer.Context,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose",
            "-v",
            help="Say more: the scene, times, where faults are, each of alike contacts.",
        ),
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print neither progress nor reports, only warnings and errors.")
    ] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    _State.quiet, _State.pairs = quiet, "all" if verbose else "folded"
    know_options(context)
    from warpffrf.model.speech import Lines, notes

    for old in [h for h in log.handlers if isinstance(h, Lines)]:
        log.removeHandler(old)
    handler = Lines("[%(relativeCreated)7.0f ms] %(message)s" if verbose else "%(message)s")
    handler.addFilter(lambda record: record.name != notes.name)  # the report has them
    log.addHandler(handler)
    log.setLevel(logging.DEBUG if verbose else logging.WARNING if quiet else logging.INFO)


app.add_typer(study_app(lambda: _State.quiet), name="study")


def _add_demo(module: str, about: str) -> None:
    """A command `demo NAME` that runs `warpffrf.demos.MODULE.main`."""

    def command(
        out: Annotated[Path, typer.Option("--out", help="Folder for the results; made if missing.")] = Path(
            f"out/{module}"
        ),
        quick: Annotated[bool, typer.Option("--quick", help="A coarser, shorter version.")] = False,
    ) -> None:
        with one_line_errors():
            run: Any = importlib.import_module(f"warpffrf.demos.{module}")
            with redirect_stdout(StringIO()) if _State.quiet else nullcontext():
                code = run.main(out, quick=quick, progress=not _State.quiet)
        raise typer.Exit(code)

    files = f"{module}.h5 (results), {module}.rrd (open it with: rerun FILE), {module}.png and summary.json"
    demo.command(module.replace("_", "-"), help=f"{about}\n\nWrites {files}.", short_help=about)(command)


for _module, _about in DEMOS.items():
    _add_demo(_module, _about)


@app.command("run")
def run_scene_file(
    scene_file: Annotated[Path, SCENE],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="Another value for a parameter or a key, by its dotted name: --set upper.load=2000. Repeat for more.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the results; left out: out/NAME of the file NAME.toml.")
    ] = None,
    anywhere: Annotated[
        bool, typer.Option("--anywhere", help="Let the file name results and recordings outside of the folder, too.")
    ] = False,
    check: Annotated[bool, typer.Option("--check", help="Build the scene and describe it, but do not run it.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the files of an earlier run.")] = False,
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Go on where a run into the same folder was stopped, or read it if it ended."),
    ] = False,
) -> None:
    """Run the scene of a TOML file: bodies, joints, drives, forces, contacts, and how to simulate them.

    Writes the results (.h5), the recording where the file asks for one (.rrd, open it with: rerun FILE), and the scene
    as it was run (.toml) into a folder, and prints a report. Exit code 1 where a solver gave up or a file could not be
    written; results are kept. Ctrl-C ends a run early and keeps what there is; --resume goes on.

    Example: warpffrf run press.toml --set upper.load=2000 --set simulate.step=5e-5 --out out/press
    """
    with one_line_errors():
        from warpffrf.scene_file import load_scene, run_scene

        if check:
            print(load_scene(scene_file, settings=settings or ()).scene.check())
            return
        results = run_scene(
            scene_file, settings=settings or (), out=out, anywhere=anywhere, progress=not _State.quiet,
            overwrite=overwrite, resume=resume,
        )  # fmt: skip
        for call, result in results.items():
            if not _State.quiet:
                print(f"{call}\n{result.report(pairs=_State.pairs)}")
        if any(result.status != "completed" or result.unwritten for result in results.values()):
            raise typer.Exit(1)


@app.command("modes")
def modes_of_scene_file(
    scene_file: Annotated[Path, SCENE],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Another value for a parameter or a key, as in run. Repeat for more."
        ),
    ] = None,
    count: Annotated[int, typer.Option(help="How many modes, from the lowest on.")] = 20,
    about: Annotated[
        str,
        typer.Option(
            metavar="STATE",
            help="equilibrium, initial, or a results file (.h5) of this scene, whose last state is meant.",
        ),
    ] = EQUILIBRIUM,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PNG", help="Also draw their shapes here: .png, .pdf or .svg.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
) -> None:
    """List frequencies, damping and moving bodies of the lowest modes of a machine, joints and contacts included.

    Example: warpffrf modes press.toml --count 6 --about out/press/press.h5
    """
    with one_line_errors():
        from warpffrf.scene_file import load_scene

        scene = load_scene(scene_file, settings=settings or ()).scene
        modes = warpffrf.eigenmodes(scene, count, about=_state(about), progress=not _State.quiet)
        print(modes.report())
        if out is not None:
            from warpffrf.output.plots.picture import write_picture

            print(f"drawn to {write_picture(modes.plot_shapes(count), out, 'modes', overwrite=overwrite)}")


@app.command("campbell")
def campbell_of_scene_file(
    scene_file: Annotated[Path, SCENE],
    speed: Annotated[
        str, typer.Argument(metavar="NAME", help="The key that the speed [rad/s] is put into, as --set of run has it.")
    ],
    last: Annotated[float, typer.Argument(metavar="LAST", help="The largest speed, rad/s.")],
    first: Annotated[float, typer.Option(metavar="SPEED", help="The smallest speed, rad/s.")] = 0.0,
    steps: Annotated[int, typer.Option(help="How many steps from the smallest to the largest.")] = 12,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Another value for a parameter or a key. Repeat for more."),
    ] = None,
    count: Annotated[int, typer.Option(help="How many modes at each speed, from the lowest on.")] = 12,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PNG", help="Also draw the diagram here: .png, .pdf or .svg.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
) -> None:
    """List natural frequencies about the initial state of a machine against the speed of its rotation.

    Example: warpffrf campbell rotor.toml speed 600 --out campbell.png
    """
    with one_line_errors():
        from warpffrf.output.plots.picture import write_drawing
        from warpffrf.scene_file import load_scene

        if steps < 1:
            raise warpffrf.InputError(f"--steps is {steps}; it must be at least 1")

        def build(rate: float) -> warpffrf.Scene:
            return load_scene(scene_file, settings=[*(settings or ()), f"{speed}={rate!r}"]).scene

        speeds = [first + (last - first) * n / steps for n in range(steps + 1)]
        found = warpffrf.campbell(build, speeds, count, progress=not _State.quiet)
        print(found.report())
        if out is not None:
            print(f"drawn to {write_drawing(found.plot, out, 'campbell', overwrite=overwrite)}")


def _state(about: str) -> Any:
    """What `--about` means to `eigenmodes`."""
    if about in (EQUILIBRIUM, "initial"):
        return None if about == EQUILIBRIUM else about
    if Path(about).suffix.lower() not in (".h5", ".hdf5"):
        raise warpffrf.InputError(f"--about is {about!r}; known: {EQUILIBRIUM}, initial, or a results file (.h5)")
    return warpffrf.Result.load(about)


@app.command("reduce")
def reduce_mesh(
    mesh_file: Annotated[
        Path,
        typer.Argument(metavar="MESH", help="Volume mesh: .msh, .vtu, .inp (Abaqus, CalculiX), .bdf (Nastran)."),
    ],
    length_unit: Annotated[
        str, typer.Option(metavar="UNIT", help="Unit of the lengths in the mesh file: m, cm, mm, um, in or ft.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write, for example roller.h5.")],
    youngs_modulus: Annotated[
        float | None, typer.Option(help="Young's modulus in Pa, for steel 210e9. Left out: the materials of the file.")
    ] = None,
    poisson_ratio: Annotated[float | None, typer.Option(help="Poisson's ratio, for steel 0.3.")] = None,
    density: Annotated[float | None, typer.Option(help="Density in kg/m3, for steel 7850.")] = None,
    part: Annotated[
        str | None,
        typer.Option(help="Which body of several: instance, part or group, or the number of a connected part from 0."),
    ] = None,
    interface: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SET",
            help="Named set of facets that a joint holds: as one rigid piece, SET, by its mean motion, SET=average, or "
            "node by node, SET=free. Repeat for more.",
        ),
    ] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SET", help="Named set of facets that touches others; a cylinder is fitted to it. Repeat for more."
        ),
    ] = None,
    max_frequency: Annotated[
        float | None, typer.Option(help="Keep vibration modes up to this frequency in Hz.")
    ] = None,
    basis: Annotated[
        str, typer.Option(help="free_free, craig_bampton, craig_chang, krylov, balanced or pod.")
    ] = "free_free",
    modes: Annotated[int | None, typer.Option(help="Keep at most this many vibration modes.")] = None,
    traction_spacing: Annotated[
        float | None, typer.Option(help="Spacing of the contact grid in m; left out: that of the mesh.")
    ] = None,
    half_width: Annotated[
        float | None,
        typer.Option(help="Instead of a spacing: expected half-width of the contact patch in m (force within 1 %)."),
    ] = None,
    stress: Annotated[
        list[str] | None,
        typer.Option(metavar="SET", help="Set of facets, skin or all, where stresses are wanted. Repeat for more."),
    ] = None,
    inertia_modes: Annotated[
        int | None,
        typer.Option(help="How many of the global modes, the lowest, get inertia terms; left out: all up to 60."),
    ] = None,
    stiffening: Annotated[
        bool,
        typer.Option(
            "--stiffening", help="Also what turning and loads on interfaces add to the stiffness of the modes."
        ),
    ] = False,
    membrane: Annotated[
        bool,
        typer.Option(
            "--membrane", help="As --stiffening, with the membrane energy of plates and frames that deflect far."
        ),
    ] = False,
    membrane_modes: Annotated[
        int | None, typer.Option(help="How many modes, the lowest, have membrane energy; left out: up to 20.")
    ] = None,
    centrifugal: Annotated[
        bool,
        typer.Option(
            "--centrifugal", help="Also modes for the static response to turning: for rotors, discs, rings and blades."
        ),
    ] = False,
    local_dynamics: Annotated[
        bool,
        typer.Option("--local-dynamics", help="Also the mass of the local modes, for runs that give them inertia."),
    ] = False,
    cache: Annotated[
        bool, typer.Option(help="Take an unchanged body from the cache instead of reducing again.")
    ] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a reduced body that is there.")] = False,
) -> None:
    """Turn a finite-element mesh into a reduced body that a simulation can use.

    Example: warpffrf reduce roller.msh --length-unit mm --youngs-modulus 210e9 --poisson-ratio 0.3 --density 7850
    --interface bore --contact rim --max-frequency 20e3 -o roller.h5

    The names of the sets in a mesh are listed by: warpffrf info MESH --length-unit mm
    """
    with one_line_errors():
        from warpffrf.model.output_paths import check_ending, checked_output_path, size_text

        check_ending(output, "--output", (".h5", ".hdf5"))
        target = checked_output_path(output, "--output", overwrite=overwrite)
        mesh = warpffrf.mesh.read(mesh_file, length_unit=length_unit, part=part_of(part))
        body = warpffrf.reduce(
            mesh,
            _material(mesh, youngs_modulus, poisson_ratio, density),
            interfaces={name: kind or "rigid" for name, _, kind in (entry.partition("=") for entry in interface or [])},
            contact=dict.fromkeys(contact or []),
            basis=basis,
            max_frequency=max_frequency,
            modes=modes,
            traction_spacing=traction_spacing,
            expected_half_width=half_width,
            stress={name: name for name in stress or []},
            inertia_modes=inertia_modes,
            stiffening="membrane" if membrane else stiffening,
            membrane_modes=membrane_modes,
            centrifugal=centrifugal,
            local_dynamics=local_dynamics,
            cache=cache,
            progress=not _State.quiet,
        )
        body.save(target, overwrite=overwrite)
        if not _State.quiet:
            print(body.info())
            print(f"written to {target}, {size_text(target.stat().st_size)}")


def part_of(text: str | None) -> int | str | None:
    """`--part`: a number is that of a connected part, anything else a name."""
    return int(text) if text is not None and text.isdecimal() else text


def _material(mesh: Any, E: float | None, nu: float | None, rho: float | None) -> Any:
    """The material of the options, all three of them, or those of the mesh's file."""
    given = [value for value in (E, nu, rho) if value is not None]
    if len(given) == 3:
        return warpffrf.Material(*given)
    if given:
        raise warpffrf.InputError("--youngs-modulus, --poisson-ratio and --density belong together; give all three")
    if not mesh.materials:
        raise warpffrf.InputError(
            f"mesh {mesh.name}: the file says no material; add --youngs-modulus, --poisson-ratio and --density"
        )
    return mesh.materials


@app.command("info")
def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Mesh, reduced body or results (.h5), sweep (folder).")],
    length_unit: Annotated[
        str | None,
        typer.Option(metavar="UNIT", help="For a mesh: unit of the lengths in the file: m, cm, mm, um, in or ft."),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option(help="For a mesh: which body of several: instance, part or group, or a number from 0."),
    ] = None,
    density: Annotated[
        float | None,
        typer.Option(help="For a mesh: density in kg/m3; left out: that of the file's materials, or steel."),
    ] = None,
    page: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also write a page here: a picture of a reduced body's quality, of a sweep .html with its pictures.",
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
) -> None:
    """Say what is in a file: size, mass, inertia, named sets, modes, or how a run or a sweep went."""
    with one_line_errors():
        from warpffrf.cli_info import describe_file

        print(
            describe_file(
                file,
                length_unit=length_unit,
                part=part_of(part),
                density=density,
                page=page,
                overwrite=overwrite,
                pairs=_State.pairs,
            )  # fmt: skip
        )


add_result_commands(app)
add_example_commands(app)
add_picture_commands(app, lambda: _State.quiet)
add_sweep_command(app, lambda: _State.quiet)
add_sweep_plot_command(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with `arguments` (None: those of the process); returns the exit code."""
    try:
        app(list(arguments) if arguments is not None else None, prog_name="warpffrf")
    except SystemExit as leaving:
        return leaving.code if isinstance(leaving.code, int) else 1
    return 0
