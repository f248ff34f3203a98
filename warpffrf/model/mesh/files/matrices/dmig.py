"""Nastran matrices as DMIG cards, in punch (.pch) and bulk data files.

    DMIG  NAME  0   IFO  TIN  TOUT  POLAR  -  NCOL    the head: form 1 square, 6 symmetric; type 1, 2 real, 3, 4 complex
    DMIG  NAME  GJ  CJ   -    G1    C1     A1  B1     a column: grid point and component, then rows with values
    +     G2    C2  A2   B2   ...

EXTSEOUT(DMIGPCH), PARAM,EXTOUT,DMIGPCH (OptiStruct too) and the like write them. Rows of scalar points are generalised
coordinates of a reduction, not displacements, and are refused.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.matrices.formats import FileMatrix, from_triplets
from warpffrf.model.mesh.files.nastran import Card, cards
from warpffrf.model.mesh.files.raw_mesh import listed_counts

NAMES = {"stiffness": ("K2GG", "KGG", "KAAX", "KAA", "K2PP"), "mass": ("M2GG", "MGG", "MAAX", "MAA", "M2PP")}
SYMMETRIC, SQUARE = 6, 1
COMPONENTS = 6


@dataclass
class _Matrix:
    """A head, and entries: row and column as grid point and component, and value."""

    form: int
    kind: int
    card: Card
    places: list[tuple[int, int, int, int]] = field(default_factory=list)
    values: list[float] = field(default_factory=list)


def read_dmig(file: Path, name: str | None, role: str) -> FileMatrix:
    """A matrix of DMIG cards. Raises `InputError` with the line for damaged ones, and for no such matrix."""
    try:
        others: Counter[str] = Counter()
        matrices = _matrices(file, others)
        chosen = _chosen(matrices, file, name, role)
        left = [*(f"matrix {key}" for key in matrices if key != chosen)]
        left += [f"cards {listed_counts(others)}"] if others else []
        note = (f"{file.name}: not used for {chosen}: {', '.join(left)}",) if left else ()
        return replace(_assembled(chosen, matrices[chosen], file), notes=note)
    except InputError as error:
        raise InputError(str(error).replace("mesh file", "matrix file", 1)) from None


def _matrices(file: Path, others: Counter[str]) -> dict[str, _Matrix]:
    found: dict[str, _Matrix] = {}
    for card in cards(file):
        if card.name != "DMIG":
            others[card.name] += 1
            continue
        name = card.text(1).upper()
        if card.text(2) == "0":
            if name in found:
                raise card.fault(f"{name} has two heads; give one of the matrices another name")
            found[name] = _Matrix(card.integer(3), card.integer(4), card)
            continue
        if name not in found:
            raise card.fault(f"{name} has no head, a card with 0 in its third field, before it; write it first")
        _column(found[name], card)
    return found


def _column(matrix: _Matrix, card: Card) -> None:
    column = card.integer(2), card.integer(3, 0)
    given = [at for at in range(5, len(card.fields) + 1, 4) if any(card.text(at + i) for i in range(4))]
    if not given or card.text(4):
        raise card.fault("a column needs rows, and its fifth field is empty; export the matrix again")
    for at in given:
        matrix.places.append((card.integer(at), card.integer(at + 1, 0), *column))
        matrix.values.append(card.real(at + 2))
        if card.real(at + 3, 0.0):
            raise card.fault(f"field {at + 4} is an imaginary part; export real matrices")


def _chosen(matrices: dict[str, _Matrix], file: Path, name: str | None, role: str) -> str:
    wanted = (name.strip().upper(),) if name is not None else NAMES[role]
    usable = [key for key, matrix in matrices.items() if matrix.form in (SQUARE, SYMMETRIC)]
    for key in wanted:
        if key in matrices:
            return key
    if name is None and len(usable) == 1:
        return usable[0]
    raise InputError(
        f"matrix file {file.name}: no {role} matrix among {', '.join(matrices) or 'nothing'}, looked for "
        f"{', '.join(wanted)}; name it: mesh.read_matrix(path, name)"
    )


def _assembled(name: str, matrix: _Matrix, file: Path) -> FileMatrix:
    if matrix.form not in (SQUARE, SYMMETRIC):
        raise matrix.card.fault(f"{name} is of form {matrix.form}, no square matrix; name another one")
    if matrix.kind not in (1, 2):
        raise matrix.card.fault(f"{name} is of type {matrix.kind}, complex; export real matrices")
    if not matrix.places:
        raise matrix.card.fault(f"{name} has no columns; export it again")
    places = np.array(matrix.places, dtype=np.int64)
    both = places.reshape(-1, 2)
    odd = both[(both[:, 1] < 1) | (both[:, 1] > COMPONENTS)]
    if len(odd):
        raise InputError(
            f"matrix file {file.name}: {name} has a row of point {odd[0, 0]}, component {odd[0, 1]}, which is no "
            "displacement or rotation; export the matrices of all grid points, without component modes"
        )
    dofs, place = np.unique(both, axis=0, return_inverse=True)
    row, column = place.reshape(-1, 2).T
    low, high = (np.minimum(row, column), np.maximum(row, column)) if matrix.form == SYMMETRIC else (row, column)
    again = Counter((low * len(dofs) + high).tolist()).most_common(1)[0]
    if again[1] > 1:
        (g, c), (h, d) = (dofs[i].tolist() for i in divmod(again[0], len(dofs)))
        raise matrix.card.fault(f"{name}: the entry of {g}-{c} and {h}-{d} is given {again[1]} times; give it once")
    return FileMatrix(
        from_triplets(row, column, np.array(matrix.values), len(dofs)), dofs - [0, 1], f"{file.name} ({name})"
    )
