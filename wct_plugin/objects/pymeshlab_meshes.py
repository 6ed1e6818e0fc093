"""The current mesh of a ``pymeshlab.MeshSet`` as surface, and a surface as a MeshSet, in the process that holds it."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wct_plugin.adapters.meshlab.carry import COLOUR, QUALITY
from wct_plugin.errors import InputError
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects import colours
from wct_plugin.objects.assembled import needs_surface, not_carried, not_read

if TYPE_CHECKING:
    import pymeshlab

_WHAT = "pymeshlab.MeshSet"


def from_pymeshlab(meshes: "pymeshlab.MeshSet | pymeshlab.Mesh") -> SurfaceMesh:
    """Make a surface of the current mesh of a MeshSet, or of a Mesh: points where its matrix puts them.

    Quality and colours come along, where they are not those that every mesh has, zero and white. Attributes of other
    names stay where they are: pymeshlab does not list them.
    """
    mesh: Any = meshes
    if type(meshes).__name__ == "MeshSet":
        if not meshes.mesh_number():
            raise InputError(f"{_WHAT}: has no mesh")
        mesh = meshes.current_mesh()
    point_data, cell_data = {}, {}
    if mesh.vertex_scalar_array().any():
        point_data[QUALITY] = mesh.vertex_scalar_array()
    if mesh.has_face_scalar():
        cell_data[QUALITY] = mesh.face_scalar_array()
    if (mesh.vertex_color_matrix() != 1.0).any():
        point_data |= colours.split(np.rint(mesh.vertex_color_matrix() * 255.0))
    if mesh.has_face_color():
        cell_data |= colours.split(np.rint(mesh.face_color_matrix() * 255.0))
    not_read(_WHAT, [f"{mesh.edge_number()} edges"] if mesh.edge_number() else [])
    if not mesh.face_number():
        raise InputError(f"{_WHAT}: its current mesh has {mesh.vertex_number()} points and no triangle")
    points, triangles = mesh.transformed_vertex_matrix(), mesh.face_matrix().astype(np.int64)
    return SurfaceMesh(points, triangles, None, point_data, cell_data)  # type: ignore[arg-type]  # None: zeros


def to_pymeshlab(mesh: TetMesh | SurfaceMesh) -> "pymeshlab.MeshSet":
    """Make a MeshSet of one mesh of a surface, with its quality and colours; all else is named in a warning."""
    import pymeshlab

    surface = needs_surface(mesh, _WHAT)
    lost = ["tags"] if surface.tags.any() else []
    extra = {}
    for letter, what, data in (("v", "point", surface.point_data), ("f", "triangle", surface.cell_data)):
        kept = set()
        table = colours.joined(data)
        if table is not None:
            extra[f"{letter}_color_matrix"] = table / 255.0
            kept |= set(COLOUR)
        if QUALITY in data and data[QUALITY].ndim == 1 and data[QUALITY].dtype.kind in "biuf":
            extra[f"{letter}_scalar_array"] = data[QUALITY].astype(np.float64)
            kept.add(QUALITY)
        lost += [f"{what} data {name!r}" for name in data if name not in kept]
    made = pymeshlab.MeshSet()
    one = pymeshlab.Mesh(np.array(surface.points), surface.triangles.astype(np.int32), **extra)
    made.add_mesh(one, Path(surface.source).stem)
    not_carried(_WHAT, lost)
    return made
