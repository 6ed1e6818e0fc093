"""``skfem.MeshTet`` as mesh and back: subdomains are regions or sets of tets, boundaries are sets of tagged facets.

skfem has names and no numbers: a region whose name is a whole number has that number as its tag, and one that has no
name gets its tag as name. An ``OrientedBoundary`` has a direction for each facet. It is kept in facet data
``oriented:NAME``: 1 where it is that in which the facet's vertices run counter-clockwise, -1 where it is the other.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.formats import MESHIO
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.mid_nodes import find_middles
from wct_plugin.mesh.named_groups import names_of, regions_of
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.objects.assembled import assembled, needs_tets, not_carried
from wct_plugin.types import Ints

if TYPE_CHECKING:
    from skfem import MeshTet  # type: ignore[import-untyped]

_ORIENTED = "oriented:"
_WHAT = "skfem.MeshTet"
#: Nodes of a tet of ``MeshTet2``; their order is that of ``tetra10``.
_SECOND_ORDER = 10


def from_skfem(mesh: "MeshTet") -> TetMesh | SurfaceMesh:
    """Make a mesh of a ``skfem.MeshTet``.

    Subdomains that share no tet become regions of these names. Where some do, all stay sets of tets, and there is a
    region for each combination, so that the border of every one is kept. Of a ``skfem.MeshTet2`` the corners are taken
    and the nodes on edges kept as curves. Groups that have no member are named in a warning.
    """
    tets = np.asarray(mesh.t, dtype=np.int64).T
    subdomains = {str(name): np.unique(ids) for name, ids in (mesh.subdomains or {}).items()}
    tags, names, sets = regions_of(subdomains, len(tets))
    facets, facet_sets, oriented = _facets(mesh, tets)
    nodes = np.asarray(mesh.dofs.element_dofs, dtype=np.int64).T
    second = nodes.shape[1] == _SECOND_ORDER
    lost = [f"{what} {name!r}, which is empty" for what, name in _empty(mesh)]
    nothing = np.zeros(len(facets), dtype=np.int64)
    raw = RawMesh(
        np.asarray(mesh.doflocs, dtype=np.float64).T,
        [RawBlock("tetra10", nodes) if second else RawBlock("tetra", tets), RawBlock("triangle", facets)],
        cell_data={
            "gmsh:physical": [tags, nothing],
            **{_ORIENTED + name: [None, values] for name, values in oriented.items()},
        },
        cell_sets={
            **{name: [ids, None] for name, ids in sets.items()},
            **{name: [sets.get(name), ids] for name, ids in facet_sets.items()},
        },
        field_data={name: np.array([tag, 3]) for name, tag in names.items()},
    )
    return assembled(raw, MESHIO, _WHAT, ("gmsh:physical",), lost)


def _empty(mesh: "MeshTet") -> list[tuple[str, str]]:
    """What and how it is called, of groups without a member."""
    groups = (("subdomain", mesh.subdomains), ("boundary", mesh.boundaries))
    return [(what, str(name)) for what, found in groups for name, ids in (found or {}).items() if not np.size(ids)]


def _facets(mesh: "MeshTet", tets: Ints) -> tuple[Ints, dict[str, Ints], dict[str, Ints]]:
    """The facets of all boundaries, wound out of their first tet; which are in each; the directions of some."""
    boundaries: dict[str, Any] = mesh.boundaries or {}
    used = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(np.asarray(one) for one in boundaries.values())]))
    used = used.astype(np.int64)
    facets = np.asarray(mesh.facets, dtype=np.int64).T[used]
    points = np.asarray(mesh.p).T
    out = points[facets].mean(axis=1) - points[tets[mesh.f2t[0, used]]].mean(axis=1)
    inward = np.einsum("ki,ki->k", normals(points, facets), out) < 0
    facets[inward] = facets[inward][:, ::-1]
    sets, oriented = {}, {}
    for name, ids in boundaries.items():
        place = np.searchsorted(used, np.asarray(ids, dtype=np.int64))
        sets[str(name)] = np.unique(place)
        if getattr(ids, "ori", None) is not None and (np.any(ids.ori) or (mesh.f2t[1, np.asarray(ids)] >= 0).any()):
            if len(ids.ori) != len(ids):  # as NumPy's slices of one leave it
                raise InputError(f"{_WHAT}: boundary {name!r} has {len(ids)} facets and {len(ids.ori)} directions")
            values = np.zeros(len(used), dtype=np.int64)
            values[place] = 1 - 2 * np.asarray(ids.ori)
            oriented[str(name)] = values
    return facets, sets, oriented


def to_skfem(mesh: TetMesh | SurfaceMesh) -> "MeshTet":
    """Make a ``skfem.MeshTet``, or a ``MeshTet2`` of tets that had nodes on edges; what it cannot carry is named.

    Subdomains are the regions and the sets of tets, boundaries the groups of tagged facets: by their names, and those
    that have none by their tag.
    """
    import skfem

    mesh = needs_tets(mesh, _WHAT)
    made = skfem.MeshTet(np.array(mesh.points.T), np.array(mesh.tets.T, dtype=np.int32))
    subdomains = names_of(mesh.regions, mesh.names, 3, mesh.tet_sets)
    row = find_rows(
        np.sort(np.asarray(made.facets, dtype=np.int64).T, axis=1),
        np.sort(mesh.facets.vertices, axis=1),
        len(mesh.points),
    )
    groups = names_of(mesh.facets.tags, mesh.names, 2, mesh.facets.sets)
    boundaries = {name: _boundary(made, mesh, name, members, row) for name, members in groups.items()}
    not_carried(_WHAT, _lost(mesh, row, groups))
    if mesh.second_order:
        made = _with_mid_nodes(made, mesh)
    if subdomains:
        made = made.with_subdomains({name: ids.astype(np.int32) for name, ids in subdomains.items()})
    return made.with_boundaries(boundaries) if boundaries else made


def _with_mid_nodes(made: "MeshTet", mesh: TetMesh) -> "MeshTet":
    """The ``MeshTet2`` with nodes on all edges, where the mesh has them."""
    import skfem

    straight = skfem.MeshTet2.from_mesh(made)
    ends = np.sort(np.asarray(made.edges, dtype=np.int64).T, axis=1)
    places = np.array(straight.doflocs)
    places[:, made.nvertices :] = find_middles(mesh).points[find_rows(mesh.topology.edges, ends, made.nvertices)].T
    return skfem.MeshTet2(places, straight.t)


def _boundary(made: "MeshTet", mesh: TetMesh, name: str, members: Ints, row: Ints) -> Any:
    """Facet numbers of skfem's, with a direction where there is one."""
    members = members[row[members] >= 0]
    facets, first = np.unique(row[members], return_index=True)
    facets = facets.astype(np.int32)
    if _ORIENTED + name not in mesh.facets.data:
        return facets
    from skfem.generic_utils import OrientedBoundary  # type: ignore[import-untyped]

    members = members[first]
    vertices = mesh.facets.vertices[members]
    along = normals(mesh.points, vertices) * np.asarray(mesh.facets.data[_ORIENTED + name])[members, None]
    out = mesh.points[vertices].mean(axis=1) - mesh.points[mesh.tets[made.f2t[0, facets]]].mean(axis=1)
    return OrientedBoundary(facets, np.einsum("ki,ki->k", along, out) < 0)


def _lost(mesh: TetMesh, row: Ints, groups: Mapping[str, Ints]) -> list[str]:
    lost = [f"point data {name!r}" for name in mesh.point_data] + [f"cell data {name!r}" for name in mesh.cell_data]
    lost += [f"facet data {name!r}" for name in mesh.facets.data if not name.startswith(_ORIENTED)]
    lost += [f"set {name!r} of points" for name in mesh.point_sets]
    lost += [f"{len(one)} tagged {what}" for one, what in ((mesh.edges, "edges"), (mesh.nodes, "vertices")) if len(one)]
    lost += [f"{len(cells)} {kind} cells" for kind, cells in (mesh.others.cells if mesh.others else {}).items()]
    loose = int((row < 0).sum())
    grouped = np.zeros(len(row), dtype=bool)
    for members in groups.values():
        grouped[members] = True
    bare = int((~grouped & (row >= 0)).sum())
    lost += [f"{loose} tagged facets that are none of a tet"] if loose else []
    lost += [f"{bare} facets of no group"] if bare else []
    return lost + (["which sides are periodic"] if mesh.periodic else [])
