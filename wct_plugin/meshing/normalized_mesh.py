"""A mesh as the remesher works on it: in a unit in which nothing under- or overflows, with its own surface."""

import math
import warnings
from dataclasses import dataclass
from functools import cached_property

from wct_plugin.errors import WctWarning
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.goals import misses
from wct_plugin.measure.quality import Quality
from wct_plugin.measure.thin_walls import thinnest
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing.boundary_choice import PatchChoices
from wct_plugin.meshing.periodic_pairs import PeriodicSurface
from wct_plugin.meshing.reference import Reference


@dataclass(frozen=True, eq=False)
class NormalizedMesh:
    """What came in; its ``reference``, if any, is the surface that was given."""

    mesh: TetMesh
    own: Reference  #: its own boundary, interfaces and tagged facets
    choices: PatchChoices  #: what may happen to each patch of these
    unit: int  #: coordinates are in 2 ** unit of the user's unit of length
    tangled: bool  #: its tets overlap as it came
    periodic: PeriodicSurface | None = None  #: which patches are translates of which; ``own`` is cut along them

    @property
    def diagonal(self) -> float:
        """Of the given surface's bounding box, or else of the mesh's."""
        return (self.mesh.reference or self.mesh).diagonal

    @cached_property
    def measured(self) -> Quality:
        """Of the tets that came."""
        return compiled_quality.measure(self.mesh)

    def count_bad(self, goal: str) -> int:
        """Tets that keep it from the goal."""
        return count_bad(self.mesh, self.measured, goal)

    def warn_of_thin_walls(self, tolerance: float) -> None:
        """Say where the two sides of a wall, each within the ``tolerance``, a length, may meet."""
        thin = thinnest(self.mesh, 2.0 * tolerance)
        if not thin:
            return
        body = "the body" if (self.mesh.regions == thin.region).all() else f"region {thin.region}"
        thickness, x, y, z = (math.ldexp(one, self.unit) for one in (thin.thickness, *thin.place))
        warnings.warn(
            f"{body} is {thickness:.3g} thick near ({x:.4g}, {y:.4g}, {z:.4g}), thinner than twice the tolerance of"
            f" {tolerance / self.diagonal:.2e} of the diagonal, within which its two sides may meet; use a tolerance"
            f" below {thin.thickness / 2.0 / self.diagonal:.2e}",
            WctWarning,
            stacklevel=3,
        )


def count_bad(mesh: TetMesh, measured: Quality, goal: str) -> int:
    """Tets that keep a mesh from its goal."""
    return int(misses(mesh, measured, goal).sum())
