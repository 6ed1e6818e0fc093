"""``filters.meshlab``: any of MeshLab's filters, or a script of them, on a surface."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, field_validator, model_validator

from wct_plugin.adapters.meshlab import run as meshlab
from wct_plugin.errors import OptionError
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import Progress, ProgressCallback, ProgressChoice
from wct_plugin.types import Metrics
from wct_plugin.waiting.printed import told


class MeshlabOptions(Options):
    """Which filter of pymeshlab, with which arguments; or a script."""

    filter: str | None = Field(None, min_length=1, description="pymeshlab's name of a filter, as meshing_close_holes")
    arguments: dict[str, Any] = Field(
        {},
        description="The filter's arguments by name; a length is a number in the mesh's unit or a text like '1%', "
        "of the argument's greatest value, mostly the bounding box's diagonal",
    )
    script: Path | None = Field(None, description="A filter script of MeshLab (.mlx) to run instead")
    timeout: float | None = Field(None, gt=0, description="Seconds after which MeshLab is ended (default: none)")

    @field_validator("arguments")
    @classmethod
    def _json(cls, arguments: dict[str, Any]) -> dict[str, Any]:
        return {name: _plain(value, name) for name, value in arguments.items()}

    @model_validator(mode="after")
    def _one(self) -> "MeshlabOptions":
        if (self.filter is None) == (self.script is None):
            raise ValueError("exactly one of 'filter' and 'script' must be given")
        if self.script is not None and self.arguments:
            raise ValueError("'arguments' go with 'filter'; a script has its own")
        return self


class Meshlab(FilterStage[MeshlabOptions]):
    """Run any pymeshlab filter, or an .mlx script of MeshLab, on a surface: repair, remesh, smooth, measure.

    Names, types, choices and declared ranges of all arguments are checked before anything runs. The metrics hold what
    the filters measure and every argument used, lengths in the mesh's unit. Tags and data stay with the points and
    triangles that keep their place; a warning names what is dropped. ``quality`` and the colours ``red``, ``green``,
    ``blue``, ``alpha`` are MeshLab's own, per point and per triangle.
    """

    name = "meshlab"
    takes = SurfaceMesh
    gives = SurfaceMesh
    declaration = MeshlabOptions
    example: ClassVar[dict[str, Any]] = {"filter": "meshing_close_holes", "arguments": {"maxholesize": 50}}

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        chosen = self.options
        if chosen.filter is not None:
            where = f"filters.{self.name} ({chosen.filter})"
            self._steps = [meshlab.Step(chosen.filter, where, chosen.arguments)]
        elif chosen.script is not None:
            self._steps = meshlab.read_script(chosen.script)
        self._asked = False
        self._fault = ""  #: what pymeshlab cannot take, once it was asked

    def __call__(self, mesh: Any = None, progress: ProgressChoice = None) -> tuple[SurfaceMesh, Metrics]:
        """Run; the process that runs the filters checks them first, so none is started only for that."""
        self.check_takes(None if mesh is None else type(mesh))
        with told(progress) as callback:
            return self.run(mesh, callback)

    @classmethod
    def prepare(cls, stages: Sequence[Any]) -> None:
        """Ask pymeshlab for the filters and their arguments of all stages; it takes a second, once."""
        new = [stage for stage in stages if not stage._asked]
        faults = meshlab.check([stage._steps for stage in new]) if new else []
        for stage, fault in zip(new, faults, strict=True):
            stage._asked, stage._fault = True, fault

    def validate(self) -> None:  # noqa: D102
        self.prepare([self])
        if self._fault:
            raise OptionError(self._fault)

    def run(self, mesh: SurfaceMesh, progress: ProgressCallback) -> tuple[SurfaceMesh, Metrics]:  # noqa: D102
        progress(Progress("MeshLab", 0.0))
        made, log = meshlab.run(mesh, self._steps, self.options.timeout)
        measures = {name: value for step in log for name, value in step.pop("measures").items()}
        return made, {"points": len(made.points), "triangles": len(made.triangles), "measures": measures, "steps": log}


def _plain(value: Any, name: str) -> Any:
    """As JSON has it: NumPy's numbers and arrays become Python's."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(each, name) for each in value]
    if not isinstance(value, str | bool | int | float):
        raise ValueError(
            f"argument {name!r} is a {type(value).__name__}; allowed are numbers, texts, booleans and lists"
        )
    return value
