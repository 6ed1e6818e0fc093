"""The planes of a surface, put right: what a file rounded, or noise moved off them, goes back onto them."""

import math
from dataclasses import dataclass, replace

import numpy as np

from wct_plugin.core import _core
from wct_plugin.measure.planes import PlaneCount
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.triangle_surfaces import normals
from wct_plugin.meshing.reference import Reference
from wct_plugin.types import Bools, Floats, Ints

#: What counts as noise, as a fraction of the extent, where coordinates have all their digits.
_NOISE = 1e-9
#: Coarser coordinates than this fraction of the extent are no rounding: numbers such as 0.25 are meant.
_COARSEST = 6e-6
#: Patches this near to a plane, as a fraction of the extent, are planes with noise: single precision or six digits were
#: in between, whatever digits there are now.
_NOISY = 1e-6
#: A patch is a plane where its vertices are within so many precisions of one: rounding three coordinates moves a point
#: by up to sqrt(3), noise by some standard deviations.
_WITHIN = 8.0
#: No vertex goes farther, in precisions: where planes meet at a small angle, their line may be far off.
_FARTHEST = 16.0
_NONE: Ints = np.empty(0, dtype=np.int64)
#: Points are in line where they are no farther across, as a fraction of their spread.
_STRAIGHT = 1e-4


def precision(points: Floats, unit: int = 0) -> float:
    """How exact the coordinates of points (n, 3), in 2 ** ``unit`` of the unit they were written in, are, a length.

    Half the step between two numbers that could have been written there, where these are of single precision or have
    few decimals; and 1e-9 of the extent at least, as numbers that were computed scatter so.
    """
    points = np.ldexp(points, unit)
    return math.ldexp(_written_precision(points), -unit)


def _written_precision(points: Floats) -> float:
    extent = float(np.ptp(points, axis=0).max(initial=0.0))
    largest = float(np.abs(points).max(initial=0.0))
    least, most = max(_NOISE * extent, largest * 2.0**-53), _COARSEST * extent
    with np.errstate(over="ignore"):
        single = bool(np.array_equal(points.astype(np.float32), points))
    if single:
        return max(min(largest * 2.0**-24, most), least)
    return max(_half_a_step(np.abs(points[points != 0.0]), most), least)


