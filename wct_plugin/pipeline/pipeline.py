"""Stages in a row or with branches: checked as a whole before anything runs, then read, run and written.

>>> import wct_plugin as wct
>>> chain = wct.Filter.generate_tetrahedralization(edge_length=0.1) | wct.Filter.meshing_well_centered()
>>> result = (wct.Reader("bone.ply") | chain | wct.Writer("bone.vtu")).execute()  # doctest: +SKIP
>>> result.mesh, result.metrics["meshing_well_centered"]["deviation"]  # doctest: +SKIP
"""

import logging
import os
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from wct_plugin.errors import InternalError, OptionError, WctError
from wct_plugin.io.region_choice import Regions
from wct_plugin.objects.conversions import called
from wct_plugin.pipeline import json_form
from wct_plugin.pipeline.flow import Flow, size
from wct_plugin.pipeline.graph import Step, find_stage, label, order, unnamed, upstream, wire
from wct_plugin.pipeline.readers_writers import Reader, ReadMesh, WriteMesh, Writer, mesh_reader, writer_type
from wct_plugin.pipeline.result import Result, StageResult, goal_of
from wct_plugin.pipeline.stage import FilterStage, Kind, Options, Stage
from wct_plugin.progress import Progress, ProgressCallback, ProgressChoice
from wct_plugin.types import Metrics
from wct_plugin.waiting.printed import told

_log = logging.getLogger(__name__)


class Pipeline:
    """Steps in order; ``|`` joins two pipelines, or a pipeline and a stage.

    Nothing is checked before :meth:`check`, which :meth:`execute` begins with, but each stage's own options.
    """

    def __init__(self, steps: Iterable[Step] = ()) -> None:
        self.steps = tuple(steps)

    @classmethod
    def from_json(cls, content: Any, settings: Sequence[str] = ()) -> "Pipeline":
        """Make a pipeline of JSON text, or of the list or dict that it stands for.

        ``settings`` are ``stage.option=value``, the stage by its type or tag. Raises
        :class:`wct_plugin.errors.InputError` for what is no JSON and :class:`OptionError` for what is no pipeline.
        """
        return cls(json_form.parse(content, settings))

    def to_json(self) -> list[Any]:
        """The list that :meth:`from_json` makes this pipeline of; options that were not given stay out."""
        return json_form.form(self.steps)

    def __or__(self, other: "Pipeline | Stage[Any]") -> "Pipeline":
        behind = other.steps if isinstance(other, Pipeline) else (Step(other),)
        return Pipeline(self.steps + behind)

    def __ror__(self, other: Stage[Any]) -> "Pipeline":
        return Pipeline((Step(other), *self.steps))

    def __repr__(self) -> str:
        return f"<Pipeline {' | '.join(step.stage.type() for step in self.steps)}>"

    @property
    def is_open(self) -> bool:
        """Whether it needs a mesh or file put before it: it begins with a stage that takes what comes before."""
        return bool(self.steps) and not self.steps[0].stage.starts() and not self.steps[0].inputs

    def between(
        self,
        source: Any,
        targets: Iterable[str | Path] = (),
        *,
        regions: Regions = None,
        max_bytes: int | None = None,
        input_format: str | None = None,
        output_format: str | None = None,
    ) -> "Pipeline":
        """The pipeline with a reader of ``source``, a file or mesh, before it and writers of ``targets`` behind it.

        ``regions``: names of the array or sets that are the regions, and ``max_bytes`` as of :func:`wct_plugin.read`.
        The formats are suffixes, of files whose names do not tell them.
        """
        if self.steps and not self.is_open:
            given = source if isinstance(source, str | Path) else called(source)
            raise OptionError(f"{label(self.steps, 0)}: needs no input; only filters that take a mesh can have {given}")
        written = {} if output_format is None else {"format": output_format}
        ends = [Step(find_stage(writer_type(str(target)))(filename=target, **written)) for target in targets]
        reader = mesh_reader(source, regions, input_format=input_format, max_bytes=max_bytes)
        return Pipeline((Step(reader), *self.steps, *ends))

    def check(self, kinds: Iterable[Kind] | None = None, *, read: bool = False) -> None:
        """Check everything that can be checked before running: wiring, tags, files, formats and kinds of mesh.

        ``kinds``: those of the mesh that a pipeline without reader is meant for. ``read``: read the inputs too, as
        many a format can hold a tet mesh or a surface.
        """
        wires = wire(self.steps)
        if self.is_open and kinds is None:
            raise OptionError(f"{label(self.steps, 0)}: has no input; put a reader or a file before it")
        within_tolerance(self.steps, wires)
        _check_outputs(self.steps)
        _follow(self.steps, wires, {0: frozenset(kinds)} if self.is_open and kinds is not None else {})
        stages = [step.stage for step in self.steps]
        for index, stage in enumerate(stages):
            with _named(self.steps, index):
                stage.prepare([one for one in stages if type(one) is type(stage)])
                stage.validate()
        if read and not self.is_open:
            _read(self.steps, wires, [0.0] * len(self.steps), lambda _: True)

    def apply(self, mesh: Any, progress: ProgressChoice = None) -> Result:
        """Run a pipeline that has no reader on ``mesh``, of ours or of another library."""
        return self.between(mesh).execute(progress)

    def execute(self, progress: ProgressChoice = None) -> Result:
        """Check the pipeline, read every input, run the filters, and then, if none of them failed, write every output.

        Each file is written whole or not at all. ``progress=True`` prints where the work stands; a function is called
        with it, and stops the filter that is at work, which keeps its best, by giving False.
        """
        self.check()
        wires = wire(self.steps)
        stages = within_tolerance(self.steps, wires)
        steps = [replace(step, stage=stage) for step, stage in zip(self.steps, stages, strict=True)]
        with told(progress) as callback:
            return _executed(steps, wires, callback)


