"""Kernel modules for a GPU, without one: NVRTC compiles each to PTX of compute capability 9.0.

`compiled.json` holds a stamp of each module as it compiled last: Warp's hash of its kernels and of all functions,
structs and constants that they use, with Warp's version. Modules whose stamp is another one have changed since, and are
compiled by every run of the tests; all of them are by `make verify`. Write the stamps anew after a change of kernels:

    python tests/conformance/cuda_modules.py
"""

from __future__ import annotations

import hashlib
import importlib
import json
import tempfile
from pathlib import Path

import warp as wp

import warpffrf_kernels
from warpffrf_kernels.core.scalars import BLOCK

ARCH = 90  # compute capability 9.0
FOLDER = Path(warpffrf_kernels.__file__).parent
STAMPS = Path(__file__).with_name("compiled.json")
MODULES = [
    ".".join(path.relative_to(FOLDER).with_suffix("").parts)
    for path in sorted(FOLDER.rglob("*.py"))
    if "\n@kernel" in path.read_text(encoding="utf-8")
]


def module_of(name: str) -> wp.Module:
    return wp.get_module(importlib.import_module(f"warpffrf_kernels.{name}").__name__)


def stamp(name: str) -> str:
    """Of a module as it is now."""
    content = module_of(name).get_module_hash(BLOCK) + wp.config.version.encode()
    return hashlib.sha256(content).hexdigest()[:16]


def changed() -> list[str]:
    """Modules that differ from those that compiled last."""
    kept = json.loads(STAMPS.read_text(encoding="utf-8"))
    return [name for name in MODULES if kept.get(name) != stamp(name)]


def compile_to_ptx(name: str, folder: Path) -> str:
    """The PTX of a module; needs no device. Raises what NVRTC reports."""
    module = module_of(name)
    assert module.kernels
    before = module.options["block_dim"]
    module.options["block_dim"] = BLOCK
    try:
        wp.compile_aot_module(module, arch=ARCH, module_dir=folder, use_ptx=True)
    finally:
        module.options["block_dim"] = before
    (ptx,) = folder.glob("*.ptx")
    return ptx.read_text(encoding="utf-8")


def main() -> None:
    for name in (names := changed()):
        print(name, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            compile_to_ptx(name, Path(folder))
    STAMPS.write_text(json.dumps({name: stamp(name) for name in MODULES}, indent=1) + "\n", encoding="utf-8")
    print(f"compiled: {len(names)} of {len(MODULES)} modules")


if __name__ == "__main__":
    main()
