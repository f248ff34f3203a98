"""Loading and running of scene files."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.scene_file.build import RUNS, TITLE, Builder
from warpffrf.scene_file.document import document_of, read_document, to_toml
from warpffrf.scene_file.object_cache import Kept
from warpffrf.scene_file.source import Source

log = logging.getLogger("warpffrf")

DOCUMENT_SIGN = "# the scene as warpffrf ran it\n"


@dataclass(frozen=True)
class LoadedScene:
    """The contents of a scene file.

    scene: the `Scene`. equilibrium, static, simulate: the arguments of these calls, None without such a
    table. title: of the file, or its name. made: section -> name -> object ("reduced_bodies", "bodies", "joints", ...).
    document: all values of the file, with parameters, settings and includes substituted. files: input files by the
    keys in the document that name them.
    """

    scene: Any
    equilibrium: dict[str, Any] | None
    static: dict[str, Any] | None
    simulate: dict[str, Any] | None
    title: str
    made: Mapping[str, Mapping[str, Any]]
    document: Mapping[str, Any]
    files: Mapping[tuple[str | int, ...], Path]
    running: Callable[[str], AbstractContextManager[None]]  # prefixes errors of a call with the line

    def to_toml(self) -> str:
        """The document as one TOML text, without includes and parameters."""
        return to_toml(dict(self.document))


@named_arguments
def load_scene(path: str | os.PathLike[str], *, settings: Sequence[str] = ()) -> LoadedScene:
    """Load the scene in the TOML file at `path`. settings: "name=value" as of `--set`. Raises `InputError`, with file
    and line, for an invalid entry."""
    file = Path(path).expanduser()
    if not file.is_file():
        raise InputError(f"scene file {str(path)!r} does not exist; check the path")
    return scene_of_document(read_document(file, settings), file.stem)


def scene_of(text: str, folder: str | os.PathLike[str] = ".", *, settings: Sequence[str] = ()) -> LoadedScene:
    """`load_scene` of a text; its relative paths start from `folder`."""
    return scene_of_document(document_of(text, Path(folder), settings), "scene")


def scene_of_document(source: Source, name: str, kept: Kept | None = None) -> LoadedScene:
    """The scene of a document with its parameters substituted. kept: meshes and reduced bodies of earlier scenes,
    reused where they are unchanged. name: the title if the document has none."""
    builder = Builder(source, kept)
    scene = builder.build()
    runs = {section: builder.run_arguments(section) for section in RUNS}
    return LoadedScene(
        scene,
        **runs,
        title=source.values.get(TITLE, name),
        made=builder.made,
        document=builder.document(),
        files=dict(builder.files),
        running=builder.running,
    )


@named_arguments
def run_scene(
    path: str | os.PathLike[str],
    *,
    settings: Sequence[str] = (),
    out: str | os.PathLike[str] | None = None,
    anywhere: bool = False,
    progress: bool = True,
    overwrite: bool = False,
    resume: bool = False,
) -> dict[str, Any]:
    """Run the scene file at `path`: its `equilibrium`, `static` and `simulate`; returns {call: Result}.

    Files go into the folder `out`, by default out/NAME of the file NAME.toml: what `results` and `record` name, the
    results of a call without `results` as NAME.h5 (NAME_equilibrium.h5, NAME_static.h5), and the document as it
    was run, NAME.toml. A name that leads out of the folder is refused, with InputError, unless `anywhere`. settings:
    "name=value" as of `--set`. progress: report the progress on stderr. overwrite: replace the files of an earlier run;
    resume: continue where it was stopped, or read it if it ended, see `simulate`.

    With the file pendulum.toml of docs/scene_file.md:

    >>> runs = wf.run_scene("pendulum.toml", out="pendulum", progress=False)
    >>> runs["simulate"].status
    'completed'
    """
    from warpffrf.output.simulate import equilibrium, simulate, static

    name = Path(path).stem
    loaded = load_scene(path, settings=settings)
    if all(getattr(loaded, section) is None for section in RUNS):
        raise InputError(
            f"{Path(path).name}: contains nothing to run; add the table [simulate], [static] or [equilibrium]"
        )
    folder = Path("out") / name if out is None else Path(out).expanduser()
    text = folder / f"{name}.toml"
    document = DOCUMENT_SIGN + loaded.to_toml()
    if text.resolve() != Path(path).expanduser().resolve():
        _write_document(text, document, overwrite, resume)
    if log.isEnabledFor(logging.DEBUG):
        log.debug("%s", loaded.scene.check())
    found: dict[str, Any] = {}
    again = {"progress": progress, "overwrite": overwrite or resume}  # an equilibrium is cheap and is recomputed
    further = {"progress": progress, "overwrite": overwrite, "resume": resume}
    calls: Any = (("equilibrium", equilibrium, again), ("static", static, further), ("simulate", simulate, further))
    for section, call, options in calls:
        arguments = getattr(loaded, section)
        if arguments is not None:
            default = f"{name}.h5" if section == "simulate" else f"{name}_{section}.h5"
            with loaded.running(section):
                found[section] = call(loaded.scene, **_in_folder(arguments, folder, default, anywhere), **options)
    return found


def _write_document(file: Path, text: str, overwrite: bool, resume: bool) -> None:
    """Write the document as run. A file that this function did not write is never replaced."""
    from warpffrf.model.files.paths import checked_output_path, written_whole

    there = file.read_bytes() if file.is_file() else None
    if there == text.encode():
        return
    if there is not None and not there.startswith(DOCUMENT_SIGN.encode()):
        raise InputError(f"--out: '{file}' is another scene, and is not replaced; choose another folder")
    if there is not None and resume and not overwrite:
        raise InputError(
            f"--resume: '{file}' is the scene of the earlier run and differs from the one to be run; resume with the "
            "same file and the same --set, or restart with --overwrite"
        )
    with written_whole(checked_output_path(file, "--out", overwrite=overwrite)) as partial:
        partial.write_text(text, encoding="utf-8")


def _in_folder(arguments: dict[str, Any], folder: Path, results: str, anywhere: bool) -> dict[str, Any]:
    """The arguments with output files in `folder`. Raises `InputError` for files outside, unless `anywhere`."""
    from warpffrf.model.files.paths import refuse_nul

    files = {"results": results, **arguments}
    placed = {key: folder / files[key] for key in ("results", "record") if key in files}
    for key, file in placed.items():
        refuse_nul(file, key)
        if not anywhere and not file.resolve().is_relative_to(folder.resolve()):
            raise InputError(
                f"{key} {str(files[key])!r} is outside the output folder '{folder}'; give a name in it, or use "
                "--anywhere (anywhere=True)"
            )
    return {**arguments, **placed}
