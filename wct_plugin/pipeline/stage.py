"""A stage of a pipeline: its name, what it takes and gives, its options declared once, and the registry of filters.

A filter is one file with two classes: an :class:`Options` model (unit, range, default and one-line help per option) and
a :class:`FilterStage` that runs on one mesh. The command line, the JSON check, Python signatures and the filter's page
all come from that one declaration. Filters register under the entry-point group ``wct_plugin.filters``.
"""

import difflib
import reprlib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from wct_plugin.errors import FractionError, OptionError, WctError
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.pipeline.faults import told_apart
from wct_plugin.pipeline.short_metrics import ShortMetrics
from wct_plugin.progress import ProgressCallback, ProgressChoice
from wct_plugin.types import Metrics
from wct_plugin.waiting.printed import told

Mesh = TetMesh | SurfaceMesh
Kind = type[TetMesh] | type[SurfaceMesh]

GROUP = "wct_plugin.filters"

#: What a pipeline says about any stage; no option may have one of these names.
RESERVED = ("type", "tag", "inputs")


class Options(BaseModel):
    """Base of every stage's options: unknown names are refused, values are checked, the instance is frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class OfDiagonal:
    """Marks an option, by ``Annotated``, that is a fraction of the bounding box's diagonal, and no length."""


#: Pydantic's names of faults of a number out of range.
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")

O_co = TypeVar("O_co", bound=Options, covariant=True)


class Stage(ABC, Generic[O_co]):
    """What readers, filters and writers have in common: a name, a declaration and checked options.

    Subclasses set :attr:`name` and :attr:`declaration` and say in the first line of their docstring what they do.
    Raises :class:`OptionError` for unknown options and values out of range.
    """

    family: ClassVar[str]  #: readers, filters or writers
    name: ClassVar[str]
    declaration: ClassVar[type[Options]]
    #: Options that a page shows as an example; those without a default must be among them.
    example: ClassVar[Mapping[str, Any]] = {}

    def __init__(self, **options: Any) -> None:
        self.options: O_co = parse_options(self.declaration, options, self.type())  # type: ignore[assignment]

    def __repr__(self) -> str:
        given = ((name, getattr(self.options, name)) for name in self.options.model_fields_set)
        shown = "".join(f" {name}={reprlib.repr(value)}" for name, value in sorted(given, key=lambda one: one[0]))
        return f"<{self.type()}{shown}>"

    def validate(self) -> None:
        """Check what needs more than the declaration: files, neighbours' names. Called before a pipeline runs anything.

        Raises :class:`WctError`. It may be called more than once.
        """

    @classmethod
    def prepare(cls, stages: Sequence[Any]) -> None:
        """Get at once what :meth:`validate` needs for all ``stages`` of this class in a pipeline; called before it.

        For those that would otherwise each start a neighbour only to be told what it takes.
        """

    @classmethod
    def starts(cls) -> bool:
        """Whether it takes no mesh, so that a pipeline or a branch of one begins with it."""
        return False

    @classmethod
    def type(cls) -> str:
        """The stage's name in a pipeline, such as ``filters.get_quality``."""
        return f"{cls.family}.{cls.name}"

    @classmethod
    def summary(cls) -> str:
        """What the stage does, in one line."""
        return (cls.__doc__ or "").strip().splitlines()[0]


class FilterStage(Stage[O_co]):
    """One filter with checked options; :meth:`run` gives a new mesh and its metrics and never changes its input.

    One that makes a mesh from nothing takes None, in the class and in :meth:`run`. Subclasses set :attr:`name`,
    :attr:`takes`, :attr:`gives`, :attr:`declaration` and say in the first line of their docstring what they do. Raises
    :class:`OptionError` for unknown options and values out of range.
    """

    family = "filters"
    takes: ClassVar[Kind | None]
    gives: ClassVar[Kind]
    measures: ClassVar[bool] = (
        False  #: whether its metrics are what :func:`~wct_plugin.reports.report.make_report` can reuse
    )

    def __call__(self, mesh: Any = None, progress: ProgressChoice = None) -> tuple[Mesh, Metrics]:
        """Check that ``mesh`` is of the kind the filter takes and what it needs is there, then run.

        ``mesh`` may be anything that :func:`wct_plugin.objects.conversions.as_mesh` takes; ``progress`` is called with
        where the work stands, and prints that where it is True. Raises
        :class:`wct_plugin.errors.InternalError` where the filter itself is at fault.
        """
        mesh = None if mesh is None else as_mesh(mesh)
        self.check_takes(None if mesh is None else type(mesh))
        self.validate()
        with told(progress) as callback:
            made, metrics = told_apart(self.run, mesh, callback)
        return made, ShortMetrics(metrics)

    @abstractmethod
    def run(self, mesh: Any, progress: ProgressCallback) -> tuple[Mesh, Metrics]:
        """Give the new mesh and a JSON-able dict of metrics."""

    @classmethod
    def starts(cls) -> bool:  # noqa: D102
        return cls.takes is None

    @classmethod
    def check_takes(cls, kind: Kind | None) -> None:
        """Raise :class:`OptionError` unless the filter takes meshes of ``kind``, or none where that is None."""
        if cls.takes is None:
            if kind is not None:
                raise OptionError(f"{cls.type()} makes a mesh from nothing and takes none, here is {KINDS[kind]}")
        elif kind is None:
            raise OptionError(f"{cls.type()} needs {KINDS[cls.takes]}, here is none")
        else:
            check_kind(cls.type(), cls.takes, kind)


