"""The command: `python -m studies NAME [CASE ...] [--out DIR]`; `python -m studies --list` lists the names."""

from __future__ import annotations

import argparse

from studies.page import listed, make


def main(arguments: list[str] | None = None) -> None:
    """Make the page of a study."""
    parser = argparse.ArgumentParser(prog="python -m studies", description=main.__doc__)
    parser.add_argument("name", nargs="?", help="of the study; all are listed if left out")
    parser.add_argument("case", nargs="*", help="cases of the study; all if left out")
    parser.add_argument("--out", default="docs", help="folder of the documentation; docs if left out")
    parser.add_argument("--quick", action="store_true", help="speed_error, stability: fewer or coarser cases")
    parser.add_argument("--list", action="store_true", help="list the studies")
    given = parser.parse_args(arguments)
    if given.list or given.name is None:
        print(listed())
        return
    for path in make(given.name, given.out, given.case, quick=given.quick):
        print(path)


if __name__ == "__main__":
    main()
