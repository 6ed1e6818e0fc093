"""Pipelines in Python: joined by |, with branches, checked as a whole, nothing written before everything has run."""

import json
from dataclasses import replace

import numpy as np
import pytest
from pydantic import Field
from support.builders import ball, bcc, jittered_cube, single, sphere_surface

import wct_plugin as wct
from wct_plugin.errors import InputError, OptionError, OutputError, WctError
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.graph import Step
from wct_plugin.pipeline.pipeline import Pipeline, mesher_within_tolerance
from wct_plugin.pipeline.stage import FilterStage, Options, find_filter
from wct_plugin.progress import Progress

CUBE = jittered_cube(4, 0)
RAN: list[str] = []


class ScaleOptions(Options):
    by: float = Field(2.0, gt=0, description="Factor")


class Scale(FilterStage[ScaleOptions]):
    """Scale a tet mesh."""

    name = "scale"
    takes = TetMesh
    gives = TetMesh
    declaration = ScaleOptions

    def run(self, mesh, progress):
        RAN.append("scale")
        progress(Progress("scaling", 1.0))
        return replace(mesh, points=mesh.points * self.options.by), {"by": self.options.by}


class Skin(FilterStage[Options]):
    """Give the boundary."""

    name = "skin"
    takes = TetMesh
    gives = SurfaceMesh
    declaration = Options

    def run(self, mesh, progress):
        RAN.append("skin")
        return mesh.boundary_surface(), {}


class Make(FilterStage[Options]):
    """Make a mesh from nothing."""

    name = "make"
    takes = None
    gives = TetMesh
    declaration = Options

    def run(self, mesh, progress):
        assert mesh is None
        return CUBE, {"tets": len(CUBE.tets)}


class FillOptions(Options):
    epsilon: float = Field(1e-3, gt=0, description="Distance from the surface")


class Fill(FilterStage[FillOptions]):
    """Stand in for a mesher."""

    name = "fill"
    takes = SurfaceMesh
    gives = TetMesh
    declaration = FillOptions

    def run(self, mesh, progress):
        return ball(2), {"epsilon": self.options.epsilon}


class Fail(Scale):
    name = "fail"

    def run(self, mesh, progress):
        raise InputError("tet 7 is of no use")


class Picky(Scale):
    name = "picky"

    def validate(self):
        raise OptionError("filters.picky: no such neighbour")


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", CUBE)
    wct.write("ball.ply", sphere_surface(40))
    RAN.clear()
    return tmp_path


def names(folder):
    return sorted(path.name for path in folder.iterdir())


# --- what runs ------------------------------------------------------------------------------------------------------


def test_a_row_reads_runs_and_writes(place):
    heard = []
    chain = wct.Reader("cube.vtu") | Scale(by=3) | wct.Filter.get_quality(worst=2) | wct.Writer("out.vtu")
    result = chain.execute(lambda state: heard.append((state.number, state.count, state.stage)))
    assert heard == [(1, 4, "reading cube.vtu"), (2, 4, "scaling"), (4, 4, "writing out.vtu")]
    assert np.array_equal(wct.read("out.vtu").points, 3.0 * CUBE.points)
    assert result.stages[-1].flow.report().source == "out.vtu"
    assert result.mesh.source == "cube.vtu"
    assert result.metrics["scale"] == {"by": 3.0}
    assert len(result.metrics["get_quality"]["worst"]) == 2
    assert result.metrics["get_quality"]["volume"] == pytest.approx(27.0)
    assert [one.stage.type() for one in result.stages] == [
        "readers.mesh", "filters.scale", "filters.get_quality", "writers.mesh",
    ]  # fmt: skip
    assert result.goals == ()
    assert result.goal_met
    assert names(place) == ["ball.ply", "cube.vtu", "out.vtu"]


