"""What a file holds, kind of cell by kind of cell, becomes a :class:`TetMesh` or a :class:`SurfaceMesh`."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import formats, read_limit, region_choice
from wct_plugin.io.abaqus_names import USUAL
from wct_plugin.io.corners import corners_only
from wct_plugin.io.periodic_sides import is_periodic
from wct_plugin.io.polygons import as_triangles
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.tet_meshes import Parts, assemble
from wct_plugin.io.text_lines import whole_number
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh, cell_kinds
from wct_plugin.mesh.mesh import check_range

#: The number of gmsh's geometric entity per cell; a file has it whether it was asked for or not.
ENTITIES = "gmsh:geometrical"
#: Arrays that hold an integer tag per cell, by format; the first one present that is not all zero is the tags.
TAGS = ("gmsh:physical", "medit:ref", "tetgen:ref", "cell_tags", "nastran:ref", "su2:tag", ENTITIES)
#: Named sets are stored as arrays of 0 and 1 of this name where a format has arrays but no sets.
SET = "set:"
#: Tags are stored as sets TAG_tetra_5 where a format has sets but no tags.
TAG_SET = "TAG_"
#: Physical names are stored in VTU files as field data (tag, dimension) of this name.
NAME = "name:"

#: Formats in which the names of tags stand under these names themselves.
_NAMED = ("gmsh", "meshio", "MED", "SU2", "Abaqus")
#: Kinds that a mesh is made of; what stands beside tets is of others.
_WIDTH = {"tetra": 4, "triangle": 3, "line": 2, "vertex": 1}
#: Arrays of meshio's own making, of no meaning after reading.
_PRIVATE = ("gmsh:dim_tags", "gmsh:bounding_entities", "facet_normals")


@dataclass
class _Kind:
    """All blocks of one kind of cell, put together."""

    cells: NDArray[np.int64]
    dimension: int
    data: dict[str, NDArray[Any]] = field(default_factory=dict)
    sets: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    tags: NDArray[np.int64] | None = None

    def as_cells(self) -> Cells:
        return Cells(self.cells, self.tags, self.data, self.sets)  # type: ignore[arg-type]  # None stands for zeros


def to_mesh(
    raw: RawMesh,
    form: formats.Format,
    lost: list[str],
    source: str,
    tags: tuple[str, ...] = TAGS,
    *,
    regions: region_choice.Regions = None,
    repair: bool = False,
) -> TetMesh | SurfaceMesh:
    """Make a mesh of what a file holds; ``lost`` grows by what a mesh cannot hold, ``tags`` may be the array of tags.

    ``regions`` are the names of the array or sets that are the regions, where it is not for the file to say.
    ``repair``: broken tets are dropped or mended. What was done to what the file holds goes to ``raw.notes``.
    Raises :class:`InputError` for volumes without a tet, and where there is neither tet nor triangle; for
    regions that are none, :class:`~wct_plugin.errors.OptionError`.
    """
    notes = raw.notes
    points = _in_space(np.asarray(raw.points))
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"its points have {points.shape[-1]} coordinates; allowed are 3, or 2 in the plane")
    raw, curved = corners_only(replace(raw, points=points))
    raw = as_triangles(raw)
    regions = region_choice.single(regions)
    kinds = _kinds(raw)
    main = "tetra" if len(kinds["tetra"].cells) else "triangle"
    if not len(kinds[main].cells):
        raise InputError("has neither tets nor triangles")
    points = raw.points
    if form.name == "VTK":  # VTK keeps blanks in names as %20
        for kind in kinds.values():
            kind.data = {unquote(name): values for name, values in kind.data.items()}
    point_data = _point_data(raw, form)
    point_sets = {str(name): _members(ids) for name, ids in raw.point_sets.items()} | _pop_sets(point_data)
    names = _names(raw.field_data, form)
    for kind in kinds.values():
        kind.sets |= _pop_sets(kind.data)
    tag_name = _take_tags(kinds, tags, regions)
    _take_tag_sets(kinds, names, raw.tag_sets)
    if form.name == "gmsh":
        for kind in kinds.values():
            _merge_repeated(kind, names)
    _drop_filling(kinds)
    _drop_repeated_sets(kinds, names, repeating=form.name == "gmsh")
    if main == "triangle":
        region_choice.refuse_for_surface(regions)
        faces = kinds["triangle"]
        points, point_data = _without_stray(points, faces, point_data, notes)
        lost += [f"{len(kinds[kind].cells)} {kind} cells" for kind in ("line", "vertex") if len(kinds[kind].cells)]
        lost += [f"set {name!r}" for name in [*faces.sets, *point_sets]] + [f"name {name!r}" for name in names]
        return SurfaceMesh(points, faces.cells, faces.tags, point_data, faces.data, source)  # type: ignore[arg-type]
    tag_name, region_name = _take_regions(kinds, names, tag_name, form, regions, source)
    parts = Parts(points, {which: kind.as_cells() for which, kind in kinds.items()}, point_data, point_sets)
    return assemble(
        parts,
        curved,
        notes,
        repair=repair,
        names=names,
        tag_name=tag_name,
        source=source,
        periodic=is_periodic(raw, lost),
        region_name=region_name,
        element_types={kind: name for kind, name in raw.element_types.items() if name != USUAL.get(kind)},
    )


def _point_data(raw: RawMesh, form: formats.Format) -> dict[str, NDArray[Any]]:
    """The points' arrays, without numbers that the format has for each point whether they are meant or not."""
    point_data = {
        unquote(name) if form.name == "VTK" else str(name): _native(values)
        for name, values in raw.point_data.items()
        if name not in _PRIVATE
    }
    for name in set(TAGS) & point_data.keys() if form is not formats.PYVISTA else ():
        point_data[name] = _whole(point_data[name])
        if not point_data[name].any():
            del point_data[name]
    return point_data


