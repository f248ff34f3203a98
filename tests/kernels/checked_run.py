"""Runs scenes, or a sample, with kernels that check their indices: `python checked_run.py FOLDER LANES [SAMPLE INDEX]`.

The kernels are compiled in Warp's debug mode, whose array accesses check indices and end the process. Two things are
added to that, since Warp lets them pass: an index below zero, which counts from the end of the array, is refused; and
native functions, which reach arrays through pointers, get pointers that know their array (`checked_pointers.h`). Not
checked are arrays inside of native functions, and a pointer that leaves its line of an array for another one.

The step is not recorded as a graph: each kernel is launched by itself, once its name is in the file `launched`. The
endings of the scenes and the kernels that were launched are written to `found.json`.
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import re
import shutil
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import warp as wp
import warp._src.build as build  # where the headers of kernels are found is no public option

import warpffrf_kernels

POINTERS = Path(__file__).with_name("checked_pointers.h")
POINTER = re.compile(
    r"(?P<const>\bconst\s+)?\b(?P<type>double|int)\s*\*\s*(?P<fixed>const\s+)?(?:__restrict\s+)?(?=\w)"
)
NEXT_POINTER = re.compile(r",\s*\*\s*(?=\w+\s*=)")
DATA = re.compile(r"(?<![\w.])([A-Za-z_][\w.]*)\.data\b")
REGISTERS = re.compile(r"#ifdef __CUDACC__\n\s*typedef double part;(?P<one>[^\n]*)\n#else.*?#endif\n", re.DOTALL)
CAST = re.compile(r"\((?:const )?double\s*\*\)")
FROM_THE_END = re.compile(r">= -(i?arr\.shape\[\d\])")
SAMPLE_SIZE = 5


def check_everything(lanes: int) -> None:
    """Kernels that are compiled from here on check their indices."""
    folder = Path(os.environ["WARP_CACHE_PATH"]) / f"headers_{wp.config.version}"
    native = Path(build.warp_home) / "native"
    shutil.copytree(native, folder / "native", ignore=shutil.ignore_patterns("*.cpp", "*.cu"), dirs_exist_ok=True)
    text, count = FROM_THE_END.subn(r">= 0 * \1", (native / "array.h").read_text())
    assert count, "Warp checks indices in other words; see array.h"
    (folder / "native" / "array.h").write_text(text)
    build.warp_home = str(folder)
    wp.config.mode = "debug"
    wp.config.enable_cpu_blocks = lanes > 1
    told_apart = zlib.crc32(POINTERS.read_bytes() + text.encode())  # headers are no part of what Warp's cache looks at
    wp.config.cpu_compiler_flags = f"{wp.config.cpu_compiler_flags} -include {POINTERS} -DCHECKED={told_apart}"


def check_pointers(module: Any) -> None:
    """Native functions of a module run through arrays by pointers that check."""
    for name, function in vars(module).items():
        snippet = getattr(function, "native_snippet", None)
        if snippet and "checked::" not in snippet:
            function.native_snippet = with_checked_pointers(name, snippet)


def with_checked_pointers(name: str, snippet: str) -> str:
    text = re.sub(r"//[^\n]*", "", snippet)
    if REGISTERS.search(text):  # by single numbers, as on a GPU
        text = CAST.sub("", re.sub(r"\bpart\b", "double", REGISTERS.sub(r"\g<one>\n", text)))
    text = DATA.sub(rf'checked::data(\1, "{name}: \1", 0)', text)
    text = POINTER.sub(lambda m: f"{m['fixed'] or ''}checked::Pointer<{m['const'] or ''}{m['type']}> ", text)
    return NEXT_POINTER.sub(", ", text)


def watch_launches(folder: Path) -> set[str]:
    """Kernels that have been launched by now, each named in a file before it is."""
    from warpffrf.online import engine
    from warpffrf.online.step import graph, launches

    found: set[str] = set()
    file = os.open(folder / "launched", os.O_RDWR | os.O_CREAT)
    go = launches.Launch.go

    def announced(self: Any, *arguments: Any) -> None:
        found.add(self.label)
        os.pwrite(file, self.label.ljust(80).encode(), 0)
        go(self, *arguments)

    setattr(launches.Launch, "go", announced)  # noqa: B010
    setattr(engine, "StepGraph", graph.LaunchByLaunch)  # noqa: B010
    setattr(graph, "load", lambda *_, **__: None)  # noqa: B010, what is launched is compiled then
    return found


def run_sample(name: str, at: int) -> np.ndarray:
    """What a sample kernel leaves in an array of zeros, given the index `at`."""
    import sample_bounds as samples

    check_pointers(samples)
    x = wp.zeros((1, SAMPLE_SIZE) if name == "write_line" else SAMPLE_SIZE, dtype=wp.float64, device="cpu")
    inputs: list[Any] = [x, at]
    if name == "read_natively":
        held = samples.Held()
        held.x = wp.ones(SAMPLE_SIZE, dtype=wp.float64, device="cpu")
        inputs = [wp.array([held], dtype=samples.Held, device="cpu"), *inputs]
    wp.launch_tiled(getattr(samples, name), dim=(1,), inputs=inputs, block_dim=64, device="cpu")
    return x.numpy().ravel()


def main() -> None:
    folder, lanes = Path(sys.argv[1]), int(sys.argv[2])
    check_everything(lanes)
    if len(sys.argv) > 3:
        print(json.dumps(run_sample(sys.argv[3], int(sys.argv[4])).tolist()))
        return
    for found in pkgutil.walk_packages(warpffrf_kernels.__path__, "warpffrf_kernels."):
        check_pointers(importlib.import_module(found.name))
    launched = watch_launches(folder)
    from small_scenes import CASES

    endings = {}
    for name, case in CASES.items():
        (folder / "scene").write_text(name)
        endings[name] = case.how(case)
    (folder / "found.json").write_text(json.dumps({"endings": endings, "launched": sorted(launched)}))


if __name__ == "__main__":
    main()
