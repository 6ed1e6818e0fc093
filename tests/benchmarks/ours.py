"""Our filters, by name through :func:`wct_plugin.stage.apply_filter`; the ones this build registers."""

from dataclasses import dataclass, field
from typing import Any

from wct_plugin.mesh import TetMesh
from wct_plugin.stage import apply_filter, filter_names


@dataclass(frozen=True)
class Ours:
    """A filter: its row in the table, its registered name and its options."""

    name: str
    filter: str
    options: dict[str, Any] = field(default_factory=dict)

    def run(self, mesh: TetMesh) -> TetMesh:
        """Apply it; the mesh's reference is the surface of the same name, where one was given."""
        made, _ = apply_filter(self.filter, mesh, **self.options)
        assert isinstance(made, TetMesh)
        return made


_ALL = (
    *(
        Ours(f"wct apply_coord {boundary} {goal}", "apply_coord_well_centering", {"boundary": boundary, "goal": goal})
        for boundary in ("fixed", "slide")
        for goal in ("3wc", "cwc")
    ),
    Ours("wct meshing_well_centered", "meshing_well_centered"),
)
OURS = tuple(tool for tool in _ALL if tool.filter in filter_names())
