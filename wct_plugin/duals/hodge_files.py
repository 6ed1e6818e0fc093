"""Hodge stars and exterior derivatives as files: one .npz, or a folder of Matrix Market files."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_array, diags_array

from wct_plugin.measure.duals import compute_duals, hodge_star
from wct_plugin.measure.exterior import exterior_derivative
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Floats


def stars(mesh: TetMesh) -> list[Floats]:
    """The diagonals of the four stars, rows as in :func:`wct_plugin.measure.duals.hodge_star`."""
    of = compute_duals(mesh)
    return [hodge_star(mesh, k, of) for k in range(4)]


def not_positive(diagonals: list[Floats]) -> list[str]:
    """What is to be said of entries that are not positive, per star that has some."""
    counts = [(k, int((~(diagonal > 0)).sum()), len(diagonal)) for k, diagonal in enumerate(diagonals)]
    return [f"{count} of {size} entries of star{k} are not positive" for k, count, size in counts if count]


def write_npz(path: Path, mesh: TetMesh, diagonals: list[Floats]) -> None:
    """Diagonals ``star0`` to ``star3``; ``d0`` to ``d2`` as ``_row``, ``_col``, ``_value``; and what rows stand for.

    These are ``points``, ``edges``, ``facets`` and ``tets``.
    """
    arrays: dict[str, Any] = {f"star{k}": diagonal for k, diagonal in enumerate(diagonals)}
    for k in range(3):
        matrix = coo_array(exterior_derivative(mesh, k))
        arrays |= {f"d{k}_row": matrix.row, f"d{k}_col": matrix.col, f"d{k}_value": matrix.data}
    topology = mesh.topology
    np.savez(path, points=mesh.points, edges=topology.edges, facets=topology.facets, tets=mesh.tets, **arrays)


def write_matrix_market(folder: Path, mesh: TetMesh, diagonals: list[Floats]) -> None:
    """A file per star, a diagonal matrix, and per derivative, in an existing ``folder``."""
    from scipy.io import mmwrite

    for k, diagonal in enumerate(diagonals):
        mmwrite(folder / f"star{k}.mtx", coo_array(diags_array(diagonal)), symmetry="general")
    for k in range(3):
        derivative = coo_array(exterior_derivative(mesh, k).astype(np.int64))
        mmwrite(folder / f"d{k}.mtx", derivative, symmetry="general")
