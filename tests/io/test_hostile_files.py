"""Files made to do harm: refused in one line, in little memory and time, and no other file is read for them."""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from support.hostile import ABAQUS, BOMBS, POINTS, VOXELS, vtu, xdmf

import wct_plugin as wct
from wct_plugin.errors import InputError, OptionError
from wct_plugin.io import voxel_image
from wct_plugin.io.netcdf_classic import ClassicFile

#: Bytes that a bomb may take beside what Python and its libraries do, and of address space in all.
_MEMORY, _SPACE = 700 << 20, 6 << 30
_CHILD = """
import json, resource, sys, time, warnings
import h5py, numpy, scipy.io, PIL.Image
import wct_plugin as wct
from wct_plugin.io import voxel_image
warnings.simplefilter("ignore")
for path in sys.argv[1:]:
    start, said = time.process_time(), "is read"
    try:
        (voxel_image.read if "/voxels/" in path else wct.read)(path)
    except wct.InputError as error:
        said = str(error)
    print(json.dumps([said, time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024]))
"""


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_SPACE, _SPACE))


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, float]]:
    """What a child with little memory says of each bomb, and the seconds it took; and that its memory was enough."""
    folder = tmp_path_factory.mktemp("bombs")
    (folder / "voxels").mkdir()
    paths = {name: folder / name for name in BOMBS} | {name: folder / "voxels" / name for name in VOXELS}
    for name, path in paths.items():
        (BOMBS | VOXELS)[name](path)
    command = [sys.executable, "-c", _CHILD, *map(str, paths.values())]
    env = dict(os.environ, OPENBLAS_NUM_THREADS="1")
    done = subprocess.run(command, capture_output=True, text=True, timeout=500, preexec_fn=_limit, env=env)
    assert done.returncode == 0, done.stderr
    found = dict(zip(paths, map(json.loads, done.stdout.splitlines()), strict=True))
    for path, (message, _, peak) in zip(paths.values(), found.values(), strict=True):
        assert peak < _MEMORY, (path, peak)
        assert message.count("\n") == 0
    return {name: (line.removeprefix(f"{paths[name]}: "), seconds) for name, (line, seconds, _) in found.items()}


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("zlib.vtu", "needs 4404019200 bytes for an array, which is more than the limit of"),
        ("lzma.vtu", "needs 4404019200 bytes for an array, which is more than the limit of"),
        ("lz4.vtu", "needs 4404019200 bytes for an array, which is more than the limit of"),
        (
            "shared.vtu",
            "needs 960000 bytes for an array, after 267840000 bytes of others, which is more than",
        ),
        ("packed.vtu.gz", "needs 1048576 bytes for what is packed in it, after 268435456 bytes of others"),
        ("declared.xdmf", "needs 6442450944 bytes for array '/p', which is more than the limit of 268435456 bytes"),
        ("chunk.xdmf", "has a part of array '/p' that unpacks to more than its 96 bytes"),
        ("large_chunk.xdmf", "needs 1610612640 bytes for a part of array '/p', after 96 bytes of others"),
        ("twice.xdmf", "has array '/p', which is packed 2 times; allowed is once"),
        ("again.xdmf", "needs 960000 bytes for array '/p', after"),
        ("quotes.xdmf", "refers to"),
        ("blocks.e", "has eb_400000000 among 2 variables; they must be numbered one after the other"),
        ("same.e", "needs 4800000 bytes for variable 'coord"),
        ("columns.msh", "needs 800000000 bytes for an array of 100000 rows of 1000 numbers"),
        ("instances.inp", "needs 4000000 bytes for instance 'I67'"),
        ("included.inp", "needs 5000004 bytes for the included file 'long.inp'"),
        ("sets.inp", "is read"),
        ("fields.bdf", "bytes for lines of 10000"),
        ("pages.tif", "bytes for the images of"),
        ("one.tif", "no image can be read: Image size (400000000 pixels) exceeds limit"),
        ("declared.npy", "no array can be read: mmap length is greater than file size"),
        ("zip.npy", "no array can be read: the magic string is not correct"),
        ("postscript", "a.png: no image can be read: cannot identify image file"),
        ("pipe", "a.png: holds an image, which is no file"),
    ],
)
def test_a_bomb_is_one_line(name: str, part: str, said: dict[str, tuple[str, float]]) -> None:
    message, seconds = said[name]
    assert part in message
    assert "--max-bytes sets another" in message or "needs" not in part
    assert seconds < 10


