"""The option ``--set STAGE.OPTION=VALUE`` of commands that run pipelines, and how it is completed."""

from collections.abc import Iterator, Sequence

import click
from click.shell_completion import CompletionItem

from wct_plugin.errors import WctError
from wct_plugin.pipeline import json_form, presets
from wct_plugin.pipeline.graph import Step
from wct_plugin.pipeline.stage_page import words


def _complete(context: click.Context, _param: click.Parameter, begun: str) -> list[CompletionItem]:
    """Stages of the pipeline, then the options of one, then the words that the option may be."""
    chain = context.params.get("chain") or next(iter(context.args), "")  # click stops at an option without its value
    try:
        steps = json_form.parse(presets.read(chain))
    except WctError:  # there is nothing to complete yet
        return []
    return [CompletionItem(one) for one in _settings(steps, begun) if one.startswith(begun)]


def _settings(steps: Sequence[Step], begun: str) -> Iterator[str]:
    path, equals, _ = begun.partition("=")
    for step in steps:
        for name in filter(None, (step.tag, step.stage.type())):
            fields = step.stage.declaration.model_fields
            if not path.startswith(f"{name}."):
                yield f"{name}."
            elif not equals:
                yield from (f"{name}.{option}=" for option in fields)
            elif (option := path.removeprefix(f"{name}.")) in fields:
                yield from (f"{path}={word}" for word in words(fields[option].annotation))


set_option = click.option(
    "--set",
    "settings",
    metavar="STAGE.OPTION=VALUE",
    multiple=True,
    shell_complete=_complete,
    help="Set an option; the stage by type or tag",
)
