"""``trimesh.Trimesh`` as surface and back; its attributes are data, its colours arrays ``red``, ``green``, ..."""

from typing import TYPE_CHECKING, Any

import numpy as np

from wct_plugin.adapters.meshlab.carry import COLOUR
from wct_plugin.io import formats
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects import colours
from wct_plugin.objects.assembled import assembled, needs_surface, not_read

if TYPE_CHECKING:
    from trimesh import Trimesh

_WHAT = "trimesh.Trimesh"
_TAGS = "gmsh:physical"


def from_trimesh(mesh: "Trimesh") -> SurfaceMesh:
    """Make a surface of a ``trimesh.Trimesh``: vertices as they are, merged or not, attributes and colours.

    Tags are the first face attribute with a conventional name (``gmsh:physical``, ...). Metadata stay where they are.
    """
    point_data, cell_data = (
        {name: np.asarray(values) for name, values in data.items() if np.shape(values)[:1] == (count,)}
        for data, count in ((mesh.vertex_attributes, len(mesh.vertices)), (mesh.face_attributes, len(mesh.faces)))
    )
    lost = [f"vertex attribute {name!r}" for name in mesh.vertex_attributes if name not in point_data]
    lost += [f"face attribute {name!r}" for name in mesh.face_attributes if name not in cell_data]
    visual: Any = mesh.visual
    if visual.kind == "vertex":
        point_data |= colours.split(np.asarray(visual.vertex_colors))
    elif visual.kind == "face":
        cell_data |= colours.split(np.asarray(visual.face_colors))
    elif visual.kind:
        lost.append(str(visual.kind))
    not_read(_WHAT, lost)
    raw = RawMesh(
        np.asarray(mesh.vertices),
        [RawBlock("triangle", np.asarray(mesh.faces))],
        point_data,
        {name: [values] for name, values in cell_data.items()},
    )
    surface = assembled(raw, formats.MESHIO, _WHAT)
    assert isinstance(surface, SurfaceMesh)  # it has triangles alone
    return surface


def to_trimesh(mesh: TetMesh | SurfaceMesh) -> "Trimesh":
    """Make a ``trimesh.Trimesh`` of a surface, its vertices neither merged nor sorted; tags are a face attribute."""
    import trimesh

    surface = needs_surface(mesh, _WHAT)
    on_points, on_faces = colours.joined(surface.point_data), colours.joined(surface.cell_data)
    on_faces = on_faces if on_points is None else None  # trimesh has colours of one kind; others stay attributes
    point_data, cell_data = (
        {name: np.array(values) for name, values in data.items() if colour is None or name not in COLOUR}
        for data, colour in ((surface.point_data, on_points), (surface.cell_data, on_faces))
    )
    if surface.tags.any():
        cell_data[_TAGS] = np.array(surface.tags)
    attributes: Any = {"vertex_attributes": point_data, "face_attributes": cell_data}
    made: Any = trimesh.Trimesh(np.array(surface.points), np.array(surface.triangles), process=False, **attributes)
    if on_points is not None:
        made.visual.vertex_colors = on_points
    elif on_faces is not None:
        made.visual.face_colors = on_faces
    done: Trimesh = made
    return done
