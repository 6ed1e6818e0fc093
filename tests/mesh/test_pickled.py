"""Meshes are pickled, copied and sent to other processes whole, and come back as frozen as they were."""

import copy
import pickle

import dask
import joblib
import numpy as np
import pytest
from support.builders import kuhn_cube
from support.comparing import assert_same

from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh


def pickled(mesh):
    return pickle.loads(pickle.dumps(mesh))


def buffered(mesh):
    """As dask sends it: arrays beside the pickle, in memory that may be read-only."""
    buffers = []
    data = pickle.dumps(mesh, protocol=5, buffer_callback=buffers.append)
    return pickle.loads(data, buffers=[bytes(one.raw()) for one in buffers])


WAYS = [pickled, buffered, copy.copy, copy.deepcopy]


def arrays(mesh):
    """Every array of a mesh, those of its cells and mappings too."""
    for value in mesh.__getstate__().values():
        if isinstance(value, np.ndarray):
            yield value
        elif isinstance(value, dict):
            yield from (one for one in value.values() if isinstance(one, np.ndarray))
        elif isinstance(value, Cells | SurfaceMesh):
            yield from arrays(value)


@pytest.mark.parametrize("way", WAYS)
def test_all_comes_back_and_stays_frozen(way, full, surface):
    for mesh in (full, surface, TetMesh(full.points, full.tets, reference=surface, source="part.msh", periodic=True)):
        again = way(mesh)
        assert type(again) is type(mesh)
        assert_same(again, mesh)
        assert (again.source, getattr(again, "periodic", 0)) == (mesh.source, getattr(mesh, "periodic", 0))
        assert sum(1 for _ in arrays(again)) == sum(1 for _ in arrays(mesh)) > 3
        assert not any(one.flags.writeable for one in arrays(again))
        with pytest.raises(TypeError):
            again.point_data["new"] = np.zeros(3)
    assert_same(way(TetMesh(full.points, full.tets, reference=surface)).reference, surface)


def test_repairs_and_names_come_back(full):
    turned = TetMesh(full.points, full.tets[:, [1, 0, 2, 3]], names=full.names, tag_name="medit:ref")
    again = pickled(turned)
    assert again.repairs == turned.repairs
    assert again.repairs.flipped == len(full.tets)
    assert (dict(again.names), again.tag_name) == (dict(full.names), "medit:ref")


def test_equal_meshes_are_one_to_the_cache_of_joblib(full):
    assert joblib.hash(pickled(full)) == joblib.hash(full)


def test_what_is_derived_is_not_pickled_and_derived_again(full):
    before = len(pickle.dumps(full))
    boundary = full.topology.boundary
    assert len(pickle.dumps(full)) == before
    again = pickled(full)
    assert "topology" not in vars(again)
    assert np.array_equal(again.topology.boundary, boundary)
    assert again.topology is not full.topology


def volume(mesh: TetMesh) -> tuple[float, bool]:
    """Runs in another process; the core takes the arrays there."""
    return float(quality.volumes(mesh.points, mesh.tets).sum()), mesh.points.flags.writeable


def test_joblib_also_where_it_maps_large_arrays_into_files():
    meshes = [kuhn_cube(n) for n in (2, 3)]
    got = joblib.Parallel(n_jobs=2, max_nbytes=100)(joblib.delayed(volume)(mesh) for mesh in meshes)
    assert got == [(pytest.approx(1.0, rel=1e-12), False)] * 2
    assert joblib.hash(meshes[0]) != joblib.hash(meshes[1])


@pytest.mark.parametrize("scheduler", ["synchronous", "processes"])
def test_dask(scheduler):
    mesh = kuhn_cube(2)
    tasks = [dask.delayed(volume)(mesh), dask.delayed(volume)(dask.delayed(mesh))]
    assert dask.compute(*tasks, scheduler=scheduler) == ((pytest.approx(1.0, rel=1e-12), False),) * 2
