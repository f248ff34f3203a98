"""One HDF5 file for one `ReducedBody`: schema version, arrays, a content hash, and a seal over the whole file.

The body is flattened to `{path: array}` plus one JSON document for everything that is not an array; the content hash,
which identifies a body, covers both, without report and provenance. Damage is detected by the seal (`sealed_file`),
which covers every byte and is checked first. A file is written to a temporary name next to its target and renamed, so
that an interrupted run leaves no partial file.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.files import hdf5_parts
from warpffrf.model.files.hdf5_parts import COMPLEX, REAL
from warpffrf.model.files.sealed_file import check_schema, verify, written_sealed
from warpffrf.model.reduced.check import check_body
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, CrossCompliance, Recovery, Sampling, Tangential
from warpffrf.model.reduced.data import DisplaySurface, Interface, ReducedBodyData
from warpffrf.model.reduced.far_field import FarField
from warpffrf.model.reduced.inertia import GeometricStiffness, InertiaTerms, SecondOrderMotion
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.stress_field import StressField
from warpffrf.model.reduced.thermal import ReducedThermal
from warpffrf.model.small_sliding import MatchedSurface

Body = TypeVar("Body", bound=ReducedBodyData)

SCHEMA = 12  # incremented with every change of the file contents; files of other schemas are refused
MARK = "warpffrf reduced body"
_COMPRESSED_FROM = 1 << 16  # bytes; below it a compressed chunk costs more than it saves
_INERTIA = ("first", "second", "gyroscopic")
_PARTS = (
    "center_of_mass", "inertia", "frequencies", "surface", "interfaces", "contact_surfaces", "cross", "inertia_terms",
    "stress", "matched", "matched_compliance", "thermal",
)  # fmt: skip
_COMPLEX = ("transfer",)  # of harmonics
_CENTRIFUGAL = "inertia_terms/stiffening/centrifugal"
_PRESTRESSED = "inertia_terms/stiffening/interfaces/"
_MEMBRANE = "inertia_terms/stiffening/membrane"
_MOTION = "inertia_terms/stiffening/motion/"
_UNITS = {
    "center_of_mass": "m",
    "inertia": "kg m2",
    "frequencies": "Hz",
    "first": "kg m",
    "second": "kg",
    "gyroscopic": "kg",
    "point": "m",
    "lags": "m/N",
    "lags_tt": "m/N",
    "lags_nt": "m/N",
    "lags_tn": "m/N",
    "lags_mass": "m2 kg/N2",
    "overlap": "m kg/N",
    "weight": "m2",
    "z": "m",
    "points": "m",
    "transfer": "m/N",
    "matched_compliance": "m/N",
    "area": "m2",
    "membrane": "J(1/2)/m2",
    "forms": "1/m",
    "gap": "m",
    "triangles": "m",
}


def _flatten(body: ReducedBodyData) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    arrays: dict[str, np.ndarray] = {
        "center_of_mass": body.center_of_mass,
        "inertia": body.inertia,
        "frequencies": body.frequencies,
        "surface/points": body.surface.points,
        "surface/triangles": body.surface.triangles,
        "surface/modes": body.surface.modes,
    }
    if body.surface.matched is not None:
        arrays["surface/matched"] = body.surface.matched
    if body.surface.second_order is not None:
        arrays["surface/second_order"] = body.surface.second_order
    facts: dict[str, Any] = {"mass": float(body.mass), "interfaces": {}, "contact_surfaces": {}}
    for name, interface in body.interfaces.items():
        arrays[f"interfaces/{name}/point"] = interface.point
        arrays[f"interfaces/{name}/modes"] = interface.modes
        if interface.nodes is not None and interface.node_modes is not None:
            arrays[f"interfaces/{name}/nodes"] = interface.nodes
            arrays[f"interfaces/{name}/node_modes"] = interface.node_modes
        facts["interfaces"][name] = interface.kind
    for name, s in body.contact_surfaces.items():
        root = f"contact_surfaces/{name}"
        arrays[f"{root}/grid/e_0"] = s.grid.e_0
        arrays[f"{root}/grid/z"] = s.grid.z
        arrays[f"{root}/lags"] = s.lags
        arrays[f"{root}/mode_normal"] = s.mode_normal
        facts["contact_surfaces"][name] = {
            "shape": s.shape.describe(),
            "deviation": s.shape.deviation,
            "recovery": _flatten_recovery(arrays, f"{root}/recovery", s.recovery),
            **_grid_facts(s.grid),
        }
        if s.slope_lags is not None:
            arrays[f"{root}/slope_lags"] = s.slope_lags
        if s.far is not None:
            arrays.update({f"{root}/far/{key}": array for key, array in s.far.arrays().items()})
            facts["contact_surfaces"][name]["far"] = s.far.facts()
        if (mass := s.local_mass) is not None:
            arrays[f"{root}/local_mass/lags_mass"] = mass.lags_mass
            arrays[f"{root}/local_mass/overlap"] = mass.overlap
        if (points := s.sampling) is not None:
            arrays.update({f"{root}/sampling/{key}": array for key, array in points.arrays().items()})
            facts["contact_surfaces"][name]["sampling"] = points.facts()
        if (t := s.tangential) is not None:
            arrays[f"{root}/tangential/lags_tt"] = t.lags_tt
            arrays[f"{root}/tangential/lags_nt"] = t.lags_nt
            arrays[f"{root}/tangential/mode_tangent"] = t.mode_tangent
            recovery = _flatten_recovery(arrays, f"{root}/tangential/recovery", t.recovery)
            facts["contact_surfaces"][name]["tangential"] = {**_grid_facts(t.grid), "recovery": recovery}
    if body.cross:
        facts["cross"] = [[cross.target, cross.source] for cross in body.cross]
    for cross in body.cross:
        root = f"cross/{cross.target}/{cross.source}"
        arrays.update({f"{root}/{key}": array for key, array in cross.arrays().items()})
    if body.inertia_terms is not None:
        arrays.update(_inertia_arrays(body.inertia_terms))
    if body.matched:
        facts["matched"] = [[name, face.facts()] for name, face in body.matched.items()]
    for name, face in body.matched.items():
        arrays.update({f"matched/{name}/{key}": array for key, array in face.arrays().items()})
    if body.matched_compliance is not None:
        arrays["matched_compliance"] = body.matched_compliance
    if body.thermal is not None:
        arrays.update({f"thermal/{key}": array for key, array in body.thermal.arrays().items()})
        facts["thermal"] = body.thermal.facts()
    if body.stress:
        facts["stress"] = {name: field.facts() for name, field in body.stress.items()}
    for name, field in body.stress.items():
        arrays.update({f"stress/{name}/{key}": array for key, array in field.arrays().items()})
    return arrays, facts


def _inertia_arrays(terms: InertiaTerms) -> dict[str, np.ndarray]:
    arrays = {f"inertia_terms/{key}": getattr(terms, key) for key in _INERTIA}
    if (stiffening := terms.stiffening) is not None:
        arrays[_CENTRIFUGAL] = stiffening.centrifugal
        arrays.update({f"{_PRESTRESSED}{name}": K for name, K in stiffening.interfaces.items()})
        if stiffening.membrane is not None:
            arrays[_MEMBRANE] = stiffening.membrane
        if (motion := stiffening.motion) is not None:
            arrays.update({f"{_MOTION}forms": motion.forms, f"{_MOTION}overlap": motion.overlap})
    return arrays


def _inertia_terms(arrays: dict[str, np.ndarray]) -> InertiaTerms | None:
    """The inertia terms, None of a body without."""
    if not any(key.startswith("inertia_terms/") for key in arrays):
        return None
    stiffening = None
    if _CENTRIFUGAL in arrays:
        motion = SecondOrderMotion(**found) if (found := _under(arrays, _MOTION)) else None
        stiffening = GeometricStiffness(
            arrays[_CENTRIFUGAL], _under(arrays, _PRESTRESSED), arrays.get(_MEMBRANE), motion
        )
    first, second, gyroscopic = (arrays[f"inertia_terms/{key}"] for key in _INERTIA)
    return InertiaTerms(first, second, gyroscopic, stiffening)


def _grid_facts(grid: SurfaceGrid) -> dict[str, Any]:
    return {
        "theta_start": float(grid.theta_start),
        "pitch": float(grid.pitch),
        "columns": int(grid.columns),
        "periodic": bool(grid.periodic),
        "columns_per_sector": int(grid.columns_per_sector),
        "kind": grid.kind,
    }


def _grid(arrays: dict[str, np.ndarray], root: str, f: dict[str, Any]) -> SurfaceGrid:
    """The grid of `_grid_facts` on the lines of `root`."""
    return SurfaceGrid(
        e_0=arrays[f"{root}/grid/e_0"],
        theta_start=f["theta_start"],
        pitch=f["pitch"],
        columns=f["columns"],
        periodic=f["periodic"],
        z=arrays[f"{root}/grid/z"],
        columns_per_sector=f["columns_per_sector"],
        kind=f["kind"],
    )


def _flatten_recovery(arrays: dict[str, np.ndarray], root: str, recovery: Recovery) -> list[int]:
    arrays[f"{root}/transfer"] = recovery.transfer
    arrays[f"{root}/axes"] = recovery.axes
    return [int(recovery.sectors), int(recovery.offset), int(recovery.stride)]


def _recovery(arrays: dict[str, np.ndarray], root: str, numbers: list[int]) -> Recovery:
    sectors, offset, stride = numbers
    return Recovery(arrays[f"{root}/transfer"], sectors, arrays[f"{root}/axes"], offset, stride)


def _local_mass(arrays: dict[str, np.ndarray], root: str) -> LocalMass | None:
    """The mass of local modes, None where the file has none."""
    if f"{root}/lags_mass" not in arrays:
        return None
    return LocalMass(arrays[f"{root}/lags_mass"], arrays[f"{root}/overlap"])


def _sampling(arrays: dict[str, np.ndarray], root: str, facts: dict[str, Any] | None) -> Sampling | None:
    """The sampling points, None where the file has none."""
    return None if facts is None else Sampling.restore(_under(arrays, root), facts)


def _under(arrays: dict[str, np.ndarray], root: str) -> dict[str, np.ndarray]:
    """The arrays whose path begins with `root`, by the rest of it."""
    return {key.removeprefix(root): array for key, array in arrays.items() if key.startswith(root)}


def _restore(
    kind: type[Body], arrays: dict[str, np.ndarray], facts: dict[str, Any], report: dict, provenance: dict
) -> Body:
    contact = {}
    for name, f in facts["contact_surfaces"].items():
        root = f"contact_surfaces/{name}"
        shape = surfaces.from_description(f["shape"])
        object.__setattr__(shape, "deviation", f["deviation"])
        tangential = None
        if (t := f.get("tangential")) is not None:
            tangential = Tangential(
                _grid(arrays, root, t),
                arrays[f"{root}/tangential/lags_tt"],
                arrays[f"{root}/tangential/lags_nt"],
                arrays[f"{root}/tangential/mode_tangent"],
                _recovery(arrays, f"{root}/tangential/recovery", t["recovery"]),
            )
        contact[name] = ContactSurface(
            name,
            shape,
            _grid(arrays, root, f),
            arrays[f"{root}/lags"],
            arrays[f"{root}/mode_normal"],
            _recovery(arrays, f"{root}/recovery", f["recovery"]),
            tangential,
            _local_mass(arrays, f"{root}/local_mass"),
            _sampling(arrays, f"{root}/sampling/", f.get("sampling")),
            arrays.get(f"{root}/slope_lags"),
            FarField.restore(_under(arrays, f"{root}/far/"), f["far"]) if "far" in f else None,
        )
    stress = {}
    for name, f in facts.get("stress", {}).items():
        stress[name] = StressField.restore(name, _under(arrays, f"stress/{name}/"), f, contact)
    return kind(
        mass=facts["mass"],
        center_of_mass=arrays["center_of_mass"],
        inertia=arrays["inertia"],
        frequencies=arrays["frequencies"],
        interfaces={
            name: Interface(
                kind,
                arrays[f"interfaces/{name}/point"],
                arrays[f"interfaces/{name}/modes"],
                arrays.get(f"interfaces/{name}/nodes"),
                arrays.get(f"interfaces/{name}/node_modes"),
            )
            for name, kind in facts["interfaces"].items()
        },
        contact_surfaces=contact,
        surface=DisplaySurface(
            arrays["surface/points"],
            arrays["surface/triangles"],
            arrays["surface/modes"],
            arrays.get("surface/matched"),
            arrays.get("surface/second_order"),
        ),  # fmt: skip
        stress=stress,
        report=report,
        provenance=provenance,
        inertia_terms=_inertia_terms(arrays),
        cross=tuple(
            CrossCompliance(target, source, **_under(arrays, f"cross/{target}/{source}/"))
            for target, source in facts.get("cross", [])
        ),
        matched={
            name: MatchedSurface.restore(name, _under(arrays, f"matched/{name}/"), f)
            for name, f in facts.get("matched", [])
        },
        matched_compliance=arrays.get("matched_compliance"),
        thermal=ReducedThermal.restore(_under(arrays, "thermal/"), facts["thermal"]) if "thermal" in facts else None,
    )


def _digest(arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> str:
    digest = hashlib.sha256(json.dumps(facts, sort_keys=True).encode())
    for key in sorted(arrays):
        array = np.ascontiguousarray(arrays[key])
        digest.update(f"|{key}|{array.dtype.str}|{array.shape}|".encode())
        digest.update(array.data)
    return digest.hexdigest()


def stored_arrays(body: ReducedBodyData) -> dict[str, np.ndarray]:
    """Every array that a file of the body holds, by its path there."""
    return _flatten(body)[0]


def content_hash(body: ReducedBodyData) -> str:
    """sha256 over all arrays and facts of the body, without report and provenance."""
    return _digest(*_flatten(body))


def write_reduced_body(body: ReducedBodyData, path: Path) -> Path:
    """Write `body` to the HDF5 file `path`; raises `InputError` where it cannot be written."""
    arrays, facts = _flatten(body)
    try:
        with written_sealed(path) as file:
            file.attrs["format"] = MARK
            file.attrs["schema"] = SCHEMA
            file.attrs["content_hash"] = _digest(arrays, facts)
            for key, text in (("facts", facts), ("report", body.report), ("provenance", body.provenance)):
                file.create_dataset(key, data=json.dumps(text))
            for key, array in arrays.items():
                packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
                dataset = file.create_dataset(
                    key, data=array, **(packed if array.nbytes >= _COMPRESSED_FROM and array.size else {})
                )
                if unit := _UNITS.get(key.rsplit("/", 1)[-1]):
                    dataset.attrs["units"] = unit
    except OSError as error:
        raise InputError(f"reduced body: cannot write {path}: {error}; choose a folder that can be written") from None
    return path


def _document(file: Any, name: str) -> dict[str, Any]:
    found = json.loads(hdf5_parts.read_text(file, name))
    if not isinstance(found, dict):
        raise InputError(f"{name} is no table")
    return found


def _stored(file: Any) -> dict[str, np.ndarray]:
    """Every array of a body's parts, by path; others are not read."""
    import h5py

    found: list[str] = []
    for part in _PARTS:
        item = hdf5_parts.member(file, part) if part in file else None
        if isinstance(item, h5py.Group):
            item.visititems(lambda n, i, at=part: found.append(f"{at}/{n}") if isinstance(i, h5py.Dataset) else None)
        elif item is not None:
            found.append(part)
    kinds = {path: COMPLEX if path.rsplit("/", 1)[-1] in _COMPLEX else REAL for path in found}
    return {path: hdf5_parts.read(file, path, kinds=kinds[path]) for path in found}


