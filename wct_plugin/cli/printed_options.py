"""``--help`` and ``--version``, which every command and ``wct`` itself print and end with.

They are not click's own: a full disk or a reader that is gone would count as a bug of ours there.
"""

from collections.abc import Callable
from importlib import metadata

import click

from wct_plugin.io.standard_streams import writing_stdout


def help_option() -> click.Option:
    """``-h`` and ``--help``, of any command."""
    return _printed(["-h", "--help"], "Show this message and exit.", lambda context: context.get_help())


def version_option() -> click.Option:
    """``--version``."""
    return _printed(
        ["--version"], "Show the version and exit.", lambda _: f"wct, version {metadata.version('wct_plugin')}"
    )


def _printed(names: list[str], about: str, text: Callable[[click.Context], str]) -> click.Option:
    def show(context: click.Context, _: click.Parameter, wanted: bool) -> None:
        if not wanted or context.resilient_parsing:
            return
        with writing_stdout():
            click.echo(text(context), color=context.color)
        context.exit()

    return click.Option(names, is_flag=True, is_eager=True, expose_value=False, callback=show, help=about)