def _executed(steps: Sequence[Step], wires: Sequence[Sequence[int]], progress: ProgressCallback) -> Result:
    """Read, run and write."""
    seconds = [0.0] * len(steps)
    metrics = [Metrics() for _ in steps]
    flows = _read(steps, wires, seconds, progress)
    for index in order(steps, wires):
        stage = steps[index].stage
        if isinstance(stage, FilterStage):
            before = flows[wires[index][0]] if wires[index] else None
            with _timed(seconds, index), _named(steps, index):
                mesh, metrics[index] = stage(before.mesh if before else None, _placed(progress, steps, index))
            flows[index] = (before or Flow(mesh)).through(stage, mesh, metrics[index], seconds[index])
            _log.debug("%s: %.1f s, %s", label(steps, index), seconds[index], size(mesh))
        elif isinstance(stage, Writer):
            flows[index] = stage.pass_on(flows[wires[index][-1]])
    for index, step in enumerate(steps):
        if isinstance(step.stage, Writer):
            _placed(progress, steps, index)(Progress(f"writing {step.stage.filename}", 0.0))
            with _timed(seconds, index):
                step.stage.write({steps[k].tag or steps[k].stage.type(): flows[k] for k in wires[index]})
            _log.debug("%s: %.1f s, %s", label(steps, index), seconds[index], step.stage.filename)
    done = tuple(
        StageResult(step.stage, step.tag, flows[index], metrics[index], seconds[index])
        for index, step in enumerate(steps)
    )
    aims = [index for index, step in enumerate(steps) if goal_of(step.stage)]
    passed = {before for index in aims for before in upstream(wires, index)}
    goals = (done[index].goal() for index in aims if index not in passed)
    return Result(done, tuple(goal for goal in goals if goal))


def _placed(progress: ProgressCallback, steps: Sequence[Step], index: int) -> ProgressCallback:
    """The callback, told too which stage of how many is at work; its phases are logged."""
    said = ""

    def hear(state: Progress) -> bool | None:
        nonlocal said
        if state.stage != said:
            said = state.stage
            _log.debug("%s: %s", label(steps, index), said)
        return progress(replace(state, number=index + 1, count=len(steps)))

    return hear


def _read(
    steps: Sequence[Step], wires: Sequence[Sequence[int]], seconds: list[float], progress: ProgressCallback
) -> dict[int, Flow]:
    """What the readers give, found to be of the kinds that the other stages take."""
    flows: dict[int, Flow] = {}
    for index, step in enumerate(steps):
        if isinstance(step.stage, Reader):
            source = getattr(step.stage.options, "filename", None)
            _placed(progress, steps, index)(
                Progress(f"reading {source}" if isinstance(source, str) else "reading", 0.0)
            )
            with _timed(seconds, index):
                mesh = step.stage.read()
            flows[index] = Flow.of(step.stage, mesh, seconds[index])
    _follow(steps, wires, {index: frozenset({type(flow.mesh)}) for index, flow in flows.items()})
    for index, step in enumerate(steps):
        if isinstance(step.stage, Writer):
            with _named(steps, index):
                for flow in _arriving(steps, wires, flows, index):
                    step.stage.check_read(flow.mesh)
    return flows


def _arriving(
    steps: Sequence[Step], wires: Sequence[Sequence[int]], flows: Mapping[int, Flow], index: int
) -> list[Flow]:
    """What the readers gave that comes to a writer as a tet mesh all the way, with its groups."""
    behind = upstream(wires, index)
    filters = [step.stage for step in (steps[k] for k in behind) if isinstance(step.stage, FilterStage)]
    return [flows[k] for k in behind & flows.keys()] if all(one.takes is one.gives for one in filters) else []


