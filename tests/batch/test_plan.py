"""What a batch refuses before it starts anything, and what it calls its outputs."""

import json
from contextlib import suppress
from pathlib import Path

import pytest
from support.builders import jittered_cube, sphere_surface
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.batch import plan as batch_plan
from wct_plugin.batch.plan import Task, plan, shard
from wct_plugin.pipeline.pipeline import Pipeline

QUALITY = wct.Filter.get_quality()
FILL = wct.Filter.generate_tetrahedralization()
SKIN = wct.Filter.generate_boundary_surface()


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a").mkdir()
    Path("b").mkdir()
    for name in ("x.vtu", "y.msh", "a/x.vtu", "b/x.vtu"):
        wct.write(name, jittered_cube(1))
    for name in ("s.stl", "t.ply"):
        wct.write(name, sphere_surface(20))
    Path("chain.json").write_text('[{"type": "filters.get_quality"}]')
    return tmp_path


def names(pipeline, inputs, suffix=None):
    return [task.name for task in plan(pipeline, inputs, Path("out"), suffix)]


def test_outputs_have_their_inputs_format_or_vtu(place):
    assert names(QUALITY, ["y.msh", "x.vtu"]) == ["x.vtu", "y.msh"]
    assert names(FILL, ["s.stl", "t.ply"]) == ["s.vtu", "t.vtu"]
    assert names(wct.Filter.meshlab(filter="meshing_close_holes"), ["s.stl", "t.ply"]) == ["s.stl", "t.ply"]
    wct.write("z.su2", jittered_cube(1))
    assert names(SKIN, ["y.msh", "z.su2"]) == ["y.msh", "z.vtu"]
    assert names(QUALITY, ["y.msh"], "mesh") == names(QUALITY, ["y.msh"], ".mesh") == ["y.mesh"]


def test_patterns_and_names(place):
    assert [task.source for task in plan(QUALITY, ["*.vtu", "y.*"], Path("out"))] == ["x.vtu", "y.msh"]
    assert batch_plan.expand(["**/x.vtu"]) == ["a/x.vtu", "b/x.vtu", "x.vtu"]
    wct.write("[1].vtu", jittered_cube(1))
    assert batch_plan.expand(["[1].vtu"]) == ["[1].vtu"]


def test_shards_cover_all_once_whatever_their_number(place):
    tasks = [Task(f"{k:03}.vtu", f"{k:03}.vtu") for k in range(17)]
    for count in (1, 2, 5, 17, 20):
        parts = [shard(tasks, (k + 1, count)) for k in range(count)]
        assert sorted((task for part in parts for task in part), key=lambda task: task.name) == tasks
        assert max(map(len, parts)) - min(map(len, parts)) <= 1


REFUSED = {
    "a/x.vtu and b/x.vtu would both be written to out/x.vtu; rename one": ["a/x.vtu", "b/x.vtu"],
    "x.vtu: is given twice": ["*.vtu", "x.vtu"],
    "a/../x.vtu: is given twice, as x.vtu too": ["x.vtu", "a/../x.vtu"],
    "none.vtu: no such file": ["x.vtu", "none.vtu"],
    "none*.vtu: no file matches": ["none*.vtu"],
    "a: is a directory; 'a/*' names the files in it": ["a"],
    "chain.json: unknown suffix '.json'; allowed are .vtu": ["chain.json"],
    "s.stl: stage 1 of 1 (filters.get_quality): needs a tet mesh, here is a surface; put": ["x.vtu", "s.stl"],
}


