"""What every change of a tet mesh must keep of its domain."""

import numpy as np


def euler(mesh):
    facets = (4 * len(mesh.tets) + len(mesh.topology.boundary)) // 2
    return len(mesh.points) - len(mesh.topology.edges) + facets - len(mesh.tets)


def check_domain(old, new):
    ends = np.sort(new.topology.boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()
    assert new.topology.components.max() == old.topology.components.max()
    assert euler(new) == euler(old)
    assert not new.repairs
