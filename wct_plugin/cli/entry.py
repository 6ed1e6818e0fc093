"""Entry point of ``wct``: signals are heard from here on, also while what the commands need is imported."""

import sys
from contextlib import suppress

from wct_plugin.cli.closed_streams import flushed, open_closed_streams
from wct_plugin.cli.interrupt import end_at_once, raise_on_sigterm, repeat_where_lost

#: As :mod:`wct_plugin.cli.messages` has it, which is not imported yet.
_FAILED = 2


def main() -> None:
    """Run the command line, and end with its exit code."""
    open_closed_streams()
    code = _FAILED
    try:
        raise_on_sigterm()
        repeat_where_lost()
        from wct_plugin.cli.main import run  # takes a fifth of a second

        code = run()
        end_at_once()
    except KeyboardInterrupt:  # before a command was there to be interrupted
        with suppress(OSError):
            if sys.stderr is not None:
                sys.stderr.write("error: interrupted; nothing was written\n")
    sys.exit(code if flushed() else _FAILED)
