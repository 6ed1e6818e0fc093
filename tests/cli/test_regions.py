"""``--regions`` on the commands that read meshes, and the line that says what the regions are."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.cli.main import run
from wct_plugin.mesh import TetMesh


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two halves in an array of an unusual name and in one of a usual one, one above and one beside the other."""
    monkeypatch.chdir(tmp_path)
    mesh = kuhn_cube(4)
    middle = mesh.points[mesh.tets].mean(axis=1)
    below, left = (np.where(middle[:, axis] < 0.5, 1, 2).astype("i4") for axis in (2, 0))
    for name, arrays in (("usual", {"mat_id": below}), ("unusual", {"zone": left})):
        cells = [("tetra", mesh.tets)]
        meshio.Mesh(mesh.points, cells, cell_data={k: [v] for k, v in arrays.items()}).write(f"{name}.vtu")
    return tmp_path


def volumes(path: str, name: str) -> dict[int, float]:
    found = meshio.read(path)
    corners = found.points[found.cells_dict["tetra"]]
    size = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    values = found.cell_data[name][0]
    return {int(value): float(size[values == value].sum()) for value in np.unique(values)}


def test_optimize_takes_usual_names_and_says_so(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(["optimize", "usual.vtu", "out.vtu", "--goal", "3wc", "--force", "--json", "-"])
    said = capsys.readouterr()
    json.loads(said.out)
    assert "note: usual.vtu: regions are of array 'mat_id', 2 values" in said.err
    assert volumes("out.vtu", "mat_id") == pytest.approx({1: 0.5, 2: 0.5}, rel=1e-9)
    assert meshio.read("out.vtu").cell_data["mat_id"][0].dtype == np.int32


def test_optimize_with_regions(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(["optimize", "unusual.vtu", "out.vtu", "--goal", "3wc", "--force", "--regions", "zone"])
    assert "warning" not in capsys.readouterr().err
    assert volumes("out.vtu", "zone") == pytest.approx({1: 0.5, 2: 0.5}, rel=1e-9)
    run(["report", "unusual.vtu"])
    assert "array 'zone' looks like materials but is not taken as regions" in capsys.readouterr().err
    assert run(["optimize", "unusual.vtu", "out.vtu", "--regions", "zone", "--print-pipeline"]) == 0
    assert json.loads(capsys.readouterr().out)[0] == {
        "type": "readers.mesh",
        "filename": "unusual.vtu",
        "regions": "zone",
    }


def test_report_run_and_batch(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["report", "unusual.vtu", "--regions", "zone", "--json", "-"]) == 0
    said = capsys.readouterr()
    assert "regions are of array 'zone'" in said.err
    json.loads(said.out)
    Path("chain.json").write_text('[{"type": "filters.meshing_well_centered", "goal": "3wc", "force": true}]')
    run(["run", "chain.json", "unusual.vtu", "out.vtu", "--regions", "zone"])
    assert volumes("out.vtu", "zone") == pytest.approx({1: 0.5, 2: 0.5}, rel=1e-9)
    run(["batch", "chain.json", "unusual.vtu", "-o", "many", "--jobs", "1", "--regions", "zone"])
    assert volumes("many/unusual.vtu", "zone") == pytest.approx({1: 0.5, 2: 0.5}, rel=1e-9)
    Path("own.json").write_text('["unusual.vtu", {"type": "filters.get_quality"}, "b.vtu"]')
    assert run(["run", "own.json", "--set", "readers.mesh.regions=zone"]) == 0
    assert run(["run", "own.json", "--regions", "zone"]) == 2
    assert "--set readers.mesh.regions=NAME" in capsys.readouterr().err


def test_sets_again_or_with_commas(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mesh = wct.read("usual.vtu")
    assert isinstance(mesh, TetMesh)
    sets = {"low": np.flatnonzero(mesh.regions == 1), "some": np.array([0])}
    wct.write("a.inp", TetMesh(mesh.points, mesh.tets, tet_sets=sets))
    for names in (["--regions", "low"], ["--regions", "low", "--regions", "some"], ["--regions", "low,some"]):
        code = run(["report", "a.inp", *names])
        said = capsys.readouterr().err
        assert code == (2 if len(names) > 2 or "," in names[-1] else 0)
        assert ("sets 'low' and 'some' share 1 tets" in said) == (code == 2)


def test_what_is_not_there(place: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["optimize", "usual.vtu", "out.vtu", "--regions", "mat"]) == 2
    said = capsys.readouterr().err
    assert said.strip() == "error: usual.vtu: regions is 'mat'; allowed are the cell arrays: mat_id"
    assert not Path("out.vtu").exists()
