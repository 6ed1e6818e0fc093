"""What of a mesh its dual does not have: cells of a dual have no place for what is on tets, facets and edges."""

from wct_plugin.mesh import TetMesh


def cells_beside(mesh: TetMesh) -> list[str]:
    """Cells that are not tets: the dual ends where they begin."""
    return [f"{len(cells)} {kind} cells" for kind, cells in (mesh.others.cells if mesh.others else {}).items()]


def groups_and_data(mesh: TetMesh) -> list[str]:
    """Data and sets of tets, sets of points, and tagged edges and vertices."""
    found = [f"cell data {name!r}" for name in mesh.cell_data if name != mesh.region_name]
    found += [f"set {name!r} of tets" for name in mesh.tet_sets if name not in mesh.names]
    found += [f"set {name!r} of points" for name in mesh.point_sets]
    found += [
        f"{len(one)} tagged {what}" for one, what in ((mesh.edges, "edges"), (mesh.nodes, "vertices")) if len(one)
    ]
    return found


def facets_and_names(mesh: TetMesh) -> list[str]:
    """Tagged facets, and the names of regions."""
    facets = [f"{len(mesh.facets)} tagged facets"] if len(mesh.facets) else []
    return facets + [f"name {name!r}" for name, (_, dimension) in mesh.names.items() if dimension == 3]
