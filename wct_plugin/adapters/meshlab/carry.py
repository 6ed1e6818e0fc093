"""What hung on a surface before MeshLab changed it, put on the surface it gave back; what cannot be is named."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import WctWarning
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.types import Ints

QUALITY = "quality"
COLOUR = ("red", "green", "blue", "alpha")
_NORMAL = ("nx", "ny", "nz")


def carry(old: SurfaceMesh, made: SurfaceMesh, live: dict[str, NDArray[Any]], what: str) -> SurfaceMesh:
    """Put the data and tags of ``old`` on the bare surface ``made``, and the quality and colours MeshLab gave.

    Where the triangles are still the same ones, all goes along. Elsewhere a point or triangle is the old one if it is
    in its exact place. New triangles get tag 0; an array goes along if it has a value for every point or triangle.

    Parameters
    ----------
    old, made : SurfaceMesh
        Before and after.
    live : dict
        ``point quality`` (n,), ``triangle quality`` (k,), ``point colour`` (n, 4), ``triangle colour`` (k, 4), if any.
    what : str
        Who changed it, for the :class:`WctWarning` that names what is dropped.
    """
    point, triangle = _origins(old, made)
    moved = old.points.shape != made.points.shape or not np.array_equal(old.points, made.points)
    lost: list[str] = []
    tags = np.where(triangle >= 0, old.tags[triangle], 0)
    if old.tags.any() and (triangle < 0).any():
        lost.append(f"the tags of {int((triangle < 0).sum())} of {len(triangle)} triangles, which are new")
    data = {}
    for kind, given, origin, stale in (
        ("point", old.point_data, point, _NORMAL if moved else ()),
        ("triangle", old.cell_data, triangle, ()),
    ):
        fresh = _fresh(live, kind)
        kept = {name: values for name, values in given.items() if name not in fresh}
        gone = [name for name in kept if name in stale or (origin < 0).any()]
        lost += [f"{kind} data {name!r}" for name in gone]
        data[kind] = {name: values[origin] for name, values in kept.items() if name not in gone} | fresh
    if lost:
        warnings.warn(f"{what} drops {', '.join(lost)}", WctWarning, stacklevel=2)
    return replace(made, tags=tags, point_data=data["point"], cell_data=data["triangle"])


def _origins(old: SurfaceMesh, made: SurfaceMesh) -> tuple[Ints, Ints]:
    """For each new point and triangle the old one it is, or -1."""
    if len(old.points) == len(made.points) and np.array_equal(old.triangles, made.triangles):
        return np.arange(len(made.points)), np.arange(len(made.triangles))
    # Adding 0 turns -0 into 0.
    _, places = np.unique(np.concatenate([old.points, made.points]) + 0.0, axis=0, return_inverse=True)
    old_place, new_place = np.split(places.reshape(-1), [len(old.points)])
    old_corners, new_corners = (
        np.sort(place[mesh.triangles], axis=1) for place, mesh in ((old_place, old), (new_place, made))
    )
    count = len(places)
    return find_rows(old_place[:, None], new_place[:, None], count), find_rows(old_corners, new_corners, count)


def _fresh(live: dict[str, NDArray[Any]], kind: str) -> dict[str, NDArray[Any]]:
    out = {}
    if f"{kind} quality" in live:
        out[QUALITY] = live[f"{kind} quality"]
    if f"{kind} colour" in live:
        out |= zip(COLOUR, np.rint(live[f"{kind} colour"] * 255.0).astype(np.uint8).T, strict=True)
    return out
