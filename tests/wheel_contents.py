"""What a wheel and a source distribution hold and say, before anything of them is installed.

Run: python tests/wheel_contents.py WHEEL SDIST
"""

from __future__ import annotations

import re
import sys
import tarfile
import zipfile
from email.message import Message
from importlib.metadata import PathDistribution
from pathlib import Path

from warpffrf import examples

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LARGEST = 8_000_000  # bytes of the wheel: 3 MB, most of it meshes, and room
LINK = re.compile(r"\]\(([^)#\s]+)")


def faults_of_metadata(wheel: Path, name: str) -> list[str]:
    """What the metadata lacks, read as installers and indices read it."""
    distribution = PathDistribution(zipfile.Path(wheel, f"{name}.dist-info/"))  # type: ignore[arg-type]
    said: Message = distribution.metadata  # type: ignore[assignment]
    expected = {"Name": "warpffrf", "License-Expression": "Apache-2.0", "Description-Content-Type": "text/markdown"}
    faults = [f"{key} is {said[key]!r}, not {value!r}" for key, value in expected.items() if said[key] != value]
    for key in ("Version", "Summary", "Requires-Python", "License-File", "Keywords", "Author"):
        faults += [] if said[key] else [f"the metadata has no {key}"]
    if len(said["Summary"]) > 512 or "\n" in said["Summary"]:
        faults.append("the summary must be one line of at most 512 characters")
    if str(said.get_payload()).strip() != README.strip():
        faults.append("the long description is not README.md")
    (entry,) = distribution.entry_points
    faults += [] if (entry.group, entry.name) == ("console_scripts", "warpffrf") else [f"entry point {entry}"]
    return faults


def faults_of_readme(inside: set[str]) -> list[str]:
    """Where the page would break outside of a checkout: fences, links to what `inside`, of the sdist, does not have."""
    faults = ["a fence of README.md is left open"] if len(re.findall(r"^```", README, re.MULTILINE)) % 2 else []
    for target in sorted(set(LINK.findall(README))):
        if "://" not in target and not any(name == target or name.startswith(f"{target}/") for name in inside):
            faults.append(f"README.md links to {target}, which the source distribution does not have")
    if "source distribution" not in README:
        faults.append("README.md does not say where its links lead outside of a checkout")
    return faults


def demo_files() -> list[str]:
    """The scripts of demos/ and their data, relative to the checkout."""
    found = [*(ROOT / "demos").glob("*.py"), *(path for path in (ROOT / "demos" / "data").iterdir() if path.is_file())]
    return [path.relative_to(ROOT).as_posix() for path in found]


def faults_of_files(in_wheel: set[str], in_sdist: set[str], name: str) -> list[str]:
    """Files that are missing, and such as nobody wants."""
    wanted = {
        f"warpffrf/examples/{n.replace('-', '_')}/{file}" for n in examples.names() for file in examples.get(n).files
    }
    wanted |= {f"warpffrf/{file}" for file in demo_files()}
    wanted |= {"warpffrf/py.typed", "warpffrf_kernels/py.typed", "warpffrf/scene_file/scene_file.md"}
    wanted |= {f"{name}.dist-info/licenses/LICENSE"}
    faults = [f"the wheel lacks {file}" for file in sorted(wanted - in_wheel)]
    strange = {file.split("/")[0] for file in in_wheel} - {"warpffrf", "warpffrf_kernels", f"{name}.dist-info"}
    faults += [f"the wheel has {folder}" for folder in sorted(strange)]
    needed = {"pyproject.toml", "README.md", "LICENSE", "Makefile", "docs/scene_file.md", "tests/conftest.py"}
    faults += [f"the source distribution lacks {file}" for file in sorted(needed - in_sdist)]
    rubbish = [f for f in in_wheel | in_sdist if "__pycache__" in f or f.endswith((".pyc", ".h5", ".rrd"))]
    return faults + [f"{file} should not be there" for file in sorted(rubbish)]


def main() -> int:
    wheel, sdist = Path(sys.argv[1]), Path(sys.argv[2])
    name = "-".join(wheel.name.split("-")[:2])
    with zipfile.ZipFile(wheel) as archive, tarfile.open(sdist) as ball:
        in_wheel = set(archive.namelist())
        in_sdist = {member.name.split("/", 1)[1] for member in ball.getmembers() if member.isfile()}
    faults = faults_of_metadata(wheel, name) + faults_of_readme(in_sdist) + faults_of_files(in_wheel, in_sdist, name)
    if wheel.stat().st_size > LARGEST:
        faults.append(f"the wheel has {wheel.stat().st_size} bytes, more than {LARGEST}")
    print(f"{wheel.name}: {len(in_wheel)} files, {wheel.stat().st_size / 1e6:.1f} MB", end="; ")
    print(f"{sdist.name}: {len(in_sdist)} files, {sdist.stat().st_size / 1e6:.1f} MB")
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
