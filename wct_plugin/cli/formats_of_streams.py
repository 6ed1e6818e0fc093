"""The options that name formats where no suffix does, as of ``-``, which is standard input or output."""

import click

from wct_plugin.cli.messages import talk_to_stderr
from wct_plugin.io.standard_streams import STREAM

input_format = click.option(
    "--input-format", metavar="SUFFIX", help="Of IN, as vtu or msh.gz  [default: its name tells; - has none]"
)
output_format = click.option(
    "--output-format", metavar="SUFFIX", help="Of OUT, as vtu or msh.gz  [default: its name tells; - has none]"
)


def leave_stdout(*targets: str | None) -> None:
    """Print to stderr what there is to say if a file goes to standard output; refuse two that do."""
    count = targets.count(STREAM)
    if count > 1:
        raise click.UsageError("'-' is given twice; standard output takes one file")
    if count:
        click.get_current_context().call_on_close(talk_to_stderr())
