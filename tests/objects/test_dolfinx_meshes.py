"""A dolfinx mesh by its arrays. dolfinx is in no package index for pip, so a stand-in has its attributes here:
vertices and nodes are numbered apart, as they are there."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.builders import two_region_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh


class Topology:
    """Connectivities of tets, their facets and vertices, made when they are asked for."""

    def __init__(self, cells):
        self.dim = cells.shape[1] - 1
        self._made = {(self.dim, 0): cells}

    def create_connectivity(self, of, to):
        cells = self._made[self.dim, 0]
        if (of, to) == (2, 0) and self.dim == 3:
            faces = np.sort(cells[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
            self._made[2, 0] = np.unique(faces, axis=0)

    def connectivity(self, of, to):
        rows = self._made[of, to]
        return SimpleNamespace(array=rows.ravel(), offsets=np.arange(0, rows.size + 1, rows.shape[1]))


class Mesh:
    """As ``dolfinx.mesh.Mesh``: geometry and topology, and the processes that share it."""

    def __init__(self, points, cells, extra=0, processes=1):
        random = np.random.default_rng(0)
        vertex_of = random.permutation(len(points))  # vertex numbers of their own
        self.topology = Topology(vertex_of[cells].astype(np.int32))
        dofs = np.hstack([cells, np.zeros((len(cells), extra), dtype=cells.dtype)])
        self.geometry = SimpleNamespace(x=points, dofmap=dofs.astype(np.int32))
        self.comm = SimpleNamespace(size=processes)


Mesh.__module__ = "dolfinx.mesh"


def tags(dim, indices, values):
    return SimpleNamespace(dim=dim, indices=np.asarray(indices, np.int32), values=np.asarray(values, np.int32))


def facets_at(mesh, where):
    """Numbers of the facets whose corners all are where the mask (n,) of points is."""
    mesh.topology.create_connectivity(2, 0)
    faces = mesh.topology.connectivity(2, 0).array.reshape(-1, 3)
    corners = np.zeros(len(mesh.geometry.x), dtype=bool)
    corners[mesh.topology.connectivity(3, 0).array.ravel()] = where[mesh.geometry.dofmap.ravel()]
    return np.flatnonzero(corners[faces].all(axis=1))


CUBE = two_region_cube(2)


def test_regions_and_facets():
    given = Mesh(CUBE.points, CUBE.tets)
    left = facets_at(given, CUBE.points[:, 0] == 0)
    mesh = wct.from_dolfinx(given, tags(3, np.arange(48), CUBE.regions), tags(2, left, np.full(len(left), 7)))
    assert np.array_equal(mesh.points, CUBE.points)
    assert np.array_equal(mesh.regions, CUBE.regions)
    assert quality.volumes(mesh.points, mesh.tets)[mesh.regions == 1].sum() == pytest.approx(0.5, rel=1e-12)
    assert mesh.facets.tags.tolist() == [7] * 8
    assert (mesh.points[mesh.facets.vertices][..., 0] == 0).all()


def test_a_mesh_alone_and_its_tuple_with_tags():
    given = Mesh(CUBE.points, CUBE.tets)
    assert_same(wct.as_mesh(given), TetMesh(CUBE.points, CUBE.tets))
    assert_same(wct.as_mesh((given, tags(3, np.arange(48), CUBE.regions), None)), CUBE)
    part = tags(3, [3, 5], [2, 9])  # tags of some cells
    assert np.flatnonzero(wct.as_mesh((given, part)).regions).tolist() == [3, 5]
    assert isinstance(wct.optimize(Mesh(*wct.to_arrays(CUBE)[:2]), goal="3wc"), TetMesh)


def test_the_arrays_that_create_mesh_takes():
    points, cells, regions = wct.to_arrays(CUBE)
    assert (points.shape, points.dtype, cells.shape, cells.dtype) == ((27, 3), np.float64, (48, 4), np.int64)
    assert all(one.flags.c_contiguous and one.flags.writeable for one in (points, cells, regions))


def test_what_is_refused():
    with pytest.raises(InputError, match=r"dolfinx.mesh.Mesh: is spread over 4 processes; allowed is one"):
        wct.as_mesh(Mesh(CUBE.points, CUBE.tets, processes=4))
    given = Mesh(np.zeros((8, 3)), np.arange(8)[None])
    given.topology._made[3, 0] = given.topology.connectivity(7, 0).array.reshape(1, 8)
    given.topology.dim = 3
    with pytest.raises(InputError, match="has cells of 8 corners; allowed are tets and triangles"):
        wct.as_mesh(given)


def test_nodes_beside_the_corners_are_named():
    with pytest.warns(wct.WctWarning, match="dolfinx.mesh.Mesh: not read: 6 nodes of each cell beside its corners"):
        mesh = wct.as_mesh(Mesh(CUBE.points, CUBE.tets, extra=6))
    assert np.array_equal(mesh.points, CUBE.points)
