"""The files that are mutated: small and rich meshes in every format and dialect that is read.

They are written by ``wct_plugin``, gmsh, VTK (pyvista) and meshio, by hand (:mod:`benchmarks.fuzz.written_texts`), and
``tests/data`` has some. Libraries that do not bear each other are each in a process of their own.
"""

import contextlib
import gzip
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.fuzz.written_texts import WRITTEN

_DATA = Path(__file__).resolve().parents[2] / "tests" / "data"
_LARGEST = 60_000  #: bytes of a file of tests/data that is taken: larger ones are only slower

_BESIDE = (".node", ".face", ".h5", ".bin", ".elements", ".vertices")  #: of files that the one that is read names

#: Two corners of a cube that share a facet, and two more: five points, two tets, regions, tagged facets.
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [2, 1, 0.5]])
TETS = np.array([[0, 1, 2, 3], [1, 4, 2, 3], [1, 5, 4, 3]])
FACETS = np.array([[0, 2, 1], [0, 1, 3], [1, 4, 2], [1, 2, 3]])


def _place(folder: Path, name: str, file: str) -> Path:
    (folder / name).mkdir(parents=True, exist_ok=True)
    return folder / name / file


def _ours(folder: Path) -> None:
    """Everything that we write: all formats, gmsh's versions, mid nodes, packed."""
    import wct_plugin as wct
    from wct_plugin.io.formats import FORMATS
    from wct_plugin.mesh import Cells

    tets = np.where(
        (np.linalg.det(POINTS[TETS[:, 1:]] - POINTS[TETS[:, :1]]) > 0)[:, None], TETS, TETS[:, [0, 1, 3, 2]]
    )
    mesh = wct.TetMesh(
        *(POINTS, tets, np.array([3, 4, 4])),
        facets=Cells(FACETS, np.array([7, 8, 7, 9]), {"flux": np.arange(4.0)}, {"inlet": np.array([0, 2])}),
        edges=Cells(np.array([[0, 1], [1, 2]]), np.array([20, 21])),
        nodes=Cells(np.array([[3]]), np.array([1])),
        point_data={"u": np.arange(18.0).reshape(6, 3), "id": np.arange(6)},
        cell_data={"heat": np.array([0.5, 1.5, 2.5]), "a name <&'": np.arange(3, dtype=np.int32)},
        point_sets={"fixed": np.array([0, 2])},
        tet_sets={"core": np.array([1])},
        names={"steel": (3, 3), "air": (4, 3), "wall": (7, 2)},
    )
    for form in FORMATS:
        for suffix in form.suffixes if form.writes else ():
            what = mesh if form.volume else mesh.boundary_surface()
            wct.write(_place(folder, f"wct-{suffix[1:]}", f"main{suffix}"), what)
            if form.surface and form.volume:
                wct.write(_place(folder, f"wct-{suffix[1:]}-skin", f"main{suffix}"), mesh.boundary_surface())
            if form.second_order:
                wct.write(_place(folder, f"wct-{suffix[1:]}-order2", f"main{suffix}"), mesh, order=2)
    for version in ("2.2", "4.1"):
        for binary in (False, True):
            path = _place(folder, f"wct-msh-{version}-{'binary' if binary else 'text'}", "main.msh")
            wct.write(path, mesh, version=version, binary=binary)
    for suffix in ("vtu", "msh"):
        data = (folder / f"wct-{suffix}" / f"main.{suffix}").read_bytes()
        _place(folder, f"wct-{suffix}-gz", f"main.{suffix}.gz").write_bytes(gzip.compress(data, mtime=0))


