"""What all commands of ``wct`` have in common: an example in their help, ``--quiet``, and completion of files."""

from typing import Any

import click

from wct_plugin.cli.output import be_quiet

#: One for each command, as one would type it.
EXAMPLES = {
    "batch": "wct batch repair-ftetwild 'scans/*.ply' -o out --jobs 4 --timeout 600",
    "completion": "wct completion bash > ~/.local/share/bash-completion/completions/wct",
    "create": "wct create cube cube.vtu --variant 84",
    "demo": "wct demo samples",
    "filters": "wct filters meshing_well_centered",
    "optimize": "wct optimize bone.ply bone.vtu --tolerance 1e-3 --html bone.html",
    "report": "wct report before.vtu after.vtu --html compared.html",
    "run": "wct run chain.json bone.ply bone.vtu --set filters.meshing_well_centered.goal=3wc",
}
#: What stands for a file in a command's usage.
_FILES = ("FILE", "FILE...", "IN", "OUT", "INPUT...", "DIR", "[DIR]", "[IN [OUT...]]")


def quiet_option() -> click.Option:
    """``--quiet``, which every command has and ``wct`` itself, for ``wct -q COMMAND``."""
    return click.Option(
        ["-q", "--quiet"],
        is_flag=True,
        expose_value=False,
        callback=_quiet,
        help="Print errors only, and what - asks for",
    )


def _quiet(context: click.Context, _: click.Parameter, value: bool) -> None:
    if value:
        context.call_on_close(be_quiet())


def with_comfort(command: click.Command, example: str) -> click.Command:
    """The command, with what all have in common."""
    command.params.append(quiet_option())
    for param in command.params:
        if param.metavar in _FILES and type(param.type) is type(click.STRING):
            param.type = click.Path(allow_dash=True)
    if example:
        command.epilog = "\n\n".join(filter(None, [f"\b\nExample:\n  {example}", command.epilog]))
    return command


class Commands(click.Group):
    """A group that gives each command what all have in common."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.params.append(quiet_option())

    def add_command(self, cmd: click.Command, name: str | None = None) -> None:
        """Add a command, completed."""
        super().add_command(with_comfort(cmd, EXAMPLES.get(name or cmd.name or "", "")), name)


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> int:
    """Print the script that completes commands, options, filters and files in SHELL.

    For bash it goes to ~/.local/share/bash-completion/completions/wct, for zsh to a file _wct in a folder of $fpath,
    for fish to ~/.config/fish/completions/wct.fish.
    """
    from click.shell_completion import get_completion_class

    found = get_completion_class(shell)
    assert found is not None
    click.echo(found(click.Group(), {}, "wct", "_WCT_COMPLETE").source())
    return 0
