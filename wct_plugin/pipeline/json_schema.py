"""The JSON schema (draft 2020-12) of pipelines, made from the declarations of every stage."""

from typing import Any

from wct_plugin.errors import WctError
from wct_plugin.pipeline.json_form import KEYS
from wct_plugin.pipeline.readers_writers import ENDS
from wct_plugin.pipeline.stage import Options, Stage, filter_names, find_filter

_TAGS = {
    "tag": {"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_-]*$", "description": "Name, for the inputs of others"},
    "inputs": {
        "description": "Tag of the stage whose mesh it takes, or a list (default: the stage before)",
        "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}],
    },
}
_FILE = {
    "type": "object",
    "description": "A file: read if it comes first, else written",
    "properties": {"filename": {"type": "string", "minLength": 1}, **_TAGS},
    "required": ["filename"],
    "additionalProperties": False,
}


def schema() -> dict[str, Any]:
    """What any JSON pipeline of the registered stages fits; filters that cannot be imported are left out."""
    stages: list[type[Stage[Options]]] = list(ENDS.values())
    for name in filter_names():
        try:
            stages.append(find_filter(name))
        except WctError:  # whoever names it in a pipeline is told why
            continue
    definitions = {stage.type(): _stage(stage) for stage in stages}
    any_stage = [{"type": "string", "minLength": 1}, {"$ref": "#/$defs/file"}]
    any_stage += [{"$ref": f"#/$defs/{name}"} for name in definitions]
    array = {"type": "array", "minItems": 1, "items": {"anyOf": any_stage}}
    pipeline, *texts = KEYS
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "wct pipeline",
        "anyOf": [
            {"$ref": "#/$defs/stages"},
            {
                "type": "object",
                "properties": {pipeline: {"$ref": "#/$defs/stages"}, **{text: {"type": "string"} for text in texts}},
                "required": [pipeline],
                "additionalProperties": False,
            },
        ],
        "$defs": {"stages": array, "file": _FILE, **definitions},
    }


def _stage(stage: type[Stage[Options]]) -> dict[str, Any]:
    made = stage.declaration.model_json_schema(ref_template=f"#/$defs/{stage.type()}/$defs/{{model}}")
    tags = {"tag": _TAGS["tag"]} if stage.starts() else _TAGS
    return {
        **made,
        "title": stage.type(),
        "description": stage.summary(),
        "properties": {"type": {"const": stage.type()}, **made.get("properties", {}), **tags},
        "required": ["type", *made.get("required", [])],
        "additionalProperties": False,
    }
