"""A mesh made anew in places, put back: what it takes from which of the two."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import jittered_cube

from wct_plugin.core.results import SearchResult
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.search_mesh import from_mesh
from wct_plugin.meshing.stitching import stitched


def flipped(start, at):
    """Near a place, two tets that share a facet become three round the edge between their other corners."""
    points, tets = start.points, start.tets
    for first in near(start, at):
        for second in np.flatnonzero(np.isin(tets, tets[first]).sum(axis=1) == 3):
            shared = np.intersect1d(tets[first], tets[second])
            a, b = np.setdiff1d(tets[first], shared)[0], np.setdiff1d(tets[second], shared)[0]
            three = np.array([[a, b, *pair] for pair in (shared[[0, 1]], shared[[1, 2]], shared[[2, 0]])])
            edges = points[three[:, 1:]] - points[three[:, :1]]
            volume = np.einsum("ij,ij->i", edges[:, 0], np.cross(edges[:, 1], edges[:, 2]))
            if (volume > 1e-6).all() or (volume < -1e-6).all():  # a convex pair
                if volume[0] < 0:
                    three = three[:, [1, 0, 2, 3]]
                kept = np.delete(np.arange(len(tets)), [first, second])
                return replace(
                    start, tets=np.vstack([tets[kept], three]), regions=np.zeros(len(tets) + 1, dtype=np.int64)
                )
    raise AssertionError("no two such tets")


NOWHERE = np.empty(0, dtype=np.int64)


def same(out, fresh):
    return out is not None and all(np.array_equal(values, vars(fresh)[name]) for name, values in vars(out).items())


def keys(points, tets):
    return {tuple(sorted(map(tuple, corners))) for corners in points[tets].tolist()}


@pytest.fixture(scope="module")
def start():
    mesh = jittered_cube(4)
    return from_mesh(mesh, own_boundary(mesh, 40.0), pinned=False)


def near(start, at):
    return np.argsort(np.linalg.norm(start.points[start.tets].mean(axis=1) - at, axis=1))


def shuffled(start, seed=3):
    """The same mesh, its points and tets in another order."""
    order = np.random.default_rng(seed).permutation(len(start.points))
    place = np.argsort(order)
    of = vars(start)
    change = {name: place[of[name]] for name in ("tets", "facets", "creases")}
    return replace(start, **change, **{name: of[name][order] for name in ("points", "stratum", "label", "size")})


def result(mesh, stuck=NOWHERE):
    """As if a search had led to the mesh."""
    return SearchResult(mesh, len(stuck), stuck, 0.0, 0, 0, 0, 0, 0, stopped=False, released=NOWHERE)


def test_the_same_mesh_stays(start):
    fresh = shuffled(start)
    assert same(stitched(fresh, NOWHERE, result(start)), fresh)


def test_old_tets_come_back_where_the_points_are_the_same(start):
    fresh = shuffled(flipped(start, 0.25))
    out = stitched(fresh, NOWHERE, result(start))
    assert keys(fresh.points, fresh.tets) != keys(start.points, start.tets)
    assert keys(out.points, out.tets) == keys(start.points, start.tets)
    assert keys(out.points, out.facets) == keys(start.points, start.facets)
    assert keys(out.points, out.creases) == keys(start.points, start.creases)
    assert len(out.regions) == len(out.tets)


def test_fresh_tets_stay_where_a_point_is_new(start):
    other = flipped(start, 0.2)
    inside = np.flatnonzero(start.stratum == 0)
    moved = inside[np.argmax(start.points[inside].sum(axis=1))]
    points = start.points.copy()
    points[moved] += 1e-3
    out = stitched(shuffled(replace(other, points=points)), NOWHERE, result(start))
    assert keys(out.points, out.tets) == keys(points, start.tets)  # the flip is undone, the move is not
    assert keys(out.points, out.facets) == keys(points, start.facets)


def test_stuck_tets_do_not_come_back(start):
    fresh = shuffled(flipped(start, 0.25))
    there = keys(fresh.points, fresh.tets)
    gone = [t for t, tet in enumerate(start.tets) if not keys(start.points, tet[None]) <= there]
    assert len(gone) == 2
    assert same(stitched(fresh, NOWHERE, result(start, np.array(gone[:1]))), fresh)


def test_what_was_surface_is_so_again(start):
    """Facets and labels come with the old tets: here the fresh mesh lacks a tet at the surface."""
    corner = start.tets[near(start, 0.5 * start.points.max(axis=0) * [0.0, 1.0, 1.0])]
    on = (start.stratum[corner] > 0).sum(axis=1) == 3
    facet = {tuple(sorted(f)) for f in start.facets.tolist()}
    tet = next(t for t in corner[on] if tuple(sorted(t[start.stratum[t] > 0])) in facet)
    outer = tuple(sorted(tet[start.stratum[tet] > 0]))
    inner = np.setdiff1d(tet, outer)[0]
    kept = ~(np.sort(start.tets, axis=1) == np.sort(tet)).all(axis=1)
    left = ~(np.sort(start.facets, axis=1) == outer).all(axis=1)
    laid_open = np.array([[inner, outer[0], outer[1]], [inner, outer[1], outer[2]], [inner, outer[2], outer[0]]])
    stratum = start.stratum.copy()
    stratum[inner] = 1
    fresh = replace(
        start,
        tets=start.tets[kept],
        regions=start.regions[kept],
        stratum=stratum,
        facets=np.vstack([start.facets[left], laid_open]),
        facet_patch=np.concatenate([start.facet_patch[left], np.zeros(3, dtype=np.int64)]),
    )
    out = stitched(shuffled(fresh), NOWHERE, result(start))
    assert keys(out.points, out.tets) == keys(start.points, start.tets)
    assert keys(out.points, out.facets) == keys(start.points, start.facets)
    patch = {
        tuple(sorted(map(tuple, c))): p
        for c, p in zip(start.points[start.facets].tolist(), start.facet_patch, strict=True)
    }
    assert all(
        patch[tuple(sorted(map(tuple, c)))] == p
        for c, p in zip(out.points[out.facets].tolist(), out.facet_patch, strict=True)
    )
    at = np.flatnonzero((out.points == start.points[inner]).all(axis=1))
    assert out.stratum[at].tolist() == [0]


def test_none_where_the_domain_is_lost(start):
    flip = flipped(start, 0.25)
    changed = keys(flip.points, flip.tets) - keys(start.points, start.tets)
    there = np.flatnonzero((start.points == next(iter(changed))[0]).all(axis=1))
    away = np.argmax(start.points.sum(axis=1))[None]
    assert stitched(flip, there, result(start)) is not None  # the old mesh is back there
    assert stitched(flip, away, result(start)) is None
    assert stitched(flip, np.array([-1]), result(start)) is None


def test_none_where_a_cavity_is_left(start):
    tet = np.flatnonzero((start.stratum[start.tets] == 0).all(axis=1))[0]
    points = start.points.copy()
    points[start.tets[tet, 0]] += 1e-3
    moved = replace(start, points=points)
    hollow = replace(moved, tets=np.delete(start.tets, tet, axis=0), regions=np.delete(start.regions, tet))
    assert same(stitched(moved, NOWHERE, result(start)), moved)
    assert stitched(hollow, NOWHERE, result(start)) is None
