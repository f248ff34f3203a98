"""The command `warpffrf`, and `python -m warpffrf`. Ctrl-C and SIGTERM are handled before large modules load."""

from __future__ import annotations

import sys

from warpffrf.model.messages.progress import terminated_as_interrupted


def main() -> int:
    """Run the command line; returns its exit code."""
    try:
        with terminated_as_interrupted():
            from warpffrf.cli import main as run

            return run()
    except KeyboardInterrupt:  # during the import
        print("interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
