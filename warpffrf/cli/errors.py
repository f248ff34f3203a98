"""Errors of commands: one line on stderr, in terms of the command line, and an exit code.

Messages of the package name arguments, such as `part=` or `expected_half_width`. They are replaced with the options of
the command, `--part` and `--half-width`.
"""

from __future__ import annotations

import logging
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer

INTERRUPTED = 130  # exit code, as in shells
OTHER_NAMES = {"interfaces": "interface", "expected_half_width": "half_width"}  # argument -> option

log = logging.getLogger("warpffrf")


@contextmanager
def one_line_errors() -> Iterator[None]:
    """End the enclosed command with one line and an exit code on wrong input, file errors and interruptions."""
    from warpffrf.model.errors import InputError
    from warpffrf.model.messages.progress import terminated_as_interrupted
    from warpffrf.model.messages.reprs import printable

    try:
        with terminated_as_interrupted():
            yield
    except BrokenPipeError:  # the reader of the output, such as head, has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise typer.Exit(0) from None
    except (InputError, OSError) as error:
        if log.isEnabledFor(logging.DEBUG):
            log.debug("traceback:", exc_info=True)
        print(printable(f"error: {in_options(str(error), _options)}"), file=sys.stderr)
        raise typer.Exit(1) from None
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


_options: dict[str, str] = {}


def know_options(context: typer.Context) -> None:
    """Set the options that error messages name: those of the command that `context`, of the main command, invokes, or
    of all its subcommands."""
    group: Any = context.command
    chosen = group.commands.get(context.invoked_subcommand)
    commands = getattr(chosen, "commands", {"": chosen}).values() if chosen is not None else ()
    pairs = ((p.name, max(p.opts, key=len)) for command in commands for p in command.params)
    _options.clear()
    _options.update({name: option for name, option in pairs if option.startswith("--")})


def in_options(text: str, options: dict[str, str]) -> str:
    """`text` with arguments replaced by `options`: `part='pad'` becomes `--part pad`; `overwrite=True`, with or without
    its option after it, becomes `--overwrite`. Names that are also words are replaced only before `=`."""
    known = options | {name: options[other] for name, other in OTHER_NAMES.items() if other in options}
    for name, option in known.items():
        text = re.sub(rf"\b{name}=True( \({option}\))?", option, text)
        text = re.sub(rf"\b{name}='([^']*)'", rf"{option} \1", text)
        text = re.sub(rf"(?<![-\w]){name}=(?=[^\s,;.)])", f"{option} ", text)
        text = re.sub(rf"(?<![-\w]){name}=", option, text)
        if "_" in name:
            text = re.sub(rf"(?<![-\w.'\"]){name}(?![\w'\"])", option, text)
    return text
