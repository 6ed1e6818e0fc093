"""``wct filters``: the list of filters, and a page for each."""

import json
from typing import Any

import click

from wct_plugin.cli.messages import GOAL_MET
from wct_plugin.cli.output import check_apart, check_outputs, print_page, print_table, write_text
from wct_plugin.errors import WctError
from wct_plugin.pipeline import stage_page
from wct_plugin.pipeline.stage import FilterStage, Options, filter_names, find_filter


def _complete_filter(_context: click.Context, _param: click.Parameter, begun: str) -> list[str]:
    return [name for name in filter_names() if name.startswith(begun)]


@click.command()
@click.argument("name", required=False, shell_complete=_complete_filter)
@click.option("--json", "json_path", metavar="FILE", help="Write the declarations as JSON schema (- for stdout)")
@click.option("--markdown", "markdown_path", metavar="FILE", help="Write the filters' pages as Markdown (- for stdout)")
def filters(name: str | None, json_path: str | None, markdown_path: str | None) -> int:
    """List the filters, or print one filter's page: what it does, its options, their ranges and defaults."""
    check_apart([], json_path, markdown_path)
    check_outputs(json_path, markdown_path)
    found: dict[str, type[FilterStage[Options]]] = {}
    broken: dict[str, str] = {}
    for one in [name] if name else filter_names():
        try:
            found[one] = find_filter(one)
        except WctError as error:  # another package's; the list has a line that says so
            if name:
                raise
            broken[one] = str(error)
    if json_path:
        schema: dict[str, Any] = {one: {"error": message} for one, message in broken.items()}
        for stage in found.values():
            schema[stage.name] = {"summary": stage.summary(), "options": stage.declaration.model_json_schema()}
        write_text(json_path, json.dumps(schema, indent=2))
    if markdown_path:
        write_text(markdown_path, stage_page.markdown(found.values()))
    if "-" in (json_path, markdown_path):
        return GOAL_MET
    if name:
        print_page(*found.values())
        return GOAL_MET
    lines = {one: stage.summary() for one, stage in found.items()} | broken
    print_table("Filters", ("filter", "does"), sorted(lines.items()), left=True)
    return GOAL_MET
