"""The two things that flow through a pipeline: :class:`TetMesh` and :class:`SurfaceMesh`, frozen and validated.

Arrays are float64 / int64, native byte order, C-contiguous and read-only; a mesh is changed through
:func:`dataclasses.replace`, which validates again. Topology is derived when first asked for (``topology.py``).
"""

from collections.abc import Iterable, Mapping
from dataclasses import InitVar, dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wct_plugin.errors import NoMeshError
from wct_plugin.exact import predicates
from wct_plugin.mesh import faults
from wct_plugin.mesh.in_words import in_words
from wct_plugin.mesh.pickled import Pickled
from wct_plugin.mesh.repairs import Repairs
from wct_plugin.mesh.shown import Shown
from wct_plugin.mesh.topology import Topology
from wct_plugin.types import Floats, Ints

if TYPE_CHECKING:  # they are made of what is defined here
    from wct_plugin.mesh.other_cells import OtherCells
    from wct_plugin.mesh.second_order import SecondOrder

_KIND = {1: "vertex", 2: "edge", 3: "triangle", 4: "tet"}
_KIND_S = {1: "vertices", 2: "edges", 3: "triangles"}


@dataclass(frozen=True, eq=False)
class Cells(Pickled):
    """Facets (d = 3), edges (d = 2) or vertices (d = 1) the user tagged: boundary conditions, interfaces, probes.

    ``vertices`` (k, d) point indices; ``tags`` (k,), 0 where the file gave none; ``data`` arrays of length k;
    ``sets`` named index arrays into the k cells.
    """

    vertices: Ints
    tags: Ints = None  # type: ignore[assignment]  # filled in __post_init__
    data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    sets: Mapping[str, Ints] = field(default_factory=dict)

    def __post_init__(self) -> None:
        vertices = indices(self.vertices, "cells")
        if vertices.ndim != 2 or not vertices.shape[1]:
            raise NoMeshError(f"tagged cells have shape {vertices.shape}; allowed is (k, number of vertices of each)")
        kind = _kind(vertices)
        store(self, "vertices", vertices)
        store(self, "tags", _tags(self.tags, len(vertices), kind))
        store_mapping(self, "data", checked_data(self.data, len(vertices), kind))
        store_mapping(self, "sets", checked_sets(self.sets, len(vertices), kind))

    def __len__(self) -> int:
        return len(self.vertices)

    def __repr__(self) -> str:
        counts = {_KIND_S.get(self.vertices.shape[1], "cells"): len(self)}
        return in_words(self, "", counts, {"data": self.data, "sets": self.sets})

    def select(self, keep: NDArray[Any], vertices: Ints | None = None) -> "Cells":
        """The cells where the mask ``keep`` (k,) holds, their points renumbered to ``vertices`` if given."""
        place = np.cumsum(keep) - 1
        return Cells(
            (self.vertices if vertices is None else vertices)[keep],
            self.tags[keep],
            {name: values[keep] for name, values in self.data.items()},
            {name: place[members[keep[members]]] for name, members in self.sets.items()},
        )


def _no_cells(width: int) -> Cells:
    return Cells(np.empty((0, width), dtype=np.int64))


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(Pickled, Shown):
    """A triangle surface: what a mesher fills, and what an output boundary is measured against.

    ``points`` (n, 3), ``triangles`` (k, 3), ``tags`` (k,), data by name, ``source`` the file it came from.
    Raises :class:`wct_plugin.errors.InputError` for NaN or infinite coordinates, indices out of range and an empty
    triangle list.
    """

    points: Floats
    triangles: Ints
    tags: Ints = None  # type: ignore[assignment]
    point_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    cell_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    source: str = ""

    def __post_init__(self) -> None:
        points = checked_points(self.points)
        triangles = indices(self.triangles, "triangles")
        if triangles.ndim != 2 or triangles.shape[1] != 3:
            raise NoMeshError(f"triangles have shape {triangles.shape}; allowed is (k, 3)")
        if not len(triangles):
            raise NoMeshError("the surface has no triangles; at least one is needed")
        check_range(triangles, len(points))
        store(self, "points", points)
        store(self, "triangles", triangles)
        store(self, "tags", _tags(self.tags, len(triangles), "triangle"))
        store_mapping(self, "point_data", checked_data(self.point_data, len(points), "point"))
        store_mapping(self, "cell_data", checked_data(self.cell_data, len(triangles), "triangle"))

    def _counts(self) -> dict[str, int]:
        return {"points": len(self.points), "triangles": len(self.triangles)}

    def _named(self) -> dict[str, Iterable[Any]]:
        return {"point data": self.point_data, "triangle data": self.cell_data}

    def _cells(self) -> tuple[Ints, Ints]:
        return self.triangles, self.tags

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, in the mesh's own unit."""
        return float(np.linalg.norm(np.ptp(self.points[np.unique(self.triangles)], axis=0)))