def _half_a_step(size: Floats, most: float) -> float:
    """Half of what the last digit stands for in the largest of some numbers > 0 that has as many as any of them.

    0 where that is more than ``most``: numbers such as 0.25 are meant. Where all digits of a double are there, it is
    next to nothing.
    """
    power = np.floor(np.log10(size))
    for digits in range(1, 17):
        written = [_has_at_most(size, power, few) for few in (digits, digits // 2)]
        if written[0].all():
            long = power[~written[1]]  # a 1 may stand for 1.00000 or be one
            half = 0.5 * 10.0 ** ((long if len(long) else power).max() + 1 - digits)
            return float(half) if half <= most else 0.0
    return 0.0


def _has_at_most(size: Floats, power: Floats, digits: int) -> Bools:
    """Which numbers, 10 ** ``power`` to 10 ** (power + 1), have no more than so many significant digits."""
    scaled = size * 10.0 ** (digits - 1 - power)
    few: Bools = np.abs(scaled - np.rint(scaled)) <= 1e-12 * scaled
    return few


def straightened(on: Reference, exact: float, pinned: Ints = _NONE) -> tuple[Reference, PlaneCount]:
    """The surface with the vertices of its planes on them, none moved by more than 16 times ``exact``, a length.

    Where patches lie within 1e-6 of the extent of a plane, but not within 8 times ``exact``, half of the farthest that
    one of their vertices is off takes the place of ``exact``: coordinates that were rounded and then turned have all
    digits and are no better for it.

    A patch is a plane where all its vertices are within 8 times ``exact`` of one; patches of one plane share it. Where
    that is within as much of a plane of one coordinate, all its vertices get that coordinate, the one most of them have
    already if there is one; so planes of an axis that are exact stay so, to the bit. Vertices of other planes go onto
    theirs, of two onto their line, of three onto their point, to rounding. Those of more than three stay where they
    are, but for coordinates of an axis, and planes go through them where they can; so do those that would go farther.
    ``pinned`` (k,) vertices stay, to the bit.
    """
    exact = max(exact, _noise(on, _WITHIN * exact) / 2.0)
    found = _Planes(on, _WITHIN * exact)
    points = found.on_axes(on.points)
    points[pinned] = on.points[pinned]
    held = found.held(points)
    held[pinned] = True
    for _ in range(3):  # a vertex that stays has its planes go through it, which may hold others
        found.fit(points, held)
        moved, too_far = found.put(points, held, _FARTHEST * exact)
        if not (too_far & ~held).any():
            break
        held = held | too_far
    count: PlaneCount = {
        "patches": len(on.sides),
        "planes": int((found.of_patch >= 0).sum()),
        "axis": int((found.axis[found.of_patch[found.of_patch >= 0]] >= 0).sum()),
        "moved": float(np.linalg.norm(moved - on.points, axis=1).max(initial=0.0) / on.diagonal),
    }
    return replace(on, points=moved, flat=_WITHIN * exact), count


def _noise(on: Reference, rounding: float) -> float:
    """How far at most vertices are off the planes of patches that are plane but for noise, a length.

    0 where none is off by more than ``rounding``, a length.
    """
    triangles, patch, count = on.strata.triangles, on.strata.patch, len(on.sides)
    if not count:
        return 0.0
    across, corners = normals(on.points, triangles), on.points[triangles]
    size = np.maximum(np.bincount(patch, minlength=count), 1)[:, None]
    normal, middle = (
        np.column_stack([np.bincount(patch, values, count) for values in each.T])
        for each in (across, corners.mean(axis=1))
    )
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    off = np.abs(np.einsum("tkx,tx->tk", corners - (middle / size)[patch][:, None], normal[patch])).max(axis=1)
    farthest = np.zeros(count)
    np.maximum.at(farthest, patch, off)
    most = _NOISY * float(np.ptp(on.points, axis=0).max())
    noisy = (farthest > rounding) & (farthest <= most) & (length[:, 0] > 0.0)
    return float(farthest[noisy].max(initial=0.0))


def straightened_mesh(mesh: TetMesh, own: Reference, exact: float) -> tuple[TetMesh, Reference, PlaneCount]:
    """A mesh and its own surface with their planes put right, but for tagged vertices.

    They stay as they are where a tet would turn over.
    """
    on, count = straightened(own, exact, mesh.nodes.vertices.ravel())
    if (_core.orientation(on.points, mesh.tets) <= 0).any():
        return mesh, own, {**count, "planes": 0, "axis": 0, "moved": 0.0}
    return mesh.altered(points=on.points), on, count


@dataclass(eq=False)
class _Plane:
    """Points p with (p - origin) . normal = 0."""

    normal: Floats
    origin: Floats


class _Planes:
    """The planes of a surface: one for all the patches that lie in it."""

    def __init__(self, on: Reference, within: float) -> None:
        self.within = within
        triangles, patch = on.strata.triangles, on.strata.patch
        self.of_patch = np.full(len(on.sides), -1, dtype=np.int64)
        self.planes: list[_Plane] = []
        self.members: list[Ints] = []  # vertices of each plane
        order = np.argsort(patch, kind="stable")
        bounds = np.searchsorted(patch[order], np.arange(len(on.sides) + 1))
        across = normals(on.points, triangles)
        area = np.linalg.norm(across, axis=1)
        total = np.bincount(patch, area, minlength=len(on.sides))
        for one in np.argsort(-total, kind="stable"):
            rows = order[bounds[one] : bounds[one + 1]]
            if not total[one] > 0.0:
                continue
            vertices = np.unique(triangles[rows])
            self._add(int(one), on.points, vertices, across[rows[np.argmax(area[rows])]])
        self.axis = np.full(len(self.planes), -1, dtype=np.int64)
        self.level = np.zeros(len(self.planes))
        for k, vertices in enumerate(self.members):
            self._find_axis(k, on.points[vertices])

    def _add(self, patch: int, points: Floats, vertices: Ints, across: Floats) -> None:
        """Give the patch its plane: one that is there already, a new one, or none where it is not plane."""
        own = points[vertices]
        near = [np.abs((own[0] - one.origin) @ one.normal) <= self.within for one in self.planes]
        for k in np.flatnonzero(near):
            plane = self.planes[k]
            if np.abs((own - plane.origin) @ plane.normal).max() <= self.within:
                both = np.union1d(self.members[k], vertices)
                joint = _fitted(points[both], plane.normal, points[:0])
                if np.abs((points[both] - joint.origin) @ joint.normal).max() <= self.within:
                    self.planes[k], self.members[k], self.of_patch[patch] = joint, both, k
                    return
        plane = _fitted(own, across, points[:0])
        if np.abs((own - plane.origin) @ plane.normal).max() <= self.within:
            self.of_patch[patch] = len(self.planes)
            self.planes.append(plane)
            self.members.append(vertices)

    def _find_axis(self, k: int, own: Floats) -> None:
        spread = np.ptp(own, axis=0) / 2.0
        axis = int(np.argmax(np.abs(self.planes[k].normal)))
        if spread[axis] > self.within:
            return
        values, times = np.unique(own[:, axis], return_counts=True)
        most = int(np.argmax(times))
        self.axis[k] = axis
        self.level[k] = values[most] if 2 * times[most] > len(own) else own[:, axis].mean()

    def on_axes(self, points: Floats) -> Floats:
        """The points, those of planes of one coordinate with exactly that."""
        out = points.copy()
        for k in np.flatnonzero(self.axis >= 0):
            out[self.members[k], self.axis[k]] = self.level[k]
            self.planes[k] = _Plane(np.eye(3)[self.axis[k]], np.eye(3)[self.axis[k]] * self.level[k])
        return out

    def held(self, points: Floats) -> Bools:
        """(n,) vertices of more than three planes."""
        times = np.zeros(len(points), dtype=np.int64)
        for vertices in self.members:
            times[vertices] += 1
        many: Bools = times > 3
        return many

    def fit(self, points: Floats, held: Bools) -> None:
        """Fit the planes that are not of an axis anew, through what is held of their vertices."""
        for k in np.flatnonzero(self.axis < 0):
            vertices = self.members[k]
            through = points[vertices[held[vertices]]]
            self.planes[k] = _fitted(points[vertices], self.planes[k].normal, through)

    def put(self, points: Floats, held: Bools, farthest: float) -> tuple[Floats, Bools]:
        """The points, each on its planes unless it is held; and which of them would go farther than they may."""
        out, too_far = points.copy(), np.zeros(len(points), dtype=bool)
        if not self.planes:
            return out, too_far
        at = np.concatenate(self.members)
        plane = np.repeat(np.arange(len(self.members)), [len(one) for one in self.members])
        order = np.lexsort([plane, at])
        at, plane = at[order], plane[order]
        vertices, first, times = np.unique(at, return_index=True, return_counts=True)
        normals_of, origins = (np.array([getattr(one, name) for one in self.planes]) for name in ("normal", "origin"))
        for many in (1, 2, 3):
            rows = np.flatnonzero((times == many) & ~held[vertices])
            if not len(rows):
                continue
            which = plane[first[rows, None] + np.arange(many)]
            tilted = (self.axis[which] < 0).any(axis=1)
            rows, which = rows[tilted], which[tilted]
            own = vertices[rows]
            normal, origin = normals_of[which], origins[which]
            moved = out[own]
            for _ in range(3):  # what rounding left of the first step
                off = np.einsum("vpk,vpk->vp", moved[:, None, :] - origin, normal)
                moved = moved - np.einsum("vkp,vp->vk", np.linalg.pinv(normal, rcond=1e-6), off)
                for row, column in zip(*np.nonzero(self.axis[which] >= 0), strict=True):
                    moved[row, self.axis[which[row, column]]] = self.level[which[row, column]]
            far = np.linalg.norm(moved - points[own], axis=1) > farthest
            too_far[own[far]] = True
            out[own[~far]] = moved[~far]
        return out, too_far


def _fitted(points: Floats, normal: Floats, through: Floats) -> _Plane:
    """The plane nearest to points (n, 3) in the mean square, among those that go through points ``through`` (k, 3).

    More than three of these it is nearest to instead. Its normal is on the side of ``normal``.
    """
    origin = (through if len(through) else points).mean(axis=0)
    _, size, lines = np.linalg.svd(through - origin, full_matrices=False)
    lines = lines[: int((size > _STRAIGHT * size.max(initial=0.0)).sum())][:2]  # that the plane contains
    offsets = points - origin
    offsets -= offsets @ lines.T @ lines
    across = np.linalg.svd(np.eye(3) - lines.T @ lines)[2][: 3 - len(lines)]
    out = np.linalg.svd(offsets @ across.T, full_matrices=False)[2][-1] @ across
    return _Plane(np.copysign(1.0, out @ normal) * out / np.linalg.norm(out), origin)
