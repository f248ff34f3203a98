"""The command, see the package; some minutes for all studies, on a quiet machine."""

from __future__ import annotations

import argparse

from studies.speed_error_pages import STUDIES
from studies.speed_error_pages.page import write_index, write_study


def main(arguments: list[str] | None = None) -> None:
    """Make pages, one study after the other, and the index after each."""
    parser = argparse.ArgumentParser(prog="python -m studies.speed_error_pages", description="Speed against error.")
    parser.add_argument("folder", nargs="?", default="docs", help="where speed_error.md is written; docs if left out")
    parser.add_argument(
        "--study", action="append", choices=list(STUDIES), help="one study; repeat for more, all if left out"
    )
    parser.add_argument("--quick", action="store_true", help="coarser machines and fewer steps")
    given = parser.parse_args(arguments)
    for name in given.study or STUDIES:
        print(write_study(STUDIES[name], given.folder, quick=given.quick))
        write_index(STUDIES, given.folder)


if __name__ == "__main__":
    main()
