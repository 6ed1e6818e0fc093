"""Standard streams that whoever started ``wct`` closed, or that take nothing more."""

import os
import sys


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
    """Whether standard output took all; else what is left leads nowhere, as Python would complain of it at its end."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.__stdout__.fileno() if sys.__stdout__ else 1)
        os.close(nowhere)
        return False
    return True
