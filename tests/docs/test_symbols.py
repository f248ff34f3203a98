"""The chapters of the method: their symbols stand in docs/method/symbols.md, and names and files that they give exist.

A symbol is what a formula (an indented block, or a span of code that is no name, path or call) has as a token, and in
running text a token with an index, a Greek letter by its name, or a single letter. Words of four letters or more are
not symbols, unless the table has them.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[2]
METHOD = ROOT / "docs" / "method"
KERNELS = ROOT / "kernels" / "warpffrf_kernels"
CHAPTERS = {page.name: page.read_text(encoding="utf-8") for page in sorted(METHOD.glob("[0-9]*.md"))}
TABLE = (METHOD / "symbols.md").read_text(encoding="utf-8")

GREEK = set(
    "alpha beta gamma delta eps eta zeta theta kappa lambda lam mu nu xi rho sigma tau phi chi psi omega "
    "Phi Psi Omega Theta Sigma".split()
)
SHORT = set(
    "all an and any are as at by cos do end go had has if in int is it not of on one or per pi row set sin sum the to "
    "two".split()
)
ARTICLES = {"a", "A", "I"}  # in running text; formulas show whether they are symbols
TOKEN = re.compile(r"(?<![A-Za-z0-9_'])[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*(?![A-Za-z0-9_])")
SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"!?\[[^\]]*\]\([^)]*\)")
PATH = re.compile(r"(?:tests|bench|demos|docs|warpffrf)/[\w/]+(?:\.\w+)?|test_\w+\.py")
NAME = re.compile(
    r"[\w./-]+|.*(?:[\"]|\.\.\.|\w=\S|=\)|=$|\w\(\)$|[a-z]{4,}\().*|[A-Z]\w+\(.*\)"
)  # of a span: a name, path or call


class Row(NamedTuple):
    """A row of the table: symbols, names by module, chapters (file names)."""

    symbols: list[str]
    code: dict[str, list[str]]
    chapters: list[str]


def rows(table: str) -> list[Row]:
    """Rows that begin with a symbol; every one has five cells."""
    found = []
    for line in table.splitlines():
        if line.startswith("| `"):
            symbols, _, _, code, chapters = (cell.strip() for cell in line.strip("|").split(" | "))
            modules = [SPAN.findall(part) for part in code.split(";")]
            found.append(
                Row(
                    SPAN.findall(symbols),
                    {path: names for path, *names in modules},
                    re.findall(r"\]\(([^)]+)\)", chapters),
                )
            )
    return found


ROWS = rows(TABLE)


def body(chapter: str) -> str:
    """A chapter without its sources."""
    return chapter.split("\n## Sources")[0]


def operators_removed(text: str) -> str:
    """A formula without what is no symbol: transposition, integral, rate, vector product, unit, order."""
    text = re.sub(r"\^-?T\b", " ", text)
    text = re.sub(r"\bd(\w*|\(.*?\))/dt\b", r"\1", text)
    text = re.sub(r"\b[aAI](?= [a-z]{4,})", " ", text)
    text = re.sub(r"\bd(\w)/d(\w)\b", r"\1 \2", text)
    text = re.sub(r"\bint (.*?) d\w\b", r"\1", text)
    return re.sub(r"(?<=\w) x (?=[\w(])|\[\w+\^\d\]|\bO\(\w\)|\bN \d+|-alpha\b|\bsum_\w+|\b(?:div|grad)\b", " ", text)


def symbols_of(chapter: str) -> set[str]:
    """Symbols that a chapter uses."""
    formulas, prose = [], []
    for line in body(chapter).splitlines():
        if line.startswith("    "):
            formulas.append(line)
        else:
            text = PATH.sub(" ", LINK.sub(" ", line))
            formulas += [span for span in SPAN.findall(text) if not NAME.fullmatch(span)]
            prose.append(SPAN.sub(" ", text))
    found = {token for text in formulas for token in TOKEN.findall(operators_removed(text)) if is_symbol(token)}
    for text in prose:
        tokens = TOKEN.findall(operators_removed(text))
        found |= {t for t in tokens if t not in ARTICLES and ("_" in t or t in GREEK or len(t) == 1)}
    return found


def is_symbol(token: str) -> bool:
    """Whether a token of a formula is one."""
    if token in SHORT:
        return False
    known = token in GREEK or token.endswith("dot") or token.removeprefix("d") in GREEK
    return known or len(token) <= 3 or re.search(r"[_\d]", token) is not None


@cache
def module(name: str) -> ast.Module | None:
    """The module that a page calls `name`: a file of warpffrf, of the kernels, or of the repository."""
    for path in (ROOT / "warpffrf" / name, KERNELS / name.removeprefix("kernels/"), ROOT / name):
        if path.is_file():
            return ast.parse(path.read_text(encoding="utf-8"))
    return None


def has(tree: ast.AST, name: str) -> bool:
    """Whether code, not text, contains a name; `Owner.name` within the class Owner."""
    *owner, last = name.split(".")
    if owner:
        classes = [n for n in ast.walk(tree) if isinstance(n, ast.ClassDef) and n.name == owner[0]]
        return any(has(found, last) for found in classes)
    fields = {ast.Name: "id", ast.Attribute: "attr", ast.arg: "arg", ast.FunctionDef: "name", ast.ClassDef: "name"}
    return any(getattr(node, fields[type(node)]) == last for node in ast.walk(tree) if type(node) in fields)


def wrong_code(row: Row) -> list[str]:
    """Modules and names of a row that do not exist."""
    wrong = []
    for path, names in row.code.items():
        tree = module(path)
        if tree is None or not names:
            wrong.append(f"{row.symbols}: {path}: no such module, or no name of it")
        else:
            wrong += [f"{row.symbols}: {path} has no {name}" for name in names if not has(tree, name)]
    return wrong


def wrong_chapters(row: Row) -> list[str]:
    """Chapters of a row that do not have one of its symbols."""
    return [
        f"{chapter} has no {symbol}"
        for chapter in row.chapters
        for symbol in row.symbols
        if not re.search(rf"(?<![A-Za-z0-9_]){symbol}(?![A-Za-z0-9_])", body(CHAPTERS.get(chapter, "")))
    ]


def test_names_of_the_table_are_in_the_code() -> None:
    assert len(ROWS) > 250 and all(row.symbols and row.code and row.chapters for row in ROWS)
    found = [line for row in ROWS for line in wrong_code(row)]
    assert not found, "\n".join(found)


def test_symbols_of_the_table_are_in_their_chapters() -> None:
    found = [line for row in ROWS for line in wrong_chapters(row)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_symbols_of_a_chapter_are_in_the_table(chapter: str) -> None:
    listed = {symbol for row in ROWS if chapter in row.chapters for symbol in row.symbols}
    missing = sorted(symbols_of(CHAPTERS[chapter]) - listed)
    assert not missing, f"docs/method/symbols.md has no row for {missing} with the chapter {chapter}"


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_files_that_a_chapter_names_exist(chapter: str) -> None:
    text = CHAPTERS[chapter]
    rooms = [ROOT, ROOT / "warpffrf", ROOT / "warpffrf" / "offline", KERNELS]
    named = {span.rstrip("/") for span in SPAN.findall(text) if re.fullmatch(r"[\w./]+", span) and "/" in span}
    named |= {span for span in SPAN.findall(text) if re.fullmatch(r"\w+\.py", span)}
    named |= {path for path in PATH.findall(LINK.sub(" ", SPAN.sub(" ", text))) if "/" in path}
    missing = [name for name in sorted(named) if not any((r / name.removeprefix("kernels/")).exists() for r in rooms)]
    assert not missing, f"{chapter} names files that do not exist: {missing}"


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_a_chapter_cites_sources_and_links_to_others(chapter: str) -> None:
    text = CHAPTERS[chapter]
    sources = text.partition("\n## Sources\n\n- ")[2]
    assert re.search(r"\b(?:1[89]|20)\d\d\b", sources), f"{chapter} cites nobody"
    unlinked = re.findall(r"[Ss]ections? \d+", LINK.sub(" ", body(text)))
    assert not unlinked, f"{chapter}: {unlinked} without a link"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("    M qddot + K q = f_1, all of it  and Newton(x)", {"M", "qddot", "K", "q", "f_1", "x"}),
        ("the span `A = G F`, a name `Phi_g`, a call `reduce(grid=G)`, a path `offline/fe.py`", {"A", "G", "F"}),
        ("By the exponent n, the ratio zeta and d_pw of the body", {"n", "zeta", "d_pw"}),
        ("    int psi_i u dA,  w x h,  dL/dt,  U^-T L,  sum_j s_j", {"psi_i", "u", "w", "h", "L", "U", "s_j"}),
        ("\n## Sources\n\n- z", set()),
    ],
)
def test_symbols_are_found(text: str, expected: set[str]) -> None:
    assert symbols_of(text) == expected


def test_wrong_rows_are_found() -> None:
    code = "`kernels/core/state.py`: `MotionState.q`, `MotionState.lam`; `no.py`: `q`"
    (wrong,) = rows(f"| `q`, `no_such` | a | b | {code} | [1](01_bodies.md) |")
    assert [line.split(" has ")[-1] for line in wrong_chapters(wrong)] == ["no no_such"]
    assert len(wrong_code(wrong)) == 2 and "MotionState.lam" in wrong_code(wrong)[0]
