"""The commands of ``wct``, and the options all of them share; an example in their help, completion."""

from importlib import import_module
from typing import Any, NamedTuple

import click
from click.shell_completion import CompletionItem

from wct_plugin.cli.messages import be_quiet, be_verbose
from wct_plugin.cli.printed_options import help_option, version_option
from wct_plugin.cli.save_case import save_case_option


class Listed(NamedTuple):
    """A command of ``wct`` as its list shows it, and where it is."""

    place: str  #: module in this package, and name in it
    summary: str  #: first sentence of its help
    example: str  #: as one would type it


COMMANDS = {
    "batch": Listed(
        "batch:batch",
        "Run PIPELINE on many files, each in a process of its own.",
        "wct batch repair-ftetwild 'scans/*.ply' -o out --jobs 4 --timeout 600",
    ),
    "completion": Listed(
        "completion:completion",
        "Print the script that completes commands, options, filters and files in SHELL.",
        "wct completion bash > ~/.local/share/bash-completion/completions/wct",
    ),
    "create": Listed(
        "create:create",
        "Make the mesh NAME from nothing and write OUT; without NAME, list what there is.",
        "wct create cube cube.vtu --variant 84",
    ),
    "demo": Listed(
        "demo:demo",
        "Write small samples into DIR, by default the current folder, and make the tets of one well-centered.",
        "wct demo samples",
    ),
    "dual": Listed(
        "dual:dual",
        "Write the circumcentric dual of the tet mesh IN: Voronoi cells, or the matrices of exterior calculus.",
        "wct dual bone.vtu cells.vtu",
    ),
    "filters": Listed(
        "filters:filters",
        "List the filters, or print one filter's page: what it does, its options, their ranges and defaults.",
        "wct filters meshing_well_centered",
    ),
    "optimize": Listed(
        "optimize:optimize",
        "Improve the tets of IN and write OUT; a surface IN goes through fTetWild or TetGen first.",
        "wct optimize bone.ply bone.vtu --tolerance 1e-3 --html bone.html",
    ),
    "report": Listed(
        "report:report",
        "Measure tet meshes, several side by side: ranges, tiers, flags, histograms, the worst tets with their place.",
        "wct report before.vtu after.vtu --html compared.html",
    ),
    "run": Listed(
        "run:run_pipeline",
        "Run PIPELINE: a JSON file, - for stdin, or the name of a ready-made one.",
        "wct run chain.json bone.ply bone.vtu --set filters.meshing_well_centered.goal=3wc",
    ),
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


def verbose_option() -> click.Option:
    """``--verbose``, which every command has too."""
    return click.Option(
        ["-v", "--verbose"],
        is_flag=True,
        expose_value=False,
        callback=_verbose,
        help="Print what is done as it is done: stages, their phases and seconds, programs that are called",
    )


def _verbose(context: click.Context, _: click.Parameter, value: bool) -> None:
    if value:
        context.call_on_close(be_verbose())


def _quiet(context: click.Context, _: click.Parameter, value: bool) -> None:
    if value:
        context.call_on_close(be_quiet())


def with_comfort(command: click.Command, example: str) -> click.Command:
    """The command, with what all have in common."""
    command.params += [quiet_option(), verbose_option(), save_case_option(), help_option()]
    for param in command.params:
        if param.metavar in _FILES and type(param.type) is type(click.STRING):
            param.type = click.Path(allow_dash=True)
    if example:
        command.epilog = "\n\n".join(filter(None, [f"\b\nExample:\n  {example}", command.epilog]))
    return command


class Commands(click.Group):
    """``wct`` itself: it imports a command when that is asked for, and none to list or complete their names."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.params += [version_option(), quiet_option(), verbose_option(), help_option()]

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, completed; None where there is none of that name."""
        if cmd_name in COMMANDS and cmd_name not in self.commands:
            module, _, name = COMMANDS[cmd_name].place.partition(":")
            command = getattr(import_module(f"wct_plugin.cli.{module}"), name)
            self.add_command(with_comfort(command, COMMANDS[cmd_name].example), cmd_name)
        return self.commands.get(cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands into the help."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, one.summary) for name, one in COMMANDS.items()])

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Commands that begin so, and options."""
        names = [
            CompletionItem(name, help=one.summary) for name, one in COMMANDS.items() if name.startswith(incomplete)
        ]
        return names + click.Command.shell_complete(self, ctx, incomplete)
