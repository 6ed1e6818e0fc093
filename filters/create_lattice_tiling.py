"""``filters.create_lattice_tiling``: space, slabs and prisms tiled by two tetrahedra."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from wct_plugin.creation import lattice_tiling
from wct_plugin.creation import metrics as creation_metrics
from wct_plugin.creation.face_groups import with_faces
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.types import Metrics

#: In which directions each domain repeats.
_REPEATS = {"cell": (True, True, True), "slab": (True, True, False), "prism": (True, False, False)}


class LatticeTilingOptions(Options):
    """Which tiling, and which piece of it."""

    a: float = Field(0.5**0.5, gt=0, description="Distance of rows of a plane, in edges along x; above 1/2: CWC")
    b: float = Field(0.5**0.5, gt=0, description="Distance of planes, in edges along x; above 1/2: CWC")
    domain: Literal["cell", "slab", "prism"] = Field(
        "cell", description="cell: repeats in x, y and z and so fills space; slab: in x and y; prism: in x only"
    )
    nx: int = Field(2, ge=1, description="Edges along x in one period")
    p: int = Field(2, ge=1, description="Rows along y: the block is p a wide; p : q is the prism's ratio where a = b")
    q: int = Field(2, ge=1, description="Planes along z: the block is q b high")
    edge_length: float | None = Field(None, gt=0, description="Length of the edges along x (none: 1, or as size says)")
    size: float | None = Field(
        None,
        gt=0,
        description="Length wanted: of the cell along x, of the slab along z (its thickness), of the prism along y",
    )

    @model_validator(mode="after")
    def _one_scale(self) -> "LatticeTilingOptions":
        if self.edge_length is not None and self.size is not None:
            raise ValueError("options 'edge_length' and 'size' exclude each other; give one of them")
        return self


class CreateLatticeTiling(FilterStage[LatticeTilingOptions]):
    """Make one period of a tiling of space, of a slab or of a rectangular prism by two tetrahedra of equal volume.

    The vertices are the lattice of (1, 0, 0), (1/2, a, 0) and (1/2, 0, b). All tets are completely well-centered if and
    only if a and b are above 1/2; the metric ``condition_met`` says so. With a = b = 0.5 ** 0.5, the default, both are
    Sommerville's tetrahedron and the lattice is body-centered cubic. The block is flat in y and z; its two ends in x
    are ragged and fit each other. Point data ``periodic_class`` is equal where periods, listed in the metrics, take
    points to each other. The facets of the sides are tagged 1 to 6, ``x_min`` to ``z_max``.
    """

    name = "create_lattice_tiling"
    takes = None
    gives = TetMesh
    declaration = LatticeTilingOptions
    example: ClassVar[dict[str, Any]] = {"domain": "prism", "p": 3, "q": 2, "size": 1.5}

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        given = self.options
        _, along_y, along_z = _REPEATS[given.domain]
        layers = (given.p * along_y, given.q * along_z)
        vertices, tets = lattice_tiling.block(given.nx, given.p, given.q)
        unit = np.array([0.5, given.a, given.b]) * self._edge_length()
        made = TetMesh(
            vertices * unit,
            tets,
            point_data={"periodic_class": lattice_tiling.classes(vertices, given.nx, layers)},
        )
        periods = [(2 * given.nx, 0, 0), *(lattice_tiling.shift(n, axis) for axis, n in enumerate(layers, 1) if n)]
        metrics = {
            "condition": "a > 1/2 and b > 1/2",
            "condition_met": given.a > 0.5 and given.b > 0.5,
            "periods": (np.array(periods) * unit).tolist(),
        }
        return with_faces(made, ragged_ends=True), creation_metrics.metrics(made) | metrics

    def _edge_length(self) -> float:
        """Length of the edges along x."""
        given = self.options
        if given.size is None:
            return given.edge_length or 1.0
        lengths = {"cell": given.nx, "slab": given.q * given.b, "prism": given.p * given.a}
        return given.size / lengths[given.domain]