def test_a_block_that_holds_more_than_it_says(tmp_path: Path) -> None:
    import base64
    import zlib

    packed = zlib.compress(bytes(1 << 24))
    head = np.array([1, 96, 0, len(packed)], "<u8").tobytes()
    vtu(tmp_path / "a.vtu", "vtkZLibDataCompressor", base64.b64encode(head) + base64.b64encode(packed), 4)
    with pytest.raises(InputError, match="has a packed block of another length than it says"):
        wct.read(tmp_path / "a.vtu")


def test_the_limit_is_the_users(tmp_path: Path, plain: Any, capsys: pytest.CaptureFixture[str]) -> None:
    from wct_plugin.cli import main

    path = tmp_path / "a.vtu"
    wct.write(path, plain)
    assert len(wct.read(path, max_bytes=1 << 20).tets) == len(plain.tets)
    with pytest.raises(InputError, match=r"a\.vtu: .* more than the limit of 100 bytes; --max-bytes sets another"):
        wct.read(path, max_bytes=100)
    with pytest.raises(OptionError, match="max_bytes is 0; allowed is a number of bytes above 0"):
        wct.read(path, max_bytes=0)
    with pytest.raises(InputError, match="limit of 100 bytes"):
        wct.Reader(str(path), max_bytes=100).execute()
    for command in (["report"], ["optimize", "out.vtu"], ["dual", "out.npz"]):
        assert (
            main.run([command[0], str(path), *[str(tmp_path / one) for one in command[1:]], "--max-bytes", "1k"]) == 2
        )
        assert "the limit of 1024 bytes" in capsys.readouterr().err
    assert main.run(["report", str(path), "--max-bytes", "8G"]) == 0
    assert main.run(["report", str(path), "--max-bytes", "8 GB"]) == 2
    assert "'8 GB' is no size; allowed is a number of bytes, as 8G or 500M" in capsys.readouterr().err


