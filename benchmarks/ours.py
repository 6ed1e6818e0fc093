"""Our filters, by name through :func:`wct_plugin.pipeline.stage.apply_filter`; the ones this build registers."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import apply_filter, filter_names


@dataclass(frozen=True)
class Ours:
    """A filter: its row in the table, its registered name and its options.

    ``near`` are further options where the mesh's reference is a surface given with it, not its own boundary.
    """

    name: str
    filter: str
    options: dict[str, Any] = field(default_factory=dict)
    near: dict[str, Any] = field(default_factory=dict)

    def load(self) -> None:
        """Nothing is left to import."""

    def run(self, mesh: TetMesh) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Apply it; points (n, 3) and tets (m, 4)."""
        made, _ = apply_filter(self.filter, mesh, **self.options, **(self.near if mesh.reference else {}))
        assert isinstance(made, TetMesh)
        return made.points, made.tets


#: Moves the boundary, as by default.
MESHING = Ours("wct meshing_well_centered", "meshing_well_centered", near={"tolerance": 1e-3})

_ALL = (
    *(
        Ours(f"wct apply_coord {boundary} {goal}", "apply_coord_well_centering", {"boundary": boundary, "goal": goal})
        for boundary in ("fixed", "slide")
        for goal in ("3wc", "cwc")
    ),
    *(
        Ours(f"{MESHING.name} {boundary}", MESHING.filter, {"boundary": boundary}, MESHING.near)
        for boundary in ("fixed", "keep")
    ),
    MESHING,
)
OURS = tuple(tool for tool in _ALL if tool.filter in filter_names())
