"""What the regions of the tets are: tags, arrays of usual names, sets, or what is asked for; and they come back."""

import logging
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from support.builders import bcc, kuhn_cube
from support.volumes import region_volumes

import wct_plugin as wct
from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.io.region_choice import USUAL, with_regions
from wct_plugin.mesh import Cells, TetMesh

DATA = Path(__file__).parents[1] / "data"


def halves(mesh: TetMesh, axis: int = 0) -> np.ndarray:
    """1 and 2, on either side of a plane."""
    middle = mesh.points[mesh.tets].mean(axis=1)[:, axis]
    return np.where(middle < np.median(middle), 1, 2)


def written(path: Path, mesh: TetMesh, **arrays: Any) -> Path:
    """By meshio, as other programs write it."""
    meshio.Mesh(mesh.points, [("tetra", mesh.tets)], cell_data={name: [a] for name, a in arrays.items()}).write(path)
    return path


@pytest.fixture
def cube() -> TetMesh:
    return kuhn_cube(4)


@pytest.mark.parametrize(
    ("name", "dtype"),
    [
        ("material", "i4"),
        ("MaterialIDs", "i4"),
        ("mat_id", "i8"),
        ("attribute", "f8"),
        ("Region Id", "u1"),
        ("cell_tags", "i8"),
        ("CellEntityIds", "i8"),
        ("ElementBlockIds", "i8"),
        ("labels", "f4"),
        ("SubDomain", "u4"),
    ],
)
@pytest.mark.parametrize("suffix", [".vtu", ".xdmf"])
def test_usual_names(
    name: str, dtype: str, suffix: str, cube: TetMesh, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    array = halves(cube).astype(dtype)
    path = written(tmp_path / f"a{suffix}", cube, **{name: array})
    with caplog.at_level(logging.INFO, "wct_plugin"):
        mesh = wct.read(path)
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.regions, array)
    if name != "cell_tags":  # which is MED's own
        assert caplog.messages == [f"{path}: regions are of array {name!r}, 2 values"]
        assert mesh.cell_data[name].dtype == dtype
    wct.write(tmp_path / f"b{suffix}", mesh)
    again = meshio.read(tmp_path / f"b{suffix}")
    assert list(again.cell_data) == [name]
    assert np.array_equal(again.cell_data[name][0], array)
    assert name == "cell_tags" or again.cell_data[name][0].dtype == dtype


def test_no_name_is_taken_for_another() -> None:
    assert len(set(USUAL)) == len(USUAL)
    assert all(name == name.lower() and name.isalnum() for name in USUAL)


def test_tags_of_the_format_come_first(cube: TetMesh, tmp_path: Path) -> None:
    tags, material = halves(cube), halves(cube, 1) * 5
    path = written(tmp_path / "a.vtu", cube, material=material, **{"gmsh:physical": tags})
    with pytest.warns(WctWarning, match=r"array 'material' looks like materials but is not taken.*--regions material"):
        mesh = wct.read(path)
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.regions, tags)
    asked = wct.read(path, regions="material")
    assert isinstance(asked, TetMesh)
    assert np.array_equal(asked.regions, material)
    wct.write(tmp_path / "b.vtu", asked)  # each under its own name
    again = meshio.read(tmp_path / "b.vtu").cell_data
    assert np.array_equal(again["material"][0], material)
    assert np.array_equal(again["gmsh:physical"][0], tags)


def test_one_tag_for_all_says_less_than_materials(cube: TetMesh, tmp_path: Path) -> None:
    path = written(tmp_path / "a.vtu", cube, mat_id=halves(cube), **{"gmsh:physical": np.full(len(cube.tets), 9)})
    mesh = wct.read(path)
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.regions, halves(cube))
    wct.write(tmp_path / "b.msh", mesh)
    again = wct.read(tmp_path / "b.msh", regions="mat_id")
    assert isinstance(again, TetMesh)
    assert set(again.cell_data["gmsh:physical"]) == {9}
    assert np.array_equal(again.regions, halves(cube))


def test_facets_have_their_tags_in_the_array_too(cube: TetMesh, tmp_path: Path) -> None:
    facets = cube.topology.boundary
    tags = (np.arange(len(facets)) % 3 + 7).astype("i4")
    given = meshio.Mesh(
        cube.points,
        [("tetra", cube.tets), ("triangle", facets)],
        cell_data={"MaterialIDs": [halves(cube).astype("i4"), tags]},
    )
    given.write(tmp_path / "a.vtu")
    mesh = wct.read(tmp_path / "a.vtu")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.facets.tags, tags)
    wct.write(tmp_path / "b.vtu", mesh)
    again = meshio.read(tmp_path / "b.vtu")
    assert list(again.cell_data) == ["MaterialIDs"]
    assert np.array_equal(np.concatenate(again.cell_data["MaterialIDs"]), np.concatenate([halves(cube), tags]))
    assert again.cell_data["MaterialIDs"][0].dtype == np.int32