@pytest.mark.filterwarnings("ignore:edges that bend", "ignore:the volume")  # of so coarse a ball
def test_from_a_surface_to_a_well_centered_mesh_against_it(place):
    mesher = wct.Filter.generate_tetrahedralization(edge_length=0.3, epsilon=0.02, stop_energy=50)
    chain = mesher | wct.Filter.meshing_well_centered(goal="3wc")
    result = (wct.Reader("ball.ply") | chain | wct.Writer("ball.vtu") | wct.Writer("ball.json")).execute()
    found = json.loads((place / "ball.json").read_text())
    assert (found["source"], found["tets"]) == ("ball.vtu", len(wct.read("ball.vtu").tets))
    assert len(result.mesh.reference.triangles) == len(sphere_surface(40).triangles)
    assert found["deviation"] == result.metrics["meshing_well_centered"]["deviation"]
    assert [goal.goal for goal in result.goals] == ["3wc"]
    lost = result.metrics["meshing_well_centered"]["losses"]
    assert result.goal_met == (found["3wc"]["count"] == found["tets"] and not lost)


def test_a_pipeline_without_reader_is_applied_to_a_mesh_or_to_any_file(place):
    chain = Scale() | Pipeline() | Scale()
    assert chain.is_open
    assert np.array_equal(chain.apply(CUBE).mesh.points, 4.0 * CUBE.points)
    chain.between("cube.vtu", ["a.vtu", "a.json"]).execute()
    assert names(place) == ["a.json", "a.vtu", "ball.ply", "cube.vtu"]
    with pytest.raises(OptionError, match=r"stage 1 of 3 \(readers.mesh\): needs no input"):
        (wct.Reader("cube.vtu") | chain).apply(CUBE)


def test_the_same_filter_twice_keeps_both_metrics():
    result = (Scale(by=3) | Pipeline() | Scale(by=5)).apply(CUBE)
    assert result.metrics == {"scale": {"by": 3.0}, "scale_2": {"by": 5.0}}


def test_branches_by_tags(place):
    chain = (
        wct.Reader("cube.vtu", tag="raw")
        | Scale(by=2)
        | wct.Writer("twice.vtu", tag="twice")
        | wct.Filter.get_quality(inputs="raw")
        | wct.Writer("once.json")
        | wct.Writer("both.json", inputs=["raw", "twice"])
    )
    result = chain.execute()
    assert result["twice"].flow.written == "twice.vtu"
    assert json.loads((place / "once.json").read_text())["volume"] == pytest.approx(1.0)
    both = json.loads((place / "both.json").read_text())
    assert list(both) == ["raw", "twice", "filters", "provenance"]
    assert [both[tag]["volume"] for tag in ("raw", "twice")] == pytest.approx([1.0, 8.0])
    assert both["filters"] == {"scale": {"by": 2.0}}
    with pytest.raises(OptionError, match=r"no stage has the tag 'rew'; did you mean 'raw'\? \(tags: raw, twice\)"):
        result["rew"]


def test_inputs_may_come_later_in_the_list(place):
    steps = (
        wct.Writer("out.vtu", inputs="big") | wct.Reader("cube.vtu", tag="cube") | Scale(by=2) | wct.Writer("x.vtu")
    ).steps
    tagged = [replace(step, tag="big") if step.stage.name == "scale" else step for step in steps]
    Pipeline(tagged).execute()
    assert np.array_equal(wct.read("out.vtu").points, 2.0 * CUBE.points)


def test_reports_side_by_side_are_measured_against_one_reference(place):
    near, far = sphere_surface(400), sphere_surface(400, radius=1.1)
    chain = wct.Reader(replace(ball(2), reference=far), tag="start") | Refer(near) | wct.Writer("out.vtu", tag="end")
    (chain | wct.Writer("both.json", inputs=["start", "end"])).execute()
    both = json.loads((place / "both.json").read_text())
    assert both["start"]["deviation"] == both["end"]["deviation"] != None  # noqa: E711


class HurryOptions(Options):
    goal: str = Field("soon", description="Not one of a mesh")


class Hurry(Scale):
    name = "hurry"
    declaration = HurryOptions

    def run(self, mesh, progress):
        return mesh, {}


