"""Broken tets on the command line, from Python and in pipelines: one line without --repair, counted with it."""

import json
import warnings
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.errors import InputError
from wct_plugin.measure import quality

DATA = Path(__file__).parents[1] / "data"
#: By file: what is found, what repair says, its volume and tets.
CASES = {
    "degen_index.vtu": ("1 tet with a vertex twice: 387", "1 tet with a vertex twice dropped", 1.0, 387),
    "duptet.vtu": ("1 repeated tet: 387 (as 0)", "1 repeated tet dropped", 1.0, 387),
    "flatsliver.mesh": ("1 tet of zero volume: 2", "1 tet of zero volume dropped", 1 / 3, 2),
    "zerovol.vtu": ("1 tet folded onto their neighbours: 387", "1 tet folded over others dropped", 1.0, 387),
}


@pytest.mark.parametrize("name", CASES)
def test_without_repair_one_line_lists_them(name, tmp_path, capsys):
    found, _, _, _ = CASES[name]
    for arguments in (["report", DATA / name], ["optimize", DATA / name, tmp_path / "out.vtu"]):
        said = refused(capsys, *arguments)
        assert said.startswith(f"{DATA / name}: ")
        assert f"(found: {found}; tets are counted from 0 in the order of the file; option repair drops" in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", CASES)
def test_repair_says_what_it_did(name, tmp_path, capsys):
    _, done, volume, count = CASES[name]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh = wct.read(DATA / name, repair=True)
    (said,) = [str(one.message) for one in caught]
    assert f"{DATA / name}: repaired: {done}; volume " in said
    assert len(mesh.tets) == count
    assert quality.volumes(mesh.points, mesh.tets).sum() == pytest.approx(volume, rel=1e-12)
    assert main.run(["report", "--repair", str(DATA / name), "--json", str(tmp_path / "a.json")]) == 0
    repairs = json.loads((tmp_path / "a.json").read_text())["repairs"]
    assert sum(repairs.values()) - repairs["orphan_points"] == 1
    assert f"repaired: {done}" in capsys.readouterr().err


def test_optimize_and_pipelines_take_it(tmp_path, capsys):
    name = str(DATA / "flatsliver.mesh")
    assert main.run(["optimize", name, str(tmp_path / "a.vtu"), "--repair", "--goal", "delaunay"]) == 0
    chain = [{"type": "readers.mesh", "filename": name, "repair": True}, {"type": "writers.mesh", "filename": "b.vtu"}]
    chain[1]["filename"] = str(tmp_path / "b.vtu")
    (tmp_path / "chain.json").write_text(json.dumps(chain))
    assert main.run(["run", str(tmp_path / "chain.json")]) == 0
    assert len(wct.read(tmp_path / "b.vtu").tets) == 2
    capsys.readouterr()
    assert main.run(["optimize", name, str(tmp_path / "a.vtu"), "--repair", "--print-pipeline"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["repair"] is True


def test_points_of_no_tet_may_be_no_numbers():
    mesh = wct.read(DATA / "nanorphan.mesh")
    assert len(mesh.tets) == 1
    assert mesh.regions.tolist() == [7]
    assert str(mesh.repairs) == "1 point without a tet dropped"


def test_points_of_no_triangle_too(tmp_path):
    points = [[0, 0, 0], [np.nan, 0, 0], [1, 0, 0], [0, 1, 1]]
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(points), [("triangle", [[0, 2, 3]])]))
    with pytest.warns(wct.WctWarning, match="1 point of no triangle, with coordinates that are no numbers, dropped"):
        assert len(wct.read(tmp_path / "a.vtu").points) == 3


def test_a_tet_that_has_such_a_point_cannot_be_mended(tmp_path):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [np.nan, 0, 0]]
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(points), [("tetra", [[0, 1, 2, 3]])]))
    for repair in (False, True):
        with pytest.raises(InputError, match=r"a\.vtu: .*no numbers"):
            wct.read(tmp_path / "a.vtu", repair=repair)


def test_what_hangs_on_cut_tets_is_cut_with_them(tmp_path):
    """A flat tet inside: regions, data, sets and tagged facets of the tets round it go to their parts."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1]], float)
    tets = [[0, 1, 2, 4], [0, 2, 3, 4], [0, 1, 2, 3], [1, 0, 3, 5], [2, 1, 3, 5]]
    cells = [("tetra", np.array(tets)), ("triangle", np.array([[0, 2, 4]]))]
    data = {"gmsh:physical": [np.array([1, 2, 9, 3, 4]), np.array([7])], "heat": [np.arange(5.0), np.array([8.0])]}
    meshio.Mesh(points, cells, point_data={"u": points[:, 0] + points[:, 2]}, cell_data=data).write(tmp_path / "a.vtu")
    with pytest.warns(wct.WctWarning, match="1 tet of zero volume cut away, 1 point added for that; volume 0.66666"):
        mesh = wct.read(tmp_path / "a.vtu", repair=True)
    assert {int(tag): int(count) for tag, count in zip(*np.unique(mesh.regions, return_counts=True), strict=True)} == {
        1: 2, 2: 2, 3: 2, 4: 2,
    }  # fmt: skip
    volume = quality.volumes(mesh.points, mesh.tets)
    assert [volume[mesh.regions == tag].sum() for tag in (1, 2, 3, 4)] == pytest.approx([1 / 6] * 4, rel=1e-12)
    assert np.array_equal(mesh.cell_data["heat"], np.array([0, 1, 3, 4])[mesh.regions - 1])
    assert np.allclose(mesh.point_data["u"], mesh.points[:, 0] + mesh.points[:, 2], atol=1e-15)
    assert mesh.facets.tags.tolist() == [7, 7]
    assert mesh.facets.data["heat"].tolist() == [8.0, 8.0]
