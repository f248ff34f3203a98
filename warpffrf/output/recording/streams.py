"""Recording streams of rerun that leave nothing behind when they are closed.

Left to itself rerun (0.41) keeps four threads and more than a megabyte of every recording that is saved with a
blueprint until the process ends: two threads of a stream that was disconnected, and two of the blueprint's own, whose
stream and memory hold one another.
"""

from __future__ import annotations

from typing import Any

APPLICATION = "warpffrf"


def new_stream() -> Any:
    """A stream that goes nowhere yet; to be closed with `close_stream` by whoever has it as `stream`."""
    import rerun as rr

    return rr.RecordingStream(APPLICATION)


def in_memory(stream: Any, blueprint: Any) -> Any:
    """Let `stream` go to memory, which opens with `blueprint`; `drain_as_bytes` of the answer is a .rrd file.

    A stream to a file never comes back from a disk that is full. The blueprint is sent as by
    `stream.send_blueprint(blueprint)`, but with its own stream in hand, to disconnect it. That needs names that rerun
    does not publish: where another version has none of them, it is done by that.
    """
    import rerun as rr
    import rerun_bindings as native

    memory = stream.memory_recording()
    try:
        own = native.new_blueprint(APPLICATION, make_default=False, make_thread_default=False)
        beside = rr.RecordingStream._from_native(own)
        beside.set_time("blueprint", sequence=0)
        blueprint._log_to_stream(beside)
        storage = beside.memory_recording().storage  # type: ignore[attr-defined]
        native.send_blueprint(storage, True, True, recording=stream.to_native())
        beside.disconnect()
    except (AttributeError, TypeError):
        stream.send_blueprint(blueprint)
    return memory


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
