"""HTML of self-contained pages: text, tables and pictures. Every text is escaped, and nothing is loaded from elsewhere.

Pages fit screens from 390 pixels and A4 paper, in light and dark colours as the reader's system asks. Pictures are
inline SVG in the colours of the page; collections, such as maps, are pixels within them.
"""

from __future__ import annotations

import hashlib
import io
import os
import re
from collections.abc import Callable, Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.reduced.body import library_versions

ENDINGS = (".html", ".htm")
DPI = 130  # of collections
PIXELS_PER_INCH = 96  # of CSS
MOST_COLUMNS = 4  # of a table that fits narrow screens
# colour of pictures, or meaning -> colour on a light page, on a dark page
COLORS = {
    "#ffffff": ("paper", "#fff", "#15191d"), "#000000": ("ink", "#1d2328", "#e3e7eb"),
    "#1b6ca8": ("blue", "#1b6ca8", "#62aee8"), "#d1495b": ("red", "#d1495b", "#ef7d8c"),
    "#2a9d6f": ("green", "#2a9d6f", "#52c495"),
    "dim": ("dim", "#59626c", "#9aa5b0"), "line": ("line", "#d8dde2", "#363e46"),
    "soft": ("soft", "#f3f5f7", "#1e2429"),
    "bad": ("bad", "#b3262f", "#ff8a8f"), "good": ("good", "#18703f", "#6fcf97"),
}  # fmt: skip
LIGHT, DARK = ("; ".join(f"--{own[0]}: {own[n]}" for own in COLORS.values()) for n in (1, 2))
STYLE = f"""
:root {{ color-scheme: light dark; {LIGHT}; }}
@media screen and (prefers-color-scheme: dark) {{ :root {{ {DARK}; }} }}
body {{ font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 1180px;
  margin: 1.5em auto; padding: 0 1em; overflow-wrap: anywhere; }}
h1 {{ font-size: 1.7em; line-height: 1.2; margin-bottom: 0.2em; }}
h2 {{ font-size: 1.25em; margin-top: 2em; border-bottom: 1px solid var(--line); }}
h3 {{ font-size: 1.05em; margin: 1.4em 0 0.3em; }}
nav a {{ margin-right: 1em; color: inherit; }} .bad {{ color: var(--bad); }} .good {{ color: var(--good); }}
table {{ border-collapse: collapse; margin: 0.5em 0; }} table + table {{ margin-top: 1.5em; }}
caption {{ text-align: left; color: var(--dim); padding-bottom: 0.2em; }}
th, td {{ text-align: left; vertical-align: top; padding: 0.2em 1em 0.2em 0; border-bottom: 1px solid var(--line);
  min-width: 5.8em; }}
thead th {{ color: var(--dim); font-weight: 600; }} tbody th {{ font-weight: 500; min-width: 6.2em; }}
tbody th[colspan] {{ background: var(--soft); padding: 0.3em 0.5em; font-weight: 600; }}
.dense {{ overflow-x: auto; }} .dense th, .dense td {{ min-width: 0; padding-right: 0.8em; overflow-wrap: normal;
  font-variant-numeric: tabular-nums; }}
figure {{ margin: 0.8em 0; }} figcaption {{ color: var(--dim); font-size: 0.9em; }}
.plots {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 23em), 1fr)); gap: 0.5em 1.5em; }}
svg {{ display: block; width: 100%; height: auto; fill: currentColor; }}
pre {{ background: var(--soft); padding: 0.8em; overflow-x: auto; font-size: 13px; }}
@media screen and (max-width: 600px) {{ body {{ font-size: 14px; }} th, td {{ padding-right: 0.6em; }} }}
@page {{ size: A4; margin: 14mm; }}
@media print {{
  body {{ font-size: 9.5pt; line-height: 1.35; margin: 0; padding: 0; max-width: none; }} nav {{ display: none; }}
  h2, h3, caption, tr:has(th[colspan]) {{ break-after: avoid; }} tr, figure {{ break-inside: avoid; }}
  .plots {{ grid-template-columns: 1fr 1fr; }} .dense {{ overflow: visible; font-size: 6.5pt; }}
  .dense th, .dense td {{ padding-right: 0.4em; }} pre {{ white-space: pre-wrap; overflow: visible; }}
}}
"""


