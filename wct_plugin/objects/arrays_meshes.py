"""Meshes as bare arrays: points, tets or triangles, and a region or tag for each."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.types import Floats, Ints


def from_arrays(arrays: Any) -> TetMesh | SurfaceMesh:
    """Make a mesh of ``(points, cells)`` or ``(points, cells, tags)``.

    Parameters
    ----------
    arrays : tuple or list
        Points (n, 3); tets (m, 4) or triangles (k, 3); whole numbers or truth values, one a cell, or None.

    Raises
    ------
    InputError
        For arrays of other shapes, and those that make no mesh.
    """
    points, cells, tags = (*map(_array, arrays), None)[:3]
    if cells is None or cells.ndim != 2 or cells.shape[1] not in (3, 4):
        shape = None if cells is None else cells.shape
        raise InputError(f"the cells have shape {shape}; allowed is (m, 4) for tets, (k, 3) for triangles")
    if tags is not None and not tags.size:  # as TetGen gives it where there are no regions
        tags = None
    made = SurfaceMesh if cells.shape[1] == 3 else TetMesh
    return made(points, cells, None if tags is None else _whole(tags))  # type: ignore[arg-type]  # None stands for zeros


def to_arrays(mesh: TetMesh | SurfaceMesh) -> tuple[Floats, Ints, Ints]:
    """Points, tets or triangles, and their regions or tags: copies that may be written to.

    Some libraries, pytetwild among them, take no array that is read-only, as those of a mesh are.
    """
    if isinstance(mesh, SurfaceMesh):
        return mesh.points.copy(), mesh.triangles.copy(), mesh.tags.copy()
    return mesh.points.copy(), mesh.tets.copy(), mesh.regions.copy()


def _array(given: Any) -> NDArray[Any] | None:
    if given is None:
        return None
    try:
        return np.asarray(given)
    except ValueError as error:  # rows of different lengths
        raise InputError(f"one of the arrays is none: {str(error).splitlines()[0]}") from error


def _whole(tags: NDArray[Any]) -> NDArray[Any]:
    """Tags in one dimension, and as integers where they came as floats, which TetGen's do, or as truth values."""
    flat = tags.ravel() if tags.ndim == 2 and 1 in tags.shape else tags
    if flat.dtype.kind == "b":
        return flat.astype(np.int64)
    if flat.dtype.kind == "f":
        bad = np.flatnonzero(~(np.isfinite(flat) & (flat == np.rint(flat))))
        if len(bad):
            raise InputError(f"the region of cell {bad[0]} is {flat[bad[0]]:g}; allowed are whole numbers")
        return flat.astype(np.int64)
    return flat
