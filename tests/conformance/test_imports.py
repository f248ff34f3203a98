"""No modules import one another in a circle. An import inside a function counts, one for type checkers alone does not.

What may import what is said by the contracts in pyproject.toml; they look at rooms, this at single modules.
"""

from pathlib import Path

import grimp
import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components


def circles(*packages: str) -> list[list[str]]:
    """The modules of each circle, sorted."""
    graph = grimp.build_graph(*packages, exclude_type_checking_imports=True, cache_dir=None)
    modules = sorted(graph.modules)
    number = {module: n for n, module in enumerate(modules)}
    pairs = [(number[m], number[other]) for m in modules for other in graph.find_modules_directly_imported_by(m)]
    rows, columns = np.array(pairs).T
    imports = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(len(modules), len(modules)))
    count, label = connected_components(imports, connection="strong")
    found = [[m for m, part in zip(modules, label, strict=True) if part == n] for n in range(count)]
    return sorted(circle for circle in found if len(circle) > 1)


def test_no_modules_import_one_another() -> None:
    assert circles("warpffrf", "warpffrf_kernels") == []


def test_a_circle_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "ringed"
    package.mkdir()
    for name, text in {
        "__init__": "",
        "first": "from ringed import second",
        "second": "from ringed.third import x",
        "third": "def f():\n    import ringed.first",
        "typed": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ringed import used",
        "used": "from ringed import typed, first",
    }.items():
        (package / f"{name}.py").write_text(text + "\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert circles("ringed") == [["ringed.first", "ringed.second", "ringed.third"]]
