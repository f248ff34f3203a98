"""Silent initialisation of Warp and loading of kernels; the user's settings are kept."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import warp as wp

from warpffrf.model.errors import InputError

TESTED_WARP = "1.19.0"  # the newest version tested
STDERR = 2

_started = False


@contextmanager
def quiet() -> Iterator[None]:
    """Warp prints warnings only, unless the user has changed its default verbosity."""
    asked = wp.config.log_level
    if asked == wp.LOG_INFO:
        wp.config.log_level = wp.LOG_WARNING
    try:
        yield
    finally:
        wp.config.log_level = asked


def start_warp() -> bool:
    """Initialise Warp; False where it is already. On a machine without a GPU its native part prints that there is
    no CUDA driver, so standard error is discarded meanwhile, for a fraction of a second.

    A requested device that does not exist is reported by `Engine`. Raises `InputError` if the folder of the compiled
    kernels cannot be made.
    """
    global _started
    if _started:
        return False
    asked = wp.config.kernel_cache_dir
    try:
        with quiet(), _native_errors_away():
            wp.init()
    except OSError as error:
        refused = kernels_not_kept(error)
        wp.config.kernel_cache_dir = asked  # so that a session may choose another folder and try again
        raise refused from None
    _started = True
    return True


def kernels_not_kept(error: OSError) -> InputError:
    """The error for a folder of compiled kernels that cannot be written to, with the cure."""
    return InputError(
        f"kernels: they cannot be kept in '{wp.config.kernel_cache_dir}' ({error.strerror or error}); set the "
        "environment variable WARP_CACHE_PATH to a folder that can be written"
    )


@contextmanager
def _native_errors_away() -> Iterator[None]:
    """Discard the process's standard error; unchanged where there is none, as in daemons."""
    try:
        kept = os.dup(STDERR)
    except OSError:
        yield
        return
    null = os.open(os.devnull, os.O_WRONLY)
    try:
        if sys.stderr is not None:
            sys.stderr.flush()
        os.dup2(null, STDERR)
        yield
    finally:
        os.dup2(kept, STDERR)
        os.close(null)
        os.close(kept)


def untested_warp_note(installed: str = wp.__version__) -> list[str]:
    """A note if Warp is newer than the tested version: captured graphs and kernel caches are recent parts of it."""
    if _numbers(installed) <= _numbers(TESTED_WARP):
        return []
    return [
        f"Warp {installed} is installed, newer than the {TESTED_WARP} that warpffrf was tested with; if a run fails or "
        f"its numbers are in doubt, compare with: pip install warp-lang=={TESTED_WARP}"
    ]


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split("+")[0].split(".")[:3] if part.isdigit())