@dataclass(frozen=True, eq=False, repr=False)
class TetMesh(Pickled, Shown):
    """A tetrahedral mesh with everything that hangs on it.

    ``points`` (n, 3) and ``tets`` (m, 4), positively oriented: ``det(x1-x0, x2-x0, x3-x0) > 0``, exactly.
    ``regions`` (m,) a tag per tet; ``facets``, ``edges``, ``nodes`` the tagged cells that came with the tets;
    ``point_data`` / ``cell_data`` arrays per point / per tet; ``point_sets`` / ``tet_sets`` named index arrays;
    ``names`` physical names as in gmsh: name -> (tag, dimension); ``tag_name`` the array the tags came from;
    ``reference`` the surface the boundary should stay near, where the pipeline knows it; ``source`` the file;
    ``periodic`` whether sides that are translates of each other are meant to match, as gmsh's files say it;
    ``others`` the cells beside the tets that are none; ``second_order`` what there was of it, if tets had mid nodes;
    ``region_name`` the array of ``cell_data`` that the regions repeat, if they came from one beside the tags;
    ``element_types`` Abaqus's type of the elements of each kind, where the file was one.

    Construction turns negative tets round and drops points no tet uses (data and tags follow); :attr:`repairs` counts
    both. With ``mends=False``, as for what the package itself makes, both are faults of who made it. Raises
    :class:`wct_plugin.errors.InputError` for NaN, indices out of range, duplicate tets and tets of zero volume.
    """

    points: Floats
    tets: Ints
    regions: Ints = None  # type: ignore[assignment]
    facets: Cells = field(default_factory=lambda: _no_cells(3))
    edges: Cells = field(default_factory=lambda: _no_cells(2))
    nodes: Cells = field(default_factory=lambda: _no_cells(1))
    point_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    cell_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    point_sets: Mapping[str, Ints] = field(default_factory=dict)
    tet_sets: Mapping[str, Ints] = field(default_factory=dict)
    names: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    tag_name: str = "gmsh:physical"
    reference: SurfaceMesh | None = None
    source: str = ""
    repairs: Repairs = field(default_factory=Repairs)
    periodic: bool = False
    others: "OtherCells | None" = None
    second_order: "SecondOrder | None" = None
    region_name: str = ""
    element_types: Mapping[str, str] = field(default_factory=dict)
    mends: InitVar[bool] = True

    def __post_init__(self, mends: bool) -> None:
        points = _rows_of_3(self.points)
        tets = indices(self.tets, "tets")
        if tets.ndim != 2 or tets.shape[1] != 4:
            raise NoMeshError(f"tets have shape {tets.shape}; allowed is (m, 4)")
        if not len(tets):
            raise NoMeshError("the mesh has no tetrahedra; at least one is needed")
        check_range(tets, len(points))
        for cells, width in ((self.facets, 3), (self.edges, 2), (self.nodes, 1)):
            if cells.vertices.shape[1] != width:
                raise NoMeshError(
                    f"{_KIND[width]} cells have {cells.vertices.shape[1]} points each; allowed is {width}"
                )
            check_range(cells.vertices, len(points))
        _check_distinct(tets)
        used = np.zeros(len(points), dtype=bool)
        used[tets] = True
        points = checked_points(points, used)
        tets, flipped = _orient(points, tets)
        store_mapping(self, "point_data", checked_data(self.point_data, len(points), "point"))
        store_mapping(self, "point_sets", checked_sets(self.point_sets, len(points), "point"))
        orphans = int(len(points) - used.sum())
        stray = 0
        if not mends and (flipped or orphans):
            what = f"{flipped} tets are negatively oriented" if flipped else f"{orphans} points are in no tet"
            raise NoMeshError(f"{what}; none may be, of a mesh that was made here")
        if orphans:
            stray = self._drop_orphans(used)
            place = np.cumsum(used) - 1
            points, tets = points[used], place[tets]
        if self.others:
            self.others.check_on(points)
        store(self, "points", points)
        store(self, "tets", tets)
        store(self, "regions", _tags(self.regions, len(tets), "tet"))
        store_mapping(self, "cell_data", checked_data(self.cell_data, len(tets), "tet"))
        store_mapping(self, "tet_sets", checked_sets(self.tet_sets, len(tets), "tet"))
        store_mapping(self, "names", dict(self.names))
        store_mapping(self, "element_types", dict(self.element_types))
        _set(self, "repairs", self.repairs + Repairs(flipped, orphans, stray))

    def _drop_orphans(self, used: NDArray[np.bool_]) -> int:
        """Renumber everything that names points; returns how many tagged cells went with the orphans."""
        place = np.cumsum(used) - 1
        stray = 0
        for name in ("facets", "edges", "nodes"):
            cells: Cells = getattr(self, name)
            keep = np.all(used[cells.vertices], axis=1)
            stray += int((~keep).sum())
            _set(self, name, cells.select(keep, place[cells.vertices]))
        store_mapping(self, "point_data", {name: values[used] for name, values in self.point_data.items()})
        store_mapping(self, "point_sets", {name: place[ids[used[ids]]] for name, ids in self.point_sets.items()})
        if self.others:
            _set(self, "others", self.others.renumbered(np.where(used, place, -1)))
        return stray

    def _counts(self) -> dict[str, int]:
        counts = {"points": len(self.points), "tets": len(self.tets), "regions": len(np.unique(self.regions))}
        counts |= {f"tagged {what}": len(getattr(self, what)) for what in ("facets", "edges", "nodes")}
        counts["other cells"] = sum(map(len, self.others.cells.values())) if self.others else 0
        return counts

    def _named(self) -> dict[str, Iterable[Any]]:
        names = {"names": self.names, "tet sets": self.tet_sets, "point sets": self.point_sets}
        return {**names, "point data": self.point_data, "tet data": self.cell_data}

    def _cells(self) -> tuple[Ints, Ints]:
        return self.tets, self.regions

    @cached_property
    def topology(self) -> Topology:
        """Boundary, interfaces, adjacency, edges and components, each derived when first asked for."""
        return Topology(self.tets, self.regions, len(self.points))

    def altered(self, **fields: Any) -> "TetMesh":
        """As by :func:`dataclasses.replace`; where tets and regions stay, the topology is not derived again.

        New points under which tets turn over are those of another mesh, with a topology of its own.
        """
        out = replace(self, **fields)
        if np.array_equal(out.tets, self.tets) and np.array_equal(out.regions, self.regions):
            _set(out, "topology", self.topology)
        return out

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, in the mesh's own unit."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    def boundary_surface(self) -> SurfaceMesh:
        """The boundary as an outward-oriented surface on its own points."""
        triangles = self.topology.boundary
        used, inverse = np.unique(triangles, return_inverse=True)
        return SurfaceMesh(self.points[used], inverse.reshape(-1, 3), source=self.source)


