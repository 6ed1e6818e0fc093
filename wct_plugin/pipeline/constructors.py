"""``wct.Reader``, ``wct.Filter`` and ``wct.Writer``: a pipeline of one stage per call, with the declared options.

>>> import inspect, wct_plugin as wct
>>> wct.Reader("bone.ply") | wct.Filter.generate_tetrahedralization() | wct.Writer("bone.vtu")
<Pipeline readers.mesh | filters.generate_tetrahedralization | writers.mesh>
>>> list(inspect.signature(wct.Filter.get_quality).parameters)
['worst', 'tag', 'inputs']
"""

import inspect
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from wct_plugin.errors import OptionError
from wct_plugin.pipeline import stage_page
from wct_plugin.pipeline.graph import Step, find_stage
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import ENDS, ReadMesh, writer_type
from wct_plugin.pipeline.stage import Options, Stage, did_you_mean, filter_names


class Filters:
    """The registered filters as functions: ``wct.Filter.NAME(option=value, ...)`` is a pipeline of one stage.

    Each takes ``tag`` and ``inputs`` too, for branches.
    """

    _family = "filters"

    def __dir__(self) -> list[str]:
        return filter_names()

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(dir(self))}>"

    def __getattr__(self, name: str) -> Callable[..., Pipeline]:
        if name not in dir(self):
            raise AttributeError(f"there is no {self._family}.{name}{did_you_mean(name, dir(self))}")
        return _constructor(find_stage(f"{self._family}.{name}"))


class _Ends(Filters):
    def __dir__(self) -> list[str]:
        return [one.name for one in ENDS.values() if one.family == self._family]


class Readers(_Ends):
    """``wct.Reader(file)`` reads a mesh, ``wct.Reader(mesh)`` takes one of ours or of another library.

    Options of ``readers.mesh`` may follow: ``wct.Reader("part.vtu", regions="zone")``.
    """

    _family = "readers"

    def __call__(self, source: Any, *, tag: str = "", **options: Any) -> Pipeline:
        """Give a pipeline that begins with ``source``."""
        return Pipeline([Step(ReadMesh(filename=source, **options), tag)])


class Writers(_Ends):
    """``wct.Writer(file)`` writes the mesh, or its report if the name ends in .html or .json.

    Options of ``writers.mesh`` or ``writers.report`` may follow: ``wct.Writer("part.msh", binary=True)``.
    """

    _family = "writers"

    def __call__(
        self, target: str | Path, *, tag: str = "", inputs: str | Sequence[str] = (), **options: Any
    ) -> Pipeline:
        """Give a pipeline that writes ``target`` and hands the mesh on."""
        writer = find_stage(writer_type(str(target)))(filename=target, **options)
        return Pipeline([Step(writer, tag, _tags(inputs))])


def _tags(inputs: str | Iterable[str]) -> tuple[str, ...]:
    return (inputs,) if isinstance(inputs, str) else tuple(inputs)


def _constructor(stage: type[Stage[Options]]) -> Callable[..., Pipeline]:
    def construct(*given: Any, tag: str = "", inputs: str | Sequence[str] = (), **options: Any) -> Pipeline:
        if given:
            raise OptionError(f"{stage.type()} takes its options by name only, as option=value")
        return Pipeline([Step(stage(**options), tag, _tags(inputs))])

    declared = list(inspect.signature(stage.declaration).parameters.values())
    extra = [inspect.Parameter("tag", inspect.Parameter.KEYWORD_ONLY, default="", annotation=str)]
    if not stage.starts():
        inputs = inspect.Parameter("inputs", inspect.Parameter.KEYWORD_ONLY, default=(), annotation=str | Sequence[str])
        extra.append(inputs)
    construct.__name__ = construct.__qualname__ = stage.name
    construct.__doc__ = stage_page.docstring(stage)
    construct.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [*declared, *extra], return_annotation=Pipeline
    )
    return construct


Reader = Readers()
Filter = Filters()
Writer = Writers()
