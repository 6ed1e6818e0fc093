"""Standard streams that whoever started ``wct`` closed, or that take nothing more."""

import os
import sys
from typing import TextIO


def open_closed_streams() -> None:
    """Let the handles of closed streams lead nowhere, lest the next file that is opened gets one.

    What other code prints would go into that file.
    """
    for handle in range(3):
        try:
            os.fstat(handle)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # which gets the lowest handle that is free


def flushed() -> bool:
    """Whether standard output took all; what it or standard error does not take is dropped.

    Python would try again at its end, and then end with a code of its own, 120.
    """
    _flush(sys.stderr)
    return _flush(sys.stdout)


def _flush(stream: TextIO | None) -> bool:
    """Whether the stream took what is buffered; else its handle leads nowhere from now on, and the buffer with it."""
    if stream is None:
        return True
    try:
        stream.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
        return False
    return True