def _kind(cells: Ints) -> str:
    return _KIND.get(cells.shape[1], "cell")


def _set(owner: object, name: str, value: object) -> None:
    object.__setattr__(owner, name, value)


def store(owner: object, name: str, values: NDArray[Any]) -> None:
    """Set an attribute of a frozen object to a view that cannot be written to."""
    view = values.view()
    view.setflags(write=False)
    _set(owner, name, view)


def store_mapping(owner: object, name: str, values: Mapping[str, Any]) -> None:
    """Set an attribute of a frozen object to a copy that cannot be written to."""
    _set(owner, name, MappingProxyType(dict(values)))


def _rows_of_3(values: ArrayLike) -> Floats:
    points = np.array(values, dtype=np.float64, order="C")
    if points.ndim != 2 or points.shape[1] != 3:
        raise NoMeshError(f"points have shape {points.shape}; allowed is (n, 3)")
    return points


def checked_points(values: ArrayLike, used: NDArray[np.bool_] | None = None) -> Floats:
    """The points (n, 3); those that are not ``used`` (n,) may be anything."""
    points = _rows_of_3(values)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1) & (True if used is None else used))
    if len(bad):
        raise NoMeshError(f"point {bad[0]} is {show_row(points[bad[0]])}{and_more(bad)}; coordinates must be finite")
    return points


