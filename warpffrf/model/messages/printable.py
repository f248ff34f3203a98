"""Text for a terminal: names in files may hold what a terminal obeys, such as colours and moves of the cursor."""

from __future__ import annotations

import unicodedata

HIDDEN = ("Cc", "Cf")  # categories of Unicode: controls, formats


def printable(text: str) -> str:
    """`text` for a terminal: control characters but line feeds and tabs, and those that change the direction of
    writing, which names in files may hold, as their escapes."""
    return "".join(
        c if c in "\n\t" or unicodedata.category(c) not in HIDDEN else c.encode("unicode_escape").decode() for c in text
    )
