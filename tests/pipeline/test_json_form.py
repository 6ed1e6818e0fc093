"""Pipelines as JSON: read, written, set from outside, refused clearly; the schema says the same as the parser."""

import json
import re
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from support.builders import jittered_cube, sphere_surface

import wct_plugin as wct
from wct_plugin.errors import InputError, OptionError, WctError
from wct_plugin.pipeline import json_form, presets
from wct_plugin.pipeline.json_schema import schema
from wct_plugin.pipeline.pipeline import Pipeline

DOCS = Path(__file__).parents[2] / "docs"
QUALITY = {"type": "filters.get_quality"}
LONG = [
    {"type": "readers.mesh", "filename": "a.vtu", "tag": "raw"},
    {"type": "filters.meshing_well_centered", "tolerance": 1e-3, "boundary": "move", "tag": "better"},
    "a.html",
    {"type": "filters.get_quality", "inputs": ["raw"]},
    {"type": "writers.report", "filename": "both.json", "inputs": ["raw", "better"]},
]
VALID = [
    ["a.vtu", QUALITY, "b.vtu", "b.html"],
    {"pipeline": ["a.vtu"], "description": "reads", "$schema": "x"},
    [QUALITY],
    [{"filename": "a.vtu", "tag": "raw"}, {**QUALITY, "inputs": "raw"}, {"filename": "b.vtu", "inputs": ["raw"]}],
    LONG,
]


def types(content):
    return [step.stage.type() for step in Pipeline.from_json(content).steps]


def test_strings_are_files_by_where_they_stand_and_end():
    assert types(["a.vtu"]) == ["readers.mesh"]
    assert types([QUALITY, "b.vtu", "b.HTML", "c.json"]) == [
        "filters.get_quality", "writers.mesh", "writers.report", "writers.report",
    ]  # fmt: skip
    assert types([{"filename": "a.json"}, {"filename": "b.json"}]) == ["readers.mesh", "writers.report"]


@pytest.mark.parametrize("content", VALID)
def test_array_or_object_and_there_and_back(content):
    pipeline = Pipeline.from_json(json.dumps(content))
    again = Pipeline.from_json(json_form.text(pipeline.to_json()))
    assert [(step.stage.options, step.tag, step.inputs) for step in pipeline.steps] == [
        (step.stage.options, step.tag, step.inputs) for step in again.steps
    ]
    assert again.to_json() == pipeline.to_json()


def test_written_as_short_as_it_goes():
    chain = wct.Reader("a.ply") | wct.Filter.get_quality(worst=2) | wct.Writer("b.vtu") | wct.Writer("c.vtu", tag="c")
    assert chain.to_json() == [
        "a.ply",
        {"type": "filters.get_quality", "worst": 2},
        "b.vtu",
        {"type": "writers.mesh", "filename": "c.vtu", "tag": "c"},
    ]
    # A string in second place would be written, so a reader there is an object.
    assert (wct.Filter.get_quality() | wct.Reader("b.vtu")).to_json()[1] == {
        "type": "readers.mesh",
        "filename": "b.vtu",
    }


def test_what_is_in_memory_has_no_json():
    chain = wct.Filter.meshing_well_centered(reference=sphere_surface(20))
    with pytest.raises(
        OptionError, match=r"stage 1 of 1 \(filters.meshing_.*\): option 'reference' is a SurfaceMesh in"
    ):
        chain.to_json()


# --- settings -------------------------------------------------------------------------------------------------------


def test_settings_name_a_stage_by_type_or_tag_and_values_are_json_or_text():
    settings = ["better.boundary=keep", "filters.meshing_well_centered.tolerance=5e-4", "better.edge_length=size"]
    settings += ["better.margin=0", "readers.mesh.filename=c.vtu"]
    reader, optimizer = Pipeline.from_json(LONG, settings).steps[:2]
    given = optimizer.stage.options
    assert (given.boundary, given.tolerance, given.edge_length, given.margin) == ("keep", 5e-4, "size", 0.0)
    assert reader.stage.options.filename == "c.vtu"
    assert LONG[1]["boundary"] == "move"


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("better", "'better' is not stage.option=value"),
        ("better=1", "'better=1' is not stage.option=value"),
        (
            "filters.meshing_well_centred.seed=1",
            "no stage 'filters.meshing_well_centred' in the pipeline; did you mean",
        ),
        ("better.sed=1", "unknown option 'sed'; did you mean 'seed'"),
        ("better.tag=x", "unknown option 'tag'"),
        ("writers.report.worst=1", "2 stages are 'writers.report'; give them tags and name one"),
        ("better.seed=-1", r"^stage 2 of 5 \(filters.meshing_well_centered\): option 'seed' is -1; input should be"),
    ],
)
def test_bad_settings(setting, message):
    with pytest.raises(OptionError, match=message):
        Pipeline.from_json(LONG, [setting])


