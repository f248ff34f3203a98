"""What a self-contained HTML page has: its text, tags, tables, pictures and addresses; elements must be nested."""

from __future__ import annotations

from html.parser import HTMLParser
from typing import Any

VOID = ("meta", "img", "br")


class Page(HTMLParser):
    """A page as read. `pictures`: their descriptions; `headless`: tables without headers; raises AssertionError for
    elements that are not nested, and for an address outside of the page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text, self.tags, self.ids, self.links = "", [], list[str](), list[str]()
        self.pictures, self.rows = list[str](), list[list[str]]()
        self.feed(text)
        self.close()
        assert not self.open
        assert len(self.ids) == len(set(self.ids)) and set(self.links) <= set(self.ids)
        assert not any(word in text for word in ("http:", "https:", "<script", "@import"))

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        found = dict(attrs)
        if tag == "tr":
            self.rows.append([])
        if tag in ("th", "td"):
            self.rows[-1].append("")
            assert tag == "td" or found["scope"] in ("col", "row", "rowgroup")
        if tag == "svg":
            assert found["role"] == "img"
            self.pictures.append(found["aria-label"])
        if "id" in found:
            self.ids.append(found["id"])
        for name in ("src", "href", "xlink:href"):
            address = found.get(name, "#")
            assert address.startswith(("#", "data:image/png;base64,")), address
            self.links += [address[1:]] if len(address) > 1 and address[0] == "#" else []

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data
        if {"th", "td"} & set(self.open):
            self.rows[-1][-1] += data
