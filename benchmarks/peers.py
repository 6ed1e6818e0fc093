"""What a user would install instead: one function per peer, a mesh in, points (n, 3) and tets (m, 4) out.

Options are those that did best of a few tried, TetGen's and Netgen's at about twice the input's tets. Regions, tags and
data are not handed over, as most of these tools know none; on a mesh of several regions only the outer boundary is
theirs to keep.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType

import numpy as np

from benchmarks.odt import odt_delaunay
from wct_plugin.measure.quality import volumes
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.types import Floats, Ints

Arrays = tuple[Floats, Ints]


@dataclass(frozen=True)
class Peer:
    """A tool: its row in the table, the distribution and module it needs, and the function that runs it."""

    name: str
    package: str
    module: str
    run: Callable[[TetMesh], Arrays]

    def load(self) -> None:
        """Import it before the clock runs; ImportError where it is not installed."""
        if self.module == "pytetwild":
            # It imports pyvista for an accessor that is of no use here, and fails without it.
            sys.modules.setdefault("pyvista", ModuleType("pyvista"))
        import_module(self.module)


def _mean_edge(mesh: TetMesh) -> float:
    ends = mesh.points[mesh.topology.edges]
    return float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).mean())


def gmsh_netgen(mesh: TetMesh) -> Arrays:
    """Three rounds of gmsh's Netgen optimizer ten times, its own optimizer and Relocate3D; the boundary stays."""
    import gmsh

    points, tets = mesh.points, mesh.tets
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for method in (*["Netgen"] * 10, "", "Relocate3D") * 3:
            points, tets = _gmsh_optimize(points, tets, method)
    finally:
        gmsh.finalize()
    return points, tets


def _gmsh_optimize(points: Floats, tets: Ints, method: str) -> Arrays:
    """One call of one optimizer on the mesh as a discrete entity, in a model of its own."""
    import gmsh

    mesh = TetMesh(points, tets)
    facets = mesh.topology.boundary
    outer = np.unique(facets)
    inner = np.setdiff1d(np.arange(len(mesh.points)), outer)
    gmsh.clear()
    gmsh.model.addDiscreteEntity(2, 1)
    gmsh.model.addDiscreteEntity(3, 1, [1])
    for dimension, nodes in ((2, outer), (3, inner)):
        gmsh.model.mesh.addNodes(dimension, 1, nodes + 1, mesh.points[nodes].ravel())
    gmsh.model.mesh.addElementsByType(1, 2, [], facets.ravel() + 1)
    gmsh.model.mesh.addElementsByType(1, 4, [], mesh.tets.ravel() + 1)
    gmsh.model.mesh.optimize(method, force=True, niter=5)
    points, made = _gmsh_tets()
    # Netgen leaves the old tets of a discrete entity in place and appends its own.
    return points, made[len(tets) :] if method == "Netgen" else made


def gmsh_delaunay(mesh: TetMesh) -> Arrays:
    """Gmsh's Delaunay algorithm fills the boundary anew, its facets kept."""
    return _gmsh_fill(mesh, 1)


def gmsh_hxt(mesh: TetMesh) -> Arrays:
    """Gmsh's HXT fills the boundary anew on one thread, its facets kept."""
    return _gmsh_fill(mesh, 10)


def _gmsh_fill(mesh: TetMesh, algorithm: int) -> Arrays:
    """With edges of .7 of the mesh's own inside, which gives about as many tets."""
    import gmsh

    surface = mesh.boundary_surface()
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7 * _mean_edge(mesh))
        gmsh.model.addDiscreteEntity(2, 1)
        gmsh.model.mesh.addNodes(2, 1, np.arange(len(surface.points)) + 1, surface.points.ravel())
        gmsh.model.mesh.addElementsByType(1, 2, [], surface.triangles.ravel() + 1)
        gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([1])])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(3)
        return _gmsh_tets()
    finally:
        gmsh.finalize()


def _gmsh_tets() -> Arrays:
    """The points and tets of the model."""
    import gmsh

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(4)
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    return coordinates.reshape(-1, 3), place[corners.astype(np.int64)].reshape(-1, 4)


def mmg_optim(mesh: TetMesh) -> Arrays:
    """``mmg3d -optim``: sizes kept; the surface may move within mmg's default tolerance."""
    return _mmg(mesh)


def mmg_les(mesh: TetMesh) -> Arrays:
    """``mmg3d -optim -optimLES``: likewise, and skewness improved."""
    return _mmg(mesh, optim_les=True)


def mmg_les_nosurf(mesh: TetMesh) -> Arrays:
    """``mmg3d -optim -optimLES -nosurf``: likewise, the surface kept."""
    return _mmg(mesh, nosurf=True, optim_les=True)