def _gmsh(folder: Path) -> None:
    """Two boxes with a common side, with physical groups and periodic ends, as gmsh writes them."""
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 2)
    boxes = [(3, gmsh.model.occ.addBox(k, 0, 0, 1, 1, 1)) for k in range(2)]
    gmsh.model.occ.fragment(boxes[:1], boxes[1:])
    gmsh.model.occ.synchronize()
    for k, (_, tag) in enumerate(gmsh.model.getEntities(3)):
        gmsh.model.addPhysicalGroup(3, [tag], 5 + k, f"body {k}")
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)][:3], 9, "wall")
    gmsh.model.addPhysicalGroup(1, [tag for _, tag in gmsh.model.getEntities(1)][:2], 11, "rim")
    ends = [
        tag
        for x in (0, 2)
        for _, tag in gmsh.model.getEntitiesInBoundingBox(x - 0.01, -0.01, -0.01, x + 0.01, 1.01, 1.01, 2)
    ]
    gmsh.model.mesh.setPeriodic(2, ends[1:], ends[:1], [1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    gmsh.model.mesh.generate(3)
    for suffix in ("msh", "unv", "med", "mesh", "bdf", "vtk", "inp", "su2", "stl"):
        gmsh.write(str(_place(folder, f"gmsh-{suffix}", f"main.{suffix}")))
    for version, binary in ((2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)):  # 4.0 it writes as text only
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(_place(folder, f"gmsh-msh-{version}-{binary}", "main.msh")))
    gmsh.finalize()


def _vtk(folder: Path) -> None:
    """VTK's own writers in all their modes."""
    import pyvista as pv
    import vtk

    cells = np.hstack(
        [np.column_stack([np.full(3, 4), TETS]).ravel(), np.column_stack([np.full(4, 3), FACETS]).ravel()]
    )
    grid = pv.UnstructuredGrid(cells, np.array([10] * 3 + [5] * 4, dtype=np.uint8), POINTS)
    grid.cell_data["material"] = np.array([1, 2, 2, 7, 7, 8, 9])
    grid.point_data["u"] = np.arange(18.0).reshape(6, 3)
    surface = (
        grid.extract_surface(algorithm="dataset_surface") if hasattr(pv, "DataSetSurface") else grid.extract_surface()
    )

    def xml(name: str, writer: Any, data: Any, mode: str, compressor: str, file: str) -> None:
        writer.SetInputData(data)
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        writer.SetFileName(str(_place(folder, name, file)))
        writer.Write()

    for mode in ("Ascii", "Binary", "Appended"):
        for compressor in ("None", "ZLib", "LZ4", "LZMA"):
            if mode == "Ascii" and compressor != "None":
                continue
            xml(f"vtk-vtu-{mode}-{compressor}", vtk.vtkXMLUnstructuredGridWriter(), grid, mode, compressor, "main.vtu")
        xml(f"vtk-vtp-{mode}", vtk.vtkXMLPolyDataWriter(), surface, mode, "ZLib", "main.vtp")
    for version in (42, 51):
        for binary in (False, True):
            for name, writer, data in (
                ("grid", vtk.vtkUnstructuredGridWriter(), grid), ("skin", vtk.vtkPolyDataWriter(), surface),
            ):  # fmt: skip
                writer.SetInputData(data)
                writer.SetFileVersion(version)
                (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
                writer.SetFileName(
                    str(_place(folder, f"vtk-{name}-{version}-{'binary' if binary else 'text'}", "main.vtk"))
                )
                writer.Write()
    for name, binary in (("binary", True), ("text", False)):
        surface.save(_place(folder, f"vtk-ply-{name}", "main.ply"), binary=binary)
        surface.save(_place(folder, f"vtk-stl-{name}", "main.stl"), binary=binary)


def _meshio(folder: Path) -> None:
    """What meshio writes in formats that we read, among them Exodus and dolfin's XML."""
    import meshio

    cells = [("tetra", TETS), ("triangle", FACETS)]
    full = meshio.Mesh(POINTS, cells, point_data={"u": np.arange(6.0)}, cell_data={"a": [np.arange(3), np.arange(4)]})
    bare = meshio.Mesh(POINTS, cells[:1])
    for name, mesh, file, settings in (
        ("exodus", meshio.Mesh(POINTS, cells), "main.e", {}),
        ("dolfin", bare, "main.xml", {"file_format": "dolfin-xml"}),
        ("medit", full, "main.mesh", {}),
        ("meditb", bare, "main.meshb", {}),
        ("abaqus", full, "main.inp", {}),
        ("xdmf-binary", full, "main.xdmf", {"data_format": "Binary"}),
        ("xdmf-xml", full, "main.xdmf", {"data_format": "XML"}),
        ("nastran", bare, "main.bdf", {}),
        ("med", bare, "main.med", {}),
        ("gmsh40", bare, "main.msh", {"file_format": "gmsh40"}),
        ("tetgen", bare, "main.node", {}),
    ):
        place = _place(folder, f"meshio-{name}", file).parent
        # It names files beside by the whole path; and the installed version may not write it.
        with suppress(Exception), contextlib.chdir(place):
            meshio.write(file, mesh, **settings)


def _rest(folder: Path) -> None:
    for name, files in WRITTEN.items():
        for file, text in files.items():
            _place(folder, name, file).write_text(text)
    for path in sorted(_DATA.iterdir()):
        if path.suffix in (".vtu", ".msh", ".mesh", ".inp") and path.stat().st_size < _LARGEST:
            shutil.copy(path, _place(folder, f"data-{path.stem}", f"main{path.suffix}"))


_GROUPS: dict[str, Callable[[Path], None]] = {
    "ours": _ours, "gmsh": _gmsh, "vtk": _vtk, "meshio": _meshio, "rest": _rest,
}  # fmt: skip


def made(folder: Path) -> list[Path]:
    """The folders of the seed files, by name; written where they are not there yet."""
    if not (folder / "done").exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for group in _GROUPS:
            command = [sys.executable, "-m", "benchmarks.fuzz.seed_files", group, str(folder)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        for place in folder.iterdir():
            if not any(place.glob("main*")):
                shutil.rmtree(place)
        (folder / "done").touch()
    return sorted(path for path in folder.iterdir() if path.is_dir())


def main_file(place: Path) -> Path:
    """The file of a seed's folder that is read."""
    files = [path for path in place.glob("main.*") if path.suffix not in _BESIDE]
    return min(files, key=lambda path: path.suffix)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    _GROUPS[sys.argv[1]](Path(sys.argv[2]))
