"""Example files: scenes as TOML, a deck of Abaqus, a mesh of Gmsh and one of VTK, each with commands that use it.

    import warpffrf as wf

    wf.examples.names()                            # ("beam", "machine", ...)
    wf.examples.copy("press", "folder")            # the files, ready to be changed
    wf.mesh.read(wf.examples.path("roller") / "roller.msh", length_unit="mm")

Each folder next to this file is one example; the first line of each of its files describes it. On the command line:
`warpffrf example` and `warpffrf example copy NAME`.
"""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = ["Example", "copy", "get", "names", "path"]


@dataclass(frozen=True)
class Example:
    """The files of one example.

    name: identifier; about: one sentence; files: their names, the main one first; commands: to be run in the folder of
    the files, in this order.
    """

    name: str
    about: str
    files: tuple[str, ...]
    commands: tuple[str, ...]


_EXAMPLES = (
    Example(
        "ball-bearing",
        "A deep-groove ball bearing with an oval outer raceway under radial load: which balls carry how much.",
        ("ball_bearing.toml",),
        ("warpffrf run ball_bearing.toml", "warpffrf run ball_bearing.toml --set ovality=0.0 --out round"),
    ),
    Example(
        "beam",
        "A beam of aluminium as a VTK mesh (.vtu), with its facets in the named sets hub and tip.",
        ("beam.vtu", "make_beam.py"),
        (
            "warpffrf info beam.vtu --length-unit mm",
            "warpffrf reduce beam.vtu --length-unit mm --youngs-modulus 70e9 --poisson-ratio 0.3 --density 2700 "
            "--interface hub --modes 20 --inertia-modes 20 --stiffening -o beam.h5",
        ),
    ),
    Example(
        "machine",
        "An Abaqus deck with two instances of a shoe of steel on cast iron: materials, sections, surfaces by name.",
        ("machine.inp", "make_machine.py"),
        (
            "warpffrf info machine.inp --length-unit mm --part shoe-1",
            "warpffrf reduce machine.inp --length-unit mm --part shoe-1 --interface foot=average --contact pad "
            "--half-width 0.5e-3 --max-frequency 50e3 -o shoe.h5",
        ),
    ),
    Example(
        "pendulum",
        "A rigid pendulum with a brake in its hinge: the smallest scene file that moves.",
        ("pendulum.toml",),
        ("warpffrf run pendulum.toml --set arm=0.4",),
    ),
    Example(
        "press",
        "Two flexible rollers pressed together; a second run rolls them on from there. Files that include one another.",
        ("press.toml", "roll.toml", "machine.toml", "steel.toml"),
        (
            "warpffrf run press.toml --check",
            "warpffrf run press.toml",
            "warpffrf run roll.toml",
            "warpffrf run press.toml --set upper.load=2000 --out light",
            "warpffrf compare out/press/press.h5 light/press.h5",
        ),
    ),
    Example(
        "roller",
        "A hollow roller as a Gmsh mesh (.msh) of quadratic tetrahedra, with the named sets rim, bore and ends.",
        ("roller.msh", "make_roller.py"),
        (
            "warpffrf info roller.msh --length-unit mm",
            "warpffrf reduce roller.msh --length-unit mm --youngs-modulus 210e9 --poisson-ratio 0.3 --density 7850 "
            "--interface bore --contact rim --max-frequency 20e3 -o roller.h5",
        ),
    ),
    Example(
        "rotor",
        "A rigid rotor held by a spring against tilting; its frequencies part with its speed: a Campbell diagram.",
        ("rotor.toml",),
        ("warpffrf campbell rotor.toml speed 600 --out campbell.png",),
    ),
    Example(
        "two-rollers",
        "The demo of that name as a scene file; the command has a coarser mesh and a shorter time.",
        ("two_rollers.toml",),
        (
            "warpffrf run two_rollers.toml --set meshes.roller.sectors=240 --set meshes.roller.axial=2 "
            "--set simulate.duration=2e-3",
        ),
    ),
)


@named_arguments
def names() -> tuple[str, ...]:
    """Names of the examples."""
    return tuple(example.name for example in _EXAMPLES)


@named_arguments
def get(name: str) -> Example:
    """The example called `name`. Raises `InputError` with the nearest name for an unknown one."""
    for example in _EXAMPLES:
        if example.name == name:
            return example
    raise unknown_name("example", name, names())


@named_arguments
def path(name: str) -> Path:
    """The folder of the installed package with the files of an example; read only.

    Raises `InputError` with the nearest name for an unknown one.
    """
    return Path(__file__).with_name(get(name).name.replace("-", "_"))


@named_arguments
def copy(name: str, folder: str | os.PathLike[str] = ".", *, overwrite: bool = False) -> tuple[Path, ...]:
    """Copy the files of an example into a folder, which is created if missing; returns their paths.

    overwrite: also replace files of these names that warpffrf wrote. A file with the same content is left unchanged.
    Raises `InputError` for an unknown example and, before anything is copied, for a file that exists.
    """
    source, target = path(name), Path(folder).expanduser()
    if target.exists() and not target.is_dir():
        raise InputError(f"example {name!r}: '{target}' is a file; give the name of a folder")
    missing = [file for file in get(name).files if not _same(source / file, target / file)]
    for file in missing:
        checked_output_path(target / file, f"example {name!r}", overwrite=overwrite)
    for file in missing:
        with written_whole(target / file) as partial:
            shutil.copyfile(source / file, partial)
    return tuple(target / file for file in get(name).files)


def _same(file: Path, other: Path) -> bool:
    return other.is_file() and other.read_bytes() == file.read_bytes()


def __dir__() -> list[str]:
    return __all__
