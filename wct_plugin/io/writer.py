"""A :class:`TetMesh` or :class:`SurfaceMesh` becomes a file; what its format cannot carry is named in one warning."""

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import ObjectError, OutputError, WctWarning
from wct_plugin.io import abaqus_names, beside_tets, formats, gmsh_version, med_families, medit_sections, mid_nodes
from wct_plugin.io.assembly import ENTITIES, SET, TAGS, gmsh_entities
from wct_plugin.io.atomic_files import replacing
from wct_plugin.io.blocks import Block
from wct_plugin.io.compressed import packing
from wct_plugin.io.formats import PYVISTA, Format
from wct_plugin.io.gmsh_options import MshOptions
from wct_plugin.io.meshio_writers import Content, attribute, save
from wct_plugin.io.periodic_sides import numbered, sides_of
from wct_plugin.io.standard_streams import STREAM, check_target, to_stdout
from wct_plugin.io.written_names import as_sets, fits_xml, fitting, with_positive_tags
from wct_plugin.io.written_regions import shared_type, tags_and_arrays
from wct_plugin.mesh import SurfaceMesh, TetMesh, cell_kinds

#: The array that holds the tags, for formats that have one for this.
_TAG = {
    "gmsh": "gmsh:physical", "MED": "cell_tags", "Medit": "medit:ref", "Nastran": "nastran:ref", "SU2": "su2:tag",
    "TetGen": "tetgen:ref",
}  # fmt: skip
_CALLED = {"tetra": "tets", "triangle": "tagged facets", "line": "tagged edges", "vertex": "tagged vertices"}


def _called(kind: str) -> str:
    return _CALLED.get(kind, f"{kind} cells")


def write(
    path: str | Path,
    mesh: TetMesh | SurfaceMesh,
    *,
    version: str | None = None,
    binary: bool | None = None,
    groups: str | None = None,
    order: int | None = None,
    suffix: str | None = None,
) -> None:
    """Write a mesh in the format of the path's suffix, whole or not at all; the mesh is left as it is.

    Formats with one array for all cells get zeros (integers) or NaN where a kind of cell lacks an array. Named sets
    become arrays ``set:NAME`` where a format has arrays but no sets.

    Parameters
    ----------
    path : str or Path
        The file to write, packed by gzip if it ends in ``.gz``. ``-`` is standard output.
    mesh : TetMesh or SurfaceMesh
        What to write.
    version : {"2.2", "4.1"}, optional
        Of a gmsh file. Without it 2.2, which most programs read, or 4.1 where cells are in several physical groups,
        which 2.2 does not have.
    binary : bool, optional
        Whether a gmsh file is binary. Without it it is text, which most programs read.
    groups : {"all", "first"}, optional
        What becomes of cells in several physical groups in a gmsh file: "all" keeps them there, "first" keeps the first
        group of each. Without it all.
    order : {1, 2}, optional
        2: tets and what is tagged on them have nodes in the middle of their edges. They are where they were on edges
        that stayed, on the curved surface that was read on its new edges, and half way elsewhere. Without it 2 where
        the tets that were read had them and the format has such cells.
    suffix : str, optional
        The suffix that tells the format, as ``vtu``, where the name does not.

    Warns
    -----
    WctWarning
        Once, naming everything the format cannot carry; once if cells in several groups make a gmsh file one of
        version 4.1, or lose groups; once for mid nodes.

    Raises
    ------
    ObjectError
        If ``mesh`` is another library's.
    OptionError
        If an option has a value that is not allowed, or is given for another format than gmsh's.
    OutputError
        If the suffix is unknown, the format cannot carry such a mesh, or the file cannot be written; and if ``version``
        is "2.2" and cells are in several groups, unless ``groups`` is "first".
    """
    if not isinstance(mesh, TetMesh | SurfaceMesh):
        raise ObjectError(
            f"{path}: is given a {type(mesh).__name__}; wct_plugin.as_mesh makes a mesh of what can be one"
        )
    file = Path(path)
    form = formats.to_write(file, volume=isinstance(mesh, TetMesh), suffix=suffix)
    msh = MshOptions(version, binary, groups)
    msh.check(path, form)
    second = mid_nodes.are_wanted(path, form, mesh, order)
    content, lost = contents(mesh, form)
    told: list[str] = []
    if form.name == "gmsh":
        msh, told = _settled(path, content, msh)
    if isinstance(mesh, TetMesh) and second:
        told.append(mid_nodes.put(content, mesh, form))
    elif isinstance(mesh, TetMesh) and mesh.second_order and order is None:
        lost.append("mid nodes of edges")
    with _target(path, form, suffix) as temporary:
        try:
            lost += save(temporary, form, mesh, content, msh)
        except (OSError, MemoryError, OutputError):
            raise
        except Exception as error:  # any at all: meshio's writers convert without looking
            reason = " ".join(str(error).split("\n", 1)[0].split())[:200]
            raise OutputError(f"{path}: cannot be written as {form.name}: {type(error).__name__}: {reason}") from error
    if lost:
        warnings.warn(f"{path}: {form.name} cannot carry, so dropped: {', '.join(lost)}", WctWarning, stacklevel=2)
    for line in told:
        warnings.warn(f"{path}: {line}", WctWarning, stacklevel=2)


