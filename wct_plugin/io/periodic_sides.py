"""gmsh's section of periodic sides: which facets, and which points, are translates of which others."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from wct_plugin.io.gmsh_sections import end, put
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.periodic import find_periodic
from wct_plugin.types import Floats, Ints


@dataclass(frozen=True, eq=False)
class PeriodicSides:
    """A side and its translate. Rows are those of the tagged facets: only these are in a file."""

    slave: Ints  #: (k,) rows of the facets of the side that is a translate, one at least
    master: Ints  #: (l,) rows of the facets that it is a translate of, one at least
    nodes: Ints  #: (m, 2) each point of the first, and what it is a translate of
    translation: Floats  #: (3,) from the master to the slave


def is_periodic(raw: RawMesh, lost: list[str]) -> bool:
    """Whether a gmsh file has sides that are translates; those that are turned go to ``lost``."""
    found = False
    for dimension, _, affine, nodes in raw.periodic:
        if dimension != 2 or not len(nodes):
            continue
        turned = affine is not None and len(affine) == 16
        turned = turned and not np.allclose(np.reshape(affine, (4, 4))[:3, :3], np.eye(3), rtol=0.0, atol=1e-9)
        found |= not turned
        if turned:
            lost.append("periodic sides that are turned")
    return found


def sides_of(mesh: TetMesh) -> list[PeriodicSides]:
    """Those with tagged facets that match, vertex for vertex."""
    unit = unit_scaling.exponent(mesh.points)
    facets, count = np.sort(mesh.facets.vertices, axis=1), len(mesh.points)
    out = []
    for pair in find_periodic(unit_scaling.scaled(mesh, -unit)):
        if not pair.translation.any():
            continue  # facets that coincide, as in a crack
        slave, master = (find_rows(facets, np.sort(side, axis=1), count) for side in (pair.slave, pair.master))
        slave, master = slave[slave >= 0], master[master >= 0]
        if len(slave) and len(master):
            translation = unit_scaling.rescaled(pair.translation, unit)
            out.append(PeriodicSides(slave, master, pair.vertices[:, ::-1], translation))
    return out


def numbered(sides: list[PeriodicSides], entities: Ints) -> Ints:
    """(k,) the entity of each tagged facet, where both sides of each pair are to be entities of their own."""
    entities = entities.copy()
    for one in sides:
        for rows in (one.slave, one.master):
            entities[rows] = entities.max() + 1
    return entities


def put_periodic(
    file: BinaryIO, binary: bool, version: str, sides: list[PeriodicSides], entity: Callable[[int], int]
) -> None:
    """Write the section, which is text in binary files of version 2.2; ``entity``: of a tagged facet, by its row."""
    if not sides:
        return
    binary = binary and version != "2.2"
    file.write(b"$Periodic\n")
    put(file, binary, np.array([[len(sides)]], dtype=np.uint64))
    for one in sides:
        put(file, binary, np.array([[2, entity(int(one.slave[0])), entity(int(one.master[0]))]], dtype=np.int32))
        affine = np.eye(4)
        affine[:3, 3] = one.translation
        if version == "2.2":
            file.write(f"Affine {' '.join(map(repr, affine.ravel().tolist()))}\n".encode())
        else:
            put(file, binary, np.array([[16]], dtype=np.uint64), affine.reshape(1, -1))
        put(file, binary, np.array([[len(one.nodes)]], dtype=np.uint64))
        put(file, binary, (one.nodes + 1).astype(np.uint64))
    end(file, binary, "Periodic")