class Refer(Scale):
    name = "refer"

    def __init__(self, surface):
        super().__init__()
        self._surface = surface

    def run(self, mesh, progress):
        return replace(mesh, reference=self._surface), {}


def test_what_the_optimiser_measured_is_in_the_report_until_the_shape_changes(place):
    flat = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]])
    fixed = wct.Filter.meshing_well_centered(boundary="fixed")
    chain = wct.Reader(flat) | fixed | wct.Filter.get_quality() | wct.Writer("kept.json") | Scale()
    (chain | wct.Writer("changed.json")).execute()
    assert json.loads((place / "kept.json").read_text())["remaining"]["count"] == 1
    assert json.loads((place / "changed.json").read_text())["remaining"] is None


def test_the_goal_that_counts_is_the_last_one_of_each_branch():
    hopeless = single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]])
    move = wct.Filter.apply_coord_well_centering
    assert not move(goal="3wc").apply(hopeless).goal_met
    goals = (move(goal="3wc") | move(goal="cwc") | Scale()).apply(bcc(2)).goals
    assert [(goal.goal, goal.missed) for goal in goals] == [("cwc", 0)]
    branches = move(goal="3wc", tag="a") | Scale() | move(goal="cwc", inputs="start")
    start = wct.Reader(hopeless, tag="start")
    goals = (start | branches).execute().goals
    assert [(goal.goal, goal.missed) for goal in goals] == [("3wc", 1), ("cwc", 1)]
    goals = (wct.Reader(hopeless) | move(goal="3wc") | Hurry()).execute().goals
    assert [goal.goal for goal in goals] == ["3wc"]
    assert str(goals[0]) == "filters.apply_coord_well_centering: 1 of 1 tets miss the goal 3wc"


def test_metadata_is_json_and_says_all(place):
    given = ball(2)
    result = (wct.Reader(given) | wct.Filter.meshing_well_centered(goal="3wc", reference=sphere_surface(400))).execute()
    found = json.loads(json.dumps(result.metadata(), allow_nan=False))
    assert found["versions"]["wct_plugin"]
    assert found["goal_met"] == result.goal_met
    reader, optimizer = found["stages"]
    name = f"<tet mesh of {len(given.tets)} tets>"
    assert reader["options"] == {"filename": name, "format": None, "repair": False}
    assert optimizer["type"] == "filters.meshing_well_centered"
    assert (optimizer["options"]["goal"], optimizer["options"]["seed"]) == ("3wc", 0)
    assert optimizer["seconds"] > 0
    assert optimizer["metrics"]["remaining"]["count"] == result.metrics["meshing_well_centered"]["remaining"]["count"]


# --- the tolerance of mesher and optimiser --------------------------------------------------------------------------


def test_the_mesher_leaves_half_of_the_smallest_tolerance_to_whom_its_mesh_goes():
    mesher, optimizer = find_filter("generate_tetrahedralization")(), find_filter("meshing_well_centered")
    two = [optimizer(tolerance=6e-4), optimizer(tolerance=2e-4), optimizer()]
    assert mesher_within_tolerance(mesher, *two).options.epsilon == 1e-4


def test_a_pipeline_lowers_the_meshers_epsilon(place):
    mesher = wct.Filter.generate_tetrahedralization
    start, optimize = wct.Reader("ball.ply"), wct.Filter.apply_coord_well_centering(tolerance=6e-4)
    assert (start | Fill() | optimize).execute().metrics["fill"] == {"epsilon": 3e-4}
    assert (start | Fill(epsilon=2e-4) | optimize).execute().metrics["fill"] == {"epsilon": 2e-4}
    assert (start | Fill() | wct.Writer("x.vtu")).execute().metrics["fill"] == {"epsilon": 1e-3}
    with pytest.raises(OptionError, match=r"stage 2 of 3 \(filters.generate_tetrahedralization\): option 'epsilon' is"):
        (start | mesher(epsilon=5e-4) | optimize).check()
    elsewhere = wct.Reader("cube.vtu") | optimize
    (start | mesher(epsilon=5e-4) | elsewhere).check()