@contextmanager
def _target(path: str | Path, form: Format, suffix: str | None) -> Iterator[Path]:
    """Where the file is to be written that afterwards is what ``path`` says, in the place it says."""
    check_target(path, form, suffix)
    name = "".join(formats.meant(Path(path), suffix).suffixes)
    with to_stdout(name) if str(path) == STREAM else replacing(path) as temporary:
        named = temporary if suffix is None else temporary.with_name(f"output{name}")
        with packing(named, form) as plain:
            yield plain
        if named != temporary:
            named.replace(temporary)


def check_groups(path: str | Path, mesh: TetMesh, msh: MshOptions, suffix: str | None = None) -> None:
    """Raise the error that :func:`write` would raise for the groups of the mesh; for use before long work."""
    form = formats.to_write(Path(path), volume=True, suffix=suffix)
    if form.name == "gmsh" and msh.version == "2.2":
        _settled(path, contents(mesh, form)[0], msh)


def _settled(path: str | Path, content: Content, msh: MshOptions) -> tuple[MshOptions, list[str]]:
    try:
        return gmsh_version.settle(content, msh)
    except OutputError as error:
        raise OutputError(f"{path}: {error}") from None


def contents(mesh: TetMesh | SurfaceMesh, form: Format) -> tuple[Content, list[str]]:
    """What of the mesh the format can carry, as meshio wants it, and the names of all else."""
    lost: list[str] = []
    if isinstance(mesh, TetMesh) and mesh.others and not set(mesh.others.cells) & set(form.others):
        lost += [f"{len(cells)} {_called(kind)}" for kind, cells in mesh.others.cells.items()]
        mesh = replace(mesh, others=None)
    blocks = [block for block in _blocks(mesh, form) if _fits(block, form, lost)]
    points = given = beside_tets.points_of(mesh)
    if form.name == "Nastran":
        points = _rounded(given)
        if (points != given).any():
            lost.append("digits of coordinates beyond what 16 characters hold")
    content = Content(points, [(block.kind, np.array(block.cells)) for block in blocks])
    _put_point_data(content, mesh, form, lost)
    _put_cell_data(content, blocks, form, lost)
    names = dict(mesh.names) if isinstance(mesh, TetMesh) else {}
    if form.name == "gmsh":
        names, changed = with_positive_tags(blocks, names)
        families = isinstance(mesh, TetMesh) and mesh.tag_name == med_families.TAGS  # these say nothing by their number
        lost += [] if families else changed
    _put_tags(content, blocks, mesh, form, lost)
    point_sets = beside_tets.point_sets_of(mesh) if isinstance(mesh, TetMesh) else {}
    if form.name == "gmsh" and isinstance(mesh, TetMesh):
        content.groups = {block.kind: _take_groups(block, names) for block in blocks}
    kept = fitting(form, blocks, names)
    if form.name == "Abaqus":
        kept, content.comments = as_sets(blocks, names)
        content.types = dict(mesh.element_types) if isinstance(mesh, TetMesh) else {}
    _put_sets(content, blocks, point_sets, form, lost)
    if isinstance(mesh, TetMesh) and mesh.periodic:
        _put_periodic(content, mesh, form, lost)
    content.names = {name: np.array(pair, dtype=np.int64) for name, pair in kept.items()}
    lost += [f"name {name!r}" for name in names if name not in kept and name not in _sets_as_arrays(content)]
    return content, lost


def _sets_as_arrays(content: Content) -> set[str]:
    """Names of the sets of cells that are written as arrays."""
    return {unquote(name)[len(SET) :] for name in content.cell_data if name.startswith(SET)}


