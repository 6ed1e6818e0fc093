"""Boxes side by side along x as gmsh meshes them, with everything that solvers ask for by name."""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

import gmsh


def stack(
    file: str | Path,
    layers: Mapping[str, float],
    ends: tuple[str, str],
    size: float,
    *,
    interfaces: Sequence[str] = (),
    width: float = 1.0,
    unit: float = 1.0,
) -> None:
    """Write the ``layers``, thickness by name, with the groups of facets ``ends`` and, between them, ``interfaces``.

    Edges are ``size`` long; all lengths are written times ``unit``. Version 2.2, which every solver reads.
    """
    places = [0.0, *itertools.accumulate(layers.values())]
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    boxes = [
        (3, gmsh.model.occ.addBox(start, 0, 0, end - start, width, width)) for start, end in itertools.pairwise(places)
    ]
    gmsh.model.occ.fragment(boxes[:1], boxes[1:])
    gmsh.model.occ.synchronize()
    for name, (_, box) in zip(layers, boxes, strict=True):
        gmsh.model.addPhysicalGroup(3, [box], name=name)
    near = 1e-3 * width
    for name, x in zip((ends[0], *interfaces, ends[1]), places if interfaces else places[:: len(boxes)], strict=True):
        within = (x - near, -near, -near, x + near, width + near, width + near)
        gmsh.model.addPhysicalGroup(2, [face for _, face in gmsh.model.getEntitiesInBoundingBox(*within, 2)], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.ScalingFactor", unit)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(file))
    gmsh.finalize()
