"""Files that are made to do harm: to take memory by the gigabyte, to hang, to lead elsewhere."""

import base64
import io
import lzma
import os
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from PIL import Image
from scipy.io import netcdf_file

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
_BLOCK, _COUNT = 24 << 17, 1400  #: bytes of a packed block, and how many: 4.4 GB
_CELLS = (
    b'<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>'
    b'<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>'
    b'<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>'
)
ABAQUS = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=A\n1,1,2,3,4\n"


def vtu(path: Path, compressor: str, points: bytes, count: int) -> None:
    """A VTU file of one tet whose points are these bytes of base64."""
    path.write_bytes(
        b'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" header_type="UInt64" compressor="%b">'
        b'<UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="1"><Points><DataArray type="Float64" '
        b'NumberOfComponents="3" format="binary">%b</DataArray></Points>%b</Piece></UnstructuredGrid></VTKFile>'
        % (compressor.encode(), count, points, _CELLS)
    )


def _packed(block: bytes, size: int, count: int) -> bytes:
    head = np.array([count, size, 0, *[len(block)] * count], "<u8").tobytes()
    return base64.b64encode(head) + base64.b64encode(block * count)


def _lz4_zeros(size: int) -> bytes:
    count = size - 1 - 4 - 15 - 5
    return bytes([0x1F, 0, 1, 0, *[255] * (count // 255), count % 255, 0x50]) + bytes(5)


def _bomb(compressor: str, pack: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    return lambda path: vtu(path, compressor, _packed(pack(bytes(_BLOCK)), _BLOCK, _COUNT), _BLOCK // 24 * _COUNT)


def _shared(path: Path) -> None:
    """Arrays that are all the same bytes."""
    count = 40_000
    data = np.array([24 * count], "<u8").tobytes() + bytes(24 * count)
    arrays = b"".join(
        b'<DataArray type="Float64" NumberOfComponents="3" Name="a%d" format="appended" offset="0"/>' % k
        for k in range(4000)
    )
    path.write_bytes(
        b'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" header_type="UInt64"><UnstructuredGrid>'
        b'<Piece NumberOfPoints="%d" NumberOfCells="1"><Points><DataArray type="Float64" NumberOfComponents="3" '
        b'format="appended" offset="0"/></Points><PointData>%b</PointData>%b</Piece></UnstructuredGrid>'
        b'<AppendedData encoding="raw">_%b</AppendedData></VTKFile>' % (count, arrays, _CELLS, data)
    )


def _gzip(path: Path) -> None:
    packer = zlib.compressobj(9, wbits=31)
    with path.open("wb") as file:
        for _ in range(300):
            file.write(packer.compress(bytes(1 << 20)))
        file.write(packer.flush())


def xdmf(path: Path, item: str, shape: str = "4 3", more: str = "", how: str = "HDF") -> None:
    """An XDMF file of one tet whose points are an item of a format."""
    path.write_text(
        '<Xdmf><Domain><Grid><Topology TopologyType="Tetrahedron" NumberOfElements="1"><DataItem Format="XML" '
        f'DataType="Int" Dimensions="1 4">0 1 2 3</DataItem></Topology><Geometry GeometryType="XYZ"><DataItem '
        f'Format="{how}" DataType="Float" Precision="8" Dimensions="{shape}">{item}</DataItem></Geometry>{more}'
        "</Grid></Domain></Xdmf>"
    )


def _xdmf_of(make: Callable[[h5py.File], object], shape: str = "4 3", more: str = "") -> Callable[[Path], None]:
    def write(path: Path) -> None:
        with h5py.File(path.with_suffix(".h5"), "w") as file:
            make(file)
        xdmf(path, f"{path.stem}.h5:/p", shape, more)

    return write


def _bomb_of_a_chunk(file: h5py.File) -> None:
    data = file.create_dataset("p", (4, 3), "f8", maxshape=(None, 3), chunks=(4, 3), compression="gzip")
    packer = zlib.compressobj(9)
    content = b"".join(packer.compress(bytes(1 << 20)) for _ in range(300)) + packer.flush()
    data.id.write_direct_chunk((0, 0), content)


def _twice_packed(file: h5py.File) -> None:
    made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    made.set_chunk((4, 3))
    made.set_deflate(9)
    made.set_filter(h5py.h5z.FILTER_LZF, 0, (4, 261, 96))
    h5py.h5d.create(file.id, b"p", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((4, 3)), made)


def _exodus(path: Path) -> None:
    with netcdf_file(path, "w") as file:
        for name, size in (("n", 4), ("d", 3), ("e", 1), ("c", 4)):
            file.createDimension(name, size)
        file.createVariable("coord", "f8", ("d", "n"))[:] = POINTS.T
        cells = file.createVariable("connect400000000", "i4", ("e", "c"))
        cells[:] = [[1, 2, 3, 4]]
        cells.elem_type = "TETRA"


def _netcdf(path: Path) -> None:
    """A thousand variables of the same 5 MB."""
    name = lambda text: len(text).to_bytes(4, "big") + text.encode() + bytes(-len(text) % 4)  # noqa: E731
    four = lambda number: number.to_bytes(4, "big")  # noqa: E731
    size, count = 600_000, 1000
    head = b"CDF\x01" + four(0) + four(10) + four(1) + name("n") + four(size) + bytes(8) + four(11) + four(count)
    entries = [name(f"coord{k:04}") + four(1) + four(0) + bytes(8) + four(6) + four(8 * size) for k in range(count)]
    begin = four(len(head) + sum(len(one) + 4 for one in entries))
    path.write_bytes(head + b"".join(one + begin for one in entries) + bytes(8 * size))


def _gmsh(path: Path) -> None:
    """Arrays of one row of a thousand numbers, for a hundred thousand points."""
    count = 100_000
    nodes = "".join(f"{k + 1} 0 0 {k}\n" for k in range(count))
    row = f"1 {'0 ' * 1000}"
    data = "".join(f'$NodeData\n1\n"d{k}"\n1\n0\n3\n0\n1000\n1\n{row}\n$EndNodeData\n' for k in range(9))
    path.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{count}\n{nodes}$EndNodes\n"
        f"$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n{data}"
    )


def _instances(path: Path) -> None:
    nodes = "".join(f"{k},0,0,{k}\n" for k in range(1, 20001))
    placed = "".join(f"*INSTANCE,NAME=I{k},PART=P\n*END INSTANCE\n" for k in range(20000))
    path.write_text(
        f"*PART,NAME=P\n*NODE\n{nodes}*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n*END PART\n"
        f"*ASSEMBLY,NAME=A\n{placed}*END ASSEMBLY\n"
    )


def _included(path: Path) -> None:
    (path.parent / "long.inp").write_text("** " + "x" * 5_000_000 + "\n")
    path.write_text(ABAQUS + "*INCLUDE,INPUT=long.inp\n" * 900)


def _sets(path: Path) -> None:
    """Sets that each have the one before twice among their members."""
    lines = "".join(f"*NSET,NSET=S{k + 1}\nS{k},S{k}\n" for k in range(60))
    path.write_text(f"{ABAQUS}*NSET,NSET=S0\n1,2\n{lines}")


def _free_fields(path: Path) -> None:
    """Cards of free fields, one of them with a hundred thousand."""
    grids = "".join(f"GRID,{k},,0.,0.,{k}.\n" for k in range(1, 60001))
    path.write_text(f"{grids}GRID,60001,,0.,0.,1.{',' * 100_000}\nCTETRA,1,1,1,2,3,4\nENDDATA\n")


#: What takes memory or time without bound, by the name of the file.
BOMBS: dict[str, Callable[[Path], object]] = {
    "zlib.vtu": _bomb("vtkZLibDataCompressor", zlib.compress),
    "lzma.vtu": _bomb("vtkLZMADataCompressor", lzma.compress),
    "lz4.vtu": _bomb("vtkLZ4DataCompressor", lambda block: _lz4_zeros(len(block))),
    "shared.vtu": _shared,
    "packed.vtu.gz": _gzip,
    "declared.xdmf": _xdmf_of(
        lambda file: file.create_dataset("p", (1 << 28, 3), "f8", chunks=(1 << 20, 3), compression="gzip"),
        f"{1 << 28} 3",
    ),
    "chunk.xdmf": _xdmf_of(_bomb_of_a_chunk),
    "large_chunk.xdmf": _xdmf_of(
        lambda file: file.create_dataset("p", (4, 3), "f8", maxshape=(None, 3), chunks=(1 << 26, 3), compression="gzip")
    ),
    "twice.xdmf": _xdmf_of(_twice_packed),
    "again.xdmf": _xdmf_of(
        lambda file: file.create_dataset("p", data=np.zeros((40_000, 3))),
        "40000 3",
        "".join(
            f'<Attribute Name="a{k}" Center="Node"><DataItem Format="HDF" Dimensions="40000 3">again.h5:/p</DataItem>'
            "</Attribute>"
            for k in range(1000)
        ),
    ),
    "quotes.xdmf": lambda path: path.write_text(
        f'<Xdmf><Domain><Grid Reference="/Xdmf/Domain/Grid[{chr(39) * 80}"></Grid></Domain></Xdmf>'
    ),
    "blocks.e": _exodus,
    "same.e": _netcdf,
    "columns.msh": _gmsh,
    "instances.inp": _instances,
    "included.inp": _included,
    "sets.inp": _sets,
    "fields.bdf": _free_fields,
}


def _image(path: Path) -> None:
    one = Image.new("L", (9000, 9000))
    one.save(path, compression="tiff_adobe_deflate", save_all=True, append_images=[one] * 8)


def _npy(path: Path) -> None:
    head = io.BytesIO()
    shape = (1 << 14, 1 << 14, 1 << 14)
    np.lib.format.write_array_header_1_0(head, {"descr": "|u1", "fortran_order": False, "shape": shape})
    path.write_bytes(head.getvalue())


def _folder(path: Path, make: Callable[[Path], object]) -> None:
    path.mkdir()
    make(path / "a.png")


#: The same of voxels.
VOXELS: dict[str, Callable[[Path], object]] = {
    "pages.tif": _image,
    "one.tif": lambda path: Image.new("L", (20000, 20000)).save(path, compression="tiff_adobe_deflate"),
    "declared.npy": _npy,
    "zip.npy": lambda path: path.write_bytes(b"PK\x03\x04" + bytes(100)),
    "postscript": lambda path: _folder(path, lambda image: image.write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\nshowpage\n")),
    "pipe": lambda path: _folder(path, os.mkfifo),
}