def write_page(path: str | os.PathLike[str], what: str, text: Callable[[], str], *, overwrite: bool = False) -> Path:
    """Write the page that `text` makes; returns its path. Raises InputError naming `what` for another ending, a path
    that cannot be written, and an existing file, unless `overwrite` is set and warpffrf wrote it."""
    check_ending(path, what, ENDINGS)
    target = checked_output_path(path, what, overwrite=overwrite)
    page = text()
    with written_whole(target) as partial:
        partial.write_text(page, encoding="utf-8")
    return target


def document(title: str, *parts: str) -> str:
    """A page with its heading."""
    version = library_versions(("warpffrf",))["warpffrf"]
    head = (
        '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta name="generator" content="warpffrf {escape(version)}">'
        f"<title>{escape(title)}</title><style>{STYLE}</style>"
    )
    body = "\n".join([f"<h1>{escape(title)}</h1>", *parts])
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def section(title: str, *parts: str) -> str:
    """Parts under a heading, to which `contents` links."""
    return f'<h2 id="{_anchor(title)}">{escape(title)}</h2>\n' + "\n".join(parts)


def contents(titles: Iterable[str]) -> str:
    """Links to sections."""
    return "<nav>" + "\n".join(f'<a href="#{_anchor(title)}">{escape(title)}</a>' for title in titles) + "</nav>"


def _anchor(title: str) -> str:
    return re.sub(r"\W+", "-", title.lower())


def heading(text: str) -> str:
    """A heading within a section."""
    return f"<h3>{escape(text)}</h3>"


def paragraph(text: str, look: str = "") -> str:
    """look: "good" or "bad" colours the text."""
    return f'<p class="{look}">{escape(text)}</p>' if look else f"<p>{escape(text)}</p>"


def listed(texts: Iterable[str]) -> str:
    """A list."""
    return "<ul>" + "".join(f"<li>{escape(text)}</li>\n" for text in texts) + "</ul>"


def verbatim(text: str) -> str:
    """Text with its line breaks, in letters of one width."""
    return f"<pre>{escape(text)}</pre>"


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "") -> str:
    """A table whose rows begin with what they are about; a row of one cell heads those below it. A table of more than
    `MOST_COLUMNS` scrolls on narrow screens."""
    names = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    body = "".join(f"<tr>{_cells([escape(str(value)) for value in row], len(head))}</tr>\n" for row in rows)
    said = f"<caption>{escape(caption)}</caption>" if caption else ""
    found = f"<table>{said}<thead><tr>{names}</tr></thead>\n<tbody>{body}</tbody></table>"
    if len(head) <= MOST_COLUMNS:
        return found
    label = escape(caption or f"table of {', '.join(head)}", quote=True)
    return f'<div class="dense" role="region" aria-label="{label}" tabindex="0">{found}</div>'


def _cells(cells: Sequence[str], columns: int) -> str:
    if len(cells) == 1 < columns:
        return f'<th scope="rowgroup" colspan="{columns}">{cells[0]}</th>'
    return f'<th scope="row">{cells[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in cells[1:])


def picture(figure: Any, alt: str, caption: str = "") -> str:
    """A matplotlib figure; alt: what it shows, for those who cannot see it."""
    said = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    width = round(PIXELS_PER_INCH * figure.get_size_inches()[0])
    label = f'role="img" aria-label="{escape(alt, quote=True)}" style="max-width: {width}px"'
    return f"<figure>{_svg(figure, alt).replace('<svg', f'<svg {label}', 1)}{said}</figure>"


def plots(pictures: Iterable[str]) -> str:
    """Pictures side by side."""
    return '<div class="plots">' + "\n".join(pictures) + "</div>"


def _svg(figure: Any, alt: str) -> str:
    """The figure as an element of a page, in the colours of the page; its names, which `alt` enters, are its own."""
    from matplotlib import rc_context

    for ax in figure.axes:
        for collection in ax.collections:
            collection.set_rasterized(True)
    stream = io.StringIO()
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": "page"}):
        figure.savefig(stream, format="svg", dpi=DPI)
    _, _, text = stream.getvalue().partition("<svg")
    opening, _, inside = text.partition(">")
    box = re.search(r'viewBox="[^"]*"', opening)
    inside = re.sub(r"<metadata>.*?</metadata>", "", inside, flags=re.DOTALL)
    text = f"<svg {box.group() if box else ''}>{inside}"
    own = hashlib.sha256((alt + text).encode()).hexdigest()[:8]
    text = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>p{own}-", text)
    for color, (name, _, _) in COLORS.items():
        text = text.replace(f": {color}", f": var(--{name})")
    return text.strip()
