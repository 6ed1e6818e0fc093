"""What a pipeline has done: the last mesh, and per stage its options, metrics, mesh and seconds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.errors import OptionError
from wct_plugin.measure import compiled_quality
from wct_plugin.measure.goals import DUAL, FLAGS, misses
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.flow import Flow, size
from wct_plugin.pipeline.provenance import environment, options_of, plain
from wct_plugin.pipeline.stage import Mesh, Options, Stage, did_you_mean
from wct_plugin.types import Metrics


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
    most: int | None = None  #: tets allowed
    losses: tuple[str, ...] = ()  #: what of the domain was not kept
    stopped: bool = False  #: the work was cut short
    exhausted: bool = False  #: the search took all the work that the option effort allows
    needed: int | None = None  #: value of max_tets that a new start would have taken

    @property
    def met(self) -> bool:
        """Whether every tet meets the goal, in a valid mesh of no more tets than allowed, and the domain was kept."""
        return self.valid and not self.missed and not self.losses and not self._beyond

    @property
    def _beyond(self) -> bool:
        return self.most is not None and self.tets > self.most

    def __str__(self) -> str:
        said = ["tets overlap"] if not self.valid else []
        if self._beyond:
            said.append(f"{self.tets} tets, {self.most} are allowed")
        said.append(
            f"{self.missed} of {self.tets} tets miss the goal {self.goal}"
            if self.missed
            else f"all {self.tets} tets meet the goal {self.goal}"
        )
        if self.stopped:
            said.append("the work was stopped")
        elif self.missed and self.needed is not None:
            said.append(f"a new start would have taken more tets: max_tets={self.needed} allows it")
        elif self.missed and self.exhausted:
            said.append("the search ended at its limit of work; a larger effort goes on")
        return f"{self.stage}: " + "; ".join((*said, *self.losses))


@dataclass(frozen=True, eq=False)
class StageResult:
    """One stage after it has run."""

    stage: Stage[Options]
    tag: str
    flow: Flow  #: what it handed on
    metrics: Metrics
    seconds: float

    def __repr__(self) -> str:
        tag = f" {self.tag!r}" if self.tag else ""
        return f"<StageResult {self.stage.type()}{tag}: {self.size()}, {self.seconds:.1f} s>"

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
        missing = misses(mesh, compiled_quality.measure(mesh), goal)
        most = getattr(self.stage.options, "max_tets", None)
        losses = tuple(loss["text"] for loss in self.metrics.get("losses", ()))
        stopped, valid = bool(self.metrics.get("stopped")), overlap(mesh) is None
        return Goal(
            self.stage.type(),
            goal,
            len(missing),
            int(missing.sum()),
            valid,
            most,
            losses,
            stopped,
            exhausted=bool(self.metrics.get("exhausted")),
            needed=self.metrics.get("needed"),
        )


@dataclass(frozen=True, eq=False)
class Result:
    """What :meth:`wct_plugin.pipeline.pipeline.Pipeline.execute` gives; ``result["tag"]`` is the stage of that tag."""

    stages: tuple[StageResult, ...]  #: in the pipeline's order
    goals: tuple[Goal, ...]  #: of the last filter with a goal on each branch

    def __repr__(self) -> str:
        goals = "".join(f"; {goal}" for goal in self.goals)
        return f"<Result {' | '.join(one.stage.type() for one in self.stages)}: {self.stages[-1].size()}{goals}>"

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