def _in_space(points: NDArray[Any]) -> NDArray[Any]:
    """The points; those of a plane, which have two coordinates, with a third of zero."""
    flat = points.ndim == 2 and points.shape[1] == 2
    return np.column_stack([points, np.zeros(len(points))]) if flat else points


def _without_stray(
    points: NDArray[Any], faces: _Kind, point_data: dict[str, NDArray[Any]], notes: list[str]
) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
    """Leave out points that are no numbers where no triangle has them."""
    keep = np.isfinite(points).all(axis=1) | np.isin(np.arange(len(points)), faces.cells)
    if keep.all():
        return points, point_data
    check_range(faces.cells, len(points))
    count = int((~keep).sum())
    notes.append(f"{count} point{'s' * (count > 1)} of no triangle, with coordinates that are no numbers, dropped")
    faces.cells = (np.cumsum(keep) - 1)[faces.cells]
    return points[keep], {name: values[keep] for name, values in point_data.items()}


def _widths(raw: RawMesh) -> dict[str, int]:
    """How many points cells have, by kind: the kinds of a mesh, and those beside tets."""
    widths = dict(_WIDTH)
    has_tets = any(block.type == "tetra" and len(block) for block in raw.cells)
    for block in raw.cells:
        if block.type in _WIDTH or not len(block):
            continue
        if cell_kinds.dimension(block.type) == 3 and not has_tets:
            raise InputError(
                f"has {len(block)} {block.type} cells and no tet; tets are needed, beside which other cells may stand"
            )
        if cell_kinds.dimension(block.type) < 1 or not has_tets:
            raise InputError(f"has {len(block)} {block.type} cells; allowed are tetra, triangle, line and vertex")
        widths[block.type] = np.asarray(block.data).shape[1]
    return widths


def _kinds(raw: RawMesh) -> dict[str, _Kind]:
    """Per kind of cell all of meshio's blocks as one, with their data and sets."""
    kinds = {}
    for kind, width in _widths(raw).items():
        blocks = [k for k, block in enumerate(raw.cells) if block.type == kind and len(block)]
        if not blocks:
            kinds[kind] = _Kind(np.empty((0, width), dtype=np.int64), cell_kinds.dimension(kind))
            continue
        rows = np.concatenate([np.asarray(raw.cells[k].data) for k in blocks])
        made = _Kind(rows.astype(np.int64), cell_kinds.dimension(kind))
        for name, values in raw.cell_data.items():
            if name not in _PRIVATE and any(values[k] is not None for k in blocks):
                made.data[str(name)] = _native(_joined([(values[k], len(raw.cells[k])) for k in blocks]))
        starts = np.cumsum([0, *(len(raw.cells[k]) for k in blocks)])
        for name, members in raw.cell_sets.items():
            if name not in _PRIVATE:
                known = [members[k] if k < len(members) else None for k in blocks]
                made.sets[str(name)] = np.concatenate(
                    [_members(ids) + start for ids, start in zip(known, starts, strict=False)]
                )
        kinds[kind] = made
    return kinds


