"""What a filter of another package is made of; see the page on pipelines for a whole one."""

from wct_plugin.pipeline.stage import FilterStage, Mesh, OfDiagonal, Options
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.types import Metrics

__all__ = ["FilterStage", "Mesh", "Metrics", "OfDiagonal", "Options", "Progress", "ProgressCallback"]
