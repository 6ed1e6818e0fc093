"""The JSON schema of reports holds for all that is written, and says something."""

import json
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from support.builders import ball, bcc, jittered_cube, single, sphere_surface

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.errors import OptionError
from wct_plugin.reports.json_schema import schema
from wct_plugin.reports.report import make_report

CHECK = Draft202012Validator(schema())


def errors(found):
    return [error.message for error in CHECK.iter_errors(json.loads(json.dumps(found, allow_nan=False)))]


def test_the_schema_is_one_and_describes_every_key():
    Draft202012Validator.check_schema(schema())
    described = schema()["$defs"]["report"]["properties"]
    assert set(described) == set(make_report(bcc(2)).to_dict()) == set(schema()["$defs"]["report"]["required"])


def test_it_holds_for_any_mesh():
    flat = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1e-12]])
    for mesh in (bcc(2), jittered_cube(3), replace(ball(2), reference=sphere_surface(50)), flat):
        assert errors(make_report(mesh).to_dict()) == []
    for mesh in (bcc(2), jittered_cube(3)):
        assert errors(make_report(mesh, exact=True).to_dict()) == []
    broken = replace(make_report(bcc(2)), volume=float("inf"))
    assert errors(broken.to_dict()) == []


@pytest.mark.parametrize(
    "change",
    [
        {"tets": -1},
        {"tier": "best"},
        {"3wc": {"count": 1}},
        {"histograms": {}},
        {"deviation": {"max": 0.1}},
        {"unknown": 1},
        {"worst": [{"tet": 0}]},
    ],
)
def test_it_refuses_what_is_no_report(change):
    found = make_report(bcc(2)).to_dict()
    assert errors(found | change)
    assert errors([found, found | change])
    assert errors({key: value for key, value in found.items() if key != "volume"})


def test_it_holds_for_what_the_command_line_writes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    wct.write("a.vtu", jittered_cube(3))
    wct.write("flat.vtu", single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]]))
    assert main.run(["report", "a.vtu", "--json", "one.json"]) == 0
    assert main.run(["report", "a.vtu", "flat.vtu", "--json", "two.json"]) == 0
    assert main.run(["optimize", "flat.vtu", "out.vtu", "--boundary", "fixed", "--json", "made.json"]) == 1
    capsys.readouterr()
    one, two, made = (json.loads((tmp_path / f"{name}.json").read_text()) for name in ("one", "two", "made"))
    for found in (one, two, made):
        assert errors(found) == []
    assert two[0] == one
    stages = made["provenance"]["stages"]
    assert [stage["type"] for stage in stages] == ["readers.mesh", "filters.meshing_well_centered"]
    assert stages[1]["given"] == ["boundary"]
    assert stages[1]["options"]["boundary"] == "fixed"
    assert all(stage["seconds"] > 0 for stage in stages)
    assert made["provenance"]["versions"]["numpy"] == np.__version__
    assert made["after"]["tolerance"] > 0
    assert made["after"]["remaining"]["count"] == 1
    assert main.run(["report", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out) == schema()


@pytest.mark.parametrize("tag", ["filters", "provenance"])
def test_no_mesh_may_take_a_name_that_means_something_else(tag, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("a.vtu", bcc(2))
    first = wct.Reader("a.vtu", tag=tag) | wct.Filter.get_quality(tag="q")
    with pytest.raises(OptionError, match=f"no input may have the tag '{tag}'"):
        (first | wct.Writer("r.json", inputs=[tag, "q"])).check()
