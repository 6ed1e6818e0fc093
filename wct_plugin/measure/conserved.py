"""What a mesh made anew must keep: areas and lengths of groups, and how much of the surface is sharp."""

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from wct_plugin.measure.fidelity import interface_rows
from wct_plugin.measure.quantities import Quantity, quantity
from wct_plugin.mesh import Cells, TetMesh, unit_scaling
from wct_plugin.mesh.index_arrays import masks
from wct_plugin.mesh.named_groups import tag_names
from wct_plugin.mesh.triangle_surfaces import areas, bends
from wct_plugin.types import Bools, Floats, Ints

#: The volume of a region, and the area of a group or interface, may change by this fraction.
CHANGE = 0.005
#: Edges of the boundary that bend as creases do may be longer than before by this factor, and this fraction of all.
SHARPER = (1.02, 0.001)


class Sharp(TypedDict):
    """Length of boundary edges that bend more than the crease angle."""

    before: float
    after: float
    allowed: float


def group_names(mesh: TetMesh, cells: Cells) -> dict[str, Bools]:
    """The groups of tagged cells, by tag (under its name, where it has one) and by set, as masks (k,)."""
    named = tag_names(mesh.names, cells.vertices.shape[1] - 1)
    out: dict[str, Bools] = {}
    for tag in np.unique(cells.tags):
        if tag != 0 or not cells.sets:
            out[named.get(int(tag), str(tag))] = cells.tags == tag
    return out | masks(cells.sets, len(cells))


def measure_groups(old: TetMesh, new: TetMesh, stretch: Mapping[str, float]) -> dict[str, Quantity]:
    """Area of each group of facets and length of each group of edges, by name.

    ``stretch``: area of a group on the surface that is followed over that on the old mesh's own facets, where they
    differ.
    """
    out = {}
    for of_old, of_new in ((old.facets, new.facets), (old.edges, new.edges)):
        before, after = (
            {
                name: float(_sizes(mesh.points, cells.vertices[rows]).sum())
                for name, rows in group_names(mesh, cells).items()
            }
            for mesh, cells in ((old, of_old), (new, of_new))
        )
        for name, size in before.items():
            out[name] = quantity(size * stretch.get(name, 1.0), after.get(name, 0.0))
    interfaces, made = _interface_areas(old), _interface_areas(new)
    for name, area in interfaces.items():
        out[f"interface {name}"] = quantity(area, made.get(name, 0.0))
    return out


def _interface_areas(mesh: TetMesh) -> dict[str, float]:
    """By the tags of both regions, the smaller first: ``1|2``."""
    area = _sizes(mesh.points, mesh.topology.interfaces)
    return {name: float(area[rows].sum()) for name, rows in interface_rows(mesh).items()}


def sharp_length(points: Floats, triangles: Ints, crease_angle: float) -> tuple[float, float]:
    """Length of a surface's edges that bend more than ``crease_angle`` degrees, and of all between two triangles."""
    edges, bend, _ = bends(points, triangles, np.zeros(len(triangles), dtype=np.int64))
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    return float(length[bend > crease_angle].sum()), float(length.sum())


def measure_sharp(old: list[tuple[Floats, Ints]], new: tuple[Floats, Ints], crease_angle: float) -> Sharp:
    """How long edges that bend are on the new boundary and on the old ones, the sharpest of which rules."""
    before = max(sharp_length(points, triangles, crease_angle)[0] for points, triangles in old)
    after, all_of_it = sharp_length(*new, crease_angle)
    return {"before": before, "after": after, "allowed": SHARPER[0] * before + SHARPER[1] * all_of_it}


def _sizes(points: Floats, cells: Ints) -> Floats:
    """Areas of triangles (k, 3), lengths of edges (k, 2), in any unit of length."""
    unit = unit_scaling.exponent(points)
    points = unit_scaling.rescaled(points, -unit)
    if cells.shape[1] == 3:
        size, dimension = areas(points, cells), 2
    else:
        size, dimension = np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1), 1
    return np.asarray(np.ldexp(size, dimension * unit), dtype=np.float64)