def test_facets_with_tags_of_their_own_keep_them(cube: TetMesh, tmp_path: Path) -> None:
    facets = Cells(cube.topology.boundary, np.arange(len(cube.topology.boundary)) % 2 + 5)
    mesh = replace(cube, facets=facets, cell_data={"zone": halves(cube)})
    wct.write(tmp_path / "a.vtu", mesh)
    got = wct.read(tmp_path / "a.vtu", regions="zone")
    assert isinstance(got, TetMesh)
    assert np.array_equal(got.regions, halves(cube))
    assert np.array_equal(got.facets.tags, facets.tags)
    wct.write(tmp_path / "b.vtu", got)
    wct.write(tmp_path / "b.msh", got)
    for path, regions in ((tmp_path / "b.vtu", "zone"), (tmp_path / "b.msh", None)):
        again = wct.read(path, regions=regions)
        assert isinstance(again, TetMesh)
        assert np.array_equal(again.regions, halves(cube))
        assert np.array_equal(again.facets.tags, facets.tags)


def test_an_array_becomes_the_tags_of_formats_that_have_some(cube: TetMesh, tmp_path: Path) -> None:
    path = written(tmp_path / "a.vtu", cube, material=halves(cube))
    mesh = wct.read(path)
    for suffix in (".msh", ".mesh", ".bdf", ".med", ".inp", ".ele"):
        wct.write(tmp_path / f"b{suffix}", mesh)  # without a warning
        again = wct.read(tmp_path / f"b{suffix}")
        assert isinstance(again, TetMesh)
        assert np.array_equal(again.regions, halves(cube)), suffix


@pytest.mark.parametrize(
    ("name", "array", "said"),
    [
        ("zone", lambda mesh: halves(mesh), True),
        ("zone", lambda mesh: halves(mesh) * 1.0, True),
        ("zone", lambda mesh: np.random.default_rng(0).integers(0, 3, len(mesh.tets)), False),  # in no patches
        ("zone", lambda mesh: np.arange(len(mesh.tets)), False),  # numbers of cells
        ("zone", lambda mesh: halves(mesh) * 0.5, False),
        ("zone", lambda mesh: np.ones(len(mesh.tets), dtype=int), False),
        ("my zone", lambda mesh: halves(mesh), True),
    ],
)
def test_an_array_that_looks_like_materials_is_warned_about(
    name: str, array: Any, said: bool, cube: TetMesh, tmp_path: Path
) -> None:
    path = written(tmp_path / "a.vtu", cube, **{name: array(cube)})
    if not said:
        assert not wct.read(path).regions.any()  # type: ignore[union-attr]
        return
    option = f"regions={name!r} \\(--regions {name}\\)" if name == "zone" else "--regions 'my zone'"
    with pytest.warns(WctWarning, match=rf"a\.vtu: array {name!r} looks like materials.*{option}"):
        wct.read(path)
    wct.read(path, regions=name)


def test_the_attribute_of_a_tag_file(cube: TetMesh, tmp_path: Path) -> None:
    mesh = wct.read(written(tmp_path / "a.xdmf", cube, f=halves(cube)))
    assert np.array_equal(mesh.regions, halves(cube))  # type: ignore[union-attr]


def test_sets_that_have_each_tet_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "wct_plugin"):
        mesh = wct.read(DATA / "two_materials.inp")
    assert isinstance(mesh, TetMesh)
    assert caplog.messages[0].endswith("two_materials.inp: regions are of sets 'MAT1', 'MAT2'")
    assert mesh.names == {"MAT1": (1, 3), "MAT2": (2, 3)}
    assert {name: len(members) for name, members in mesh.tet_sets.items()} == {"MAT1": 9, "MAT2": 5, "EB1": 14}
    before = region_volumes(mesh, mesh.regions)
    assert before == pytest.approx({1: 0.4166666888385334, 2: 0.25000001330312005}, rel=1e-12)
    wct.write(tmp_path / "a.msh", mesh)
    again = wct.read(tmp_path / "a.msh")
    assert isinstance(again, TetMesh)
    assert again.names["MAT2"] == (2, 3)
    assert region_volumes(again, again.regions) == pytest.approx(before, rel=1e-12)


def test_sets_come_back_when_the_tets_are_made_anew(tmp_path: Path) -> None:
    mesh = replace(bcc(3), regions=None)
    half = halves(mesh)
    sets = {"STEEL": np.flatnonzero(half == 1), "AIR": np.flatnonzero(half == 2), "WHOLE": np.arange(len(mesh.tets))}
    wct.write(tmp_path / "a.inp", replace(mesh, tet_sets=sets))
    given = wct.read(tmp_path / "a.inp")
    assert isinstance(given, TetMesh)
    made, _ = wct.apply_filter("meshing_well_centered", given, goal="3wc", edge_length=0.7)
    assert isinstance(made, TetMesh)
    assert len(made.tets) != len(mesh.tets)
    wct.write(tmp_path / "b.inp", made)
    found = meshio.read(tmp_path / "b.inp")
    assert set(found.cell_sets) == {"STEEL", "AIR", "WHOLE"}
    ids = np.zeros(len(made.tets), dtype=int)
    ids[found.cell_sets["STEEL"][0]], ids[found.cell_sets["AIR"][0]] = 1, 2
    assert region_volumes(made, ids) == pytest.approx(region_volumes(mesh, half), rel=1e-9)
    assert len(found.cell_sets["WHOLE"][0]) == len(made.tets)


