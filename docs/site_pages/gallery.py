"""The gallery: a page of each demo with its docstring, its picture and its script, and cards with the machines."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

from site_pages.api import write

INDEX = """\
# Gallery

Each demo is one script of one or two hundred lines; what they print, and what it is compared with, is on
[another page](../../demos.md). `warpffrf demo NAME` runs one, `--quick` in a shorter version.

::::{grid} 1 2 3 3
:gutter: 3

"""
CARD = """\
:::{{grid-item-card}} {title}
:img-top: ../../{picture}
:img-alt: {title}
:link: {stem}
:link-type: doc
{first}
:::

"""
PAGE = """\
# {title}

{text}

![{title}](../../{stem}.png)

What it prints, and the references: [{name}](../../demos.md#{name}). The script, [{stem}.py](../../../demos/{stem}.py),
runs as `warpffrf demo {name}`:

```{{literalinclude}} ../../../demos/{stem}.py
:language: python
```
"""


def generate(app: Any) -> None:
    """Handler of builder-inited."""
    root = Path(app.srcdir)
    folder = root / "docs" / "made" / "gallery"
    index, stems = INDEX, []
    for script in sorted(root.glob("demos/[a-z]*.py")):
        text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
        stem, title = script.stem, script.stem.replace("_", " ").capitalize()
        first = " ".join(text.split("\n\n")[0].split())
        write(folder / f"{stem}.md", PAGE.format(title=title, text=text, stem=stem, name=stem.replace("_", "-")))
        machine = f"machines/{stem}.png"  # not of demos without bodies
        picture = machine if (root / "docs" / machine).is_file() else f"{stem}.png"
        index += CARD.format(title=title, stem=stem, first=first, picture=picture)
        stems.append(stem)
    write(folder / "index.md", index + "::::\n\n```{toctree}\n:hidden:\n\n" + "\n".join(stems) + "\n```\n")


def setup(app: Any) -> dict[str, Any]:
    app.connect("builder-inited", generate)
    return {"parallel_read_safe": True}