def _joined(parts: list[tuple[NDArray[Any] | None, int]]) -> NDArray[Any]:
    """One column of those of several blocks; of a block that has none, zero or NaN."""
    known = [np.asarray(part) for part, _ in parts if part is not None]
    dtype = np.result_type(*known)
    fill: Any = np.nan if dtype.kind == "f" else np.zeros(1, dtype)[0]
    width = known[0].nbytes // max(len(known[0]), 1)
    read_limit.claim(width * sum(count for part, count in parts if part is None), "data that some cells lack")
    return np.concatenate(
        [np.full((count, *known[0].shape[1:]), fill, dtype) if part is None else part for part, count in parts]
    )


def _take_tags(kinds: dict[str, _Kind], names: tuple[str, ...], regions: region_choice.Regions = None) -> str:
    """Make the first array of these names that says anything the tags; returns its name.

    Gmsh's entities stay beside other tags if they are to be ``regions``.
    """
    chosen = names[0] if names else TAGS[0]
    for name in reversed(names):
        columns = [kind.data[name] for kind in kinds.values() if name in kind.data]
        # Zero is no tag; and every cell of a gmsh file has an entity, whether there is more than one or not.
        said = [column != column[0] if name == ENTITIES else (column != 0) & (column == column) for column in columns]
        says = any(column.any() for column in said)
        if says and all(_whole(column).dtype.kind in "iu" for column in columns):
            chosen = name
        elif not says:  # fractions stay data
            for kind in kinds.values():
                kind.data.pop(name, None)
    for kind in kinds.values():
        if chosen in kind.data:
            kind.tags = _whole(kind.data.pop(chosen)).astype(np.int64)
    if ENTITIES not in (chosen, regions):  # gmsh's own bookkeeping then, made anew when written
        for kind in kinds.values():
            kind.data.pop(ENTITIES, None)
    return chosen


def _take_regions(
    kinds: dict[str, _Kind],
    names: dict[str, tuple[int, int]],
    tag_name: str,
    form: formats.Format,
    regions: region_choice.Regions,
    source: str,
) -> tuple[str, str]:
    """Make an array or sets the regions of the tets, if these names ask for it or the tets have no different tags.

    Tags that the tets have then stay as an array. Other cells have their tags from the same array if they have no
    tags at all. Returns the names of the array of tags and of that of regions.
    """
    tets = kinds["tetra"]
    own = np.zeros(0, dtype=np.int64) if tets.tags is None else tets.tags
    tagged = bool(own.any())
    if tagged and (regions == tag_name or (regions is None and len(np.unique(own)) > 1)):
        return tag_name, ""
    count = len(tets.cells)
    if regions is None:
        chosen = region_choice.usual(tets.data, tets.sets, count, tag_file=form.name == "XDMF")
    else:
        chosen = region_choice.wanted(regions, tets.data, tets.sets, count)
    if chosen is None:
        return tag_name, ""
    region_choice.say(source, chosen)
    if tagged:
        tets.data[tag_name] = own
    else:
        names |= region_choice.set_names(chosen, names)
    tets.tags = chosen.regions
    return tag_name if tagged else _share_tags(kinds, chosen.array, tag_name), chosen.array


def _share_tags(kinds: dict[str, _Kind], array: str, tag_name: str) -> str:
    """Make the array of the regions the tags of all other cells, if these have none; returns the name of the tags."""
    others = [kind for which, kind in kinds.items() if which != "tetra"]
    columns = [region_choice.whole(kind.data[array]) for kind in others if array in kind.data]
    if not columns or any(column is None for column in columns):
        return tag_name
    if any(kind.tags is not None and kind.tags.any() for kind in others):
        return tag_name
    for kind in others:
        if array in kind.data:
            kind.tags = region_choice.whole(kind.data.pop(array))
    return array


