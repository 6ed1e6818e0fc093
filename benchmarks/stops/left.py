"""Whether what a stop left is a mesh that is as good as the one that was given: in NumPy and fractions."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.fuzz.judge import exact, result, said
from benchmarks.fuzz.judge.result import Arrays
from benchmarks.fuzz.outer_facets import boundary_of

Floats = NDArray[np.float64]
_NOTHING = "; nothing was written"


@dataclass(frozen=True)
class Promise:
    """What holds of the best mesh so far."""

    old: Arrays
    goal: str
    tolerance: float  #: of the boundary, as a fraction of the bounding box's diagonal


def faults_of_mesh(new: Arrays, promise: Promise) -> list[str]:
    """A mesh, of the same regions, as large, within the tolerance, and with no smaller share of good tets."""
    old = promise.old
    if faults := result.faults_of_mesh(new):
        return faults
    faults = result.faults_of_regions(old, new, volumes=False)
    volumes = [sum(result.region_volumes(mesh).values()) for mesh in (old, new)]
    if abs(volumes[1] / volumes[0] - 1) > 0.05:
        faults.append(f"the volume changed by {float(volumes[1] / volumes[0] - 1):+.1%}")
    far = farthest(new, old)
    if far > 1.001 * promise.tolerance:
        faults.append(f"the boundary is {far:.2g} of the diagonal off, of {promise.tolerance:g} allowed")
    if promise.goal in ("3wc", "cwc"):
        before, after = (
            result.share(exact.count_flags(mesh.points, mesh.tets), promise.goal, len(mesh.tets)) for mesh in (old, new)
        )
        if after < before:
            faults.append(f"{float(after):.1%} of the tets are {promise.goal} after {float(before):.1%}")
    return faults


def farthest(new: Arrays, old: Arrays) -> float:
    """Greatest distance of the new boundary's vertices and facets' middles from the old one, over the diagonal."""
    surface = old.points[boundary_of(old.tets)]
    corners = new.points[boundary_of(new.tets)]
    points = np.unique(np.vstack([corners.reshape(-1, 3), corners.mean(axis=1)]), axis=0)
    diagonal = float(np.linalg.norm(np.ptp(old.points, axis=0)))
    return max(float(_distances(point, surface).min()) for point in points) / diagonal


def _distances(point: Floats, triangles: Floats) -> Floats:
    """From a point to each triangle (k, 3, 3): to its plane where the point is above it, else to its sides."""
    a = triangles[:, 0]
    sides = np.roll(triangles, -1, axis=1) - triangles
    offsets = point - triangles
    along = np.clip((offsets * sides).sum(axis=2) / (sides**2).sum(axis=2), 0.0, 1.0)
    nearest: Floats = np.linalg.norm(offsets - along[:, :, None] * sides, axis=2).min(axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    above = (np.einsum("kij,kj->ki", np.cross(sides, offsets), normals) >= 0).all(axis=1)
    heights = np.abs(((point - a) * normals).sum(axis=1)) / np.linalg.norm(normals, axis=1)
    return np.where(above, heights, nearest)


def faults_of_command(code: int, text: str, folder: Path, inputs: set[str], promise: Promise) -> list[str]:
    """Of a command that was stopped: its exit code, what it says, and what it left in its folder."""
    left = {path.name for path in folder.iterdir()} - inputs
    faults = said.faults_of_output(text)
    faults += [f"{name} is left" for name in sorted(left) if name.startswith(".")]
    lines = [line for line in text.splitlines() if line.startswith("error: ")]
    if code == 2:
        begins, _, names = "".join(lines).partition("; written before: ")
        told = set(names.split(", ")) if names else set()
        if len(lines) != 1 or told != left or begins != "error: interrupted" + ("" if left else _NOTHING):
            faults.append(f"exit code 2, {sorted(left)} is written, and it says {lines}")
    elif code not in (0, 1) or lines:
        faults.append(f"exit code {code}, and it says {lines}")
    elif "out.vtu" not in left:
        faults.append(f"exit code {code}, and no mesh is written")
    if "out.vtu" in left:
        faults += faults_of_mesh(result.load(folder / "out.vtu"), promise)
    return faults