@pytest.mark.parametrize("reason", REFUSED)
def test_inputs_are_refused_before_anything_starts(reason, place, capsys):
    assert refused(capsys, "batch", "chain.json", *REFUSED[reason], "-o", "out").startswith(reason)
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["-o", "."], "x.vtu would be written over the input x.vtu"),
        (["-o", "a"], "a/x.vtu would be written over the input a/x.vtu"),
        (["-o", "x.vtu"], "x.vtu: is a file; a batch needs a directory for its outputs"),
        (["-o", "out", "--format", "stl"], "x.stl: STL cannot carry a tetrahedral mesh"),
        (["-o", "out", "--format", "vtx"], "x.vtx: unknown suffix '.vtx'"),
        (["-o", "out", "--format", ""], "suffix '' cannot end a file's name; allowed is one such as vtu"),
        (["-o", "out", "--format", "a/b"], "suffix 'a/b' cannot end a file's name; allowed is one such as vtu"),
        (["-o", "out", "--jobs", "0"], "Invalid value for '--jobs': 0 is not in the range x>=1."),
        (["-o", "out", "--timeout", "0"], "timeout is 0.0; allowed is a number above 0"),
        (["-o", "out", "--memory-limit", "-1"], "memory_limit is -1.0; allowed is a number above 0"),
        (["-o", "out", "--shard", "3"], "Invalid value for '--shard': '3' is not i/n, such as 1/8 for the first of"),
        (["-o", "out", "--shard", "3/2"], "shard 3/2: allowed are 1/2 to 2/2"),
        (["-o", "out", "--set", "filters.get_quality.wurst=1"], "chain.json: 'filters.get_quality.wurst=1': unknown"),
        (["-o", "out", "--jobs", "2", "--scheduler", "tcp://localhost:1"], "jobs is for this machine; how many run"),
        ([], "Missing option '-o' / '--output'."),
    ],
)
def test_options_are_refused_before_anything_starts(options, reason, place, capsys):
    before = sorted(place.rglob("*"))
    inputs = ["a/x.vtu"] if "a" in options else ["x.vtu"]
    assert refused(capsys, "batch", "chain.json", *inputs, *options).startswith(reason)
    assert sorted(place.rglob("*")) == before


@pytest.mark.parametrize(
    ("stages", "reason"),
    [
        ([], "the pipeline has no stages"),
        (["x.vtu", {"type": "filters.get_quality"}], "stage 1 of 2 (readers.mesh): a batch's pipeline holds filters"),
        ([{"type": "filters.get_quality"}, "o.vtu"], "stage 2 of 2 (writers.mesh): a batch's pipeline holds filters"),
        ([{"type": "filters.get_quality"}, {"type": "filters.meshlab"}], "stage 2 of 2 (filters.meshlab):"),
        ([{"type": "filters.create_cube"}], "stage 1 of 1 (filters.create_cube): makes a mesh from nothing; a batch's"),
        ([{"type": "filters.get_qualty"}], "bad.json: stage 1 of 1 (filters.get_qualty): unknown stage"),
    ],
)
def test_pipelines_are_refused_before_anything_starts(stages, reason, place, capsys):
    Path("bad.json").write_text(json.dumps(stages))
    said = refused(capsys, "batch", "bad.json", "x.vtu", "-o", "out")
    assert said.startswith((reason, f"bad.json: {reason}"))
    assert not Path("out").exists()


def test_companions_of_a_file_collide_too(place, capsys):
    wct.write("t.node", jittered_cube(1))
    assert Path("t.ele").exists()
    said = refused(capsys, "batch", "chain.json", "t.node", "t.ele", "-o", "out")
    assert said.startswith("t.ele and t.node would both be written to out/t.node")
    assert "would be written over the input t.node" in refused(capsys, "batch", "chain.json", "t.node", "-o", ".")


def test_an_output_directory_that_takes_no_file(small_disk, place, capsys):
    with suppress(OSError):  # until it is full
        (small_disk / "fill").write_bytes(bytes(1 << 20))
    assert str(small_disk / "out") in refused(capsys, "batch", "chain.json", "x.vtu", "-o", small_disk / "out")


def test_the_fingerprint_is_that_of_what_the_pipeline_does(place):
    def of(*stages):
        return batch_plan.fingerprint(Pipeline.from_json(list(stages)))

    one = {"type": "filters.meshing_well_centered", "goal": "3wc", "seed": 1}
    assert of(one) == of(dict(reversed(one.items())))
    assert of(one) != of({**one, "seed": 2})
    assert len({of(one), of(one, {"type": "filters.get_quality"})}) == 2
    marker = {"type": "filters.meshing_well_centered", "reference": "s.stl"}
    before = of(marker)
    wct.write("s.stl", sphere_surface(21))
    assert of(marker) != before