def _merge_repeated(kind: _Kind, names: dict[str, tuple[int, int]]) -> None:
    """Make one of cells that stand in the file several times, which is gmsh 2.2's way to have them in several groups.

    The first tag stays; groups that lose members by this become sets, named as the group or by its number.
    """
    _, first, place = np.unique(kind.cells, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(kind.cells) or kind.tags is None:
        return
    order = np.argsort(first)
    keep = first[order]  # in the order of the file
    place = np.argsort(order)[place.ravel()]  # where each cell is among those kept
    again = np.ones(len(kind.cells), dtype=bool)
    again[keep] = False
    dimension = kind.dimension
    kind.sets = {name: np.unique(place[ids]) for name, ids in kind.sets.items()}
    for tag in np.unique(kind.tags[again]).tolist():
        name = next((name for name, pair in names.items() if pair == (tag, dimension)), str(tag))
        kind.sets[name] = np.unique(place[kind.tags == tag])
    kind.data = {name: values[keep] for name, values in kind.data.items()}
    kind.cells, kind.tags = kind.cells[keep], kind.tags[keep]


def _take_tag_sets(kinds: dict[str, _Kind], names: dict[str, tuple[int, int]], tag_sets: Mapping[str, bool]) -> None:
    """Turn the sets that stand for tags where a format has no tags (Abaqus) into tags again.

    ``tag_sets``: those under the names of their tags, and whether they are sets by themselves too.
    """
    for which, kind in kinds.items():
        for name in [name for name in kind.sets if name in tag_sets and names[name][1] == kind.dimension]:
            if kind.tags is None:
                kind.tags = np.zeros(len(kind.cells), dtype=np.int64)
            kind.tags[kind.sets[name]] = names[name][0]
            if not tag_sets[name]:
                del kind.sets[name]
        prefix = f"{TAG_SET}{which}_"
        for name in [name for name in kind.sets if name.startswith(prefix)]:
            if kind.tags is None:
                kind.tags = np.zeros(len(kind.cells), dtype=np.int64)
            kind.tags[kind.sets.pop(name)] = whole_number(name.removeprefix(prefix), f"the tag of set {name!r}")
        kind.sets = {name: ids for name, ids in kind.sets.items() if not name.startswith(TAG_SET)}


def gmsh_entities(tags: NDArray[np.int64]) -> NDArray[np.int64]:
    """A gmsh entity number per cell, from its tag: positive, and different for different tags."""
    return np.where(tags > 0, tags, tags.max(initial=0) + 1 - tags)


def _pop_sets(data: dict[str, NDArray[Any]]) -> dict[str, NDArray[np.int64]]:
    return {name[len(SET) :]: np.flatnonzero(data.pop(name)) for name in list(data) if name.startswith(SET)}


def _drop_filling(kinds: dict[str, _Kind]) -> None:
    for name in {name for kind in kinds.values() for name in kind.data}:
        empty = {kind: _says_nothing(made.data[name]) for kind, made in kinds.items() if name in made.data}
        if not all(empty.values()):
            for kind in (kind for kind, nothing in empty.items() if nothing):
                del kinds[kind].data[name]


def _says_nothing(values: NDArray[Any]) -> bool:
    return bool(np.isnan(values).all() if values.dtype.kind == "f" else not values.any())


def _drop_repeated_sets(kinds: dict[str, _Kind], names: dict[str, tuple[int, int]], *, repeating: bool) -> None:
    """Leave out sets that have all their members among other cells.

    ``repeating``: those too that only repeat a physical name, of which meshio makes a set for each.
    """
    for name in {name for kind in kinds.values() for name in kind.sets}:
        somewhere = any(len(kind.sets.get(name, ())) for kind in kinds.values())
        for which, kind in kinds.items():
            members = kind.sets.get(name)
            if members is None:
                continue
            tag, dimension = names.get(name, (0, -1))
            group = repeating and tag and dimension == kind.dimension and kind.tags is not None
            repeats = group and np.array_equal(np.sort(members), np.flatnonzero(kind.tags == tag))
            if repeats or (not len(members) and (somewhere or name in names or which != "tetra")):
                del kind.sets[name]


def _names(found: dict[str, Any], form: formats.Format) -> dict[str, tuple[int, int]]:
    names = {}
    for name, value in found.items():
        pair = np.asarray(value).ravel()
        if pair.size == 2 and (form.name in _NAMED or name.startswith(NAME)):
            names[name.removeprefix(NAME)] = (int(pair[0]), int(pair[1]))
    return names


def _members(ids: Any) -> NDArray[np.int64]:
    return np.asarray([] if ids is None else ids, dtype=np.int64)


def _native(values: Any) -> NDArray[Any]:
    array = np.asarray(values)
    return array.astype(array.dtype.newbyteorder("="))


def _whole(values: NDArray[Any]) -> NDArray[Any]:
    """Floats that are whole numbers as integers; anything else as it is."""
    if values.dtype.kind == "f" and (values == np.rint(values)).all() and (np.abs(values) < 2.0**63).all():
        return values.astype(np.int64)
    return values
