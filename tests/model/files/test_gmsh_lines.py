"""Text .msh files: a line with a number too few, too many, or with something else is refused, with its number."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf import examples
from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError

DATA = Path(__file__).resolve().parents[2] / "data"
FILES = {"2.2": DATA / "gmsh_wedge6.msh", "4.1": DATA / "gmsh_hex8.msh"}


def lines_of(text: str, section: str) -> range:
    """Indices of the lines of a section, without its own first and last."""
    lines = text.split("\n")
    return range(lines.index(f"${section}") + 1, lines.index(f"$End{section}"))


@pytest.mark.parametrize("version", list(FILES))
@pytest.mark.parametrize("section", ["Nodes", "Elements"])
@pytest.mark.parametrize("change", ["a word less", "a word more", "a letter", "a line less"])
def test_a_wrong_line_is_named(tmp_path: Path, version: str, section: str, change: str) -> None:
    text = FILES[version].read_text()
    path = tmp_path / "m.msh"
    for at in lines_of(text, section):
        lines = text.split("\n")
        words = lines[at].split()
        if change == "a line less":
            del lines[at]
        else:
            words = {"a word less": words[:-1], "a word more": [*words, "1"], "a letter": [words[0] + "x", *words[1:]]}[
                change
            ]
            lines[at] = " ".join(words)
        path.write_text("\n".join(lines))
        with pytest.raises(InputError, match=r"m\.msh"):
            wfmesh.read(path, length_unit="mm")


def test_a_node_less_is_not_a_tag_instead(tmp_path: Path) -> None:
    path = tmp_path / "m.msh"
    path.write_text(FILES["2.2"].read_text().replace("4 6 2 1 1 1 2 13 7 8 22", "4 6 2 1 1 1 2 13 7 8"))
    with pytest.raises(InputError, match=r"m\.msh, line 42: '4 6 2 1 1 1 2 13 7 8' is not 'number type tags nodes'"):
        wfmesh.read(path, length_unit="mm")


def test_a_file_that_ends_early_is_refused(tmp_path: Path) -> None:
    text = FILES["2.2"].read_text()
    (tmp_path / "m.msh").write_text(text[: text.index("$Elements") + 12])
    with pytest.raises(InputError, match="m.msh"):
        wfmesh.read(tmp_path / "m.msh", length_unit="mm")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("\n24 ", "\n23 ", "not positive and distinct"),
        ("\n24 ", "\n0 ", "not positive and distinct"),
        ("\n24 ", "\n2000000000 ", "refers to a node that the file does not contain"),
    ],
)
def test_numbers_of_nodes(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = FILES["2.2"].read_text()
    begin, end = text.index("$Nodes"), text.index("$EndNodes")
    (tmp_path / "m.msh").write_text(text[:begin] + text[begin:end].replace(old, new) + text[end:])
    with pytest.raises(InputError, match=message):
        wfmesh.read(tmp_path / "m.msh", length_unit="mm")


def test_more_nodes_than_there_are(tmp_path: Path) -> None:
    lines = FILES["4.1"].read_text().split("\n")
    at = lines.index("$Nodes") + 1
    blocks, total, *rest = lines[at].split()
    lines[at] = " ".join([blocks, str(int(total) + 1), *rest])
    (tmp_path / "m.msh").write_text("\n".join(lines))
    with pytest.raises(InputError, match=f"has {total} nodes and declares {int(total) + 1}"):
        wfmesh.read(tmp_path / "m.msh", length_unit="mm")


def test_nodes_of_a_binary_file(tmp_path: Path) -> None:
    content = (examples.path("roller") / "roller.msh").read_bytes()
    at = content.index(b"\n$Nodes\n") + 8
    changes = ((0, 10**15), (8, 10**15), (32 + 12, 10**15), (32 + 20, 2**40), (32 + 20, 0))
    for place, value in ((at + offset, value) for offset, value in changes):
        (tmp_path / "m.msh").write_bytes(content[:place] + value.to_bytes(8, "little") + content[place + 8 :])
        with pytest.raises(InputError, match="m.msh"):
            wfmesh.read(tmp_path / "m.msh", length_unit="mm")