def indices(values: ArrayLike, what: str) -> Ints:
    """The indices as our own array; :class:`NoMeshError` names ``what`` they are if they are no integers."""
    given = np.asarray(values)
    if given.dtype.kind not in "iu" and given.size:
        raise NoMeshError(f"{what} have dtype {given.dtype}; allowed are integers")
    return np.array(given, dtype=np.int64, order="C")


def check_range(cells: Ints, count: int) -> None:
    """Raise :class:`NoMeshError` unless all indices of the cells (k, d) are below ``count``."""
    if not cells.size or (cells.min() >= 0 and cells.max() < count):
        return
    bad = np.flatnonzero(((cells < 0) | (cells >= count)).any(axis=1))
    if len(bad):
        raise NoMeshError(
            f"{_kind(cells)} {bad[0]} is {show_row(cells[bad[0]])}{and_more(bad)}; indices must lie in 0..{count - 1}"
        )


def _check_distinct(tets: Ints) -> None:
    """No vertex twice in a tet and no tet twice; afterwards every tet is a set of four points of its own."""
    twice = faults.with_a_vertex_twice(tets)
    if len(twice):
        raise NoMeshError(
            f"tet {twice[0]} is {show_row(tets[twice[0]])}{and_more(twice)}; its four vertices must differ"
        )
    twins = faults.repeated(tets)
    if len(twins):
        second, first = twins[0].tolist()
        raise NoMeshError(
            f"tet {second} repeats tet {first}, vertices {show_row(tets[first])}{and_more(twins)}; each may occur once"
        )


def _orient(points: Floats, tets: Ints) -> tuple[Ints, int]:
    """Turn negative tets round; the sign is exact, so that afterwards every volume is truly positive."""
    turned, signs = predicates.turned(points, tets)
    flat = np.flatnonzero(signs == 0)
    if len(flat):
        raise NoMeshError(
            f"tet {flat[0]}, vertices {show_row(tets[flat[0]])}, has zero volume{and_more(flat)}; it must not"
        )
    return turned, int((signs < 0).sum())


def _tags(values: ArrayLike | None, count: int, kind: str) -> Ints:
    if values is None:
        return np.zeros(count, dtype=np.int64)
    tags = indices(values, f"{kind} tags")
    if tags.shape != (count,):
        raise NoMeshError(f"{kind} tags have shape {tags.shape}; allowed is ({count},)")
    return tags


def checked_data(values: Mapping[str, ArrayLike], count: int, kind: str) -> dict[str, NDArray[Any]]:
    """Our own copies of arrays of length ``count``, in native byte order."""
    out = {}
    for name, given in values.items():
        array = np.array(given)
        if not array.dtype.isnative:
            array = array.astype(array.dtype.newbyteorder("="))
        if array.ndim == 0 or len(array) != count:
            raise NoMeshError(f"{kind} data {name!r} has shape {array.shape}; its length must be {count}")
        array.setflags(write=False)
        out[str(name)] = array
    return out


def checked_sets(values: Mapping[str, ArrayLike], count: int, kind: str) -> dict[str, Ints]:
    """Our own copies of index arrays into ``count`` things."""
    out = {}
    for name, given in values.items():
        members = indices(given, f"members of {kind} set {name!r}")
        if members.ndim != 1 or (len(members) and not (members.min() >= 0 and members.max() < count)):
            raise NoMeshError(f"{kind} set {name!r} must be a list of indices in 0..{count - 1}")
        members.setflags(write=False)
        out[str(name)] = members
    return out


def show_row(values: NDArray[Any]) -> str:
    """A point, or the vertices of a cell, as messages show them."""
    return "(" + ", ".join(f"{value:g}" if values.dtype.kind == "f" else str(value) for value in values) + ")"


def and_more(found: NDArray[Any]) -> str:
    """What a message that names the first of ``found`` says of the others."""
    return f" (and {len(found) - 1} more)" if len(found) > 1 else ""
