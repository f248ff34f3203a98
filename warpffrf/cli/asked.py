"""What the main command was asked for, which the others read."""

from __future__ import annotations

from typing import Literal


class Asked:
    """Options that stand before the name of a command."""

    quiet = False  # neither progress nor reports
    pairs: Literal["folded", "all"] = "folded"  # of reports
