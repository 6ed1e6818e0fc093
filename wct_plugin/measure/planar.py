"""Triangle meshes in a plane: how many triangles are acute, which is what well-centered means there."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.exact import predicates
from wct_plugin.exact.polynomial_signs import exact_signs
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.mesh.triangle_surfaces import thickness
from wct_plugin.types import Floats

#: As far off a plane, in diagonals, points may be that single precision put in it.
_FLAT = 1e-6

#: What is said wherever tets are asked for.
NOT_OPTIMISED = "2D meshes are not optimised; `wct report` says how many of their triangles are acute"


@dataclass(frozen=True)
class PlanarReport:
    """A triangle mesh in a plane; counts are exact, angles in degrees."""

    source: str
    points: int  #: that a triangle uses
    triangles: int
    regions: Mapping[int, int]  #: tag -> number of triangles
    acute: int  #: triangles that contain their circumcenter inside
    right: int  #: triangles that have it on an edge
    angles: tuple[float, float]  #: the smallest and the largest
    area: float

    @property
    def percent(self) -> float:
        """Share of acute triangles."""
        return 100.0 * self.acute / self.triangles

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings and dicts."""
        return {
            "source": self.source,
            "dimension": 2,
            "points": self.points,
            "triangles": self.triangles,
            "regions": {str(tag): count for tag, count in self.regions.items()},
            "acute": {"count": self.acute, "percent": self.percent},
            "right": self.right,
            "angles": {"min": self.angles[0], "max": self.angles[1]},
            "area": self.area,
        }

    def headline(self) -> str:
        """One line: what the mesh is and how many of its triangles are well-centered."""
        name = self.source or "mesh"
        return f"{name}: 2D, {self.triangles} triangles, {self.points} points, {self.percent:.3f} % acute"

    def rows(self) -> list[tuple[str, str]]:
        """What there is to say of it."""
        low, high = self.angles
        return [
            ("points", str(self.points)),
            ("triangles", str(self.triangles)),
            *(
                (f"triangles of region {tag}", str(count))
                for tag, count in self.regions.items()
                if len(self.regions) > 1
            ),
            ("acute, which is well-centered in 2D", f"{self.acute} ({self.percent:.3f} %)"),
            ("right-angled", str(self.right)),
            ("obtuse", str(self.triangles - self.acute - self.right)),
            ("angles", f"{low:.2f}° - {high:.2f}°"),
            ("area", f"{self.area:.6g}"),
        ]


def is_planar(surface: SurfaceMesh) -> bool:
    """Whether all of a surface is in one plane, so that it bounds nothing."""
    return thickness(surface.points, surface.triangles) <= _FLAT


def check_not_planar(surface: SurfaceMesh) -> None:
    """Raise :class:`InputError` for a triangle mesh in a plane, which no mesher can fill."""
    if is_planar(surface):
        name = surface.source or "the surface"
        raise InputError(f"{name}: the surface is planar, so that it has no inside; {NOT_OPTIMISED}")


def measure(surface: SurfaceMesh) -> PlanarReport:
    """Measure a triangle mesh in a plane."""
    corners = surface.points[surface.triangles]
    signs = exact_signs(predicates.corners, surface.points, surface.triangles).values
    angles = _angles(corners)
    sides = corners[:, 1:] - corners[:, :1]
    tags, counts = np.unique(surface.tags, return_counts=True)
    return PlanarReport(
        source=surface.source,
        points=len(np.unique(surface.triangles)),
        triangles=len(surface.triangles),
        regions=dict(zip(tags.tolist(), counts.tolist(), strict=True)),
        acute=int((signs > 0).all(axis=1).sum()),
        right=int(((signs >= 0).all(axis=1) & (signs == 0).any(axis=1)).sum()),
        angles=(float(angles.min()), float(angles.max())),
        area=float(0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()),
    )


def _angles(corners: Floats) -> Floats:
    """(k, 3) the angles of triangles (k, 3, 3) in degrees."""
    one, other = (np.roll(corners, shift, axis=1) - corners for shift in (-1, 1))
    across = np.linalg.norm(np.cross(one, other), axis=2)
    angles: Floats = np.degrees(np.arctan2(across, np.einsum("kix,kix->ki", one, other)))
    return angles
