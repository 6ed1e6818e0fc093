"""Files that cannot be read: each is refused in one line that names it, in finite time, and nothing else is raised."""

import re
import signal
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.io import netcdf_file

from wct_plugin.errors import InputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS
from wct_plugin.mesh import TetMesh

ALL = [(form, suffix) for form in FORMATS for suffix in form.suffixes if form.writes]
#: Formats without counts or an end, where a file cut at the end of a line is a good one; of Nastran's that is said.
ENDLESS = (".inp", ".obj", ".bdf", ".fem", ".nas")
NASTRAN = ENDLESS[2:]
TETRA = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


class TooLong(BaseException):
    pass


@pytest.fixture(autouse=True)
def _limit() -> Iterator[None]:
    def stop(*_: Any) -> None:
        raise TooLong

    old = signal.signal(signal.SIGALRM, stop)
    signal.alarm(20)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, old)


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    return checked(caught.value, path)


def checked(error: InputError, path: Path) -> str:
    """What the error says of the file: in one line, and in words rather than by the class of an exception."""
    said = str(error)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    assert "malformed or truncated" not in said
    return said.removeprefix(f"{path}: ")


def refused(path: Path) -> bool:
    """Whether the file is refused, as it should be; of one that is read there may be warnings of ours alone."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", WctWarning)  # a changed name may be that of a section nobody knows
            read(path)
    except InputError as error:
        checked(error, path)
        return True
    return False


@pytest.fixture
def good(request: pytest.FixtureRequest, plain: TetMesh, tmp_path: Path) -> Path:
    form, suffix = request.param
    path = tmp_path / f"part{suffix}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WctWarning)  # Nastran rounds
        write(path, plain if form.volume else plain.boundary_surface())
    return path


each = pytest.mark.parametrize(("form", "suffix"), ALL, ids=lambda value: value if isinstance(value, str) else "")


@each
@pytest.mark.parametrize(
    "content",
    [
        b"hello\nthis is no mesh 1 2 3\n",
        b"\n\n\n",
        b"<html><body>404</body></html>",
        bytes(3000),
        bytes(range(256)) * 9,
    ],
    ids=["text", "blank", "html", "zeros", "binary"],
)
def test_garbage(form: Any, suffix: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"part{suffix}"
    path.write_bytes(content)
    if form.name == "TetGen":
        path.with_suffix(".ele" if suffix == ".node" else ".node").write_text("4 3 0 0\n1 2 3 4\n")
    said = refusal(path)
    assert said.startswith(f"cannot be read as {form.name}: ") or said == "has neither tets nor triangles"


@each
def test_empty(form: Any, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"part{suffix}"
    path.touch()
    assert refusal(path) == "is empty"


@each
def test_missing(form: Any, suffix: str, tmp_path: Path) -> None:
    assert refusal(tmp_path / f"part{suffix}") == "there is no such file"


@pytest.mark.parametrize("good", ALL, indirect=True, ids=[suffix for _, suffix in ALL])
def test_truncated(good: Path) -> None:
    data = good.read_bytes()
    whole = 0
    for cut in sorted({len(data) * k // 40 for k in range(1, 40)} | {10, 30, 60, 100}):
        good.write_bytes(data[:cut])
        try:
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                read(good)
            whole += 1
            assert ["does not end with ENDDATA" in str(one.message) for one in said] == [True] * (
                good.suffix in NASTRAN
            )
        except InputError as error:
            checked(error, good)
    assert good.suffix in ENDLESS or not whole


@pytest.mark.parametrize("good", ALL, indirect=True, ids=[suffix for _, suffix in ALL])
def test_a_changed_byte_never_escapes(good: Path) -> None:
    data, random = good.read_bytes(), np.random.default_rng(0)
    for at in random.integers(len(data), size=60):
        good.write_bytes(data[:at] + random.bytes(1) + data[at + 1 :])
        refused(good)


@pytest.mark.parametrize("good", ALL, indirect=True, ids=[suffix for _, suffix in ALL])
def test_a_changed_number_never_escapes(good: Path) -> None:
    numbers = [b"nan", b"-1", b"1e30", b"9223372036854775807", b"1" + 22 * b"0", b"abc", b"\xfc"]
    data, random = good.read_bytes(), np.random.default_rng(1)
    found = list(re.finditer(rb"(?<![\w.])[\d.]+(?![\w.])", data))
    for match in [*found[:6], *(found[k] for k in random.integers(len(found), size=6))]:
        for number in random.choice(numbers, 2):
            good.write_bytes(data[: match.start()] + number + data[match.end() :])
            refused(good)


@pytest.mark.parametrize("good", ALL, indirect=True, ids=[suffix for _, suffix in ALL])
def test_lines_lost_or_in_another_place_never_escape(good: Path) -> None:
    lines, random = good.read_bytes().splitlines(keepends=True), np.random.default_rng(2)
    for first, second in random.integers(len(lines), size=(12, 2)):
        swapped = list(lines)
        swapped[first], swapped[second] = lines[second], lines[first]
        for changed in (swapped, lines[:first] + lines[first + 1 :], lines[:first] + lines[max(first, second) :]):
            good.write_bytes(b"".join(changed) or b"\n")
            refused(good)


@pytest.mark.parametrize("name", ["a.xdmf", "a.med"])
def test_damage_of_hdf5_is_said(name: str, plain: TetMesh, tmp_path: Path) -> None:
    path = tmp_path / name
    write(path, plain)
    damaged = path.with_suffix(".h5") if name == "a.xdmf" else path
    data, random, said = damaged.read_bytes(), np.random.default_rng(3), []
    for at in random.integers(len(data), size=150):
        damaged.write_bytes(data[:at] + bytes(16) + data[at + 16 :])
        said.append(refused(path))
    assert sum(said) > 10
    damaged.write_bytes(data[:2000])
    assert "lacks a part that is needed, or it is damaged (" in refusal(path)


def test_damage_of_netcdf_is_said(tmp_path: Path) -> None:
    path = tmp_path / "a.e"
    with netcdf_file(path, "w") as file:
        for name, size in (("num_nodes", 4), ("num_dim", 3), ("num_el_in_blk1", 1), ("num_nod_per_el1", 4)):
            file.createDimension(name, size)
        file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = np.transpose(TETRA)
        cells = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
        cells[:] = [[1, 2, 3, 4]]
        cells.elem_type = "TETRA"
    assert not refused(path)
    data = path.read_bytes()
    for cut in range(8, len(data), 7):
        path.write_bytes(data[:cut])
        assert refusal(path).startswith("cannot be read as Exodus: ")
    for at in range(4, len(data), 2):
        path.write_bytes(data[:at] + bytes([data[at] ^ 16]) + data[at + 1 :])
        refused(path)


@pytest.mark.parametrize("suffix", [".obj", ".off"])
def test_names_need_not_be_utf8(suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    path, surface = tmp_path / f"a{suffix}", plain.boundary_surface()
    write(path, surface)
    path.write_bytes(path.read_bytes().replace(b"\n", b"  # W\xfcrfel\n", 1))
    assert np.array_equal(read(path).points, surface.points)


def test_a_set_for_a_tag_that_is_no_number(tmp_path: Path) -> None:
    (tmp_path / "a.inp").write_text(
        "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=TAG_tetra_x\n1,1,2,3,4\n"
    )
    assert refusal(tmp_path / "a.inp") == "has the tag of set 'TAG_tetra_x' 'x'; allowed is a whole number"


def test_open_cells_beside_tets_have_their_corners(tmp_path: Path) -> None:
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(TETRA), [("tetra", [[0, 1, 2, 3]] * 2)]), binary=False)
    head, types, tail = (tmp_path / "a.vtu").read_text().partition('Name="types"')
    (tmp_path / "a.vtu").write_text(head + types + tail.replace("10\n10", "10\n73"))
    said = (
        "cannot be read as VTU: cell 1 is of VTK's type 73 and has 4 points; allowed are known types with enough points"
    )
    assert refusal(tmp_path / "a.vtu") == said


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".inp"])
def test_of_infinite_coordinates_only_the_place_is_said(suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    path, points = tmp_path / f"a{suffix}", np.array(plain.points)
    points[0, 0] = np.inf
    meshio.write(path, meshio.Mesh(points, [("tetra", plain.tets), ("quad", [[0, 1, 2, 3]])]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "point 0 is (inf, " in refusal(path)


# Inputs on which meshio's own readers never end.
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999999\nend_header\n"),
        ("a.off", "OFF\n"),
        ("a.bdf", "BEGIN BULK\n"),
        ("a.node", "# nothing\n"),
    ],
)
def test_endless_readers(name: str, content: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content)
    (tmp_path / "a.ele").write_text("# nothing\n")
    assert refusal(tmp_path / name)


def test_a_directory_and_an_unknown_suffix(tmp_path: Path) -> None:
    (tmp_path / "a.vtu").mkdir()
    assert refusal(tmp_path / "a.vtu") == "is a directory; the name of a mesh file is needed"
    (tmp_path / "a.docx").write_text("text")
    assert refusal(tmp_path / "a.docx").startswith("unknown suffix '.docx'; allowed are .vtu .vtk .xdmf")


@pytest.mark.parametrize("kind", ["hexahedron", "wedge", "pyramid", "hexahedron20"])
def test_volumes_without_a_tet_are_refused_by_name(kind: str, tmp_path: Path) -> None:
    count = meshio._common.num_nodes_per_cell[kind]
    points = np.random.default_rng(0).random((20, 3))
    cells = [("triangle", [[0, 1, 2]]), (kind, [list(range(count)), list(range(count))[::-1]])]
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(points, cells))
    said = f"has 2 {kind} cells and no tet; tets are needed, beside which other cells may stand"
    assert refusal(tmp_path / "a.vtu") == said


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
@pytest.mark.parametrize(
    ("code", "said"),
    [
        (42, "has 1 polyhedron cells; allowed are tetra, triangle, line and vertex"),
        (51, "cell 1 is of VTK's type 51 and has 8 points; allowed are known types with enough points"),
    ],
)
def test_cells_meshio_skips_are_not_lost(code: int, said: str, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    points = np.random.default_rng(0).random((8, 3))
    cells = [("tetra", [[0, 1, 2, 3]]), ("hexahedron", [list(range(8))])]
    given = meshio.Mesh(points, cells)
    if suffix == ".vtu":
        meshio.vtu.write(path, given, binary=False)
        head, types, tail = path.read_text().partition('Name="types"')
        path.write_text(head + types + tail.replace("12", str(code)))
    else:
        meshio.vtk.write(path, given, binary=True)
        old, new = (np.array([value], dtype=">i4").tobytes() + b"\n" for value in (12, code))
        head, _, tail = path.read_bytes().rpartition(old)
        path.write_bytes(head + new + tail)
    assert said in refusal(path)


def test_neither_tets_nor_triangles(tmp_path: Path) -> None:
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(TETRA), [("line", [[0, 1]])]))
    assert refusal(tmp_path / "a.vtu") == "has neither tets nor triangles"


def test_plane_points_get_a_third_coordinate(tmp_path: Path) -> None:
    (tmp_path / "a.mesh").write_text(
        "MeshVersionFormatted 2\nDimension 2\nVertices\n3\n0 0 0\n1 0 0\n0 1 0\nTriangles\n1\n1 2 3 0\nEnd\n"
    )
    assert read(tmp_path / "a.mesh").points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("points", "tets", "said"),
    [
        (
            [[np.nan, 0, 0], *TETRA[1:]],
            [[0, 1, 2, 3]],
            "point 0 is (nan, 0, 0); coordinates must be finite (found: 1 tet with coordinates that are no numbers: 0;"
            " tets are counted from 0 in the order of the file; repair cannot mend these)",
        ),
        (TETRA, [[0, 1, 2, 7]], "tet 0 is (0, 1, 2, 7); indices must lie in 0..3"),
        (
            [*TETRA[:3], [1.0, 1, 0]],
            [[0, 1, 2, 3]],
            "tet 0, vertices (0, 1, 2, 3), has zero volume; it must not (found: 1 tet of zero volume: 0; tets are"
            " counted from 0 in the order of the file; option repair drops or mends such tets)",
        ),
    ],
)
def test_what_the_mesh_finds_names_the_file(points: Any, tets: Any, said: str, tmp_path: Path) -> None:
    meshio.vtu.write(tmp_path / "a.vtu", meshio.Mesh(np.array(points), [("tetra", np.array(tets))]))
    assert refusal(tmp_path / "a.vtu") == said


def test_what_stands_beyond_counts_of_tetgen_is_said(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n5 1 1 2\n# made by hand\n")
    (tmp_path / "a.ele").write_text("1 4 0\n0 0 1 2 3\n")
    with pytest.warns(WctWarning, match=r"not read: 2 lines of a\.node beyond its count"):
        assert len(read(tmp_path / "a.ele").points) == 4


def test_a_ten_node_tetgen_file(tmp_path: Path) -> None:
    (tmp_path / "a.node").write_text("1 3 0 0\n0 0 0 0\n")
    (tmp_path / "a.ele").write_text("1 10 0\n0 0 0 0 0 0 0 0 0 0 0\n")
    assert refusal(tmp_path / "a.ele").startswith("cannot be read as TetGen: ")
