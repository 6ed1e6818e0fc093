"""``wct create``: a subcommand per filter that makes a mesh, made of its declaration."""

import pytest
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.pipeline.stage import filter_names, find_filter

CREATORS = [name for name in filter_names() if find_filter(name).starts()]


def test_creators_are_those_named_so():
    assert [name for name in filter_names() if name.startswith("create_")] == CREATORS


def test_alone_it_lists(capsys):
    assert main.run(["create"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    for name in CREATORS:
        assert f" {name.removeprefix('create_')} " in printed
    assert "Make the corner of a cube" in printed


def test_it_writes_what_the_filter_makes(tmp_path, capsys):
    target = tmp_path / "cube.vtu"
    assert main.run(["create", "cube", str(target), "--variant", "84", "--size", "2"]) == 0
    assert "completely well centered yes" in " ".join(capsys.readouterr().out.split())
    mesh = wct.read(target)
    assert len(mesh.tets) == 84
    assert mesh.points.max() == 2
    assert main.run(["report", str(target), "--goal", "cwc"]) == 0


def test_numbers_of_a_tiling_outside_the_condition_are_shown(tmp_path, capsys):
    assert main.run(["create", "create_lattice_tiling", str(tmp_path / "t.vtu"), "--a", "0.4", "--nx", "1"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "condition a > 1/2 and b > 1/2 condition met no" in printed
    assert "periods (1, 0, 0), (0, 0.8, 0), (0, 0, 1.414)" in printed


@pytest.mark.parametrize("name", CREATORS)
def test_help_has_every_option(name, capsys):
    assert main.run(["create", name.removeprefix("create_"), "--help"]) == 0
    printed = capsys.readouterr().out
    for option in find_filter(name).declaration.model_fields:
        assert f"--{option.replace('_', '-')} " in printed


def test_refusals(tmp_path, capsys):
    target = tmp_path / "out.vtu"
    assert refused(capsys, "create", "cub", target).startswith("cannot create 'cub'; did you mean 'cube'? (allowed: ")
    assert refused(capsys, "create", "cube", target, "--variant", "85").startswith(
        "filters.create_cube: option 'variant' is '85'; input should be '194'"
    )
    line = refused(capsys, "create", "lattice_tiling", target, "--a", "0")
    assert line == "filters.create_lattice_tiling: option 'a' is 0.0; input should be greater than 0"
    assert "STL cannot carry a tetrahedral mesh" in refused(capsys, "create", "cube", tmp_path / "cube.stl")
    assert "no such option" in refused(capsys, "create", "cube", target, "--sise", "2").lower()
    assert refused(capsys, "create", "cube") == "Missing argument 'OUT'."
    assert not list(tmp_path.iterdir())
