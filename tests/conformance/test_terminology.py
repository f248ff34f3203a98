"""Private words and phrases do not appear in text and public names; each has a standard term.

Text is that of docstrings, comments, messages and pages. A blank of a phrase also matches a line break, in comments and
in strings of several lines. Names in backticks and expressions in braces are no text. Pages that studies write are not
read, nor, for the words of `PLAIN`, the kernels and the page that lists their arrays.
"""

from __future__ import annotations

import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("warpffrf", "kernels", "demos")
PROOF = ("tests", "bench")  # read for PLAIN words alone
PAGES = ("README.md", "CONTRIBUTING.md", "docs")
WRITTEN = ("docs/studies", "docs/speed_error", "docs/stability")  # pages that studies write

# regular expression of a word or phrase -> what to write instead
TEXT = {
    r"(?:what )?comes? of (?:it|this)": "follows, or is computed",
    r"turned over": "reversed",
    r"turned inside out": "inverted",
    r"parameters put in": "parameters substituted",
    r"folds? over itself": "is not monotonic",
    r"pulls? apart": "violates, or opens",
    r"not there yet": "not supported",
    r"no path back": "no load path",
    r"hands? over": "passes, or returns",
    r"in (?:its|their) stead": "instead",
    r"in silence": "without a note",
    r"so to speak": "nothing",
    r"had rather": "prefers",
    r"lies? in wait": "remains",
    r"nowhere near": "far from",
    r"of its own making": "its own",
    r"nodes repeated": "repeated nodes",
    r"breaks? down on": "crashes on",
    r"(?:is|are) squeezed out of their zone": "leave the load zone",
    r"made of others": "composed of other objects",
    r"cells a second": "cells per second",
    r"(?:one|two|three|displacements|rows) a (?:node|direction|body|contact)": "per, as in one per node",
}

PLAIN = {
    r"beside": "compared with, next to, or in addition to",
    r"told": "reported, or distinguished",
    r"tells": "reports, or shows",
    r"turned": "rotated",
}

# part of a public name -> what to call it
NAMES = {
    "spell": "an interval",
    "wish": "the request",
    "love": "half-space pressure (A. E. H. Love stands in the docstring)",
    "downhill": "descent",
    "careful": "damped",
    "hug": "conformal",
}

# file and what it may say
EXCEPTIONS: tuple[tuple[str, str], ...] = ()

GAP = r"(?:[\s#]|\\\n|\"\s*f?\")+"  # a blank: also a line break of a comment or of a string in parts
NAMED = re.compile(r"^[ \t]*(?:def|class)[ \t]+([A-Za-z]\w*)", re.MULTILINE)
PART = re.compile(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])")


def key(pattern: str) -> str:
    """The longest word that every match has: text without it is not searched."""
    return max(re.sub(r"\(\?:[^)]*\)\??|\w\?", " ", pattern).split(), key=len)


Rules = list[tuple[str, re.Pattern[str], str]]  # the word that is searched first, the rule, the term
WORDS: Rules = [(key(p), re.compile(rf"\b{p.replace(' ', GAP)}\b"), term) for p, term in TEXT.items()]
PLAIN_WORDS: Rules = [(word, re.compile(rf"(?<![\"'])\b{word}\b(?![\"'])"), term) for word, term in PLAIN.items()]
NO_TEXT = re.compile(r"`[^`\n]*`|\{[^{}\n]*\}")


def files(folders: tuple[str, ...], ending: str) -> Iterator[Path]:
    """The files of these folders, and those that are named."""
    for name in folders:
        path = ROOT / name
        for file in [path] if path.is_file() else sorted(path.rglob(f"*{ending}")):
            if file.suffix == ending and not file.relative_to(ROOT).as_posix().startswith(WRITTEN):
                yield file


def text_spans(source: str) -> list[tuple[int, int]]:
    """Where comments and strings begin and end."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    kinds = {tokenize.COMMENT, tokenize.STRING, getattr(tokenize, "FSTRING_MIDDLE", tokenize.STRING)}
    return [
        (starts[token.start[0] - 1] + token.start[1], starts[token.end[0] - 1] + token.end[1])
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type in kinds
    ]


def found_in(file: Path, rules: Rules = WORDS) -> list[str]:
    """What is wrong with the text of a file, a line each."""
    text, name = file.read_text(encoding="utf-8").lower(), file.relative_to(ROOT).as_posix()
    if rules is PLAIN_WORDS:
        text = NO_TEXT.sub(lambda match: " " * len(match[0]), text)
    hits = [(hit, term) for word, rule, term in rules if word in text for hit in rule.finditer(text)]
    if hits and file.suffix == ".py":  # identifiers are not text
        spans = text_spans(text)
        hits = [(hit, term) for hit, term in hits if any(first <= hit.start() < last for first, last in spans)]
    return [
        f"{name}:{text.count(chr(10), 0, hit.start()) + 1}: {' '.join(hit[0].split())!r}; write: {term}"
        for hit, term in hits
        if not any(name == where and words in hit[0] for where, words in EXCEPTIONS)
    ]


def test_text_has_no_private_words() -> None:
    found = [line for file in (*files(SOURCES, ".py"), *files(PAGES, ".md")) for line in found_in(file)]
    assert not found, "\n".join(found)


def test_text_is_plain() -> None:
    read = (*files((*SOURCES, *PROOF), ".py"), *files(PAGES, ".md"))
    left_out = ("kernels/", "docs/arrays.md", "tests/conformance/test_terminology.py")
    found = [
        line
        for file in read
        if not file.relative_to(ROOT).as_posix().startswith(left_out)
        for line in found_in(file, PLAIN_WORDS)
    ]
    assert not found, "\n".join(found)


def test_public_names_have_no_private_words() -> None:
    found = []
    for file in files(SOURCES, ".py"):
        for name in NAMED.findall(file.read_text(encoding="utf-8")):
            found += [
                f"{file.relative_to(ROOT).as_posix()}: {name}; call it: {NAMES[part]}"
                for part in map(str.lower, PART.findall(name))
                if part in NAMES
            ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ('"""The joint pulls apart."""\n', 1),
        ("# what comes\n# of it\n", 1),
        ('x = ("the cut has no "\n     "path back")\n', 1),
        ("squeezed = turned, over = 1, 2\n", 0),
        ('"""A term that comes of age."""\n', 0),
    ],
)
def test_the_rules_find_what_they_are_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, count: int
) -> None:
    monkeypatch.setitem(globals(), "ROOT", tmp_path)
    (tmp_path / "one.py").write_text(text, encoding="utf-8")
    assert len(found_in(tmp_path / "one.py")) == count