# --- stopped --------------------------------------------------------------------------------------------------------


def test_who_stops_a_filter_gets_its_best_so_far_written(place):
    chain = wct.Reader(CUBE) | wct.Filter.meshing_well_centered() | wct.Filter.apply_coord_well_centering()
    result = (chain | wct.Writer("out.vtu")).execute(lambda state: False)
    assert result.metrics["meshing_well_centered"]["stopped"]
    assert len(wct.read("out.vtu").tets) == len(result.mesh.tets)
    assert not result.goal_met


# --- what is refused before anything runs ---------------------------------------------------------------------------


def refused(chain, error, message, place):
    before = names(place)
    with pytest.raises(error, match=message) as caught:
        chain.execute()
    assert "\n" not in str(caught.value)
    assert RAN == []
    assert names(place) == before


def test_kinds_of_mesh(place):
    quality = wct.Filter.get_quality
    hint = r"\(filters.get_quality\): needs a tet mesh, here is a surface; put filters.generate_tetrahedralization"
    refused(wct.Reader("ball.ply") | quality(), OptionError, "stage 2 of 2 " + hint, place)
    refused(wct.Reader("cube.vtu") | Skin() | quality(), OptionError, "stage 3 of 3 " + hint, place)
    refused(wct.Reader("ball.ply") | wct.Writer("r.json"), OptionError, r"\(writers.report\): needs a tet mesh", place)
    carry = "STL cannot carry a tetrahedral mesh"
    refused(wct.Reader("cube.vtu") | Scale() | wct.Writer("out.stl"), OutputError, carry, place)
    carry = r"stage 3 of 3 \(writers.mesh\): out.su2: SU2 cannot carry a surface"
    refused(wct.Reader("cube.vtu") | Skin() | wct.Writer("out.su2"), OutputError, carry, place)


def test_what_a_file_holds_is_known_once_it_is_read_and_before_filters_run(place):
    wct.write("skin.vtu", sphere_surface(40))
    chain = wct.Reader("cube.vtu") | Scale() | wct.Reader("skin.vtu") | Scale() | wct.Writer("out.vtu")
    chain.check()
    with pytest.raises(OptionError, match="stage 4 of 5"):
        chain.check(read=True)
    refused(chain, OptionError, r"stage 4 of 5 \(filters.scale\): needs a tet mesh, here is a surface", place)


def test_files(place):
    scale = Scale() | Pipeline()
    refused(wct.Reader("cubes.vtu") | scale, InputError, "stage 1 of 2 .*cubes.vtu: no such file", place)
    refused(wct.Reader("cube.xyz") | scale, InputError, "cube.xyz: unknown suffix '.xyz'", place)
    start = wct.Reader("cube.vtu") | scale
    refused(start | wct.Writer("none/x.vtu"), OutputError, "there is no directory none", place)
    refused(start | wct.Writer("none/x.html"), OutputError, "there is no directory none", place)
    refused(start | wct.Writer("x.doc"), OutputError, "unknown suffix '.doc'", place)
    refused(start | wct.Writer.report(filename="x.doc"), OutputError, "allowed are .html .json", place)
    over = start | wct.Writer.dual(filename="./cube.vtu")
    refused(over, OptionError, r"stage 3 of 3 .*: stage 1 of 3 \(readers.mesh\) reads ./cube.vtu", place)
    twice = start | wct.Writer("x.vtu") | wct.Writer("./x.vtu")
    refused(twice, OptionError, r"stage 4 of 4 .*: stage 3 of 4 \(writers.mesh\) writes ./x.vtu too", place)
    refused(start | Picky() | wct.Writer("x.vtu"), OptionError, r"^stage 3 of 4 \(filters.picky\): no such n", place)