#: Each kind of mesh in words.
KINDS: Mapping[Kind, str] = {TetMesh: "a tet mesh", SurfaceMesh: "a surface"}
_BRIDGES: Mapping[Kind, str] = {SurfaceMesh: "generate_tetrahedralization", TetMesh: "generate_boundary_surface"}


def check_kind(owner: str, needed: Kind, kind: Kind) -> None:
    """Raise :class:`OptionError` unless ``kind`` is what ``owner`` needs; it names the filter that gives that."""
    if issubclass(kind, needed):
        return
    hint = f"; put filters.{_BRIDGES[kind]} before it" if _BRIDGES[kind] in filter_names() else ""
    raise OptionError(f"{owner} needs {KINDS[needed]}, here is {KINDS[kind]}{hint}")


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Name the nearest of the ``known`` names, if one is near, as the rest of an error's message."""
    near = difflib.get_close_matches(name, list(known), 1)
    return f"; did you mean {near[0]!r}?" if near else ""


def parse_options(model: type[Options], values: Mapping[str, Any], owner: str) -> Options:
    """Check ``values`` against the declaration; the first fault becomes a one-line :class:`OptionError`."""
    try:
        return model(**values)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
    option = ".".join(str(part) for part in fault["loc"])
    if fault["type"] == "extra_forbidden":
        raise unknown_option(model, option, owner)
    if fault["type"] == "missing":
        raise OptionError(f"{owner}: option {option!r} is missing")
    message = fault["msg"].removeprefix("Value error, ")
    if not option:  # it is about several of them
        raise OptionError(f"{owner}: {message}")
    given = fault["input"]
    shown = repr(given) if isinstance(given, str | int | float) else " ".join(reprlib.repr(given).split())
    said = f"{owner}: option {option!r} is {shown}; {message[:1].lower()}{message[1:]}"
    field = model.model_fields.get(option)
    if field and fault["type"] in _BOUNDS and any(mark is OfDiagonal for mark in field.metadata):
        most = next((float(mark.le) for mark in field.metadata if hasattr(mark, "le")), None)
        raise FractionError(f"{said}: it is a fraction of the bounding box's diagonal", float(given), most)
    raise OptionError(said)


def unknown_option(model: type[Options], option: str, owner: str) -> OptionError:
    """The error that says which options ``owner`` has."""
    known = list(model.model_fields)
    hint = did_you_mean(option, known)
    return OptionError(f"{owner}: unknown option {option!r}{hint} (allowed: {', '.join(known) or 'none'})")


def _entries() -> dict[str, EntryPoint]:
    """Every registered filter by name; of two of one name, the one that is refused when it is looked up."""
    found: dict[str, EntryPoint] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)):
        first = found.get(entry.name)
        if first and first.value != entry.value:
            entry = EntryPoint(entry.name, f"{first.value} and {entry.value}", GROUP)
        found[entry.name] = entry
    return found


def filter_names() -> list[str]:
    """Names of every registered filter, ours and those of other packages, sorted."""
    return list(_entries())


def filter_places() -> dict[str, str]:
    """Where each registered filter is, as ``module:class``, by its name."""
    return {name: entry.value for name, entry in _entries().items()}


def find_filter(name: str) -> type[FilterStage[Options]]:
    """Return the registered filter of that name, with or without the prefix ``filters.``.

    Raises :class:`OptionError` for an unknown name and :class:`WctError` for a filter that cannot be imported.
    """
    entries = _entries()
    short = name.removeprefix("filters.")
    if short not in entries:
        raise OptionError(f"unknown filter {name!r}{did_you_mean(short, entries)} (allowed: {', '.join(entries)})")
    entry = entries[short]
    owner = f"filters.{short} ({entry.value})"
    if " and " in entry.value:
        raise WctError(f"{owner} is registered twice; uninstall one of the two packages")
    try:
        found = entry.load()
    except (Exception, SystemExit) as error:  # a third party's import may fail in any way; whose it was must be said
        raise WctError(f"{owner} cannot be imported: {type(error).__name__}: {' '.join(str(error).split())}") from error
    if not (isinstance(found, type) and issubclass(found, FilterStage)):
        raise WctError(f"{owner} is not a wct_plugin.plugins.FilterStage")
    if found.name != short:
        raise WctError(f"{owner} calls itself {found.name!r}; both names must be the same")
    if taken := [option for option in found.declaration.model_fields if option in RESERVED]:
        raise WctError(f"{owner} has an option {taken[0]!r}, which means something else in a pipeline")
    return found


def apply_filter(
    name: str, mesh: Any = None, /, *, progress: ProgressChoice = None, **options: Any
) -> tuple[Mesh, Metrics]:
    """Run one filter on ``mesh`` and give the new mesh and the filter's metrics; ``mesh`` stays as it is.

    The metrics are a dict that prints in short; ``print(dict(metrics))`` prints all of it.

    ``mesh`` may be one of other libraries too, see :func:`wct_plugin.objects.conversions.as_mesh`; the new one is ours.
    ``progress=True`` prints where the work stands; a function is called with it, and stops the work by giving False.

    >>> mesh, metrics = apply_filter("apply_coord_well_centering", mesh, boundary="slide")  # doctest: +SKIP
    >>> mesh, metrics = apply_filter("create_cube", variant="84")  # filters that make a mesh take none
    >>> len(mesh.tets)
    84
    """
    return find_filter(name)(**options)(mesh, progress)