def read_reduced_body(kind: type[Body], path: Path, subject: str | None = None, content: str | None = None) -> Body:
    """The body of class `kind` in the file `path`; raises `InputError` when the file is missing, damaged, no body's, of
    another schema, or another body than the one with the content hash `content`. `subject`: its name in messages, where
    a reader knows the file by another name."""
    import h5py

    if not path.is_file():
        raise InputError(f"reduced body: there is no file {path}; check the path")
    subject, cure = subject or f"reduced body: {path}", "run the reduction again"
    verify(path, subject, cure)
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != MARK:
                raise InputError(f"{subject} is not a reduced body file; {cure}")
            check_schema(int(np.asarray(file.attrs["schema"])), SCHEMA, subject, cure)
            facts, report, provenance = (_document(file, k) for k in ("facts", "report", "provenance"))
            arrays = _stored(file)
            expected = file.attrs["content_hash"]
        if _digest(arrays, facts) != expected:
            raise InputError(f"{subject} is damaged (content hash differs); {cure}")
        if content is not None and expected != content:
            raise InputError(f"{subject} is not the body of its name (content hash differs); {cure}")
        body = _restore(kind, arrays, facts, report, provenance)
        check_body(body, arrays)
        return body
    except InputError as error:
        raise error if subject in str(error) else InputError(f"{subject}: {error}; {cure}") from None
    except Exception as error:  # a foreign document may raise anything
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{subject} is damaged or not an HDF5 file ({reason}); {cure}") from None