def test_wiring(place):
    start, scale = wct.Reader("cube.vtu", tag="cube"), Scale() | Pipeline()
    quality = wct.Filter.get_quality
    refused(Pipeline(), OptionError, "the pipeline has no stages", place)
    refused(scale, OptionError, r"stage 1 of 1 \(filters.scale\): has no input", place)
    unknown = r"stage 2 of 2 .*: unknown input 'cub'; did you mean 'cube'\? \(tags: cube\)"
    refused(start | quality(inputs="cub"), OptionError, unknown, place)
    refused(start | quality(tag="cube"), OptionError, "tag 'cube' is that of stage 1 of 2", place)
    refused(start | quality(tag="a b"), OptionError, "tag 'a b' is not a letter or _", place)
    many = quality(tag="q") | quality(inputs=["cube", "q"])
    refused(start | many, OptionError, r"stage 3 of 3 .*: takes one mesh; 2 inputs", place)
    both = wct.Writer("x.json", inputs=["cube", "cube"])
    refused(start | both, OptionError, "an input is given twice", place)
    refused(start | start, OptionError, "tag 'cube'", place)
    refused(wct.Reader("ball.ply") | start | scale, OptionError, r"stage 1 of 3 .*: no stage takes its mesh", place)
    circle = quality(tag="a", inputs="b") | quality(tag="b", inputs="a")
    message = r"cycle: stage 2 of 3 \(filters.get_quality\) -> stage 3 of 3 \(filters.get_quality\) -> stage 2 of 3"
    refused(start | circle, OptionError, message, place)
    refused(start | quality(tag="a", inputs="a"), OptionError, "cycle: stage 2 of 2 .* -> stage 2 of 2", place)


def test_a_stage_that_makes_its_mesh_begins_a_pipeline_or_a_branch(place):
    made = Make() | Pipeline() | Scale() | wct.Writer("made.vtu")
    assert not made.is_open
    result = made.execute()
    assert np.ptp(result.mesh.points) == 2 * np.ptp(CUBE.points)
    assert list(result.metrics) == ["make", "scale"]
    assert names(place) == ["ball.ply", "cube.vtu", "made.vtu"]

    branch = Pipeline([Step(Make(), tag="made")])
    both = wct.Reader("cube.vtu", tag="read") | branch | wct.Writer("both.json", inputs=["read", "made"])
    both.execute()
    assert set(json.loads((place / "both.json").read_text())) == {"read", "made", "filters", "provenance"}


def test_a_stage_that_makes_its_mesh_takes_none(place):
    read = wct.Reader("cube.vtu")
    refused(read | Make(), OptionError, r"stage 1 of 2 \(readers.mesh\): no stage takes its mesh", place)
    refused(Make() | Pipeline() | Make(), OptionError, r"stage 1 of 2 \(filters.make\): no stage takes", place)
    tagged = wct.Reader("cube.vtu", tag="a") | Pipeline([Step(Make(), inputs=("a",))])
    refused(tagged, OptionError, r"stage 2 of 2 \(filters.make\): a stage that takes no mesh takes no inputs", place)
    with pytest.raises(OptionError, match=r"stage 1 of 1 \(filters.make\): needs no input"):
        Pipeline([Step(Make())]).apply(CUBE)
    with pytest.raises(OptionError, match=r"filters.scale needs a tet mesh, here is none"):
        Scale()()
    with pytest.raises(OptionError, match=r"stage 2 of 2 .*needs a surface, here is a tet mesh"):
        (Make() | Pipeline([Step(Fill())])).check()


# --- what fails while it runs ---------------------------------------------------------------------------------------


def test_nothing_is_written_when_a_later_stage_fails(place):
    chain = wct.Reader("cube.vtu") | Scale() | wct.Writer("early.vtu") | Fail() | wct.Writer("late.vtu")
    with pytest.raises(InputError, match=r"^stage 4 of 5 \(filters.fail\): tet 7 is of no use$"):
        chain.execute()
    assert RAN == ["scale"]
    assert names(place) == ["ball.ply", "cube.vtu"]


def test_a_report_page_without_matplotlib_is_refused_before_the_work(place, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    refused(wct.Reader("cube.vtu") | Scale() | wct.Writer("x.html"), WctError, "needs matplotlib", place)