def test_sets_by_name(cube: TetMesh, tmp_path: Path) -> None:
    half, third = halves(cube), halves(cube, 1)
    sets = {
        "left": np.flatnonzero(half == 1),
        "low": np.flatnonzero(third == 1),
        "corner": np.flatnonzero((half == 2) & (third == 2)),
    }
    wct.write(tmp_path / "a.inp", replace(cube, tet_sets=sets))
    for names in (["left", "corner"], "left,corner"):
        mesh = wct.read(tmp_path / "a.inp", regions=names)
        assert isinstance(mesh, TetMesh)
        assert np.array_equal(mesh.regions, np.where(half == 1, 1, np.where(third == 2, 2, 0)))
        assert mesh.names == {"left": (1, 3), "corner": (2, 3)}
    one = wct.read(tmp_path / "a.inp", regions="low")
    assert np.array_equal(one.regions, np.where(third == 1, 1, 0))  # type: ignore[union-attr]
    with pytest.raises(OptionError, match=r"a\.inp: regions: sets 'left' and 'low' share \d+ tets, the first of them"):
        wct.read(tmp_path / "a.inp", regions=["left", "low"])
    with pytest.raises(
        OptionError, match=r"regions is 'right'; .* arrays: none; and the sets of tets: left, low, corn"
    ):
        wct.read(tmp_path / "a.inp", regions=["left", "right"])
    with pytest.warns(WctWarning, match="set 'left', set 'low', set 'corner' look like materials"):
        wct.read(tmp_path / "a.inp")


def test_entities_of_gmsh_can_be_asked_for(cube: TetMesh, tmp_path: Path) -> None:
    mesh = replace(cube, regions=np.full(len(cube.tets), 3))
    wct.write(tmp_path / "a.msh", mesh)
    rows = (tmp_path / "a.msh").read_text().splitlines()
    start = rows.index("$Elements") + 2
    for k, entity in enumerate(halves(cube).tolist()):
        parts = rows[start + k].split()
        rows[start + k] = " ".join([*parts[:4], str(entity + 40), *parts[5:]])
    (tmp_path / "a.msh").write_text("\n".join(rows) + "\n")
    got = wct.read(tmp_path / "a.msh", regions="gmsh:geometrical")
    assert isinstance(got, TetMesh)
    assert np.array_equal(got.regions, halves(cube) + 40)
    wct.write(tmp_path / "b.msh", got)
    again = wct.read(tmp_path / "b.msh", regions="gmsh:geometrical")
    assert np.array_equal(again.regions, got.regions)  # type: ignore[union-attr]
    assert set(wct.read(tmp_path / "b.msh").regions) == {3}  # type: ignore[union-attr]


def test_what_cannot_be_regions(cube: TetMesh, surface: Any, tmp_path: Path) -> None:
    heat = np.linspace(0, 1, len(cube.tets))
    path = written(tmp_path / "a.vtu", cube, heat=heat, bad=np.where(heat < 0.5, np.nan, 1))
    for name in ("heat", "bad"):
        with pytest.raises(OptionError, match=rf"a\.vtu: regions is '{name}', float64 of shape .* are whole numbers"):
            wct.read(path, regions=name)
    with pytest.raises(OptionError, match=r"regions is 'x'; allowed are the cell arrays: heat, bad$"):
        wct.read(path, regions="x")
    with pytest.raises(OptionError, match=r"regions is empty"):
        wct.read(path, regions=[])
    wct.write(tmp_path / "a.ply", surface)
    with pytest.raises(OptionError, match=r"a\.ply: regions is 'x', but there are triangles alone"):
        wct.read(tmp_path / "a.ply", regions="x")


def test_a_mesh_in_memory(cube: TetMesh) -> None:
    mesh = replace(cube, cell_data={"zone": halves(cube)}, tet_sets={"low": np.flatnonzero(halves(cube, 1) == 1)})
    zoned = with_regions(mesh, "zone")
    assert (zoned.region_name, set(zoned.cell_data)) == ("zone", {"zone"})
    assert np.array_equal(zoned.regions, halves(cube))
    low = with_regions(zoned, ["low"])
    assert (low.region_name, set(low.cell_data), low.names) == ("", {"zone"}, {"low": (1, 3)})
    assert np.array_equal(low.regions, 2 - halves(cube, 1))
    again = with_regions(low, "zone")
    assert (again.names, set(again.cell_data)) == ({}, {"zone"})
    chain = wct.Reader(mesh, regions="zone") | wct.Filter.get_quality()
    assert np.array_equal(chain.execute().mesh.regions, halves(cube))  # type: ignore[union-attr]
