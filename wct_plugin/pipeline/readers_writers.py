"""The ends of a pipeline: stages that read a mesh, and stages that write a mesh, its report or its dual."""

import json
import os
from abc import abstractmethod
from collections.abc import Mapping
from copy import copy
from pathlib import Path
from typing import Any, ClassVar, Literal

from pydantic import (
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    field_validator,
    model_serializer,
)

from wct_plugin.duals import dual_files
from wct_plugin.duals.dual_files import DualFormat
from wct_plugin.errors import InputError, OutputError
from wct_plugin.io import atomic_files, check_groups, check_order, formats, read, write
from wct_plugin.io.gmsh_options import MshOptions, number_as_text
from wct_plugin.io.region_choice import Regions
from wct_plugin.io.standard_streams import STREAM, check_target
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.pipeline.flow import Flow, side_by_side
from wct_plugin.pipeline.provenance import plain
from wct_plugin.pipeline.remaking import provenance, remaking
from wct_plugin.pipeline.stage import Kind, Mesh, O_co, Options, Stage, check_kind
from wct_plugin.reports import html_report

_REPORTS = (".html", ".json")


class Reader(Stage[O_co]):
    """Gives the mesh that a pipeline starts from."""

    family = "readers"

    @classmethod
    def starts(cls) -> bool:  # noqa: D102
        return True

    @abstractmethod
    def kinds(self) -> frozenset[Kind]:
        """The kinds of mesh it may give, as far as known before it has read."""

    @abstractmethod
    def read(self) -> Mesh:
        """Give the mesh."""


class Writer(Stage[O_co]):
    """Writes what comes in and hands it on."""

    family = "writers"
    many: ClassVar[bool] = False  #: whether it takes several meshes at once
    reserved: ClassVar[frozenset[str]] = frozenset()  #: tags that these cannot have

    @property
    @abstractmethod
    def filename(self) -> str:
        """The file it writes."""

    @abstractmethod
    def check_takes(self, kind: Kind) -> None:
        """Raise a :class:`~wct_plugin.errors.WctError` unless it can write meshes of ``kind``."""

    def check_read(self, mesh: Mesh) -> None:
        """Raise a :class:`~wct_plugin.errors.WctError` if a mesh with the groups of ``mesh`` cannot be written.

        Called with what a reader gave, before filters that keep the groups run.
        """

    @abstractmethod
    def pass_on(self, flow: Flow) -> Flow:
        """What goes on to the next stage."""

    @abstractmethod
    def write(self, flows: Mapping[str, Flow]) -> None:
        """Write the meshes or what is to be said of them; they come by tag, or by type where they have none."""


def _path(value: Any) -> Any:
    return os.fspath(value) if isinstance(value, os.PathLike) else value


class FileOptions(Options):
    """A file by name; relative names start at the working directory."""

    filename: str = Field(min_length=1, description="The file; its suffix tells the format")

    _as_text = field_validator("filename", mode="before")(_path)


