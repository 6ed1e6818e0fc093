"""Abaqus: sets by the names of tags, types of elements as they came."""

import re
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from support.builders import bcc, kuhn_cube

import wct_plugin as wct
from wct_plugin.mesh import Cells, TetMesh


@pytest.fixture
def tagged() -> TetMesh:
    cube = kuhn_cube(2)
    facets = cube.topology.boundary
    return replace(
        cube,
        regions=np.arange(len(cube.tets)) % 3 + 11,
        facets=Cells(facets, np.arange(len(facets)) % 2 * 7),
        names={"steel": (11, 3), "air": (12, 3), "wall": (7, 2), "nothing": (5, 3)},
    )


def test_sets_have_the_names_of_tags(tagged: TetMesh, tmp_path: Path) -> None:
    wct.write(tmp_path / "a.inp", tagged)
    found = meshio.read(tmp_path / "a.inp")
    assert set(found.cell_sets) == {"steel", "air", "wall", "TAG_tetra_13"}
    assert np.array_equal(found.cell_sets["steel"][0], np.flatnonzero(tagged.regions == 11))
    again = wct.read(tmp_path / "a.inp")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.regions, tagged.regions)
    assert np.array_equal(again.facets.tags, tagged.facets.tags)
    assert again.names == tagged.names
    assert not again.tet_sets


def test_a_set_that_is_a_region_is_both(tagged: TetMesh, tmp_path: Path) -> None:
    mesh = replace(
        tagged,
        names={"steel": (11, 3), "air": (12, 3)},
        tet_sets={"steel": np.flatnonzero(tagged.regions == 11), "air": np.array([0, 1])},  # the second is another one
    )
    with pytest.warns(match="dropped: name 'air'"):
        wct.write(tmp_path / "a.inp", mesh)
    again = wct.read(tmp_path / "a.inp")
    assert isinstance(again, TetMesh)
    assert np.array_equal(again.regions, tagged.regions)
    assert again.names == {"steel": (11, 3)}
    assert {name: ids.tolist() for name, ids in again.tet_sets.items()} == {
        "steel": np.flatnonzero(tagged.regions == 11).tolist(),
        "air": [0, 1],
    }


@pytest.mark.parametrize("kind", ["CPS3", "S3R", "R3D3", "S3"])
def test_types_of_facets_come_back(kind: str, tagged: TetMesh, tmp_path: Path) -> None:
    mesh = bcc(2)
    wct.write(tmp_path / "a.inp", replace(mesh, facets=Cells(mesh.topology.boundary)))
    text = (tmp_path / "a.inp").read_text()
    assert re.findall(r"TYPE=(\w+)", text) == ["C3D4", "S3"]
    (tmp_path / "b.inp").write_text(text.replace("TYPE=S3", f"TYPE={kind}"))
    mesh = wct.read(tmp_path / "b.inp")
    wct.write(tmp_path / "c.inp", mesh)
    assert re.findall(r"TYPE=(\w+)", (tmp_path / "c.inp").read_text()) == ["C3D4", kind]
    better, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc", force=True)
    wct.write(tmp_path / "d.inp", better)
    text = (tmp_path / "d.inp").read_text()
    assert re.findall(r"TYPE=(\w+)", text) == ["C3D4", kind]
    assert "abaqus:" not in text


def test_types_side_by_side(tagged: TetMesh, tmp_path: Path) -> None:
    facets = Cells(
        tagged.facets.vertices, tagged.facets.tags, sets={"abaqus:R3D3": np.arange(10), "some": np.array([9, 20])}
    )
    wct.write(tmp_path / "a.inp", replace(tagged, facets=facets, names={}))
    assert re.findall(r"TYPE=(\w+)", (tmp_path / "a.inp").read_text()) == ["C3D4", "S3", "R3D3"]
    again = wct.read(tmp_path / "a.inp")
    assert isinstance(again, TetMesh)
    rows = again.facets.vertices
    assert np.array_equal(rows[again.facets.sets["abaqus:R3D3"]], facets.vertices[:10])
    assert np.array_equal(np.sort(rows[again.facets.sets["some"]], axis=0), np.sort(facets.vertices[[9, 20]], axis=0))
    assert sorted(again.facets.tags.tolist()) == sorted(facets.tags.tolist())


def test_lines_of_sets_are_as_long_as_abaqus_takes(tagged: TetMesh, tmp_path: Path) -> None:
    wct.write(tmp_path / "a.inp", replace(tagged, point_sets={"all": np.arange(len(tagged.points))}, names={}))
    for line in (tmp_path / "a.inp").read_text().splitlines():
        assert len(line.split(",")) <= 16
        assert len(line) <= 256
    assert len(wct.read(tmp_path / "a.inp").point_sets["all"]) == len(tagged.points)  # type: ignore[union-attr]