def _mmg(mesh: TetMesh, **options: bool) -> Arrays:
    import mmgpy

    made = mmgpy.MmgMesh3D(np.array(mesh.points), mesh.tets.astype(np.int32))
    made.remesh(**mmgpy.Mmg3DOptions(optim=True, verbose=-1, **options).to_dict())
    return made.get_vertices(), made.get_tetrahedra().astype(np.int64)


def tetgen_regenerate(mesh: TetMesh) -> Arrays:
    """``tetgen -pYq1.2/12 -a``: the boundary filled anew, its facets kept, no tet above the input's mean volume."""
    import tetgen

    surface = mesh.boundary_surface()
    mesher = tetgen.TetGen(np.array(surface.points), surface.triangles.astype(np.int32))
    points, tets, *_ = mesher.tetrahedralize(
        plc=True,
        nobisect=True,
        quality=True,
        minratio=1.2,
        mindihedral=12.0,
        fixedvolume=True,
        maxvolume=float(volumes(mesh.points, mesh.tets).mean()),
    )
    return points, tets.astype(np.int64)


def netgen_regenerate(mesh: TetMesh) -> Arrays:
    """Netgen fills the boundary anew and optimizes ten rounds; its facets kept.

    ``maxh`` of half the mean edge did best: Netgen makes its tets larger than asked.
    """
    from netgen import meshing

    surface = mesh.boundary_surface()
    made = meshing.Mesh(dim=3)
    made.Add(meshing.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    made.AddPoints(np.array(surface.points))
    made.AddElements(dim=2, index=1, data=surface.triangles.astype(np.int32), base=0)
    made.GenerateVolumeMesh(maxh=0.5 * _mean_edge(mesh), optsteps3d=10)
    corners = made.Elements3D().NumPy()["nodes"][:, :4]
    return np.array(made.Coordinates()), corners.astype(np.int64) - 1


def odt(mesh: TetMesh) -> Arrays:
    """Optimal Delaunay triangulation, the boundary kept."""
    return odt_delaunay(np.array(mesh.points), np.array(mesh.tets))


def ftetwild(mesh: TetMesh) -> Arrays:
    """What fTetWild makes by default of the surface given with the mesh, else of the boundary, at about its count.

    Its tets have about a tenth of the cube of the edge length asked for.
    """
    volume = abs(float(volumes(mesh.points, mesh.tets).sum()))
    return _ftetwild(mesh.reference or mesh.boundary_surface(), float(np.cbrt(10.0 * volume / len(mesh.tets))))


def ftetwild_strict(mesh: TetMesh) -> Arrays:
    """FTetWild from the boundary surface, until the AMIPS energy is below 6, not the usual 10; 5 takes minutes."""
    return _ftetwild(mesh.boundary_surface(), _mean_edge(mesh), stop_energy=6.0)


def _ftetwild(surface: SurfaceMesh, edge: float, stop_energy: float = 10.0) -> Arrays:
    from pytetwild import pytetwild

    # It dies of a segmentation fault on points that no triangle uses.
    used, triangles = np.unique(surface.triangles, return_inverse=True)
    points, tets = pytetwild.tetrahedralize(
        surface.points[used],
        triangles.reshape(-1, 3).astype(np.int32),
        edge_length_fac=edge / surface.diagonal,
        epsilon=1e-3,
        stop_energy=stop_energy,
        quiet=True,
    )
    return points, tets.astype(np.int64)


#: The mesher whose CPU time on the same model ours is measured by.
MESHER = Peer("fTetWild", "pytetwild", "pytetwild", ftetwild)

PEERS = (
    MESHER,
    Peer("gmsh Netgen + Relocate3D", "gmsh", "gmsh", gmsh_netgen),
    Peer("gmsh Delaunay", "gmsh", "gmsh", gmsh_delaunay),
    Peer("gmsh HXT", "gmsh", "gmsh", gmsh_hxt),
    Peer("mmg3d -optim", "mmgpy", "mmgpy", mmg_optim),
    Peer("mmg3d -optim -optimLES", "mmgpy", "mmgpy", mmg_les),
    Peer("mmg3d -optim -optimLES -nosurf", "mmgpy", "mmgpy", mmg_les_nosurf),
    Peer("TetGen -pYq1.2/12 -a", "tetgen", "tetgen", tetgen_regenerate),
    Peer("Netgen from boundary", "netgen-mesher", "netgen.meshing", netgen_regenerate),
    Peer("ODT + Delaunay", "scipy", "scipy.spatial", odt),
    Peer("fTetWild stop_energy 6", "pytetwild", "pytetwild", ftetwild_strict),
)
