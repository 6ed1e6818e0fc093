"""``wct create``: meshes from nothing, one subcommand per filter that makes one."""

import shlex
from typing import Any

import click

from wct_plugin.cli import filter_options, formats_of_streams
from wct_plugin.cli.commands import with_comfort
from wct_plugin.cli.messages import GOAL_MET
from wct_plugin.cli.output import print_metrics, print_table
from wct_plugin.cli.progress_bar import progress_bar
from wct_plugin.errors import OptionError, WctError
from wct_plugin.pipeline.graph import Step, unplaced_errors
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import WriteMesh
from wct_plugin.pipeline.remaking import flag
from wct_plugin.pipeline.stage import FilterStage, Options, did_you_mean, filter_names, find_filter
from wct_plugin.pipeline.stage_page import about

_VERB = "create_"


def _creators() -> dict[str, type[FilterStage[Options]]]:
    """The filters that make a mesh from nothing, by name without the verb."""
    found = {}
    for name in filter_names():
        if name.startswith(_VERB):
            try:
                found[name.removeprefix(_VERB)] = find_filter(name)
            except WctError:  # another package's; `wct filters` has a line that says so
                continue
    return {name: stage for name, stage in found.items() if stage.starts()}


class _Creations(click.Group):
    """A subcommand per filter, made of its declaration when it is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_creators())

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:
        creators = _creators()
        name = cmd_name.removeprefix(_VERB)
        if name not in creators:
            raise OptionError(f"cannot create {name!r}{did_you_mean(name, creators)} (allowed: {', '.join(creators)})")
        return _command(name, creators[name])


def _command(name: str, stage: type[FilterStage[Options]]) -> click.Command:
    def run(target: str, output_format: str | None, **values: Any) -> int:
        formats_of_streams.leave_stdout(target)
        written = filter_options.given_msh(values) | ({} if output_format is None else {"format": output_format})
        writer = WriteMesh(filename=target, **written)
        chain = Pipeline([Step(stage(**filter_options.given(values, stage.name))), Step(writer)])
        with unplaced_errors(), progress_bar() as progress:
            result = chain.execute(progress)
        print_metrics(f"{stage.type()} -> {target}", result.stages[0].metrics)
        return GOAL_MET

    with_options = filter_options.filter_options(stage.name)(
        filter_options.msh_options(formats_of_streams.output_format(run))
    )
    with_target = click.argument("target", metavar="OUT")(with_options)
    command = click.command(name, help=about(stage), short_help=stage.summary())(with_target)
    given = (part for option, value in stage.example.items() for part in (flag(option), str(value)))
    return with_comfort(command, shlex.join(["wct", "create", name, f"{name}.vtu", *given]))


@click.group("create", cls=_Creations, invoke_without_command=True, subcommand_metavar="NAME OUT [OPTIONS]...")
@click.pass_context
def create(context: click.Context) -> int:
    """Make the mesh NAME from nothing and write OUT; without NAME, list what there is."""
    if context.invoked_subcommand is None:
        rows = [(name, stage.summary()) for name, stage in _creators().items()]
        print_table("wct create NAME OUT", ("name", "makes"), rows, left=True)
    return GOAL_MET
