"""`python -m studies.accuracy [FOLDER] [NAME ...]`"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from studies.accuracy.machines import MACHINES
from studies.accuracy.measured import measure, page
from warpffrf.model.errors import unknown_name

FOLDER, PAGE = "docs/studies", "accuracy.md"


def main() -> None:
    """Write the page, of the machines that are named, or all."""
    arguments = sys.argv[1:]
    folder = Path(arguments[0] if arguments else FOLDER)
    folder.mkdir(parents=True, exist_ok=True)
    names = arguments[1:] or list(MACHINES)
    for name in names:
        if name not in MACHINES:
            raise unknown_name("accuracy_studies: machine", name, MACHINES)
    found = []
    for number, name in enumerate(names, 1):
        begin = time.perf_counter()
        found.append(measure(MACHINES[name]))
        print(f"{number} of {len(names)}, {name}: {time.perf_counter() - begin:.0f} s", flush=True)
    text = page(found)
    (folder / PAGE).write_text(text, encoding="utf-8")
    print(folder / PAGE)


if __name__ == "__main__":
    main()
