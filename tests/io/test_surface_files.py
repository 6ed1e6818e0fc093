"""PLY, OBJ, OFF and STL as other programs write them."""

from pathlib import Path

import numpy as np
import pymeshlab
import pytest

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.mesh import SurfaceMesh

SAMPLES = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
CORNERS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"


def surface_of(path: Path) -> SurfaceMesh:
    mesh = read(path)
    assert isinstance(mesh, SurfaceMesh)
    return mesh


@pytest.mark.parametrize(
    ("name", "points", "triangles"),
    [
        ("bone.ply", 1872, 3022),
        ("colored_airplane.ply", 7017, 10796),
        ("airplane.obj", 7017, 10796),
        ("bunny.obj", 28088, 56172),
        ("bunny10k_textured.obj", 5051, 9999),
        ("cow.obj", 2904, 5804),
        ("cube.obj", 8, 12),
    ],
)
def test_the_samples_of_meshlab(name: str, points: int, triangles: int) -> None:
    mesh = surface_of(SAMPLES / name)
    assert (len(mesh.points), len(mesh.triangles)) == (points, triangles)
    judge = pymeshlab.MeshSet()
    judge.load_new_mesh(str(SAMPLES / name))
    assert np.allclose(judge.current_mesh().vertex_matrix(), mesh.points, rtol=1e-6)
    assert np.array_equal(judge.current_mesh().face_matrix(), mesh.triangles)


@pytest.mark.parametrize("binary", [True, False])
def test_quality_goes_to_meshlab_and_back(binary: bool, surface: SurfaceMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.ply", surface)
    meshlab = pymeshlab.MeshSet()
    meshlab.load_new_mesh(str(tmp_path / "a.ply"))
    assert np.array_equal(meshlab.current_mesh().face_scalar_array(), surface.cell_data["quality"])
    assert np.array_equal(meshlab.current_mesh().vertex_scalar_array(), surface.point_data["quality"])
    path = tmp_path / "b.ply"
    meshlab.save_current_mesh(str(path), binary=binary, save_face_quality=True, save_vertex_quality=True)
    mesh = surface_of(path)
    assert np.array_equal(mesh.triangles, surface.triangles)
    assert np.allclose(mesh.points, surface.points, rtol=1e-6)
    assert np.allclose(mesh.cell_data["quality"], surface.cell_data["quality"], atol=1e-6)
    assert np.allclose(mesh.point_data["quality"], surface.point_data["quality"], atol=1e-6)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".off", ".ply"])
@pytest.mark.parametrize("binary", [True, False])
def test_what_meshlab_writes(suffix: str, binary: bool, surface: SurfaceMesh, tmp_path: Path) -> None:
    meshlab = pymeshlab.MeshSet()
    meshlab.add_mesh(pymeshlab.Mesh(surface.points, surface.triangles.astype(np.int32)))
    options = {"binary": binary} if suffix in (".stl", ".ply") else {}
    meshlab.save_current_mesh(str(tmp_path / f"a{suffix}"), **options)
    mesh = surface_of(tmp_path / f"a{suffix}")
    assert len(mesh.points) == len(surface.points)
    assert np.allclose(mesh.points[mesh.triangles], surface.points[surface.triangles], atol=1e-6)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".off", ".ply"])
def test_meshlab_reads_ours(suffix: str, surface: SurfaceMesh, tmp_path: Path) -> None:
    bare = SurfaceMesh(surface.points, surface.triangles)
    write(tmp_path / f"a{suffix}", bare)
    meshlab = pymeshlab.MeshSet()
    meshlab.load_new_mesh(str(tmp_path / f"a{suffix}"))
    assert meshlab.current_mesh().face_number() == len(surface.triangles)
    assert meshlab.current_mesh().vertex_number() in (len(surface.points), 3 * len(surface.triangles))


def test_obj_with_texture_coordinates_normals_and_relative_indices(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(
        "# by hand\nmtllib no.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
        "g one\nf 1/1/1 2/2/1 3/4/1\nv 0 0 1\nf -4//1 -3//1 -1//1\n"
    )
    mesh = surface_of(tmp_path / "a.obj")
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 1, 3]]
    assert mesh.points[1].tolist() == [1, 0, 0]


@pytest.mark.parametrize("head", ["OFF\n4 1 0\n", "OFF 4 1 0\n", "# c\nOFF\n\n# c\n 4  1\n", "COFF\n4 1 0 # c\n"])
def test_off_headers(head: str, tmp_path: Path) -> None:
    points = CORNERS.replace("\n", " 255 0 0 255\n") if head.startswith("COFF") else CORNERS
    (tmp_path / "a.off").write_text(f"{head}{points}3 0 1 2 255 0 0\n")
    assert surface_of(tmp_path / "a.off").triangles.tolist() == [[0, 1, 2]]


FACES = "property list uchar int vertex_indices\nend_header\n" + CORNERS
PLY = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"


def test_ply_of_several_elements_and_lists(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_text(
        f"{PLY}element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 2\n"
        "property uchar id\nproperty list uchar float texcoord\nproperty list uchar uint vertex_index\n"
        f"end_header\n{CORNERS}0 1\n7 6 0 0 1 0 1 1 3 0 1 2\n8 0 3 0 2 3\n"
    )
    with pytest.warns(WctWarning, match=r"a\.ply: not read: face lists 'texcoord', elements 'edge'$"):
        mesh = surface_of(tmp_path / "a.ply")
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert mesh.cell_data["id"].tolist() == [7, 8]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3 4 5\n", "face 0 is (0, 1, 2, 3, 4); indices must lie in 0..1"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "face 0 has 2 corners; allowed are 3 and more"),
        ("a.obj", "v 0 0 x\n", "line 1 is 'v 0 0 x'; expected 'v x y z' or 'f a b c'"),
        ("a.obj", "v 0 0 0\nf 1 2 3\n", "triangle 0 is (0, 1, 2); indices must lie in 0..0"),
        ("a.off", f"OFF\n4 1 0\n{CORNERS}4 0 1 2\n", "face 0 of 1 has 4 numbers; expected 5"),
        ("a.off", f"OFF\n5 1 0\n{CORNERS}", "ends within vertex 4 of 5; expected 3 numbers for each"),
        ("a.ply", f"{PLY}element face 2\n{FACES}3 0 1 2\n4 0 1 2 4\n",
         "face 0 is (0, 1, 2, 4); indices must lie in 0..3"),
        ("a.ply", f"{PLY}end_header\n{CORNERS}", "has no element 'face'; a surface needs vertices and faces"),
        ("a.ply", f"{PLY}element face 0\n{FACES}",
         "has neither tets nor triangles"),
    ],
)  # fmt: skip
def test_refusals(name: str, content: str, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError) as caught:
        read(tmp_path / name)
    assert said in str(caught.value)
    assert str(caught.value).startswith(f"{tmp_path / name}: ")


@pytest.mark.parametrize("order", ["<", ">"])
def test_ply_of_either_byte_order(order: str, tmp_path: Path) -> None:
    kind = "little" if order == "<" else "big"
    head = PLY.replace("ascii", f"binary_{kind}_endian") + "element face 1\nproperty list int int vertex_indices\n"
    points = np.array(CORNERS.split(), dtype=f"{order}f4").tobytes()
    face = np.array([3, 0, 1, 2], dtype=f"{order}i4").tobytes()
    (tmp_path / "a.ply").write_bytes(f"{head}end_header\n".encode() + points + face)
    mesh = surface_of(tmp_path / "a.ply")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert mesh.triangles.tolist() == [[0, 1, 2]]