class SourceOptions(Options):
    """A file by name, or from Python a mesh, of ours or of another library."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    regions: str | list[str] | None = Field(
        None,
        description="What the regions are: the name of an array of whole numbers, or names of sets of tets"
        " (none: as the file says it)",
    )
    filename: Any = Field(
        description="The file, - for standard input; its suffix tells the format",
        json_schema_extra={"type": "string", "minLength": 1},
    )
    format: str | None = Field(
        None, description="Suffix of the format, as vtu, of a file whose name does not tell it (none: it does)"
    )
    repair: bool = Field(False, description="Drop or mend broken tets: repeated, flat, or with a vertex twice")
    max_bytes: int | None = Field(
        None,
        ge=1,
        description="Most bytes that packed or declared arrays may become (none: 100 times the files, or 256 MiB)",
    )

    @field_validator("filename", mode="before")
    @classmethod
    def _name_or_mesh(cls, value: Any, others: ValidationInfo) -> Any:
        value = _path(value)
        if isinstance(value, str) and value:
            return value
        if isinstance(value, str | bool | int | float | dict | None):  # as JSON may have it
            raise ValueError("must be the name of a mesh file")
        return as_mesh(value, regions=others.data.get("regions"))

    @model_serializer(mode="wrap")
    def _that_counts(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """What the file says by itself is no option that counts."""
        unset = ("regions", "max_bytes")
        return {name: value for name, value in dump(self).items() if name not in unset or value is not None}


class ReadMesh(Reader[SourceOptions]):
    """Read a surface or tet mesh in any format of :func:`wct_plugin.read`."""

    name = "mesh"
    declaration = SourceOptions

    def kinds(self) -> frozenset[Kind]:  # noqa: D102
        given = self.options.filename
        if not isinstance(given, str):
            return frozenset({type(given)})
        form = formats.to_read(Path(given), self.options.format)
        able: dict[Kind, bool] = {TetMesh: form.volume, SurfaceMesh: form.surface}
        return frozenset(kind for kind, can in able.items() if can)

    def validate(self) -> None:  # noqa: D102
        given = self.options.filename
        if isinstance(given, str):
            formats.to_read(Path(given), self.options.format)
            if given != STREAM and not Path(given).exists():
                raise InputError(f"{given}: no such file")

    def read(self) -> Mesh:  # noqa: D102
        given: Mesh | str = self.options.filename
        if not isinstance(given, str):
            return given
        wanted = self.options
        return read(
            given,
            suffix=wanted.format,
            regions=wanted.regions,
            repair=wanted.repair,
            max_bytes=wanted.max_bytes,
        )

    def holding(self, mesh: Mesh) -> "ReadMesh":
        """The same with what its file gave already, which it does not read again."""
        held = copy(self)
        held.options = self.options.model_copy(update={"filename": mesh})
        return held


class TargetOptions(FileOptions):
    """A mesh file by name."""

    filename: str = Field(min_length=1, description="The file, - for standard output; its suffix tells the format")
    format: str | None = Field(
        None, description="Suffix of the format, as vtu, of a file whose name does not tell it (none: it does)"
    )


class MeshFileOptions(TargetOptions):
    """A mesh file by name, with or without mid nodes, and how it is written if it is gmsh's."""

    order: Literal[1, 2] | None = Field(
        None, description="2: tets with nodes in the middle of their edges (none: as the tets that were read)"
    )

    version: Literal["2.2", "4.1"] | None = Field(
        None, description="Version of a .msh file (none: 2.2, or 4.1 where cells are in several groups)"
    )
    binary: bool | None = Field(None, description="Whether a .msh file is binary (none: it is text)")
    groups: Literal["all", "first"] | None = Field(
        None, description="Groups that a cell in several keeps in a .msh file (none: all)"
    )

    _version = field_validator("version", mode="before")(number_as_text)

    @property
    def msh(self) -> MshOptions:
        """The options of gmsh files alone."""
        return MshOptions(self.version, self.binary, self.groups)


class WriteMesh(Writer[MeshFileOptions]):
    """Write the mesh in any format of :func:`wct_plugin.write` and hand it on."""

    name = "mesh"
    declaration = MeshFileOptions

    @property
    def filename(self) -> str:  # noqa: D102
        return self.options.filename

    def validate(self) -> None:  # noqa: D102
        if self.filename != STREAM:
            atomic_files.check_writable(self.filename)

    def check_takes(self, kind: Kind) -> None:  # noqa: D102
        form = formats.to_write(Path(self.filename), volume=kind is TetMesh, suffix=self.options.format)
        self.options.msh.check(self.filename, form)
        check_target(self.filename, form, self.options.format)
        check_order(self.filename, form, self.options.order, volume=kind is TetMesh)

    def check_read(self, mesh: Mesh) -> None:  # noqa: D102
        if isinstance(mesh, TetMesh):
            check_groups(self.filename, mesh, self.options.msh, self.options.format)

    def pass_on(self, flow: Flow) -> Flow:  # noqa: D102
        return flow.into(self.filename)

    def write(self, flows: Mapping[str, Flow]) -> None:  # noqa: D102
        (flow,) = flows.values()
        msh = self.options.msh
        options = self.options
        write(
            self.filename,
            flow.mesh,
            version=msh.version,
            binary=msh.binary,
            groups=msh.groups,
            order=options.order,
            suffix=options.format,
        )


class ReportOptions(FileOptions):
    """Where the report goes and what it lists."""

    filename: str = Field(min_length=1, description="The file to write")
    format: Literal["html", "json"] | None = Field(
        None, description="html: a page that needs nothing else; json: numbers (none: as the file's suffix says)"
    )
    worst: int = Field(10, ge=0, description="How many of the worst tets to list")