# --- the documentation ----------------------------------------------------------------------------------------------


def test_the_pipelines_in_docs_are_pipelines(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```json\n(.*?)```", (DOCS / "pipelines.md").read_text(), re.DOTALL)
    assert len(blocks) == 2
    wct.write("bone.ply", sphere_surface(20))
    wct.write("part.msh", jittered_cube(2, 0))
    for block in blocks:
        Draft202012Validator(schema()).validate(json.loads(block))
        Pipeline.from_json(block).check(read=True)
    table = (DOCS / "pipelines.md").read_text()
    assert re.findall(r"^\| `([a-z-]+)` \|", table, re.MULTILINE) == presets.names()


# --- what is no pipeline --------------------------------------------------------------------------------------------

BAD = [
    ({}, "the object has no key 'pipeline'"),
    ({"pipeline": ["a.vtu"], "pipelines": 1}, "unknown key 'pipelines' beside the pipeline; did you mean 'pipeline'"),
    ({"pipeline": "a.vtu"}, "a pipeline is an array of stages, here is the string 'a.vtu'"),
    (3, "a pipeline is an array of stages, here is 3"),
    (None, "here is null"),
    (["a.vtu", 3], "stage 2 of 2: a stage is a file's name or an object, here is 3"),
    (["a.vtu", []], "here is an array"),
    (["a.vtu", {"worst": 3}], "stage 2 of 2: needs a 'type', such as"),
    ([""], "stage 1 of 1: needs a 'type', such as filters.meshing_well_centered, or the name of a file"),
    ([{"type": 3}], "stage 1 of 1: 'type' must be a string, here is 3"),
    ([{"type": "filters.get_qualty"}], "unknown stage 'filters.get_qualty'; did you mean 'filters.get_quality'"),
    ([{"type": "filter.get_quality"}], "did you mean 'filters.get_quality'"),
    ([{"type": "get_quality"}], "did you mean 'filters.get_quality'"),
    ([{"type": "writers.vtu", "filename": "a.vtu"}], r"unknown stage 'writers.vtu'.* \(allowed: readers.mesh, writers"),
    (["a.vtu", {**QUALITY, "wurst": 3}], r"stage 2 of 2 \(filters.get_quality\): unknown option 'wurst'; did you mean"),
    (["a.vtu", {**QUALITY, "worst": -3}], r"stage 2 of 2 \(filters.get_quality\): option 'worst' is -3; input should"),
    (["a.vtu", {**QUALITY, "filename": "x"}], "unknown option 'filename'"),
    ([{"type": "readers.mesh"}], r"stage 1 of 1 \(readers.mesh\): option 'filename' is missing"),
    ([{"type": "readers.mesh", "filename": 3}], "option 'filename' is 3; must be the name of a mesh file"),
    ([{**QUALITY, "tag": ""}], "'tag' must be a string that is not empty"),
    ([{**QUALITY, "tag": 3}], "'tag' must be a string"),
    ([{**QUALITY, "inputs": []}], "'inputs' is empty"),
    ([{**QUALITY, "inputs": [3]}], "'inputs' must be a tag or a list of tags"),
    ([{**QUALITY, "inputs": {"a": 1}}], "'inputs' must be a tag or a list of tags, here is an object"),
]


@pytest.mark.parametrize(("content", "message"), BAD)
def test_bad_pipelines(content, message):
    with pytest.raises(OptionError, match=message) as caught:
        Pipeline.from_json(json.dumps(content))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('["a.vtu",\n  x]', "the pipeline is no JSON: line 2, column 3: Expecting value"),
        ("", "is no JSON: line 1, column 1"),
        (b'["\xff"]', "is no JSON: not UTF-8 at byte 2"),
        ('[{"type": "filters.get_quality", "worst": 1, "worst": 2}]', "two keys 'worst'"),
        ("[" * 100_000, "nested too deep"),
    ],
)
def test_what_is_no_json(text, message):
    with pytest.raises(InputError, match=message):
        Pipeline.from_json(text)


# --- the schema -----------------------------------------------------------------------------------------------------


def test_the_schema_is_one():
    Draft202012Validator.check_schema(schema())
    found = schema()["$defs"]["filters.meshing_well_centered"]
    assert found["properties"]["goal"]["enum"] == ["delaunay", "one-sided", "3wc", "cwc"]
    assert found["properties"]["crease_angle"]["exclusiveMaximum"] == 180


@pytest.mark.parametrize("content", VALID)
def test_the_schema_takes_what_the_parser_takes(content):
    Draft202012Validator(schema()).validate(content)


@pytest.mark.parametrize("content", [content for content, _ in BAD])
def test_the_schema_refuses_what_the_parser_refuses(content):
    with pytest.raises(WctError):
        Pipeline.from_json(content)
    assert not Draft202012Validator(schema()).is_valid(content)
