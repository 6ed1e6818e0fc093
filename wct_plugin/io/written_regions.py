"""How the regions stand in a file: as tags, or in the array that they came from, but once."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.region_choice import whole
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Ints

Arrays = dict[str, NDArray[Any]]


def tags_and_arrays(mesh: TetMesh, *, native: bool) -> tuple[Ints, Arrays]:
    """The tag of each tet as it is to be written, and the arrays beside.

    ``native``: whether the format has a place of its own for tags; else they are an array among others. An array that
    the regions repeat is that of the tags where the format is native or other cells have their tags there too; tags
    that the tets had beside it are theirs again.
    """
    arrays = dict(mesh.cell_data)
    own = whole(arrays[mesh.tag_name]) if mesh.tag_name in arrays else None
    repeated = _repeats(mesh)
    if own is not None and mesh.tag_name != mesh.region_name and (repeated or _told_by_sets(mesh)):
        del arrays[mesh.tag_name]
        return own, arrays
    if not repeated:
        return mesh.regions, arrays
    if native or mesh.region_name == mesh.tag_name:
        del arrays[mesh.region_name]
        return mesh.regions, arrays
    return np.zeros_like(mesh.regions), arrays


def shared_type(mesh: TetMesh, columns: list[Ints]) -> list[NDArray[Any]]:
    """Columns of tags in the type of the array that the regions came from, if that can hold them."""
    if not _repeats(mesh):
        return [np.array(column) for column in columns]
    dtype = mesh.cell_data[mesh.region_name].dtype
    cast = [column.astype(dtype) for column in columns]
    fits = all(np.array_equal(one, column) for one, column in zip(cast, columns, strict=True))
    return cast if fits else [np.array(column) for column in columns]


def _repeats(mesh: TetMesh) -> bool:
    """Whether the regions are still those of the array that they came from."""
    if mesh.region_name not in mesh.cell_data:
        return False
    values = whole(mesh.cell_data[mesh.region_name])
    return values is not None and np.array_equal(values, mesh.regions)


def _told_by_sets(mesh: TetMesh) -> bool:
    """Whether each region but 0 is a set of tets too."""
    sets = {np.sort(members).tobytes() for members in mesh.tet_sets.values()}
    numbers = np.unique(mesh.regions[mesh.regions != 0])
    return len(numbers) > 0 and all(np.flatnonzero(mesh.regions == number).tobytes() in sets for number in numbers)
