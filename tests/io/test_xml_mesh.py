"""Meshes in XML: PyDEC's, as its ``write_mesh`` makes them, and legacy dolfin's."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from support.builders import two_region_cube

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read
from wct_plugin.mesh import SurfaceMesh, TetMesh

CUBE = two_region_cube(2)
POINTS = CUBE.points * [1 / 3, 1.1, np.pi]


def array(path: Path, values: Any, form: str) -> None:
    """As ``pydec.io.arrayio`` writes it."""
    values = np.asarray(values)
    head = {"dims": ",".join(map(str, values.shape)), "dtype": values.dtype.name, "format": form, "version": "1.0"}
    if form != "basic":
        head |= {"type": "ndarray", "rank": values.ndim}
    text = f"{len(head)}\n" + "".join(f"{key}={value}\n" for key, value in head.items())
    body = values.tobytes() if form == "binary" else b""
    if form == "ascii":
        body = " ".join(map(repr, values.ravel().tolist())).encode() + b"\n"
    elif form == "basic":
        body = "".join(" ".join(map(repr, row)) + "\n" for row in values.tolist()).encode()
    path.write_bytes(text.encode() + body)


def pydec(path: Path, points: Any, cells: Any, form: str = "basic", called: str = "elements") -> None:
    array(path.with_suffix(".vertices"), points, form)
    array(path.with_suffix(f".{called}"), cells, form)
    files = "".join(f'\t<{key}>\n\t\t<file name="{path.stem}.{key}"/>\n\t</{key}>\n' for key in (called, "vertices"))
    path.write_text(f'<?xml version="1.0" ?>\n<mesh type="simplicial_mesh">\n{files}</mesh>\n')


@pytest.mark.parametrize("form", ["basic", "ascii", "binary"])
@pytest.mark.parametrize("called", ["elements", "indices"])
@pytest.mark.parametrize("kind", [np.int32, np.int64])
def test_pydec(form: str, called: str, kind: type, tmp_path: Path) -> None:
    pydec(tmp_path / "cube.xml", POINTS, CUBE.tets.astype(kind), form, called)
    mesh = read(tmp_path / "cube.xml")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.points, POINTS)
    assert np.array_equal(mesh.tets, CUBE.tets)


def test_a_surface_of_pydec(tmp_path: Path) -> None:
    pydec(tmp_path / "skin.xml", POINTS, CUBE.topology.boundary)
    surface = read(tmp_path / "skin.xml")
    assert isinstance(surface, SurfaceMesh)
    assert np.array_equal(surface.triangles, CUBE.topology.boundary)


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        (
            "a.xml",
            "simplicial_mesh",
            "regular_cube_mesh",
            "is a mesh of type 'regular_cube_mesh'; allowed is simplicial",
        ),
        ("a.xml", "a.vertices", "../a.vertices", "names the file '../a.vertices', which lies elsewhere"),
        ("a.xml", "a.vertices", "none", "names the file 'none', but there is no such file"),
        ("a.xml", "elements>", "things>", "names no file of elements; expected <elements><file name=...>"),
        ("a.xml", "<mesh ", "<!DOCTYPE a [<!ENTITY b SYSTEM '/etc/passwd'>]><mesh ", "declares the XML entity 'b'"),
        ("a.vertices", "dims=27,3", "dims=28,3", "a.vertices has 81 numbers but announces 28,3"),
        ("a.vertices", "float64", "object0", "a.vertices has format=basic and dtype=object0; allowed are"),
        ("a.elements", "4\n", "x\n", "a.elements begins with 'x'; expected the number of its keys"),
    ],
)
def test_refusals_of_pydec(file: str, old: str, new: str, said: str, tmp_path: Path) -> None:
    folder = tmp_path / "sub"
    folder.mkdir()
    pydec(folder / "a.xml", POINTS, CUBE.tets)
    text = (folder / file).read_text()
    assert old in text
    (folder / file).write_text(text.replace(old, new, 1 if file != "a.xml" else -1))
    with pytest.raises(InputError, match=r"a\.xml: cannot be read as XML: ") as caught:
        read(folder / "a.xml")
    assert said in str(caught.value)


def dolfin(path: Path, inside: str = "") -> None:
    """As dolfin writes it: corners in ascending order."""
    points = "".join(
        f'<vertex index="{k}" x="{x!r}" y="{y!r}" z="{z!r}" />' for k, (x, y, z) in enumerate(POINTS.tolist())
    )
    cells = "".join(
        f'<tetrahedron index="{k}" v0="{a}" v1="{b}" v2="{c}" v3="{d}" />'
        for k, (a, b, c, d) in enumerate(np.sort(CUBE.tets, axis=1).tolist())
    )
    path.write_text(
        f'<?xml version="1.0"?>\n<dolfin xmlns:dolfin="http://fenicsproject.org">\n<mesh celltype="tetrahedron">'
        f'<vertices size="{len(POINTS)}">{points}</vertices><cells size="{len(CUBE.tets)}">{cells}</cells>'
        f"{inside}</mesh></dolfin>\n"
    )


def collection(dim: int, rows: Any) -> str:
    values = "".join(f'<value cell_index="{c}" local_entity="{s}" value="{v}" />' for c, s, v in rows)
    return (
        f'<mesh_value_collection name="m" type="uint" dim="{dim}" size="{len(rows)}">{values}</mesh_value_collection>'
    )


def test_dolfin_with_tags_of_cells_and_facets(tmp_path: Path) -> None:
    """Side k of a cell lies opposite its k-th corner; a facet between two cells is listed by both, or by one."""
    cells = np.sort(CUBE.tets, axis=1)
    on_end = POINTS[cells][:, :, 0] == 0
    sides = [(c, int(np.flatnonzero(~on_end[c])[0]), 5) for c in np.flatnonzero(on_end.sum(axis=1) == 3)]
    tags = [(c, 0, region + 10) for c, region in enumerate(CUBE.regions)]
    inside = f"<domains>{collection(3, tags)}{collection(2, sides)}{collection(0, [(0, 1, 2)])}</domains>"
    dolfin(tmp_path / "a.xml", inside)
    with pytest.warns(WctWarning, match=r"a\.xml: not read: tags of dimension 0 in the mesh$"):
        mesh = read(tmp_path / "a.xml")
    assert isinstance(mesh, TetMesh)
    assert np.array_equal(mesh.points, POINTS)
    assert np.array_equal(mesh.regions, CUBE.regions + 10)
    assert (POINTS[mesh.facets.vertices][:, :, 0] == 0).all()
    assert mesh.facets.tags.tolist() == [5] * 8


def test_dolfin_with_tags_beside(tmp_path: Path) -> None:
    dolfin(tmp_path / "a.xml")
    values = "".join(f'<entity index="{k}" value="{tag + 10}" />' for k, tag in enumerate(CUBE.regions))
    head = '<dolfin><mesh_function type="uint" dim="{}" size="{}">'
    (tmp_path / "a_physical_region.xml").write_text(
        head.format(3, len(CUBE.tets)) + values + "</mesh_function></dolfin>"
    )
    (tmp_path / "a_facet_region.xml").write_text(head.format(2, 0) + "</mesh_function></dolfin>")
    with pytest.warns(WctWarning, match="tags of dimension 2 in a_facet_region.xml, by numbers that only dolfin knows"):
        mesh: Any = read(tmp_path / "a.xml")
    assert np.array_equal(mesh.regions, CUBE.regions + 10)


def test_dolfin_as_meshio_writes_it(tmp_path: Path) -> None:
    given = meshio.Mesh(np.round(POINTS, 6), [("tetra", CUBE.tets)])
    meshio.dolfin.write(tmp_path / "a.xml", given)
    mesh: Any = read(tmp_path / "a.xml")
    assert np.allclose(mesh.points, POINTS, atol=1e-6)
    assert np.array_equal(np.sort(mesh.tets), np.sort(CUBE.tets))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('celltype="tetrahedron"', 'celltype="hexahedron"', "has a mesh of hexahedron cells; allowed are tetrahedron"),
        ('<vertices size="27"', '<vertices size="28"', "has 27 vertex elements but announces 28"),
        ('<vertex index="3"', '<vertex index="4"', "its vertex elements are not numbered from 0 to 26"),
        ("<dolfin", "<other", "is no XML, or truncated \\(mismatched tag"),
    ],
)
def test_refusals_of_dolfin(old: str, new: str, said: str, tmp_path: Path) -> None:
    dolfin(tmp_path / "a.xml")
    text = (tmp_path / "a.xml").read_text()
    assert old in text
    (tmp_path / "a.xml").write_text(text.replace(old, new))
    with pytest.raises(InputError, match=rf"a\.xml: cannot be read as XML: {said}"):
        read(tmp_path / "a.xml")


def test_other_xml(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("<html></html>")
    with pytest.raises(InputError, match=r"begins with <html>; allowed are <mesh> of PyDEC and <dolfin>"):
        read(tmp_path / "a.xml")