@contextmanager
def _timed(seconds: list[float], index: int) -> Iterator[None]:
    start = time.perf_counter()
    yield
    seconds[index] += time.perf_counter() - start


@contextmanager
def _named(steps: Sequence[Step], index: int) -> Iterator[None]:
    """Put the stage's place and type before the message of what is raised."""
    try:
        yield
    except InternalError as error:
        error.add_note(f"in {label(steps, index)}")
        raise
    except WctError as error:
        error.args = (f"{label(steps, index)}: {unnamed(str(error), steps[index].stage.type())}", *error.args[1:])
        raise
    except Exception as error:  # a bug outside a filter's run: where it was helps
        error.add_note(f"in {label(steps, index)}")
        raise


def _check_outputs(steps: Sequence[Step]) -> None:
    """Refuse two outputs in one place, and reports and duals in that of an input; a better mesh may replace that."""
    inputs = {
        os.path.realpath(step.stage.options.filename): index
        for index, step in enumerate(steps)
        if isinstance(step.stage, ReadMesh) and isinstance(step.stage.options.filename, str)
    }
    seen: dict[str, int] = {}
    for index, step in enumerate(steps):
        if not isinstance(step.stage, Writer):
            continue
        target = os.path.realpath(step.stage.filename)
        if target in seen:
            raise OptionError(f"{label(steps, index)}: {label(steps, seen[target])} writes {step.stage.filename} too")
        if target in inputs and not isinstance(step.stage, WriteMesh):
            raise OptionError(f"{label(steps, index)}: {label(steps, inputs[target])} reads {step.stage.filename}")
        seen[target] = index


def _follow(steps: Sequence[Step], wires: Sequence[Sequence[int]], known: dict[int, frozenset[Kind]]) -> None:
    """Follow the kinds of mesh there may be from stage to stage; ``known`` are those readers give or the first takes.

    Raises the error of the first stage that can take none of them.
    """
    gives: dict[int, frozenset[Kind]] = {}
    for index in order(steps, wires):
        stage = steps[index].stage
        with _named(steps, index):
            if isinstance(stage, Reader):
                gives[index] = known.get(index) or stage.kinds()
                continue
            came = [gives[source] for source in wires[index]] or [known.get(index, frozenset())]
            able = [_able(stage, kinds) for kinds in came]
            gives[index] = frozenset({stage.gives}) if isinstance(stage, FilterStage) else able[-1]


def _able(stage: Stage[Options], kinds: frozenset[Kind]) -> frozenset[Kind]:
    assert isinstance(stage, FilterStage | Writer)
    able, refusal = set(), None
    for kind in sorted(kinds, key=lambda kind: kind.__name__):
        try:
            stage.check_takes(kind)
            able.add(kind)
        except WctError as error:
            refusal = error
    if refusal and not able:
        raise refusal
    return frozenset(able)


def within_tolerance(steps: Sequence[Step], wires: Sequence[Sequence[int]]) -> list[Stage[Options]]:
    """The stages, each mesher's ``epsilon`` lowered for the filters that its mesh goes through."""
    stages = [step.stage for step in steps]
    for index, stage in enumerate(stages):
        if isinstance(stage, FilterStage) and "epsilon" in stage.declaration.model_fields:
            behind = [stages[k] for k in range(len(steps)) if index in upstream(wires, k)]
            with _named(steps, index):
                stages[index] = mesher_within_tolerance(stage, *(one for one in behind if isinstance(one, FilterStage)))
    return stages


def mesher_within_tolerance(mesher: FilterStage[Options], *optimizers: FilterStage[Options]) -> FilterStage[Options]:
    """The ``mesher`` with an ``epsilon`` of at most half the ``tolerance`` given to an optimizer, which is for both.

    An epsilon that was not given is lowered where need be; one that was raises :class:`OptionError` if too large.
    A mesher that has none keeps the surface as it is.
    """
    epsilon = mesher.options.model_dump().get("epsilon")
    given = [
        getattr(one.options, "tolerance", None) for one in optimizers if "tolerance" in one.options.model_fields_set
    ]
    tolerance = min((float(value) for value in given if value is not None), default=None)
    if tolerance is None or epsilon is None or epsilon <= tolerance / 2:
        return mesher
    if "epsilon" in mesher.options.model_fields_set:
        raise OptionError(
            f"{mesher.type()}: option 'epsilon' is {epsilon:g}; "
            f"of the tolerance of {tolerance:g} it may take half, {tolerance / 2:g}"
        )
    return type(mesher)(**mesher.options.model_dump(exclude_unset=True) | {"epsilon": tolerance / 2})
