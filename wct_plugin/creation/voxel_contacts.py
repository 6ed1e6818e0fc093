"""Voxels that touch may do so across a face only: along an edge or at a vertex alone the domain is no manifold."""

from functools import cache
from itertools import combinations

import numpy as np

from wct_plugin.types import Bools

Voxel = tuple[int, int, int]

_BLOCK: list[Voxel] = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]  # those round a vertex


def pinch(solid: Bools) -> str | None:
    """What is wrong with the first place where voxels of ``solid`` touch without a face between them, or None.

    Also where empty voxels do so at a vertex: there the surface round them touches itself. ``solid`` (nx, ny, nz) has
    at least one voxel.
    """
    other_axes = ((1, 2), (0, 2), (0, 1))
    spans = [np.flatnonzero(solid.any(axis=axes)) for axes in other_axes]
    low = [span[0] for span in spans]
    padded = np.pad(solid[tuple(slice(span[0], span[-1] + 1) for span in spans)], 1)
    nx, ny, nz = (size - 1 for size in padded.shape)
    codes = np.zeros((nx, ny, nz), dtype=np.uint8)  # of the block round each vertex
    for bit, (i, j, k) in enumerate(_BLOCK):
        codes |= padded[i : i + nx, j : j + ny, k : k + nz].view(np.uint8) << np.uint8(bit)
    table = _pinched()
    found = np.flatnonzero(np.array([fault is not None for fault in table])[codes])
    if not len(found):
        return None
    corner = np.unravel_index(found[0], codes.shape)
    fault = table[codes[corner]]
    assert fault is not None
    what, one, other, where = fault
    first, second = (
        tuple(int(sum(parts)) - 1 for parts in zip(low, corner, voxel, strict=True)) for voxel in (one, other)
    )
    return f"{what} {first} and {second} touch only {where}; what touches must share a face"


@cache
def _pinched() -> list[tuple[str, Voxel, Voxel, str] | None]:
    """For each set of solid voxels in a block which two of it touch wrongly, and where."""
    return [_fault([voxel for bit, voxel in enumerate(_BLOCK) if code >> bit & 1]) for code in range(256)]


def _fault(solid: list[Voxel]) -> tuple[str, Voxel, Voxel, str] | None:
    for one, other in combinations(solid, 2):
        if _steps(one, other) == 2:
            between = [voxel for voxel in solid if _steps(one, voxel) == _steps(voxel, other) == 1]
            if not between:
                return "voxels", one, other, "along an edge"
    empty = [voxel for voxel in _BLOCK if voxel not in solid]
    for what, voxels in (("voxels", solid), ("empty voxels", empty)):
        apart = [voxel for voxel in voxels if voxel not in _joined(voxels)]
        if apart:
            return what, voxels[0], apart[0], "at a vertex"
    return None


def _joined(voxels: list[Voxel]) -> set[Voxel]:
    """Those that the first one reaches through faces."""
    found, ahead = set(voxels[:1]), voxels[:1]
    while ahead:
        one = ahead.pop()
        new = [voxel for voxel in voxels if _steps(one, voxel) == 1 and voxel not in found]
        found.update(new)
        ahead += new
    return found


def _steps(one: Voxel, other: Voxel) -> int:
    """How many faces a way from one to the other crosses."""
    return sum(p != q for p, q in zip(one, other, strict=True))
