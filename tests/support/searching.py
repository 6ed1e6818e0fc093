"""Searches of small meshes through the core, and what must hold of their results."""

from dataclasses import replace

import numpy as np

from wct_plugin.core import _core
from wct_plugin.core.requests import SearchOptions
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import Topology
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.search_mesh import from_mesh


def arguments(mesh, *, pinned=False, crease_angle=40.0):
    """The mesh and the surface that ``search_well_centered`` takes, for a mesh that stays near its own boundary."""
    own = own_boundary(mesh, crease_angle)
    return from_mesh(mesh, own, pinned=pinned, size=np.full(len(mesh.points), 0.3)), own.surface


def search(mesh, *, pinned=False, change=None, progress=None, crease=40.0, **options):
    """A short search; ``change`` says which arrays are to be other: those of the surface begin with ``surface_``."""
    of, on = arguments(mesh, pinned=pinned, crease_angle=crease)
    change = change or {}
    of = replace(of, **{name: values for name, values in change.items() if not name.startswith("surface_")})
    on = replace(on, **{name[8:]: values for name, values in change.items() if name.startswith("surface_")})
    settings = {"tolerance": 0.05, "passes": 2, "kicks": 8} | options
    return _core.search_well_centered(of, on, SearchOptions(**settings), progress)


def bad(points, tets):
    """Tets that miss CWC, or meet it by less than the search asks for."""
    clear = quality.heights_over_radius(points, tets).min(axis=1) > 2e-3
    return int((~clear | (np.cos(np.radians(quality.face_angles(points, tets))).min(axis=1) <= 2e-3)).sum())


def rows(cells):
    return {tuple(row) for row in np.sort(cells, axis=1).tolist()}


def check_valid(found):
    assert (_core.orientation(found.mesh.points, found.mesh.tets) == 1).all()
    topology = Topology(found.mesh.tets, found.mesh.regions, len(found.mesh.points))
    assert rows(topology.boundary) == rows(found.mesh.facets)  # raises where a facet belongs to three tets
    ends = topology.boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert (np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)[1] == 2).all()
    assert np.array_equal(np.unique(found.mesh.tets), np.arange(len(found.mesh.points)))
    assert (found.mesh.stratum[found.mesh.facets] > 0).all()
    assert rows(found.mesh.creases) <= rows(topology.edges)
