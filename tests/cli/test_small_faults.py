"""What a newcomer types wrong: a length for a fraction, a folder for a file, the input's name for the output."""

import re
from pathlib import Path

import pytest
from support.builders import jittered_cube
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main, output

TOLERANCE = "filters.meshing_well_centered.tolerance=1"


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", jittered_cube(4))
    Path("folder").mkdir()


@pytest.mark.parametrize(
    "arguments", [["report", "cube.vtu"], ["optimize", "cube.vtu", "out.vtu", "--goal", "delaunay"]]
)
def test_a_page_without_suffix_gets_its_suffix(arguments):
    assert main.run([*arguments, "--html", "page", "-q"]) in (0, 1)
    assert Path("page.html").read_text().lower().startswith("<!doctype html")
    assert not Path("page").exists()


def test_a_page_is_not_written_where_another_output_is(capsys):
    said = refused(capsys, "report", "cube.vtu", "--html", "page", "--json", "page.html")
    assert said == "'page.html' is given twice; an output needs a name of its own"


# --- IN = OUT -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [["optimize"], ["run", "dec-ready"]])
def test_the_input_is_written_over_only_with_force(command, capsys):
    before = Path("cube.vtu").read_bytes()
    given = [*command, "cube.vtu", "./cube.vtu"]
    assert refused(capsys, *given) == "'./cube.vtu' is the input too; --force writes over it"
    assert Path("cube.vtu").read_bytes() == before
    assert main.run([*given, "--force", "-q"]) in (0, 1)
    assert Path("cube.vtu").read_bytes() != before


@pytest.mark.parametrize("more", [["--goal", "delaunay"], ["--filter", "apply_coord_well_centering"]])
def test_force_writes_over_the_input_also_where_nothing_is_made_anew(more):
    assert main.run(["optimize", "cube.vtu", "cube.vtu", "--force", "-q", *more]) in (0, 1)


@pytest.mark.parametrize("second", ["out.vtu", "./out.vtu"])
def test_the_second_of_two_outputs_of_one_name_is_refused(second, capsys):
    said = refused(capsys, "run", "dec-ready", "cube.vtu", "out.vtu", second)
    assert said == f"stage 5 of 5 (writers.mesh): stage 4 of 5 (writers.mesh) writes {second} too"
    assert not Path("out.vtu").exists()


# --- fractions ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ["optimize", "cube.vtu", "out.vtu", "--tolerance", "1"],
        ["run", "dec-ready", "cube.vtu", "out.vtu", "--set", TOLERANCE],
    ],
)
def test_a_length_for_a_tolerance_is_told_as_a_fraction_and_as_lengths(arguments, capsys):
    diagonal = wct.read("cube.vtu").diagonal
    said = refused(capsys, *arguments)
    assert "input should be less than or equal to 0.1: it is a fraction of the bounding box's diagonal" in said
    assert f"the diagonal of cube.vtu is {diagonal:.4g}, 0.1 is a length of {0.1 * diagonal:.4g}" in said


def test_a_length_that_would_do_is_told_as_the_fraction_that_it_is(capsys):
    mesh = jittered_cube(2)
    with pytest.raises(wct.OptionError, match=r"0\.2 as a length is 0\.002$"):
        wct.optimize((mesh.points * 100.0 / mesh.diagonal, mesh.tets), tolerance=0.2)


def test_a_mesh_that_cannot_be_read_is_no_matter_there(capsys):
    said = refused(capsys, "optimize", "none.vtu", "out.vtu", "--tolerance", "1")
    assert said.endswith("it is a fraction of the bounding box's diagonal")


def test_what_is_no_fraction_is_told_as_before():
    with pytest.raises(wct.OptionError, match=r"option 'margin' is 1; input should be less than or equal to 0\.1$"):
        wct.Filter.meshing_well_centered(margin=1)


# --- folders --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ["report", "folder"],
        ["report", "folder/"],
        ["report", "cube.vtu", "--reference", "folder"],
        ["optimize", "folder", "out.vtu"],
        ["dual", "folder", "out.npz"],
    ],
)
def test_a_folder_for_a_mesh_says_so(arguments, capsys):
    assert refused(capsys, *arguments) == "folder: is a directory; the name of a mesh file is needed"


def test_a_folder_for_a_pipeline_says_so(capsys):
    said = refused(capsys, "run", "folder", "cube.vtu", "out.vtu")
    assert said == "folder: is a directory; the name of a pipeline's file is needed"
    assert refused(capsys, "run", "dec-ready", "folder", "out.vtu").endswith(
        "folder: is a directory; the name of a mesh file is needed"
    )


# --- the report -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 3])
def test_a_report_fits_a_screen(count, capsys, monkeypatch):
    monkeypatch.setattr(output.out, "_width", 80)
    files = [f"cube_{k}.vtu" for k in range(count)]
    for file in files:
        wct.write(file, jittered_cube(2))
    assert main.run(["report", *files]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 80
    assert lines[-1].startswith("--full")
    assert main.run(["report", "--full", *files]) == 0
    full = capsys.readouterr().out
    assert len(full.splitlines()) > 80
    assert {"Tiers", "Smallest h/R", "Worst tets"} <= set(re.findall(r"Tiers|Smallest h/R|Worst tets", full))


def test_the_worst_tets_are_listed_where_they_are_asked_for(capsys):
    assert main.run(["report", "cube.vtu", "--worst", "2"]) == 0
    assert "Worst tets" in capsys.readouterr().out
