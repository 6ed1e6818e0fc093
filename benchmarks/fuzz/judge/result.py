"""Whether a mesh that a command wrote is what was promised of it, beside the mesh that it was given."""

import re
import tempfile
from collections import Counter
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from numpy.typing import NDArray

from benchmarks.fuzz.judge import exact
from benchmarks.fuzz.outer_facets import FACETS, boundary_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: What volumes of regions and areas of tagged groups may change by.
CHANGE = 5e-3


@dataclass(frozen=True)
class Arrays:
    """A mesh, as it stands in a file."""

    points: Floats
    tets: Ints
    regions: Ints
    facets: Ints = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    facet_tags: Ints = field(default_factory=lambda: np.empty(0, dtype=np.int64))


def load(path: Path) -> Arrays:
    """What of a file the judges look at, by meshio."""
    mesh = _without_data(path) if path.suffix == ".msh" else meshio.read(path)
    rows: dict[str, list[Any]] = {"tetra": [], "triangle": []}
    tags: dict[str, list[Any]] = {"tetra": [], "triangle": []}
    columns = next((mesh.cell_data[name] for name in ("gmsh:physical", "medit:ref") if name in mesh.cell_data), None)
    for k, block in enumerate(mesh.cells):
        if block.type in rows:
            rows[block.type].append(np.asarray(block.data, dtype=np.int64))
            given = np.zeros(len(block.data)) if columns is None else columns[k]
            tags[block.type].append(np.asarray(given).astype(np.int64).reshape(-1))
    none = np.empty(0, dtype=np.int64)
    return Arrays(
        np.asarray(mesh.points, dtype=np.float64),
        np.concatenate([none.reshape(0, 4), *rows["tetra"]]),
        np.concatenate([none, *tags["tetra"]]),
        np.concatenate([none.reshape(0, 3), *rows["triangle"]]),
        np.concatenate([none, *tags["triangle"]]),
    )


def with_old_tags(new: Arrays, told: str) -> Arrays:
    """A mesh with the tags below 0 that it had before it was written, where it was ``told`` what they are now."""
    tags = {}
    for kind, column in (("tetra", new.regions), ("triangle", new.facet_tags)):
        found = re.search(rf"tags below 0 of {kind} cells \(([^)]*)\)", told)
        pairs = [list(map(int, one.split(" is "))) for one in found[1].split(", ")] if found else []
        tags[kind] = (
            np.select([column == now for _, now in pairs], [was for was, _ in pairs], column) if pairs else column
        )
    return replace(new, regions=tags["tetra"], facet_tags=tags["triangle"])


def _without_data(path: Path) -> Any:
    """A file of gmsh but for its arrays, which meshio cuts into pieces of length 2."""
    text = re.sub(r"\$ElementData\n.*?\$EndElementData\n", "", path.read_text(), flags=re.DOTALL)
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / path.name
        bare.write_text(text)
        return meshio.read(bare)


def faults_of_mesh(new: Arrays) -> list[str]:
    """Whether it is a mesh: finite, all tets positive, two at a facet on its two sides, no vertex within a tet."""
    if not len(new.tets):
        return ["the output has no tets"]
    if not np.isfinite(new.points).all():
        return ["the output has a point that is not finite"]
    if new.tets.min() < 0 or new.tets.max() >= len(new.points):
        return ["the output has an index out of range"]
    if flat := exact.not_positive(new.points, new.tets):
        return [f"tet {flat[0]} of the output is not positively oriented"]
    faces = new.tets[:, FACETS].reshape(-1, 3)
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    if len(np.unique(turned, axis=0)) != len(turned):
        return ["two tets of the output lie on the same side of a facet"]
    return [f"vertex {v} of the output lies within tet {t}" for v, t in _swallowed(new)[:1]]


def _swallowed(mesh: Arrays) -> list[tuple[int, int]]:
    """Vertices that lie strictly within a tet, found by boxes and decided by fractions."""
    found = []
    corners = mesh.points[mesh.tets]
    low, high = corners.min(axis=1), corners.max(axis=1)
    for vertex, point in enumerate(mesh.points):
        near = np.flatnonzero(((low < point) & (point < high)).all(axis=1) & (mesh.tets != vertex).all(axis=1))
        for tet in near.tolist():
            rows = exact.as_fractions(corners[tet])
            here = exact.as_fractions(point[None])[0]
            if all(exact.volume6([*rows[:k], here, *rows[k + 1 :]]) > 0 for k in range(4)):
                found.append((vertex, tet))
    return found


def region_volumes(mesh: Arrays) -> dict[int, Fraction]:
    """Six times the volume of each region, exactly."""
    made: dict[int, Fraction] = {}
    for rows, region in zip(mesh.points[mesh.tets], mesh.regions.tolist(), strict=True):
        made[region] = made.get(region, Fraction(0)) + abs(exact.volume6(exact.as_fractions(rows)))
    return made


