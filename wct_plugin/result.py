"""What a pipeline has done: the last mesh, and per stage its options, metrics, mesh and seconds."""

import math
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from wct_plugin import quality
from wct_plugin.errors import OptionError
from wct_plugin.flow import Flow, size
from wct_plugin.goals import DUAL, FLAGS, misses
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.overlap import overlap
from wct_plugin.stage import Mesh, Metrics, Options, Stage, did_you_mean

#: Whose versions change a result.
_PACKAGES = ("wct_plugin", "numpy", "scipy", "meshio", "pytetwild", "pymeshlab")


def goal_of(stage: Stage[Options]) -> str | None:
    """What a stage with an option ``goal`` aims at, if that is a goal of a tet mesh."""
    goal = getattr(stage.options, "goal", None)
    return goal if goal in (*FLAGS, *DUAL) else None


@dataclass(frozen=True)
class Goal:
    """What a filter aimed at and how far the mesh it gave is from it."""

    stage: str  #: type of the filter
    goal: str
    tets: int
    missed: int
    valid: bool  #: no two tets overlap

    @property
    def met(self) -> bool:
        """Whether every tet meets the goal, in a valid mesh."""
        return self.valid and not self.missed

    def __str__(self) -> str:
        if not self.valid:
            return f"{self.stage}: tets overlap; {self.missed} of {self.tets} miss the goal {self.goal}"
        if not self.missed:
            return f"{self.stage}: all {self.tets} tets meet the goal {self.goal}"
        return f"{self.stage}: {self.missed} of {self.tets} tets miss the goal {self.goal}"


@dataclass(frozen=True, eq=False)
class StageResult:
    """One stage after it has run."""

    stage: Stage[Options]
    tag: str
    flow: Flow  #: what it handed on
    metrics: Metrics
    seconds: float

    def options(self) -> dict[str, Any]:
        """Every option that counts, as the declaration itself dumps them, ready for JSON."""
        return options_of(self.stage)

    def size(self) -> str:
        """How large its mesh is, in words."""
        return size(self.flow.mesh)

    def goal(self) -> Goal | None:
        """The goal that a filter with an option of that name had, and whether its mesh meets it."""
        goal, mesh = goal_of(self.stage), self.flow.mesh
        if goal is None or not isinstance(mesh, TetMesh):
            return None
        missing = misses(mesh, quality.measure(mesh), goal)
        return Goal(self.stage.type(), goal, len(missing), int(missing.sum()), overlap(mesh) is None)


@dataclass(frozen=True, eq=False)
class Result:
    """What :meth:`wct_plugin.Pipeline.execute` gives; ``result["tag"]`` is the stage of that tag."""

    stages: tuple[StageResult, ...]  #: in the pipeline's order
    goals: tuple[Goal, ...]  #: of the last filter with a goal on each branch

    def __getitem__(self, tag: str) -> StageResult:
        tags = {stage.tag: stage for stage in self.stages if stage.tag}
        if tag not in tags:
            hint = did_you_mean(tag, tags)
            raise OptionError(f"no stage has the tag {tag!r}{hint} (tags: {', '.join(tags) or 'none'})")
        return tags[tag]

    @property
    def mesh(self) -> Mesh:
        """The mesh that the last stage handed on."""
        return self.stages[-1].flow.mesh

    @property
    def metrics(self) -> Mapping[str, Metrics]:
        """Metrics of each filter that the last mesh came through, by the filter's name (``name_2`` where it recurs)."""
        return self.stages[-1].flow.metrics

    @property
    def goal_met(self) -> bool:
        """Whether every goal is met; also if there is none."""
        return all(goal.met for goal in self.goals)

    def metadata(self) -> dict[str, Any]:
        """Everything but the meshes, ready for JSON: per stage options, metrics and seconds; goals; versions."""
        return {
            **environment(),
            "goal_met": self.goal_met,
            "goals": [vars(goal) for goal in self.goals],
            "stages": [
                {
                    "type": one.stage.type(),
                    **({"tag": one.tag} if one.tag else {}),
                    "options": one.options(),
                    "mesh": one.size(),
                    "metrics": plain(one.metrics),
                    "seconds": one.seconds,
                }
                for one in self.stages
            ],
        }


def options_of(stage: Stage[Options]) -> dict[str, Any]:
    """Every option that counts, as the declaration itself dumps them, ready for JSON."""
    given = stage.options
    return {name: plain(getattr(given, name)) for name in given.model_dump(warnings=False)}


@cache
def versions() -> Mapping[str, str]:
    """Versions of Python and of the packages that change a result, as installed."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # a neighbour that nothing has asked for
            continue
    return found


def environment() -> dict[str, Any]:
    """What a result depends on beside its input and options, ready for JSON."""
    return {"versions": dict(versions()), "platform": platform.platform()}


def plain(value: Any) -> Any:
    """Numbers, strings, lists and dicts, as JSON has them; None for what is not finite, a mesh as its file or size."""
    match value:
        case Mapping():
            return {str(key): plain(item) for key, item in value.items()}
        case list() | tuple():
            return [plain(item) for item in value]
        case np.ndarray() | np.generic():
            return plain(value.tolist())
        case float():
            return value if math.isfinite(value) else None
        case TetMesh():
            return value.source or f"<tet mesh of {len(value.tets)} tets>"
        case SurfaceMesh():
            return value.source or f"<surface of {len(value.triangles)} triangles>"
        case str() | int() | None:
            return value
        case _:
            return str(value)
