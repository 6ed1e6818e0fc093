"""OpenFOAM's polyMesh: points, faces, owner, neighbour, boundary, and a zone of cells per region; text."""

import re
from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path

import numpy as np

from wct_plugin.duals.dual_mesh import DualMesh
from wct_plugin.types import Ints

#: Where the mesh is in the folder of a case.
FOLDER = Path("constant/polyMesh")
#: What is written there.
FILES = ("points", "faces", "owner", "neighbour", "boundary", "cellZones")


def words(names: Iterable[str], prefix: str) -> dict[str, str]:
    """For each name a word of OpenFOAM's: letters, digits and ``_ . + -``, no digit first; each once."""
    found: dict[str, str] = {}
    for name in names:
        word = re.sub(r"[^A-Za-z0-9_.+-]", "_", name)
        word = word if re.match("[A-Za-z_]", word) else prefix + word
        free, number = word, 1
        while free in found.values():
            number += 1
            free = f"{word}_{number}"
        found[name] = free
    return found


def write(folder: Path, dual: DualMesh, patches: Mapping[str, Ints], zones: Mapping[str, Ints]) -> None:
    """Write the files into an existing ``folder``.

    ``patches``: by a word of OpenFOAM's the rows of the mesh's ``topology.boundary``, each in one; ``zones``: by such a
    word the cells. Faces between cells come in upper-triangular order, those of the boundary patch by patch.
    """
    inner = len(dual.neighbour)
    of_patch = np.empty(int(dual.facets.max()) + 1, dtype=np.int64)
    for number, rows in enumerate(patches.values()):
        of_patch[rows] = number
    outer = np.argsort(of_patch[dual.facets], kind="stable") + inner
    order = np.concatenate([np.arange(inner), outer])
    counts = np.bincount(of_patch[dual.facets], minlength=len(patches)).tolist()
    note = f"nPoints:{len(dual.points)} nCells:{len(dual.vertex)} nFaces:{len(order)} nInternalFaces:{inner}"
    _put(folder, "points", "vectorField", _vectors(dual), len(dual.points))
    _put(folder, "faces", "faceList", _rings(dual, order), len(order))
    _put(folder, "owner", "labelList", _labels(dual.owner[order]), len(order), note)
    _put(folder, "neighbour", "labelList", _labels(dual.neighbour), inner, note)
    starts = inner + np.cumsum([0, *counts])
    _put(
        folder,
        "boundary",
        "polyBoundaryMesh",
        (
            f"{name}\n{{\n    type patch;\n    nFaces {count};\n    startFace {start};\n}}\n"
            for name, count, start in zip(patches, counts, starts.tolist(), strict=False)
        ),
        len(patches),
    )
    _put(
        folder,
        "cellZones",
        "regIOobject",
        chain.from_iterable(
            (f"{name}\n{{\ntype cellZone;\ncellLabels List<label>\n{len(cells)}\n(\n", *_labels(cells), ")\n;\n}\n")
            for name, cells in zones.items()
        ),
        len(zones),
    )


def _put(folder: Path, name: str, kind: str, lines: Iterable[str], count: int, note: str = "") -> None:
    said = f'    note "{note}";\n' if note else ""
    with (folder / name).open("w", encoding="ascii", newline="\n") as file:
        file.write("FoamFile\n{\n    version 2.0;\n    format ascii;\n")
        file.write(f'    class {kind};\n{said}    location "{FOLDER}";\n    object {name};\n}}\n\n{count}\n(\n')
        file.writelines(lines)
        file.write(")\n")


def _vectors(dual: DualMesh) -> Iterable[str]:
    return (f"({x!r} {y!r} {z!r})\n" for x, y, z in dual.points.tolist())


def _labels(values: Ints) -> Iterable[str]:
    return (f"{value}\n" for value in values.tolist())


def _rings(dual: DualMesh, order: Ints) -> Iterable[str]:
    corners, starts = dual.corners.tolist(), dual.starts.tolist()
    rings = (corners[starts[face] : starts[face + 1]] for face in order.tolist())
    return (f"{len(ring)}({' '.join(map(str, ring))})\n" for ring in rings)
