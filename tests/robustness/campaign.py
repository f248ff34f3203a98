"""Damage files of all formats, read each in a process of its own with limits, and count what becomes of it.

    python tests/robustness/campaign.py --count 5000 --seed 1 --keep out/damaged

Classes: `refused` (an InputError of one line with the file's name), `unnamed` (without it), `same` numbers, `different`
ones, `raw` (another exception), `hang`, `crash`, `memory` (the bound is passed). Of `different` those of formats with a
checksum are faults; text with another digit is mostly another sound file. Prints a table, and with --json writes the
counts and faults. The exit status is 1 where there are faults. Needs fork and resource limits: Linux.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent))

from formats import FORMATS, Format

from warpffrf.model.errors import InputError

SECONDS = 10  # a read
MORE_MEMORY = 1 << 30  # bytes of address space, above what the process has
MORE_RESIDENT = 512  # MiB in use, above what the process has
CLASSES = ("refused", "unnamed", "same", "different", "raw", "hang", "crash", "memory")
FAULTS = ("unnamed", "raw", "hang", "crash", "memory")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=5000, help="mutations, over all formats")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", help="formats")
    parser.add_argument("--show", nargs="*", default=(), help="classes of which every file is listed")
    parser.add_argument("--keep", type=Path, help="a folder for the files that are at fault")
    parser.add_argument("--json", type=Path, help="where to write counts and faults")
    options = parser.parse_args()
    chosen = {name: FORMATS[name] for name in options.only or FORMATS}
    counts: dict[str, Counter[str]] = {}
    faults: list[list[Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, form) in enumerate(chosen.items()):
            share = (options.count * (number + 1)) // len(chosen) - (options.count * number) // len(chosen)
            more = {"seed": options.seed, "faults": faults, "keep": options.keep, "shown": options.show}
            counts[name] = attack(Path(folder), name, form, share, **more)
            print(f"{name:20}" + "".join(f"{word} {counts[name][word]:<6}" for word in CLASSES if counts[name][word]))
            sys.stdout.flush()
    for fault in faults:
        print(*fault)
    if options.json:
        options.json.write_text(json.dumps({"counts": counts, "faults": faults}))
    return 1 if faults else 0


def attack(
    folder: Path,
    name: str,
    form: Format,
    count: int,
    *,
    seed: int = 1,
    faults: list[list[Any]],
    keep: Path | None = None,
    shown: Sequence[str] = (),
) -> Counter[str]:
    """Damage `count` copies of a sound file; what is at fault is added to `faults`, classes of `shown` are printed."""
    sound, path = folder / f"sound{form.suffix}", folder / f"damaged{form.suffix}"
    form.make(sound)
    shutil.copy(sound, path)
    expected = form.read(path)  # here: what has to be imported is imported once
    if form.read(path) != expected:
        raise AssertionError(f"{name} is not read the same twice")
    rng, counts = random.Random(f"{seed} {name}"), Counter()
    for number in range(count):
        shutil.copy(sound, path)
        what = form.damage(path, rng)
        if path.read_bytes() == sound.read_bytes():
            counts["same"] += 1
            continue
        found, message = classified(form, path, expected)
        counts[found] += 1
        if found in shown:
            print(f"{found} {name} {number}: {what}; {message}")
        if found in FAULTS or (found == "different" and form.exact):
            faults.append([found, name, number, what, message])
            if keep is not None:
                keep.mkdir(parents=True, exist_ok=True)
                label = "".join(c if c.isalnum() else "_" for c in name)
                shutil.copy(path, keep / f"{label}_{number}_{found}{form.suffix}")
    return counts


def classified(form: Format, path: Path, expected: str) -> tuple[str, str]:
    """The class of one file, and what was said."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reader)
        _child(form, path, expected, writer)
    os.close(writer)
    with os.fdopen(reader, "rb") as stream:
        answer = stream.read()
    status = os.waitpid(pid, 0)[1]
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return ("hang", "") if number == signal.SIGALRM else ("crash", signal.Signals(number).name)
    if not answer:
        return "crash", f"status {status}"
    found, message = json.loads(answer)
    return found, message


def _child(form: Format, path: Path, expected: str, writer: int) -> None:
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        bound = _address_space() + MORE_MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (bound, bound))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(SECONDS)
        answer = _read(form, path, expected)
        if (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024 > MORE_RESIDENT:
            answer = "memory", answer[1]
        os.write(writer, json.dumps(answer).encode()[:60000])
    finally:
        os._exit(0)


def _read(form: Format, path: Path, expected: str) -> tuple[str, str]:
    start = time.monotonic()
    try:
        found = form.read(path)
    except InputError as error:
        text = str(error)
        return ("refused" if path.name in text and "\n" not in text else "unnamed"), text[:300]
    except MemoryError as error:
        return "memory", repr(error)[:300]
    except BaseException as error:
        own = [f for f in traceback.extract_tb(error.__traceback__) if "warpffrf" in f.filename]
        place = f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""
        return "raw", f"{type(error).__name__}: {error} at {place}"[:300]
    return ("same" if found == expected else "different"), f"{time.monotonic() - start:.1f} s"


def _address_space() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * os.sysconf("SC_PAGESIZE")


if __name__ == "__main__":
    sys.exit(main())
