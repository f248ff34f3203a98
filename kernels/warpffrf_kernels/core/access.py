"""What a kernel does to the arrays that it is given, said in its signature.

An array without a mark is read. `out` is set anew, whatever stood there; `inout` is read and written; `changed` is
read and written too, and needs what another kernel has set, as a sum does. The order of launches is checked from this
(`warpffrf.online.step.phases`), and this against the kernels' source (`tests/kernels/test_signatures.py`).
"""

from typing import Any


def out(annotation: Any) -> Any:
    """Mark the annotation of an array whose entries are set without regard to what they were."""
    annotation.access = "out"
    return annotation


def inout(annotation: Any) -> Any:
    """Mark the annotation of an array that is read and written."""
    annotation.access = "inout"
    return annotation


def changed(annotation: Any) -> Any:
    """Mark the annotation of an array whose entries another kernel has set and this one changes."""
    annotation.access = "changed"
    return annotation


def is_changed(annotation: Any) -> bool:
    return getattr(annotation, "access", "in") == "changed"


def is_read(annotation: Any) -> bool:
    return getattr(annotation, "access", "in") != "out"


def is_written(annotation: Any) -> bool:
    return getattr(annotation, "access", "in") != "in"
