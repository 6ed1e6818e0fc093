"""``filters.get_quality``: the report's numbers as metrics."""

from typing import Any, ClassVar

from pydantic import Field

from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import ProgressCallback
from wct_plugin.reports.report import make_report
from wct_plugin.types import Metrics


class QualityOptions(Options):
    """What the report lists."""

    worst: int = Field(10, ge=0, description="How many of the worst tets to list")


class GetQuality(FilterStage[QualityOptions]):
    """Measure a tet mesh: ranges of h/R, angles and R/l, tiers, flags, and the worst tets with their place."""

    name = "get_quality"
    takes = TetMesh
    gives = TetMesh
    declaration = QualityOptions
    example: ClassVar[dict[str, Any]] = {"worst": 3}

    def run(self, mesh: TetMesh, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        return mesh, make_report(mesh, worst=self.options.worst).to_dict()
