"""A mesh on its way through a pipeline, with what the filters found out about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.stage import FilterStage, Mesh, Options, Stage, find_filter
from wct_plugin.reports.report import Report, make_report
from wct_plugin.types import Metrics


@dataclass(frozen=True)
class Passed:
    """A reader or filter that a mesh came through."""

    stage: Stage[Options]
    seconds: float
    size: str  #: of the mesh it gave, in words


@dataclass(frozen=True, eq=False)
class Flow:
    """What one stage hands to the next."""

    mesh: Mesh
    metrics: Mapping[str, Metrics] = field(default_factory=dict)  #: of each filter the mesh came through, by its name
    found: Mapping[str, Any] = field(default_factory=dict)  #: metrics of the filter that measured the mesh
    written: str = ""  #: the file that holds the mesh, once it is written
    history: tuple[Passed, ...] = ()  #: the stages it came through, the first first
    _reports: dict[tuple[int, int], Report] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        return f"<Flow {' -> '.join(one.stage.type() for one in self.history)}: {size(self.mesh)}>"

    @classmethod
    def of(cls, stage: Stage[Options], mesh: Mesh, seconds: float) -> "Flow":
        """The flow behind the reader ``stage``."""
        return cls(mesh, history=(Passed(stage, seconds, size(mesh)),))

    def through(self, stage: FilterStage[Options], mesh: Mesh, metrics: Metrics, seconds: float = 0.0) -> "Flow":
        """The flow behind the filter ``stage``, which gave ``mesh`` and ``metrics``."""
        key, count = stage.name, 1
        while key in self.metrics:
            count += 1
            key = f"{stage.name}_{count}"
        found: Mapping[str, Any] = {}
        if stage.measures:
            found = metrics
        elif _same_shape(self.mesh, mesh):
            found = self.found
        history = (*self.history, Passed(stage, seconds, size(mesh)))
        return Flow(mesh, {**self.metrics, key: metrics}, found, history=history)

    def into(self, file: str) -> "Flow":
        """The flow behind a writer of ``file``, which is what reports call the mesh from there on."""
        return replace(self, written=file, _reports={})

    def report(self, worst: int = 10, reference: SurfaceMesh | None = None) -> Report:
        """The report of the mesh, made once; ``reference`` takes the place of the mesh's own, if given.

        What a filter has measured is not measured again.
        """
        find_filter("get_quality").check_takes(type(self.mesh))
        assert isinstance(self.mesh, TetMesh)
        mesh, found = self.mesh, dict(self.found)
        if reference is not None and reference is not mesh.reference:
            mesh = mesh.altered(reference=reference)
            found.pop("deviation", None)
        key = (worst, id(mesh.reference))
        if key not in self._reports:
            report = make_report(mesh, worst, found)
            self._reports[key] = replace(report, source=self.written or report.source)
        return self._reports[key]


def side_by_side(flows: Mapping[str, Flow], worst: int = 10) -> dict[str, Report]:
    """A report of each, all measured against the reference of the last one, so that their numbers compare."""
    last = list(flows.values())[-1].mesh
    reference = last.reference if isinstance(last, TetMesh) else None
    return {name: flow.report(worst, reference) for name, flow in flows.items()}


def size(mesh: Mesh) -> str:
    """How large a mesh is, in words."""
    cells = f"{len(mesh.tets)} tets" if isinstance(mesh, TetMesh) else f"{len(mesh.triangles)} triangles"
    return f"{cells}, {len(mesh.points)} points"


def _same_shape(one: Mesh, other: Mesh) -> bool:
    if isinstance(one, TetMesh) and isinstance(other, TetMesh):
        return np.array_equal(one.points, other.points) and np.array_equal(one.tets, other.tets)
    return False
