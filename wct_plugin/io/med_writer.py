"""Writes MED as Salome, code_aster and gmsh read it: tags, sets and names as families with their groups."""

import io
from collections.abc import Callable, Mapping
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io import med_families
from wct_plugin.io.med import KINDS
from wct_plugin.io.med_families import Family
from wct_plugin.types import Floats, Ints

_MED = {kind: med for med, kind in KINDS.items()}
_MESH = "mesh"
_NO_PROFILE = "MED_NO_PROFILE_INTERNAL"
_NO_TEXT = np.bytes_("")
#: MED's name of what has no time step, and of the only one of a field.
_TIMELESS = "-0000000000000000001-0000000000000000001"
_STEP = "0000000000000000000100000000000000000001"


def write(
    path: Path,
    points: Floats,
    cells: list[tuple[str, Ints]],
    tags: list[Ints],
    point_sets: Mapping[str, Ints],
    cell_sets: Mapping[str, list[Ints]],
    names: Mapping[str, NDArray[np.int64]],
    point_data: Mapping[str, NDArray[Any]],
    cell_data: Mapping[str, list[NDArray[Any]]],
) -> None:
    """Write the file, each kind of cell once; by way of memory, as HDF5 leaves a full disk unnoticed."""
    import h5py  # type: ignore[import-untyped]

    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        info = file.create_group("INFOS_GENERALES")
        for key, value in (("MAJ", 3), ("MIN", 0), ("REL", 0)):  # of 3.1 and later Salome 8.3 reads none
            info.attrs.create(key, value)
        step = _put_mesh(file)
        families = file.create_group(f"FAS/{_MESH}")
        families.create_group("FAMILLE_ZERO").attrs.create("NUM", 0)
        of_points = _put_point_families(families, len(points), point_sets)
        of_cells = _put_cell_families(families, cells, tags, cell_sets, names)
        _put_points(step, points, of_points)
        _put_cells(step, cells, of_cells)
        fields = file.create_group("CHA")
        for name, values in point_data.items():
            _put_values(_put_field(fields, name, values), "NOE", values)
        for name, columns in cell_data.items():
            field = _put_field(fields, name, columns[0])
            for (kind, _), values in zip(cells, columns, strict=True):
                _put_values(field, f"MAI.{_MED[kind]}", values)
    path.write_bytes(buffer.getvalue())


def _put_mesh(file: Any) -> Any:
    """The head of the mesh; gives the place of its points and cells."""
    mesh = file.create_group(f"ENS_MAA/{_MESH}")
    axes = np.bytes_("".join(f"{name:<16}" for name in "XYZ"))
    for key, value in (("DIM", 3), ("ESP", 3), ("REP", 0), ("SRT", 1), ("TYP", 0), ("NOM", axes)):
        mesh.attrs.create(key, value)
    for key in ("UNT", "UNI"):
        mesh.attrs.create(key, _NO_TEXT)
    mesh.attrs.create("DES", np.bytes_("Written by wct_plugin"))
    step = mesh.create_group(_TIMELESS)
    step.attrs.create("PDT", -1.0)
    for key, value in (("CGT", 1), ("NDT", -1), ("NOR", -1)):
        step.attrs.create(key, value)
    return step


def _put_points(step: Any, points: Floats, families: Ints) -> None:
    nodes = step.create_group("NOE")
    for key, value in (("CGT", 1), ("CGS", 1), ("PFL", np.bytes_(_NO_PROFILE))):
        nodes.attrs.create(key, value)
    _put_rows(nodes, "COO", points.flatten(order="F"), len(points))
    if families.any():
        _put_rows(nodes, "FAM", families, len(points))


def _put_cells(step: Any, cells: list[tuple[str, Ints]], families: list[Ints]) -> None:
    every = step.create_group("MAI")
    every.attrs.create("CGT", 1)
    for (kind, rows), numbers in zip(cells, families, strict=True):
        block = every.create_group(_MED[kind])
        for key, value in (("CGT", 1), ("CGS", 1), ("PFL", np.bytes_(_NO_PROFILE))):
            block.attrs.create(key, value)
        _put_rows(block, "NOD", rows.flatten(order="F") + 1, len(rows))
        _put_rows(block, "FAM", numbers, len(rows))


