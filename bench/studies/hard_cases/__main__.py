"""The command: `python -m studies.hard_cases [--out DIR]`, half an hour for all cases, on a quiet machine."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.hard_cases import stability


def main(arguments: list[str] | None = None) -> None:
    """Run the cases and write page, table and map. A suite that was stopped continues in its folder."""
    parser = argparse.ArgumentParser(prog="python -m studies.hard_cases", description=main.__doc__)
    parser.add_argument("--case", action="append", help="a case by name; repeat for more, all if left out")
    parser.add_argument("--quick", action="store_true", help="some of the cases, at two steps each")
    parser.add_argument("--out", type=Path, default=Path("docs/stability"), help="the folder, made if missing")
    parser.add_argument("--overwrite", action="store_true", help="begin anew")
    given = parser.parse_args(arguments)
    print(stability(given.out, cases=given.case, quick=given.quick, overwrite=given.overwrite).report())


if __name__ == "__main__":
    main()
