"""Random options of a filter, from its declaration: most in range, some at its ends, some beyond."""

import random
from typing import Any

from wct_plugin.pipeline.stage import find_filter

#: Of options that multiply the work, the most that a case may ask for; what a case may not be given at all.
_MOST = {
    "effort": 2,
    "max_tets": 3000,
    "size": 4,
    "divisions": 3,
    "max_rounds": 20,
    "iterations": 50,
    "num_opt_iter": 5,
}
_UNTOLD = ("edge_length",)
_NEVER = ("reference", "max_bytes", "timeout", "memory_limit", "filename", "script")
_WORDS = (
    "",
    "x",
    "*",
    "1e400",
    "nan",
    "move",
    "keep",
    "fixed",
    "*=fixed",
    "12=fixed,*=move",
    "11=keep",
    "1=0.5,*=0.7",
    "é",
    "a=b=c",
)


_BOUNDARY = ("move", "keep", "fixed", "*=fixed", "12=fixed,*=move", "11=keep,*=move")


def _number(draw: random.Random, name: str, schema: dict[str, Any]) -> Any:
    whole = schema["type"] == "integer"
    low = schema.get("minimum", schema.get("exclusiveMinimum", 0))
    high = schema.get("maximum", schema.get("exclusiveMaximum", max(10, 10 * low)))
    high = min(high, _MOST.get(name, high))
    way = draw.random()
    if way < 0.015:
        return draw.choice((low - 1, high + 1, -1, 0, 1e300, 2**63, "x", None))
    if way < 0.15 and "exclusiveMinimum" not in schema:
        return draw.choice((low, high))
    if whole:
        return draw.randint(int(low), int(high))
    value = low + (high - low) * 10.0 ** -draw.uniform(0, 4)
    return value if value > low else high


def _value(draw: random.Random, name: str, schema: dict[str, Any], definitions: dict[str, Any]) -> Any:
    if "$ref" in schema:
        schema = definitions[schema["$ref"].rpartition("/")[2]]
    if "anyOf" in schema:
        return _value(draw, name, draw.choice(schema["anyOf"]), definitions)
    if "enum" in schema:
        return draw.choice(schema["enum"]) if draw.random() < 0.99 else "no such word"
    if "const" in schema:
        return schema["const"]
    match schema.get("type"):
        case "boolean":
            return draw.random() < 0.5
        case "integer" | "number":
            return _number(draw, name, schema)
        case "string" if name == "boundary" and draw.random() < 0.8:
            return draw.choice(_BOUNDARY)
        case "string":
            return draw.choice(_WORDS)
        case "array":
            return [
                _value(draw, name, schema.get("items", {"type": "number"}), definitions)
                for _ in range(draw.randint(0, 3))
            ]
        case "object":
            return {draw.choice(("1", "*", "11", "x")): draw.uniform(0.1, 2) for _ in range(draw.randint(0, 2))}
    return None


def options_of(draw: random.Random, name: str) -> dict[str, Any]:
    """Some options of the filter, each with some value."""
    schema = find_filter(name).declaration.model_json_schema()
    given = {}
    for option, declared in schema.get("properties", {}).items():
        needed = option in schema.get("required", ())
        if option in _NEVER or (not needed and draw.random() > 0.25):
            continue
        value = _value(draw, option, declared, schema.get("$defs", {}))
        if option in _UNTOLD and draw.random() < 0.7:  # of these the declaration does not tell what is allowed
            value = draw.uniform(0.1, 1)
        if value is not None or draw.random() < 0.1:
            given[option] = value
    if draw.random() < 0.01:
        given["no_such_option"] = 1
    return given
