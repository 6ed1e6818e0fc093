"""Pictures of a mesh for its report: the boundary by quality, and the bad tets inside.

Drawn far to near (Newell's painter's algorithm) by matplotlib, which needs neither display nor GL and gives the same
picture everywhere. Triangles of a boundary are of like size near each other, so their centers tell which is in front.
"""

from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import WctError, how_to_install
from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import Topology
from wct_plugin.mesh.triangle_surfaces import normals, surface_edges
from wct_plugin.reports.colour_scales import OBTUSE, Stops, colours
from wct_plugin.reports.eye import Eye
from wct_plugin.types import Floats, Ints

_SKIN, _BACK, _LINE = (0.55, 0.6, 0.66, 0.13), (0.55, 0.6, 0.66, 0.22), (0.42, 0.47, 0.53, 0.9)
_LIGHT = np.array([-0.35, 0.5, 0.8])  # in the picture's axes: right, up, towards the eye
_WIDTH, _DPI, _COLOURS = 760, 100, 128
#: So few bad tets are ringed, or they would be overlooked.
_FEW = 40


@dataclass(frozen=True)
class Picture:
    """A PNG with transparent ground, and its words."""

    png: bytes
    size: tuple[int, int]  #: width and height in pixels
    caption: str
    alt: str


def check_available() -> None:
    """Raise :class:`wct_plugin.errors.WctError` without matplotlib."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise WctError(f"the HTML page needs matplotlib: {how_to_install('report')}") from None


def pictures(mesh: TetMesh) -> tuple[tuple[Picture, ...], tuple[Picture, ...]]:
    """Of the boundary and of the bad tets, if there are any, from one side; and the same from the opposite side."""
    check_available()
    measured = compiled_quality.measure(mesh)
    outside = ~measured.well_centered_3
    bad = np.flatnonzero(~measured.completely_well_centered)
    colour = colours(measured.min_height)
    colour[~outside & ~measured.completely_well_centered] = OBTUSE
    owner = mesh.topology.boundary_half_facets[:, 0]
    drawn = _Drawn(mesh, colours(measured.min_height), colour, bad, outside)
    surface = (
        f"{int(outside[owner].sum())} of {len(owner)} boundary triangles belong to a tet that does not contain its "
        "circumcenter"
    )
    inside = f"{int(outside.sum())} tets do not contain their circumcenter"
    if obtuse := len(bad) - int(outside.sum()):
        inside += f", {obtuse} more do and have a triangle that is not acute"
    sides = []
    for side, eye in (("", Eye.of(mesh)), (", from the opposite side", Eye.of(mesh, behind=True))):
        found = [drawn.boundary(eye, f"The boundary, each triangle by min h/R of its tet{side}", surface)]
        if len(bad):
            found.append(drawn.inside(eye, f"The bad tets in the transparent boundary{side}", inside))
        sides.append(tuple(found))
    return sides[0], sides[1]


def deviation_pictures(mesh: TetMesh, apart: Floats, stops: Stops) -> tuple[Picture, Picture]:
    """Of the boundary by how far each facet is from the reference, ``apart`` (b,), from one side and from the other."""
    check_available()
    alt = f"The farthest is {apart.max():.2e} of the diagonal away, half of them less than {np.median(apart):.2e}"
    sides = []
    for side, eye in (("", Eye.of(mesh)), (", from the opposite side", Eye.of(mesh, behind=True))):
        sheet = _Sheet(eye.see(mesh.points), eye)
        sheet.triangles(mesh.topology.boundary, colours(apart, stops))
        sides.append(sheet.picture(f"The boundary, each triangle by its distance from the reference{side}", alt))
    return sides[0], sides[1]


@dataclass(frozen=True, eq=False)
class _Drawn:
    mesh: TetMesh
    by_height: Floats  #: (m, 3) colour of each tet on the boundary
    colour: Floats  #: (m, 3) colour of each tet inside
    bad: Ints
    outside: NDArray[np.bool_]  #: (m,) those of the bad ones that do not contain their circumcenter

    def boundary(self, eye: Eye, caption: str, alt: str) -> Picture:
        sheet = _Sheet(eye.see(self.mesh.points), eye)
        topology = self.mesh.topology
        sheet.triangles(topology.boundary, self.by_height[topology.boundary_half_facets[:, 0]])
        return sheet.picture(caption, alt)

    def inside(self, eye: Eye, caption: str, alt: str) -> Picture:
        sheet = _Sheet(eye.see(self.mesh.points), eye)
        skin = self.mesh.topology.boundary
        sheet.glass(skin, behind=True)
        body = Topology(self.mesh.tets[self.bad], self.mesh.regions[self.bad], len(self.mesh.points))
        sheet.triangles(body.boundary, self.colour[self.bad[body.boundary_half_facets[:, 0]]])
        sheet.glass(skin, behind=False)
        sheet.lines(find_strata(self.mesh).segments)
        if len(self.bad) <= _FEW:
            for kind, shape in ((True, "o"), (False, "s")):
                some = self.bad[self.outside[self.bad] == kind]
                sheet.rings(self.mesh.tets[some], shape)
        return sheet.picture(caption, alt)


class _Sheet:
    """What is drawn first lies behind."""

    def __init__(self, seen: Floats, eye: Eye) -> None:
        from matplotlib.figure import Figure

        self._seen, self._eye = seen, eye
        low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
        middle, size = (low + high) / 2, np.maximum(high - low, 1e-300)
        aspect = float(np.clip(size[1] / size[0], 0.45, 1.0))  # a tall mesh leaves room at its sides
        self._half = 0.54 * np.maximum(size, [size[1] / aspect, size[0] * aspect])
        self._figure = Figure(figsize=(_WIDTH / _DPI, _WIDTH * aspect / _DPI), dpi=_DPI)
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        self._axes.set(xlim=middle[0] + self._half[:1] * [-1, 1], ylim=middle[1] + self._half[1:] * [-1, 1])
        self._pixel = 2.0 * float(self._half[0]) / _WIDTH
        self._layer = 0

    def triangles(self, triangles: Ints, colour: Floats) -> None:
        """Those that face the eye (their vertices counter-clockwise from outside), lit, the farthest first."""
        facing, light = self._facing(triangles)
        triangles, colour = triangles[facing], colour[facing] * light[facing, None]
        order = np.argsort(self._seen[triangles, 2].mean(axis=1), kind="stable")
        corners = self._seen[triangles[order], :2]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        fine = not len(corners) or float(np.median(sides)) < 6 * self._pixel  # lines would hide the colours
        self._polygons(corners, colour[order], colour[order] if fine else (*_LINE[:3], 0.55), 0.4)

    def glass(self, triangles: Ints, *, behind: bool) -> None:
        """The far or the near half of a closed surface, seen through, with its outline."""
        facing, _ = self._facing(triangles)
        half = triangles[facing != behind]
        self._polygons(self._seen[half, :2], _BACK if behind else _SKIN, "none", 0.0)
        rim, _, _, times, _ = surface_edges(half, len(self._seen))
        self.lines(rim[times == 1])

    def lines(self, ends: Ints) -> None:
        """Edges, in front of all before."""
        from matplotlib.collections import LineCollection

        self._add(LineCollection(list(self._seen[ends, :2]), colors=[_LINE], linewidths=0.8))

    def rings(self, tets: Ints, shape: str) -> None:
        """Around tets, however small they are."""
        at = self._seen[tets].mean(axis=1)
        self._layer += 1
        self._axes.plot(
            at[:, 0], at[:, 1], shape, markersize=15, markerfacecolor="none", markeredgecolor="#c4500c",
            markeredgewidth=1.6, zorder=self._layer,
        )  # fmt: skip

    def picture(self, caption: str, alt: str) -> Picture:
        """What was drawn."""
        from PIL import Image

        self._compass()
        width, height = (int(side) for side in self._figure.bbox.size)
        raw, packed = BytesIO(), BytesIO()
        self._figure.savefig(raw, format="rgba", transparent=True)
        image = Image.frombytes("RGBA", (width, height), raw.getvalue())
        image.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE).save(packed, format="png")
        return Picture(packed.getvalue(), image.size, caption, f"{caption}. {alt}.")

    def _facing(self, triangles: Ints) -> tuple[NDArray[np.bool_], Floats]:
        normal = normals(self._seen, triangles)
        length = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
        light = np.clip(normal @ _LIGHT / (length * np.linalg.norm(_LIGHT)), 0.0, 1.0)
        return normal[:, 2] > 0, 0.72 + 0.28 * light

    def _polygons(self, corners: Any, face: Any, edge: Any, width: float) -> None:
        from matplotlib.collections import PolyCollection

        self._add(PolyCollection(corners, facecolors=face, edgecolors=edge, linewidths=width))

    def _add(self, collection: Any) -> None:
        self._layer += 1
        collection.set_zorder(self._layer)
        self._axes.add_collection(collection, autolim=False)

    def _compass(self) -> None:
        """Where x, y and z point, in the emptiest corner."""
        low, half = np.array([self._axes.get_xlim()[0], self._axes.get_ylim()[0]]), self._half
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
        around = low + 2.0 * half * corners
        near = [int((np.abs(self._seen[:, :2] - corner) < 130 * self._pixel).all(axis=1).sum()) for corner in around]
        size = self._figure.get_size_inches() * _DPI
        start = np.array([60.0, 60.0]) + corners[int(np.argmin(near))] * (size - 120.0)
        for name, axis in zip("xyz", self._eye.axes.T, strict=True):
            self._axes.annotate(
                "", start + 34.0 * axis[:2], start, xycoords="figure pixels", textcoords="figure pixels",
                arrowprops={"arrowstyle": "->", "color": _LINE[:3], "linewidth": 1.4},
            )  # fmt: skip
            x, y = start + 46.0 * axis[:2]
            self._axes.text(x, y, name, transform=None, color=_LINE[:3], fontsize=11, ha="center", va="center")
