"""Recording streams of rerun, to files, that leave nothing behind when they are closed.

Left to itself rerun (0.41) keeps four threads and more than a megabyte of every recording until the process ends: two
threads of a stream that was disconnected, and two of the blueprint that was saved with it, whose stream and memory hold
one another.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

APPLICATION = "warpffrf"


def new_stream() -> Any:
    """A stream that goes nowhere yet; to be closed with `close_stream` by whoever has it as `stream`."""
    import rerun as rr

    return rr.RecordingStream(APPLICATION)


def save_stream(stream: Any, file: Path, blueprint: Any) -> None:
    """Let `stream` go to `file`, which opens with `blueprint`.

    As `stream.save(file, default_blueprint=blueprint)`, but with the stream of the blueprint in hand, to disconnect it.
    That needs names that rerun does not publish: where another version has none of them, it is done by `save`.
    """
    import rerun as rr
    import rerun_bindings as native

    try:
        own = native.new_blueprint(APPLICATION, make_default=False, make_thread_default=False)
        beside = rr.RecordingStream._from_native(own)
        beside.set_time("blueprint", sequence=0)
        blueprint._log_to_stream(beside)
        memory = beside.memory_recording()  # type: ignore[attr-defined]
        native.save(str(file), default_blueprint=memory.storage, recording=stream.to_native())
        beside.disconnect()
    except (AttributeError, TypeError):
        stream.save(str(file), default_blueprint=blueprint)


def close_stream(owner: Any) -> None:
    """Write what is left of `owner.stream`, close it and take it from the owner.

    rerun ends the threads of streams that nobody refers to when it is initialised again, which makes no recording here
    and leaves those of the user as they are.
    """
    import rerun as rr

    try:
        owner.stream.flush()
    finally:
        owner.stream.disconnect()
        del owner.stream
        rr.init(APPLICATION, init_logging=False)