class WriteReport(Writer[ReportOptions]):
    """Write the report of a tet mesh, or of several side by side, as an HTML page or as JSON, and hand the last one on.

    JSON of one mesh is the object that ``wct report --json`` gives. JSON of several has the reports under their tags,
    and of the last one under ``filters`` the metrics of the filters it came through and under ``provenance`` its
    stages with options and seconds, and the versions. All are measured against the reference of the last one.
    """

    name = "report"
    declaration = ReportOptions
    many = True
    reserved = frozenset({"filters", "provenance"})  # beside the tags in the JSON

    @property
    def filename(self) -> str:  # noqa: D102
        return self.options.filename

    def _is_page(self) -> bool:
        suffix = Path(self.filename).suffix.lower()
        if self.options.format is None and suffix not in _REPORTS:
            raise OutputError(f"{self.filename}: unknown suffix {suffix!r}; allowed are {' '.join(_REPORTS)}")
        return (self.options.format or suffix.removeprefix(".")) == "html"

    def validate(self) -> None:  # noqa: D102
        if self._is_page():
            html_report.check_available()
        atomic_files.check_writable(self.filename)

    def check_takes(self, kind: Kind) -> None:  # noqa: D102
        check_kind(self.type(), TetMesh, kind)

    def pass_on(self, flow: Flow) -> Flow:  # noqa: D102
        return flow

    def write(self, flows: Mapping[str, Flow]) -> None:  # noqa: D102
        if self._is_page():
            text = _page(flows, self.options.worst)
        else:
            text = json.dumps(report_content(flows, self.options.worst), indent=2)
        with atomic_files.replacing(self.filename) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _page(flows: Mapping[str, Flow], worst: int) -> str:
    reports, last = side_by_side(flows, worst), list(flows.values())[-1]
    sources = [Path(one.source).name for one in reports.values() if one.source]
    return html_report.html(
        list(reports.values()),
        " → ".join(sources) or "Report",
        names=list(reports),
        meshes=[flow.mesh for flow in flows.values() if isinstance(flow.mesh, TetMesh)],
        made=provenance(last) | {"again": remaking(last)},
    )


def report_content(flows: Mapping[str, Flow], worst: int = 10) -> dict[str, Any]:
    """What :class:`WriteReport` writes as JSON."""
    reports = {name: one.to_dict() for name, one in side_by_side(flows, worst).items()}
    if len(reports) == 1:
        return next(iter(reports.values()))
    last = list(flows.values())[-1]
    return {**reports, "filters": plain(last.metrics), "provenance": provenance(last)}


class DualOptions(FileOptions):
    """Where the dual goes, and in what form."""

    filename: str = Field(min_length=1, description="The file, NAME.vtu or NAME.npz, or the folder to write")
    format: DualFormat | None = Field(
        None,
        description="vtu: polyhedra; openfoam: polyMesh in a folder; npz, matrix-market: Hodge stars and derivatives"
        " (none: as the suffix says, a folder is openfoam)",
    )


class WriteDual(Writer[DualOptions]):
    """Write the circumcentric dual of a tet mesh, as Voronoi cells or as Hodge stars, and hand the mesh on.

    Voronoi cells: NAME.vtu, or constant/polyMesh in a folder, which is OpenFOAM's. Hodge stars and exterior
    derivatives: NAME.npz, or Matrix Market files in a folder.
    """

    name = "dual"
    declaration = DualOptions

    @property
    def filename(self) -> str:  # noqa: D102
        return self.options.filename

    def validate(self) -> None:  # noqa: D102
        form = dual_files.format_of(self.filename, self.options.format)
        dual_files.check_dual_writable(self.filename, form)

    def check_takes(self, kind: Kind) -> None:  # noqa: D102
        check_kind(self.type(), TetMesh, kind)

    def pass_on(self, flow: Flow) -> Flow:  # noqa: D102
        return flow

    def write(self, flows: Mapping[str, Flow]) -> None:  # noqa: D102
        (flow,) = flows.values()
        dual_files.write_dual(self.filename, flow.mesh, format=self.options.format)


#: Every reader and writer by type.
ENDS: Mapping[str, type[Reader[Options]] | type[Writer[Options]]] = {
    end.type(): end for end in (ReadMesh, WriteMesh, WriteReport, WriteDual)
}


def mesh_reader(
    source: Any,
    regions: Regions = None,
    *,
    input_format: str | None = None,
    repair: bool = False,
    max_bytes: int | None = None,
) -> ReadMesh:
    """The reader of a mesh or file, with those options that are given."""
    options: dict[str, Any] = {} if input_format is None else {"format": input_format}
    if regions is not None:
        options["regions"] = regions if isinstance(regions, str) else list(regions)
    options |= {"repair": True} if repair else {}
    options |= {} if max_bytes is None else {"max_bytes": max_bytes}
    return ReadMesh(filename=source, **options)


def writer_type(filename: str) -> str:
    """The type of writer that a file's name alone asks for."""
    return (WriteReport if Path(filename).suffix.lower() in _REPORTS else WriteMesh).type()