def _rounded(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coordinates as Nastran's fields of 16 characters hold them; meshio fails on longer ones."""

    def fitting(value: float) -> float:
        texts = (np.format_float_scientific(value, exp_digits=1, precision=digits) for digits in range(11, 0, -1))
        return float(next(text for text in texts if len(text) <= 16))

    return np.array([fitting(value) for value in points.ravel().tolist()]).reshape(points.shape)


def _blocks(mesh: TetMesh | SurfaceMesh, form: Format) -> list[Block]:
    if isinstance(mesh, SurfaceMesh):
        return [Block("triangle", mesh.triangles, mesh.tags, dict(mesh.cell_data), {})]
    tags, arrays = tags_and_arrays(mesh, native=form.sets or form.name in _TAG)
    blocks = [Block("tetra", mesh.tets, tags, arrays, dict(mesh.tet_sets))]
    for kind, cells in beside_tets.tagged_cells(mesh).items():
        blocks.append(Block(kind, cells.vertices, cells.tags, dict(cells.data), dict(cells.sets)))
    return blocks


def _fits(block: Block, form: Format, lost: list[str]) -> bool:
    count = 0 if block.kind in form.cells or block.kind in form.others else len(block.cells)
    if form.name == "Medit" and block.kind == "vertex":  # it has vertices of which something is said, and no others
        said = [members for name, members in block.sets.items() if medit_sections.set_of(name, "vertex")]
        count = len(block.cells) - len(np.unique(np.concatenate([*said, np.empty(0, dtype=np.int64)])))
    if count:
        lost.append(f"{count} {_called(block.kind)}")
    return count < len(block.cells)


def _put_point_data(content: Content, mesh: TetMesh | SurfaceMesh, form: Format, lost: list[str]) -> None:
    own = {"Medit": "medit:ref", "TetGen": "tetgen:ref"}.get(form.name)
    for name, values in beside_tets.point_data_of(mesh).items():
        if name == own and values.dtype.kind in "iu" and values.ndim == 1:
            content.point_data[name] = np.array(values)
            continue
        array = _array(name, values, form) if form.point_data else None
        if array is None:
            lost.append(f"point data {name!r}")
        else:
            content.point_data[_spelled(name, form)] = array
    if form.name == "Medit" and not content.point_data:  # meshio would give every point a 1
        content.point_data["medit:ref"] = np.zeros(len(content.points), dtype=np.int64)


def _put_cell_data(content: Content, blocks: list[Block], form: Format, lost: list[str]) -> None:
    """One array for all blocks, as meshio wants it; zeros or NaN where a block has none."""
    for name in dict.fromkeys(name for block in blocks for name in block.data):
        owners = [block.data[name] for block in blocks if name in block.data]
        arrays = [_array(name, values, form) for values in owners] if form.cell_data else [None]
        if any(array is None for array in arrays) or len({values.shape[1:] for values in owners}) > 1:
            lost.append(f"cell data {name!r}")
            continue
        dtype = np.result_type(*[array for array in arrays if array is not None])
        tail = next(array for array in arrays if array is not None).shape[1:]
        columns = []
        for block in blocks:
            fill = np.nan if dtype.kind == "f" else 0
            column = np.full((len(block.cells), *tail), fill, dtype=dtype)
            if name in block.data:
                column[...] = _array(name, block.data[name], form)
            columns.append(column)
        content.cell_data[_spelled(name, form)] = columns


def _put_tags(
    content: Content, blocks: list[Block], mesh: TetMesh | SurfaceMesh, form: Format, lost: list[str]
) -> None:
    # Under another name than a conventional one they would not be read as tags again.
    known = isinstance(mesh, TetMesh) and mesh.tag_name in (*TAGS, mesh.region_name, *mesh.cell_data)
    meant = mesh.tag_name if isinstance(mesh, TetMesh) and known else "gmsh:physical"
    tags = [block.tags if _keeps_tags(block.kind, form) else np.zeros_like(block.tags) for block in blocks]
    for block, kept in zip(blocks, tags, strict=True):
        if (block.tags != kept).any():
            lost.append("regions" if block.kind == "tetra" else f"tags of {_called(block.kind)}")
    key = _spelled(_TAG.get(form.name, meant), form)
    entities = [gmsh_entities(block.tags) for block in blocks] if form.name == "gmsh" else []
    for name in dict.fromkeys((key, ENTITIES) if form.name == "gmsh" else (key,)):
        columns = content.cell_data.pop(name, None)
        if columns is not None and isinstance(mesh, TetMesh) and name == mesh.region_name:
            entities[0] = columns[0].astype(np.int64)  # what a gmsh file has beside groups can be the regions
        elif columns is not None:
            lost.append(f"cell data {name!r}, whose name is that of the tags")
    if form.name == "gmsh":
        groups = meant != ENTITIES
        content.cell_data[key] = [column if groups else np.zeros_like(column) for column in tags]
        content.cell_data[ENTITIES] = entities
    elif form.tagged and (form.name in _TAG or any(column.any() for column in tags)):
        if isinstance(mesh, TetMesh) and key == _spelled(mesh.region_name, form):
            content.cell_data[key] = shared_type(mesh, tags)
        else:
            content.cell_data[key] = [np.array(column) for column in tags]


def _keeps_tags(kind: str, form: Format) -> bool:
    """Whether tags of such cells go into the file; those of other cells do where those of tets of that size do."""
    like = {2: "triangle", 3: "tetra"}[cell_kinds.dimension(kind)] if kind in form.others else kind
    return like in form.tagged or form.sets


def _put_sets(content: Content, blocks: list[Block], points: Any, form: Format, lost: list[str]) -> None:
    """Sets where the format has them, else arrays of 0 and 1."""
    able = {"Abaqus": abaqus_names.fits, "MED": med_families.fits}.get(form.name)
    for which, block in enumerate(blocks):
        for name, members in block.sets.items():
            fits = able is not None and able(name) and (len(members) or form.name == "MED")
            fits |= form.name == "Medit" and medit_sections.set_of(name, block.kind) is not None
            if fits:
                nobody = [members[:0] for _ in blocks]
                content.cell_sets.setdefault(name, nobody)[which] = members
            elif form.cell_data and (array := _array(SET + name, np.zeros(0, "u1"), form)) is not None:
                key = _spelled(SET + name, form)
                columns = content.cell_data.setdefault(key, [np.zeros(len(b.cells), array.dtype) for b in blocks])
                columns[which][members] = 1
            else:
                lost.append(f"set {name!r} of {_called(block.kind).removeprefix('tagged ')}")
    for name, members in points.items():
        if able is not None and able(name):
            content.point_sets[name] = members
        elif form.point_data and (array := _array(SET + name, np.zeros(len(content.points), "u1"), form)) is not None:
            array[members] = 1
            content.point_data[_spelled(SET + name, form)] = array
        else:
            lost.append(f"set {name!r} of points")


def _put_periodic(content: Content, mesh: TetMesh, form: Format, lost: list[str]) -> None:
    content.periodic = sides_of(mesh) if form.name == "gmsh" else []
    if not content.periodic:
        lost.append("which sides are periodic")
        return
    for k, (kind, _) in enumerate(content.cells):
        if kind == "triangle":
            content.cell_data[ENTITIES][k] = numbered(content.periodic, content.cell_data[ENTITIES][k])


def _take_groups(block: Block, names: Mapping[str, tuple[int, int]]) -> dict[int, NDArray[np.int64]]:
    """Take out the sets that are physical groups, by name and dimension, of cells that have other tags."""
    groups = {}
    for name in [name for name in block.sets if names.get(name, (0, -1))[1] == cell_kinds.dimension(block.kind)]:
        tag, _ = names[name]
        if tag and np.isin(np.flatnonzero(block.tags == tag), block.sets[name]).all():
            groups[tag] = block.sets.pop(name)
    return groups


def _array(name: str, values: NDArray[Any], form: Format) -> NDArray[Any] | None:
    """A copy in a type and shape the format has; None where it has none, or where the name would break the file."""
    if values.dtype.kind not in "biuf" or values.ndim > 2 or (values.ndim == 2 and not values.shape[1]):
        return None
    width = values.shape[1] if values.ndim == 2 else 1
    array = np.array(values, dtype="u1" if values.dtype.kind == "b" and form is not PYVISTA else None)
    if array.dtype.itemsize not in (1, 2, 4, 8) or array.dtype == np.float16:
        array = array.astype(np.float64)
    match form.name:
        case "VTK":  # of the integer types meshio writes, VTK itself knows only the 8-byte ones
            if array.dtype.kind in "iu" and array.dtype != np.uint64:
                array = array.astype(np.int64)
            return None if width == 2 else array
        case "gmsh":
            return array.astype(np.float64) if width in (1, 3, 9) and not set('"\n') & set(name) else None
        case "MED":
            return array.astype(np.float64) if "/" not in name else None
        case "VTU" | "XDMF":
            return array if fits_xml(name) else None
        case "PLY":
            taken = name in ("x", "y", "z", "vertex_indices", "vertex_index") or name.split() != [name]
            return array if values.ndim == 1 and not taken else None
    return array


def _spelled(name: str, form: Format) -> str:
    """The name as it has to stand in the file."""
    if form.name == "VTU":  # meshio's XML writer escapes nothing
        return attribute(name)
    if form.name == "VTK":  # VTK's own spelling of blanks
        return quote(name, safe="!#$&'()*+,/:;<=>?@[\\]^`{|}~")
    return name
