"""gmsh files in FiPy, with centroids as it comes and with circumcenters for its centers.

FiPy asks the program gmsh for its version, which the wheel of gmsh puts beside Python, and it uses parts of NumPy that
are on their way out.
"""

import os
import warnings
from pathlib import Path

import gmsh
import numpy as np

from wct_plugin.measure import quality

os.environ["PATH"] += os.pathsep + str(Path(gmsh.__file__).parents[3] / "bin")
with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    import fipy

__all__ = ["Circumcentric", "fipy"]


class Circumcentric(fipy.Gmsh3D):
    """A gmsh file whose cells and facets have their circumcenters as centers; volumes and normals stay."""

    def _calcCellCenters(self) -> np.ndarray:  # noqa: N802 (FiPy's name)
        return quality.circumcenters(self.vertexCoords.T, self._orderedCellVertexIDs.T.astype(np.int64)).T

    def _calcFaceCenters(self) -> np.ndarray:  # noqa: N802
        origin, second, third = self.vertexCoords[:, np.asarray(self.faceVertexIDs)].swapaxes(0, 1)
        a, b = second - origin, third - origin
        aa, ab, bb = ((x * y).sum(axis=0) for x, y in ((a, a), (a, b), (b, b)))
        return origin + 0.5 * (bb * (aa - ab) * a + aa * (bb - ab) * b) / (aa * bb - ab * ab)
