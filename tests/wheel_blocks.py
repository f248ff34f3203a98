"""Runs all that README.md and docs/*.md print for their readers, as printed, with an installed wheel in another folder.

Every section of a page has a folder of its own, in which its blocks of Python and its commands run in the order of the
page. All share one cache of kernels, cold at first: the first section runs alone, for it compiles what most need, the
others two at a time. Modules and commands that pages name within a line are looked up, not run.
Run: python tests/wheel_blocks.py VENV FOLDER
"""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from printed import Printed, printed

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
# Run in another way than printed, in a way that the page documents too: for its time.
INSTEAD = {"warpffrf demo two-rollers": "warpffrf demo two-rollers --quick"}
# What pages print and this does not run.
LEFT_OUT = {
    "make ...": "for a checkout, not for a wheel; `make test`, `make demo` and `make bench` are run there",
    "python -m warpffrf. ...": "studies of minutes to an hour, which write pages of the repository: only looked up",
    "rerun FILE.rrd": "opens a window",
    "warpffrf view ...": "opens a window, or serves a page until it is stopped",
    "warpffrf picture FILE.rrd ...": "is drawn by the viewer, on a virtual screen that a machine need not have",
    "docs/two_rollers.md": "its one command is that of README.md",
}
ELSEWHERE = {("two_rollers.md", "warpffrf demo two-rollers")}
# Pages whose blocks of Python go on from one to the next, over all sections.
STORIES = {"coupling.md", "how_do_i.md", "stepping.md", "sweeps.md"}
MODULE = re.compile(r"python\s+-m\s+(warpffrf[\w.]+)")
INLINE = re.compile(r"`warpffrf ([a-z][a-z-]*(?: [a-z][a-z-]+)?)[^`]*`")
WORKERS = 2
LONGEST = 1800  # s, of one block: none takes two minutes on a quiet machine, all may stand in line on a busy one
SHOWN = 3000  # characters of what a block that failed has said


def environment(venv: Path, folder: Path) -> dict[str, str]:
    """That of a user who has installed the wheel and nothing of the checkout; caches are in `folder`."""
    kept = {name: os.environ[name] for name in ("HOME", "LANG", "OPENBLAS_NUM_THREADS") if name in os.environ}
    path = os.pathsep.join([str(venv / "bin"), os.environ.get("PATH", "")])
    caches = {"WARP_CACHE_PATH": str(folder / "kernels"), "XDG_CACHE_HOME": str(folder / "cache")}
    return {**kept, **caches, "PATH": path, "MPLBACKEND": "agg", "COLUMNS": "120"}


def arguments(item: Printed, venv: Path, folder: Path) -> list[str]:
    """How the item is run in `folder`."""
    if item.is_python:
        script = folder / f"block_{item.line}.py"
        script.write_text(item.text, encoding="utf-8")
        return [str(venv / "bin" / "python"), script.name]
    text = INSTEAD.get(item.text, item.text)
    return [str(venv / "bin" / "warpffrf"), *Printed(False, text, item.line).words[1:]]


@dataclass(frozen=True)
class Section:
    """What a section of a page prints."""

    page: Path
    heading: str
    items: list[Printed]


def sections() -> list[Section]:
    """All sections that print something to be run."""
    found: dict[tuple[Path, str], list[Printed]] = {}
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for item in printed(text):
            before = re.findall(r"^## (.*)$", "\n".join(text.splitlines()[: item.line]), re.MULTILINE)
            heading = before[-1] if before and page.name not in STORIES else ""
            if not needs_a_screen(item) and (page.name, item.text) not in ELSEWHERE:
                found.setdefault((page, heading), []).append(item)
    return [
        Section(page, heading, told_at_once(items) if page.name in STORIES else items)
        for (page, heading), items in found.items()
    ]


def needs_a_screen(item: Printed) -> bool:
    """Whether a command shows something in a window, or has it drawn there."""
    if item.is_python:
        return False
    return item.words[1] == "view" or (item.words[1] == "picture" and item.words[2].endswith(".rrd"))


def told_at_once(items: list[Printed]) -> list[Printed]:
    """Blocks of Python that go on from one to the next as one, in the place of the first; commands where they are."""
    blocks = [item for item in items if item.is_python]
    whole = Printed(True, "\n".join(block.text for block in blocks), blocks[0].line)
    return [whole if item is blocks[0] else item for item in items if item is blocks[0] or not item.is_python]


def run_section(section: Section, venv: Path, folder: Path) -> list[str]:
    """Run what a section prints, in a folder of its own; returns what failed."""
    page, failed = section.page, []
    here = folder / page.stem / re.sub(r"\W+", "_", section.heading or "top").lower()
    here.mkdir(parents=True, exist_ok=True)
    for item in section.items:
        words, begun = arguments(item, venv, here), time.perf_counter()
        process = subprocess.Popen(
            words, cwd=here, env=environment(venv, folder), text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        try:
            said, _ = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            process.kill()
            said = f"{process.communicate()[0]}\nnot ready after {LONGEST} s"
        label = "python" if item.is_python else item.text if item.text not in INSTEAD else f"{INSTEAD[item.text]} (*)"
        place = f"{page.relative_to(ROOT)}:{item.line}"
        print(f"{time.perf_counter() - begun:6.1f} s  {process.returncode}  {place:24} {label[:80]}", flush=True)
        if process.returncode:
            failed.append(f"{place}: exit code {process.returncode}\n{said[-SHOWN:]}")
    return failed


def look_up(venv: Path, folder: Path) -> list[str]:
    """Modules and commands that pages name within a line and the wheel does not have."""
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    modules, names = sorted(set(MODULE.findall(text))), sorted(set(INLINE.findall(text)))
    code = f"""
import sys
from importlib.util import find_spec
import typer
from warpffrf.cli import app
missing = [f"python -m {{m}}" for m in {modules!r} if find_spec(m) is None]
group = typer.main.get_command(app)
for name in {names!r}:
    known, (first, *rest) = group.commands, name.split()
    if first not in known or (rest and hasattr(known[first], "commands") and rest[0] not in known[first].commands):
        missing.append(f"warpffrf {{name}}")
print("\\n".join(missing), end="")
"""
    done = subprocess.run(
        [str(venv / "bin" / "python"), "-c", code],
        cwd=folder,
        env=environment(venv, folder),
        capture_output=True,
        text=True,
    )
    if done.returncode:
        return [done.stderr[-SHOWN:]]
    print(f"looked up: {len(modules)} modules, {len(names)} commands")
    return [f"the pages name `{line}`, which the wheel does not have" for line in done.stdout.splitlines()]


def main() -> int:
    venv, folder = (Path(word).resolve() for word in sys.argv[1:3])
    folder.mkdir(parents=True, exist_ok=True)
    begun, failed = time.perf_counter(), look_up(venv, folder)
    first, *rest = sections()
    failed += run_section(first, venv, folder)
    with ThreadPoolExecutor(WORKERS) as pool:
        for found in pool.map(lambda section: run_section(section, venv, folder), rest):
            failed += found
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"{time.perf_counter() - begun:.0f} s in all, {spent.ru_utime + spent.ru_stime:.0f} s of the processors;",
        end=" ",
    )
    print("(*) the quick form that the page documents. Not run:")
    print("\n".join(f"  {what}: {why}" for what, why in LEFT_OUT.items()))
    print("\n".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
