"""Points that are in one place, counted."""

import numpy as np

import wct_plugin as wct
from wct_plugin.measure.coincident import count_coincident
from wct_plugin.mesh import TetMesh


def test_a_mesh_taken_apart():
    """Every tet with points of its own: each point of the mesh is there as often as tets meet in it."""
    cube, _ = wct.apply_filter("create_cube", variant="84")
    apart = TetMesh(cube.points[cube.tets.ravel()], np.arange(4 * len(cube.tets)).reshape(-1, 4))
    degree = np.bincount(cube.tets.ravel())
    found = count_coincident(apart)
    assert found == {"points": degree[degree > 1].sum(), "places": (degree > 1).sum()}
    assert count_coincident(cube) == {"points": 0, "places": 0}
    report = wct.report(apart)
    assert report.to_dict()["coincident"] == found
    assert f"{found['points']} points coincide, in {found['places']} places (merge=all joins them)" in report.notes
