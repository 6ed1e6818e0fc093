"""The arguments IN and OUT of commands that make one of the other, and what there is to say of reading IN."""

from collections.abc import Callable
from typing import Any

import click

from wct_plugin.cli import filter_options, formats_of_streams


def in_and_out(command: Callable[..., Any]) -> Callable[..., Any]:
    """Decorate a command with ``source`` and ``target``, and with the options that say how IN is read."""
    command = formats_of_streams.input_format(command)
    command = filter_options.max_bytes_option(command)
    command = filter_options.repair_option(filter_options.regions_option(command))
    return click.argument("source", metavar="IN")(click.argument("target", metavar="OUT")(command))
