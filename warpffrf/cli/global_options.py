"""Options of the main command, which the subcommands read."""

from __future__ import annotations

from typing import Literal


class Asked:
    """Options before the name of a subcommand."""

    quiet = False  # print neither progress nor reports
    pairs: Literal["folded", "all"] = "folded"  # of reports