def faults_of_regions(old: Arrays, new: Arrays, *, volumes: bool) -> list[str]:
    """Whether the regions are those that there were, and, if asked for, as large."""
    before, after = region_volumes(old), region_volumes(new)
    if before.keys() != after.keys():
        return [f"regions {sorted(before)} became {sorted(after)}"]
    if not volumes:
        return []
    changes = {tag: float(after[tag] / before[tag] - 1) for tag in before}
    return [
        f"the volume of region {tag} changed by {change:+.2%}"
        for tag, change in changes.items()
        if abs(change) > CHANGE
    ]


def _areas(mesh: Arrays) -> dict[int, float]:
    unit = np.ptp(mesh.points, axis=0).max()
    corners = mesh.points[mesh.facets] / unit
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = (
        0.5 * np.linalg.norm(normals, axis=1) * unit**2
        if 1e-100 < unit < 1e100
        else 0.5 * np.linalg.norm(normals, axis=1)
    )
    return {int(tag): float(areas[mesh.facet_tags == tag].sum()) for tag in np.unique(mesh.facet_tags) if tag}


def faults_of_groups(old: Arrays, new: Arrays) -> list[str]:
    """Whether the groups of tagged facets are those that there were, and as large."""
    before, after = _areas(old), _areas(new)
    if before.keys() != after.keys():
        return [f"groups of facets {sorted(before)} became {sorted(after)}"]
    return [
        f"the area of group {tag} changed by {after[tag] / area - 1:+.2%}"
        for tag, area in before.items()
        if area and abs(after[tag] / area - 1) > CHANGE
    ]


def faults_of_planes(old: Arrays, new: Arrays) -> list[str]:
    """Whether each boundary facet lies in one of the planes along the axes that the boundary had, to the bit."""
    had = []
    for axis in range(3):
        rows = old.points[boundary_of(old.tets), axis]
        had.append(set(rows[(rows == rows[:, :1]).all(axis=1), 0].tolist()))
    rows = new.points[boundary_of(new.tets)]
    plane = np.zeros(len(rows), dtype=bool)
    for axis in range(3):
        values = rows[:, :, axis]
        plane |= (values == values[:, :1]).all(axis=1) & np.isin(values[:, 0], sorted(had[axis]))
    return [] if plane.all() else [f"{int((~plane).sum())} boundary facets left their planes"]


def share(flags: dict[str, int], goal: str, tets: int) -> Fraction:
    """The share of tets that meet a goal."""
    return Fraction(flags[goal], tets)


def _sides(mesh: Arrays, axis: int) -> list[Any]:
    """The vertices of the boundary at both ends of an axis, without their place along it, in order."""
    rows = mesh.points[np.unique(boundary_of(mesh.tets))]
    low, high = rows[:, axis].min(), rows[:, axis].max()
    return [sorted(np.delete(rows[rows[:, axis] == end], axis, axis=1).tolist()) for end in (low, high)]


def faults_of_pairs(old: Arrays, new: Arrays) -> list[str]:
    """Whether ends of an axis that had the same vertices but for a shift along it still have."""
    faults = []
    for axis in range(3):
        (low, high), (left, right) = _sides(old, axis), _sides(new, axis)
        if low == high and len(low) > 2 and left != right:
            faults.append(
                f"the ends of axis {axis} matched, and have {len(left)} and {len(right)} vertices that do not"
            )
    return faults


def faults_of_report(report: dict[str, Any], mesh: Arrays) -> list[str]:
    """Whether what a report says of a mesh is so: how many tets, in which regions, of which flags.

    No tet may have a flag that it has not exactly; one that has it by so little that floats may not tell may lack it.
    """
    faults = []
    if report["tets"] != len(mesh.tets):
        faults.append(f"the report says {report['tets']} tets, the file has {len(mesh.tets)}")
    counted = {str(tag): count for tag, count in Counter(mesh.regions.tolist()).items()}
    if {str(tag): count for tag, count in report["regions"].items()} != counted:
        faults.append(f"the report says regions {report['regions']}, the file has {counted}")
    most = exact.count_flags(mesh.points, mesh.tets)
    for flag, least in exact.count_flags(mesh.points, mesh.tets, exact.TIE).items():
        if not least <= report[flag]["count"] <= most[flag]:
            faults.append(f"the report says {report[flag]['count']} tets are {flag}, exactly {most[flag]} are")
    return faults


def faults_of_same(one: Arrays, other: Arrays, what: str) -> list[str]:
    """Whether two meshes are the same, to the bit."""
    for name in ("points", "tets", "regions", "facets", "facet_tags"):
        a, b = getattr(one, name), getattr(other, name)
        if a.shape != b.shape or a.tobytes() != b.tobytes():
            return [f"{name} differ {what}"]
    return []
