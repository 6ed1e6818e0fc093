"""Entry point of ``wct``: signals are heard from here on, also while what the commands need is imported."""

import sys
from contextlib import suppress

from wct_plugin.cli.closed_streams import flushed, open_closed_streams
from wct_plugin.cli.interrupt import end_at_once, raise_on_sigterm, repeat_where_lost

#: As :mod:`wct_plugin.cli.messages` has it, which is not imported yet.
_FAILED = 2


def main() -> None:
    """Run the command line, and end with its exit code."""
    code: int | None = None
    said = "interrupted; nothing was written"
    try:
        open_closed_streams()
        raise_on_sigterm()
        repeat_where_lost()
        from wct_plugin.cli.main import run  # takes a fifth of a second

        said = "interrupted"
        code = run()
        end_at_once()
    except KeyboardInterrupt:  # before a command was there to be interrupted, or as it ended
        if code is None:
            with suppress(OSError):
                if sys.stderr is not None:
                    sys.stderr.write(f"error: {said}\n")
        end_at_once()
    took_all = flushed()
    sys.exit(code if took_all and code is not None else _FAILED)
