"""A stage of a pipeline: its name, what it takes and gives, its options declared once, and the registry of filters.

A filter is one file with two classes: an :class:`Options` model (unit, range, default and one-line help per option) and
a :class:`Filter` that runs on one mesh. The command line, the JSON check, Python signatures and the filter's page all
come from that one declaration. Filters register under the entry-point group ``wct_plugin.filters``.
"""

import difflib
import reprlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from wct_plugin.errors import OptionError, WctError
from wct_plugin.mesh import SurfaceMesh, TetMesh

Mesh = TetMesh | SurfaceMesh
Metrics = dict[str, Any]

GROUP = "wct_plugin.filters"


@dataclass(frozen=True)
class Progress:
    """Where a long filter stands: ``done`` in 0..1, ``bad`` the tets that miss the goal so far (None: unknown)."""

    stage: str
    done: float
    bad: int | None = None


#: Called now and then during long work; returning False stops it and keeps the best so far.
ProgressCallback = Callable[[Progress], bool | None]


class Options(BaseModel):
    """Base of every filter's options: unknown names are refused, values are checked, the instance is frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


O_co = TypeVar("O_co", bound=Options, covariant=True)


class Filter(ABC, Generic[O_co]):
    """One filter with checked options; :meth:`run` gives a new mesh and its metrics and never changes its input.

    Subclasses set :attr:`name`, :attr:`takes`, :attr:`gives`, :attr:`declaration` and say in the first line of their
    docstring what they do. Raises :class:`OptionError` for unknown options and values out of range.
    """

    name: ClassVar[str]
    takes: ClassVar[type[TetMesh] | type[SurfaceMesh]]
    gives: ClassVar[type[TetMesh] | type[SurfaceMesh]]
    declaration: ClassVar[type[Options]]

    def __init__(self, **options: Any) -> None:
        self.options: O_co = parse_options(self.declaration, options, f"filters.{self.name}")  # type: ignore[assignment]

    def __call__(self, mesh: Mesh, progress: ProgressCallback | None = None) -> tuple[Mesh, Metrics]:
        """Check that ``mesh`` is of the kind the filter takes and what it needs is there, then run."""
        self.check_takes(type(mesh))
        self.validate()
        return self.run(mesh, progress or _silent)

    def validate(self) -> None:
        """Check what needs more than the declaration: files, neighbours' names. Called before a pipeline runs anything.

        Raises :class:`WctError`. It may be called more than once.
        """

    @abstractmethod
    def run(self, mesh: Any, progress: ProgressCallback) -> tuple[Mesh, Metrics]:
        """Give the new mesh and a JSON-able dict of metrics."""

    @classmethod
    def check_takes(cls, kind: type[Mesh]) -> None:
        """Raise :class:`OptionError` unless the filter takes meshes of ``kind``."""
        if issubclass(kind, cls.takes):
            return
        maker = "generate_tetrahedralization" if kind is SurfaceMesh else "generate_boundary_surface"
        raise OptionError(
            f"filters.{cls.name} needs {_KINDS[cls.takes]}, here is {_KINDS[kind]}; put filters.{maker} before it"
        )

    @classmethod
    def summary(cls) -> str:
        """What the filter does, in one line."""
        return (cls.__doc__ or "").strip().splitlines()[0]


_KINDS: Mapping[type, str] = {TetMesh: "a tet mesh", SurfaceMesh: "a surface"}


def _silent(_: Progress) -> bool:
    return True


def parse_options(model: type[Options], values: Mapping[str, Any], owner: str) -> Options:
    """Check ``values`` against the declaration; the first fault becomes a one-line :class:`OptionError`."""
    try:
        return model(**values)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
    option = ".".join(str(part) for part in fault["loc"])
    message = fault["msg"].removeprefix("Value error, ")
    if not option:  # of the options together
        raise OptionError(f"{owner}: {message}")
    if fault["type"] == "extra_forbidden":
        known = list(model.model_fields)
        near = difflib.get_close_matches(option, known, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise OptionError(f"{owner}: unknown option {option!r}{hint} (allowed: {', '.join(known) or 'none'})")
    given = fault["input"]
    shown = repr(given) if isinstance(given, str | int | float) else " ".join(reprlib.repr(given).split())
    raise OptionError(f"{owner}: option {option!r} is {shown}; {message[:1].lower()}{message[1:]}")


def _entries() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)}


def filter_names() -> list[str]:
    """Names of every registered filter, ours and those of other packages, sorted."""
    return list(_entries())


def find_filter(name: str) -> type[Filter[Options]]:
    """Return the registered filter of that name, with or without the prefix ``filters.``.

    Raises :class:`OptionError` for an unknown name and :class:`WctError` for a filter that cannot be imported.
    """
    entries = _entries()
    short = name.removeprefix("filters.")
    if short not in entries:
        near = difflib.get_close_matches(short, entries, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise OptionError(f"unknown filter {name!r}{hint} (allowed: {', '.join(entries)})")
    entry = entries[short]
    try:
        found = entry.load()
    except Exception as error:  # a third party's import may fail in any way; the user wants to know whose it was
        raise WctError(
            f"filters.{short} ({entry.value}) cannot be imported: {type(error).__name__}: {error}"
        ) from error
    if not (isinstance(found, type) and issubclass(found, Filter)):
        raise WctError(f"filters.{short} ({entry.value}) is not a wct_plugin.stage.Filter")
    return found


def apply_filter(
    name: str, mesh: Mesh, /, *, progress: ProgressCallback | None = None, **options: Any
) -> tuple[Mesh, Metrics]:
    """Run one filter on ``mesh`` and give the new mesh and the filter's metrics; ``mesh`` stays as it is.

    >>> mesh, metrics = apply_filter("apply_coord_well_centering", mesh, boundary="slide")  # doctest: +SKIP
    """
    return find_filter(name)(**options)(mesh, progress)