def _put_rows(parent: Any, name: str, values: NDArray[Any], rows: int) -> None:
    made = parent.create_dataset(name, data=values)
    made.attrs.create("CGT", 1)
    made.attrs.create("NBR", rows)


def _put_cell_families(
    families: Any,
    cells: list[tuple[str, Ints]],
    tags: list[Ints],
    sets: Mapping[str, list[Ints]],
    names: Mapping[str, NDArray[np.int64]],
) -> list[Ints]:
    """Put the families of the cells; gives their number for each cell."""
    called = {(int(tag), int(dimension)): name for name, (tag, dimension) in names.items()}
    numbers = [np.zeros(len(rows), dtype=np.int64) for _, rows in cells]
    made: list[Family] = []
    free = _free_numbers(tags)
    for k, (kind, _) in enumerate(cells):
        dimension = med_families.dimension_of(kind)
        own = {name: members[k] for name, members in sets.items() if len(members[k]) or _is_of(members, k)}
        for tag, groups, members in med_families.combined(tags[k], own):
            one = Family(free(tag), tag, called.get((tag, dimension), ""), groups, dimension)
            numbers[k][members] = one.number
            made.append(one)
    there = {(one.tag, one.dimension) for one in made}
    for (tag, dimension), name in called.items():  # names that no cell has
        if (tag, dimension) not in there:
            made.append(Family(free(tag), tag, name, (), dimension))
    if made:
        med_families.write(families.create_group("ELEME"), made)
    return numbers


def _free_numbers(tags: list[Ints]) -> Callable[[int], int]:
    """Gives each family a number of its own below 0: that of its tag if it is free, as gmsh takes it for the entity."""
    kept = {-abs(tag) for column in tags for tag in np.unique(column).tolist()}
    others = (-number for number in count(1) if -number not in kept)
    free = set(kept) - {0}

    def number(tag: int) -> int:
        if -abs(tag) not in free:
            return next(others)
        free.remove(-abs(tag))
        return -abs(tag)

    return number


def _is_of(members: list[Ints], k: int) -> bool:
    """Whether an empty set is put among the cells of kind ``k``: among the first ones, which are the tets."""
    return k == 0 and not any(map(len, members))


def _put_point_families(families: Any, points: int, sets: Mapping[str, Ints]) -> Ints:
    numbers = np.zeros(points, dtype=np.int64)
    if not sets:
        return numbers
    parent = families.create_group("NOEUD")
    number = count(1)
    for _, groups, members in med_families.combined(np.zeros(points, dtype=np.int64), sets):
        own = next(number)
        numbers[members] = own
        med_families.put(parent, f"NODES_{own}", own, groups)
    return numbers


def _put_field(fields: Any, name: str, values: NDArray[Any]) -> Any:
    if name in fields:  # points and cells may have fields of one name
        return fields[name][_STEP]
    field = fields.create_group(name)
    parts = 1 if values.ndim == 1 else values.shape[1]
    components = np.bytes_(" " * 16 * parts)
    for key, value in (("MAI", np.bytes_(_MESH)), ("TYP", 6), ("NCO", parts), ("NOM", components)):
        field.attrs.create(key, value)
    for key in ("UNI", "UNT"):
        field.attrs.create(key, _NO_TEXT)
    step = field.create_group(_STEP)
    for key, value in (("NDT", 1), ("NOR", 1), ("PDT", 0.0), ("RDT", -1), ("ROR", -1)):
        step.attrs.create(key, value)
    return step


def _put_values(step: Any, support: str, values: NDArray[Any]) -> None:
    held = step.create_group(support)
    held.attrs.create("GAU", _NO_TEXT)
    held.attrs.create("PFL", np.bytes_(_NO_PROFILE))
    profile = held.create_group(_NO_PROFILE)
    for key, value in (("NBR", len(values)), ("NGA", 1), ("GAU", _NO_TEXT)):
        profile.attrs.create(key, value)
    profile.create_dataset("CO", data=values.flatten(order="F"))
