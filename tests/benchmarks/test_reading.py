"""The files are read by all readers, to the same counts, and every reader has a cell in the table."""

from pathlib import Path

import meshio
import pytest

from benchmarks import reading, table
from wct_plugin.io import read
from wct_plugin.mesh import TetMesh


@pytest.mark.filterwarnings("ignore:overflow encountered in scalar multiply:RuntimeWarning")  # meshio's, of text STL
def test_the_files_are_what_they_say(tmp_path: Path) -> None:
    paths = reading.make(tmp_path, 600)
    before = [path.read_bytes() for path in paths]
    assert reading.make(tmp_path, 600) == paths
    assert [path.read_bytes() for path in paths] == before
    sizes = set()
    for path in paths:
        mesh = read(path)
        count = len(mesh.tets) if isinstance(mesh, TetMesh) else len(mesh.triangles)
        kind = "tetra" if isinstance(mesh, TetMesh) else "triangle"
        assert len(meshio.read(path).cells_dict[kind]) == count
        sizes.add((kind, count))
    assert sizes == {("tetra", 750), ("triangle", 576)}


def test_every_reader_has_a_cell(tmp_path: Path) -> None:
    paths = reading.make(tmp_path / "made", 100)
    rows = reading.rows_of(paths[:1] + paths[-1:], tmp_path, 60.0)
    assert [row["file"] for row in rows] == ["surface.ply", "tets.mesh"]
    assert isinstance(rows[0]["VTK"], float)
    assert rows[1]["VTK"] is None
    assert all(row["ours"] == pytest.approx(row["ratio"] * min(row["VTK"] or 1e9, row["meshio"])) for row in rows)
    text = reading.markdown(rows, table.machine(["numpy"]))
    assert "| file | MB | ours | VTK | meshio | ours / fastest |" in text
    assert text.count("\n| ") == 4
