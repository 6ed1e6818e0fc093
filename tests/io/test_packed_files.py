"""Files packed by gzip, of every format, and standard input and output under the name ``-``."""

import gzip
import io
import warnings
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from support.comparing import assert_same

from wct_plugin.batch import plan
from wct_plugin.errors import InputError, OutputError, WctWarning
from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.pipeline import Pipeline

ALL = [(form, suffix) for form in FORMATS for suffix in form.suffixes if form.writes]
each = pytest.mark.parametrize(("form", "suffix"), ALL, ids=lambda value: value if isinstance(value, str) else "")


@each
def test_packed_is_what_plain_is(form: Any, suffix: str, plain: TetMesh, tmp_path: Path) -> None:
    mesh = plain if form.volume else plain.boundary_surface()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WctWarning)  # Nastran rounds
        write(tmp_path / f"a{suffix}", mesh)
        write(tmp_path / f"b{suffix}.gz", mesh)
    assert gzip.decompress((tmp_path / f"b{suffix}.gz").read_bytes())
    one, other = read(tmp_path / f"a{suffix}"), read(tmp_path / f"b{suffix}.gz")
    assert_same(one, other)
    assert other.source == str(tmp_path / f"b{suffix}.gz")
    left = {file.name for file in tmp_path.iterdir() if file.name.startswith("b")}
    wanted = {f"b{one}.gz" for one in (form.packed or (suffix,))} | {f"b{one}" for one in form.beside}
    assert left == wanted


def test_the_same_mesh_is_packed_to_the_same_bytes(plain: TetMesh, tmp_path: Path) -> None:
    for name in ("a.msh.gz", "b.msh.gz"):
        write(tmp_path / name, plain)
    assert (tmp_path / "a.msh.gz").read_bytes() == (tmp_path / "b.msh.gz").read_bytes()
    (tmp_path / "a.msh").write_bytes(gzip.decompress((tmp_path / "a.msh.gz").read_bytes()))
    assert np.array_equal(meshio.read(tmp_path / "a.msh").points, plain.points)


def test_damaged_and_unknown(tmp_path: Path) -> None:
    (tmp_path / "a.vtu.gz").write_bytes(gzip.compress(b"x" * 10_000)[:-9])
    with pytest.raises(InputError, match=r"a\.vtu\.gz: cannot be unpacked: "):
        read(tmp_path / "a.vtu.gz")
    (tmp_path / "a.vtu.gz").write_text("no gzip")
    with pytest.raises(InputError, match=r"a\.vtu\.gz: cannot be unpacked: Not a gzipped file"):
        read(tmp_path / "a.vtu.gz")
    (tmp_path / "a.docx.gz").write_bytes(gzip.compress(b"x"))
    with pytest.raises(InputError, match=r"unknown suffix '\.docx'; allowed are \.vtu"):
        read(tmp_path / "a.docx.gz")


def test_included_files_of_a_packed_one(tmp_path: Path) -> None:
    (tmp_path / "nodes.inp").write_text("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n")
    text = "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"
    (tmp_path / "a.inp.gz").write_bytes(gzip.compress(text.encode()))
    mesh = read(tmp_path / "a.inp.gz")
    assert isinstance(mesh, TetMesh)
    assert len(mesh.tets) == 1


def test_batches_name_outputs_by_both_suffixes(plain: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "a.msh.gz", plain)
    chain = Pipeline.from_json([{"type": "filters.get_quality"}])
    named = [
        plan.plan(chain, [tmp_path / "a.msh.gz"], tmp_path / "out", suffix)[0].name
        for suffix in (None, "vtu", "vtu.gz")
    ]
    assert named == ["a.msh.gz", "a.vtu", "a.vtu.gz"]


class _Stream:
    def __init__(self, content: bytes = b"") -> None:
        self.buffer = io.BytesIO(content)


@pytest.mark.parametrize("suffix", ["vtu", ".vtu", "msh", "msh.gz", "mesh", "inp", "ply"])
def test_standard_input_and_output(suffix: str, plain: TetMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh: TetMesh | SurfaceMesh = plain.boundary_surface() if suffix == "ply" else plain
    out = _Stream()
    monkeypatch.setattr("sys.stdout", out)
    write("-", mesh, suffix=suffix)
    monkeypatch.setattr("sys.stdin", _Stream(out.buffer.getvalue()))
    again = read("-", suffix=suffix)
    assert np.array_equal(np.sort(again.points, axis=0), np.sort(mesh.points, axis=0))
    assert again.source == "-"


def test_streams_without_format_or_of_several_files(plain: TetMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", _Stream(b""))
    with pytest.raises(InputError, match=r"^-: has no suffix that tells its format; --input-format names it, as vtu$"):
        read("-")
    with pytest.raises(InputError, match=r"^-: is empty$"):
        read("-", suffix="vtu")
    with pytest.raises(InputError, match=r"^-: TetGen has several files; standard input is one$"):
        read("-", suffix="ele")
    with pytest.raises(InputError, match=r"^-: unknown format 'docx'; allowed are vtu vtk"):
        read("-", suffix="docx")
    with pytest.raises(OutputError, match=r"^-: XDMF has several files; standard output is one$"):
        write("-", plain, suffix="xdmf")
    with pytest.raises(OutputError, match=r"^-: has no suffix that tells its format; --output-format names it"):
        write("-", plain)


def test_a_file_of_any_name(plain: TetMesh, tmp_path: Path) -> None:
    write(tmp_path / "deck.dat", plain, suffix="inp")
    assert (tmp_path / "deck.dat").read_text().startswith("*")
    mesh = read(tmp_path / "deck.dat", suffix="inp")
    assert np.array_equal(mesh.points, plain.points)
    assert [file.name for file in tmp_path.iterdir()] == ["deck.dat"]
    with pytest.raises(OutputError, match=r"deck\.dat: TetGen has several files, so that the name itself must tell"):
        write(tmp_path / "deck.dat", plain, suffix="ele")
