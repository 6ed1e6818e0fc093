"""Searches of small meshes through the core, and what must hold of their results."""

import numpy as np

from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import Topology
from wct_plugin.meshing.reference import own_boundary


def arguments(mesh, *, pinned=False, crease_angle=40.0):
    """What ``search_well_centered`` takes, for a mesh that stays near its own boundary."""
    own = own_boundary(mesh, crease_angle)
    of = own.strata
    return {
        "points": mesh.points,
        "tets": mesh.tets,
        "regions": np.searchsorted(own.regions, mesh.regions),
        "stratum": np.where(of.stratum > 0, 3, 0).astype(np.int8) if pinned else of.stratum,
        "label": np.full(len(of.label), -1) if pinned else of.label,
        "size": np.full(len(mesh.points), 0.3),
        "facets": of.triangles,
        "facet_patch": of.patch,
        "creases": of.segments,
        "crease_curve": of.curve,
        "surface_points": mesh.points,
        "surface_triangles": of.triangles,
        "surface_patch": of.patch,
        "surface_segments": of.segments,
        "surface_curve": of.curve,
    }


def search(mesh, *, pinned=False, change=None, **options):
    settings = {
        "tolerance": 0.05,
        "acute": True,
        "margin": 0.02,
        "flip_surface": True,
        "split_surface": True,
        "passes": 2,
        "kicks": 8,
        "seed": 0,
    }
    return _core.search_well_centered(**(arguments(mesh, pinned=pinned) | (change or {})), **(settings | options))


def bad(points, tets):
    """Tets that miss CWC, or meet it by less than the search asks for."""
    clear = quality.heights_over_radius(points, tets).min(axis=1) > 2e-3
    return int((~clear | (np.cos(np.radians(quality.face_angles(points, tets))).min(axis=1) <= 2e-3)).sum())


def rows(cells):
    return {tuple(row) for row in np.sort(cells, axis=1).tolist()}


def check_valid(found):
    assert (_core.orientation(found["points"], found["tets"]) == 1).all()
    topology = Topology(found["tets"], found["regions"], len(found["points"]))
    assert rows(topology.boundary) == rows(found["facets"])  # raises where a facet belongs to three tets
    ends = topology.boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert (np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)[1] == 2).all()
    assert np.array_equal(np.unique(found["tets"]), np.arange(len(found["points"])))
    assert (found["stratum"][found["facets"]] > 0).all()
    assert rows(found["creases"]) <= rows(topology.edges)