# --- other files ----------------------------------------------------------------------------------------------------


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder beside which there is a secret."""
    folder = tmp_path / "here"
    folder.mkdir()
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["p"] = POINTS
    (tmp_path / "secret.bin").write_bytes(POINTS.tobytes())
    (tmp_path / "secret.inp").write_text("*NODE\n9,1,1,1\n")
    os.mkfifo(folder / "pipe")
    (folder / "device").symlink_to("/dev/zero")
    for suffix in ("h5", "bin", "inp"):
        (folder / f"link.{suffix}").symlink_to(f"../secret.{suffix}")
    return folder


def _virtual(file: h5py.File, _: Path) -> None:
    layout = h5py.VirtualLayout((4, 3), "f8")
    layout[...] = h5py.VirtualSource("../secret.h5", "p", (4, 3))
    file.create_virtual_dataset("p", layout)


_LEADING_OUT: dict[str, Any] = {
    "link": lambda file, _: file.update({"p": h5py.ExternalLink("../secret.h5", "/p")}),
    "pipe": lambda file, _: file.update({"p": h5py.ExternalLink("pipe", "/p")}),
    "soft": lambda file, _: file.update({"q": h5py.ExternalLink("../secret.h5", "/"), "p": h5py.SoftLink("/q/p")}),
    "circle": lambda file, _: file.update({"q": h5py.SoftLink("/p"), "p": h5py.SoftLink("/q")}),
    "storage": lambda file, place: file.create_dataset(
        "p", (4, 3), "f8", external=[(place.parent / "secret.bin", 0, 96)]
    ),
    "virtual": _virtual,
}


@pytest.mark.parametrize("way", _LEADING_OUT)
def test_hdf5_leads_to_no_other_file(way: str, place: Path) -> None:
    with h5py.File(place / "mesh.h5", "w") as file:
        _LEADING_OUT[way](file, place)
    xdmf(place / "a.xdmf", "mesh.h5:/p")
    with pytest.raises(InputError, match="which is kept in another file"):
        wct.read(place / "a.xdmf")
    if way == "link":
        for name in ("a.med", "a.e"):
            (place / name).write_bytes((place / "mesh.h5").read_bytes())
            with pytest.raises(InputError, match="has the link 'p' into another file; allowed are links within it"):
                wct.read(place / name)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("link.h5:/p", "names the file 'link.h5', a link that leads elsewhere"),
        ("pipe:/p", "names the file 'pipe', which is no file"),
        ("device:/p", "names the file 'device', a link that leads elsewhere"),
        ("../secret.h5:/p", "names the file '../secret.h5', which lies elsewhere"),
        ("/etc/passwd:/p", "names the file '/etc/passwd', which lies elsewhere"),
        ("none.h5:/p", "names the file 'none.h5', but there is no such file"),
    ],
)
def test_what_an_xdmf_file_names(name: str, said: str, place: Path) -> None:
    xdmf(place / "a.xdmf", name)
    with pytest.raises(InputError, match=said):
        wct.read(place / "a.xdmf")
    if "secret" not in name:
        xdmf(place / "b.xdmf", name.removesuffix(":/p").replace("link.h5", "link.bin"), how="Binary")
        with pytest.raises(InputError, match=said.replace("link.h5", "link.bin")):
            wct.read(place / "b.xdmf")


@pytest.mark.parametrize("name", ["link.inp", "pipe", "device", "../secret.inp", "/etc/passwd"])
def test_what_is_included(name: str, place: Path) -> None:
    (place / "a.inp").write_text(f"{ABAQUS}*INCLUDE,INPUT={name}\n")
    (place / "a.bdf").write_text(f"INCLUDE '{name}'\nENDDATA\n")
    (place / "a.pvtu").write_text(
        f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="{name}"/></PUnstructuredGrid></VTKFile>'
    )
    for file in ("a.inp", "a.bdf", "a.pvtu"):
        with pytest.raises(InputError, match=r"allowed are files beside|which is no file"):
            wct.read(place / file)


def test_files_of_a_format_of_several(place: Path) -> None:
    (place / "a.ele").write_text("1 4 0\n1 1 2 3 4\n")
    os.mkfifo(place / "a.node")
    with pytest.raises(InputError, match=r"needs a\.node beside it, which is no file"):
        wct.read(place / "a.ele")
    (place / "a.node").unlink()
    (place / "a.node").symlink_to("../secret.inp")
    with pytest.raises(InputError, match=r"needs a\.node beside it, a link that leads elsewhere"):
        wct.read(place / "a.ele")
    (place / "d.xml").write_text(
        '<dolfin><mesh celltype="tetrahedron" dim="3"><vertices size="4">'
        + "".join(f'<vertex index="{k}" x="{x}" y="{y}" z="{z}"/>' for k, (x, y, z) in enumerate(POINTS))
        + '</vertices><cells size="1"><tetrahedron index="0" v0="0" v1="1" v2="2" v3="3"/></cells></mesh></dolfin>'
    )
    os.mkfifo(place / "d_facet_region.xml")
    with pytest.raises(InputError, match=r"names the file 'd_facet_region\.xml', which is no file"):
        wct.read(place / "d.xml")


def test_links_among_the_files_themselves_are_followed(place: Path) -> None:
    store = place / "store"
    store.mkdir()
    with h5py.File(store / "mesh.h5", "w") as file:
        file["p"] = POINTS
        file["q"] = h5py.SoftLink("/p")
    xdmf(store / "a.xdmf", "mesh.h5:/q")
    (place / "mesh.h5").symlink_to("store/mesh.h5")
    xdmf(place / "b.xdmf", "mesh.h5:/p")
    shelf = place.parent / "shelf"
    shelf.mkdir()
    for name in ("a.xdmf", "mesh.h5"):  # as stores of data have it: all of a mesh is links into one folder
        (shelf / name).symlink_to(store / name)
    for path in (store / "a.xdmf", place / "b.xdmf", shelf / "a.xdmf"):
        assert np.array_equal(wct.read(path).points, POINTS)


def test_scripts_of_meshlab_name_no_folder_and_no_server(tmp_path: Path) -> None:
    from wct_plugin.adapters.meshlab import run

    scripts = {
        "sends the mesh to a server": '<filter name="Export to Sketchfab"/>',
        "allowed in a script is the name of a file without folders": (
            '<filter name="Transfer: Vertex Color to Texture"><Param name="textName" value="/etc/passwd"/></filter>'
        ),
    }
    for k, filter_ in enumerate(scripts.values()):
        (tmp_path / f"{k}.mlx").write_text(f"<!DOCTYPE FilterScript><FilterScript>{filter_}</FilterScript>")
    faults = run.check([run.read_script(tmp_path / f"{k}.mlx") for k in range(len(scripts))])
    assert all(part in fault for part, fault in zip(scripts, faults, strict=True))
    (tmp_path / "a.mlx").write_text('<!DOCTYPE F [<!ENTITY a "x">]><FilterScript><filter name="&a;"/></FilterScript>')
    with pytest.raises(InputError, match="declares the XML entity 'a'; allowed are scripts without"):
        run.read_script(tmp_path / "a.mlx")


# --- netCDF's classic files, against SciPy --------------------------------------------------------------------------


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("recorded", [0, 1, 2])
def test_classic_netcdf_is_what_scipy_reads(version: int, recorded: int, tmp_path: Path) -> None:
    from scipy.io import netcdf_file

    random = np.random.default_rng(recorded)
    wanted = {"a": random.normal(size=(3, 5)), "c": random.integers(100, size=(3,)).astype("i4")}
    with netcdf_file(tmp_path / "a.nc", "w", version=version) as file:
        file.title = "some words"
        for name, size in (("t", None), ("n", 5), ("k", 3)):
            file.createDimension(name, size)
        for name, dimensions in (("a", ("k", "n")), ("c", ("k",))):
            file.createVariable(name, wanted[name].dtype, dimensions)[:] = wanted[name]
        file.variables["a"].elem_type = "TETRA"
        for k in range(recorded):
            wanted[f"r{k}"] = (
                random.normal(size=(4, 5)).astype("f4") if k else random.integers(9, size=(4, 3)).astype("i2")
            )
            made = file.createVariable(f"r{k}", wanted[f"r{k}"].dtype, ("t", "n" if k else "k"))
            made[:] = wanted[f"r{k}"]
    found = ClassicFile((tmp_path / "a.nc").read_bytes())
    assert found.variables.keys() == wanted.keys()
    assert found.variables["a"].attributes == {"elem_type": b"TETRA"}
    for name, values in wanted.items():
        assert np.array_equal(found.values(name), values)
        assert found.values(name).dtype == values.dtype


def test_voxels_have_a_limit(tmp_path: Path) -> None:
    (tmp_path / "v").mkdir()
    from PIL import Image

    Image.new("L", (100, 100), 1).save(tmp_path / "v/a.png")
    assert voxel_image.read(str(tmp_path / "v"), 10_000).shape == (100, 100, 1)
    with pytest.raises(InputError, match="needs 10000 bytes for the images of"):
        voxel_image.read(str(tmp_path / "v"), 9_999)
