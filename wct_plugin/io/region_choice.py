"""Which of what a file says of its tets are their regions, where its own tags do not say it: an array, or sets.

What is chosen stays with the mesh as it is: an array is repeated by the regions, and sets are unions of them, so that
both come back when the tets are made anew.
"""

import logging
import re
import shlex
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.io.disjoint_sets import disjoint_cover
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import components
from wct_plugin.types import Ints

Arrays = Mapping[str, NDArray[Any]]
#: What may be asked for: the name of an array or of a set, or names of sets.
Regions = str | Sequence[str] | None

#: Arrays that say which material or part a cell is of, in the order in which they are asked; case, blanks, ``-`` and
#: ``_`` are no matter. Of OpenGeoSys, sfepy, MFEM, GEOS, gmsh, ParaView, dolfinx, legacy dolfin, ...
USUAL = (
    *("material", "materials", "materialid", "materialids", "matid", "matids", "mat", "mats", "materialnumber"),
    *("attribute", "attributes", "region", "regions", "regionid", "regionids", "cellentityids", "entityid"),
    *("entityids", "elementblockids", "elementblockid", "blockid", "blockids", "subdomain", "subdomains"),
    *("subdomainid", "domain", "domains", "domainid", "domainids", "celltags", "celltag", "meshtags", "meshtag"),
    *("cellmarkers", "cellmarker", "partid", "partids", "bodyid", "bodyids", "objectid", "propertyid", "propertyids"),
    *("pid", "physical", "physicalid", "physicalids", "volumeid", "zoneid", "phaseid", "tissue", "grainid", "grainids"),
    *("labels", "label", "elementtag", "elementtags", "nametoread"),
)
#: An array of more values than this, each in one piece or not, is rather numbers of cells than of materials.
_FEW = 64
#: Facets between different values, as a part of those that there would be at random, below which values are in patches.
_PATCHY = 0.5
#: And as many tets have to be in a patch, on average: neighbours are often numbered in turn.
_TETS_PER_PATCH = 8

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Chosen:
    """The regions of the tets, and where they come from."""

    regions: Ints
    array: str = ""  #: the array that they repeat, if any
    sets: Mapping[str, int] = field(default_factory=dict)  #: else the number of each set

    def __str__(self) -> str:
        count = len(np.unique(self.regions))
        if self.array:
            return f"array {self.array!r}, {count} value{'' if count == 1 else 's'}"
        return f"set{'' if len(self.sets) == 1 else 's'} {', '.join(map(repr, self.sets))}"


def say(where: str, chosen: Chosen) -> None:
    """Tell whoever listens to the log of this package what the regions are."""
    _log.info("%s: regions are of %s", where or "the mesh", chosen)


def single(names: Regions) -> Regions:
    """One name as a text, however it came."""
    return names[0] if names is not None and not isinstance(names, str) and len(names) == 1 else names


def wanted(names: Regions, arrays: Arrays, sets: Mapping[str, Ints], count: int) -> Chosen:
    """The regions by name; raises :class:`OptionError` for names that are not there, or that cannot be regions.

    One name is that of an array, or of a set; several, also in one text with commas, are those of sets that share no
    tet. Tets in none of the sets have region 0.
    """
    listed = [names] if isinstance(names, str) else list(names or ())
    if len(listed) == 1 and listed[0] not in arrays and listed[0] not in sets:
        listed = [name.strip() for name in listed[0].split(",")]
    if len(listed) == 1 and listed[0] in arrays:
        return Chosen(_whole_or_refused(listed[0], arrays[listed[0]]), listed[0])
    unknown = [name for name in listed if name not in sets]
    if unknown or not listed:
        alone = unknown[:1] if len(listed) > 1 else listed
        raise OptionError(f"regions is {', '.join(map(repr, alone)) or 'empty'}; {_allowed(arrays, sets)}")
    return _of_sets(dict.fromkeys(listed), sets, count)


def _allowed(arrays: Arrays, sets: Mapping[str, Ints]) -> str:
    said = f"allowed are the cell arrays: {', '.join(arrays) or 'none'}"
    return said + (f"; and the sets of tets: {', '.join(sets)}" if sets else "")


def _whole_or_refused(name: str, values: NDArray[Any]) -> Ints:
    found = whole(values)
    if found is None:
        raise OptionError(f"regions is {name!r}, {values.dtype} of shape {values.shape}; allowed are whole numbers")
    return found


def _of_sets(names: Mapping[str, Any], sets: Mapping[str, Ints], count: int) -> Chosen:
    regions = np.zeros(count, dtype=np.int64)
    for number, name in enumerate(names, start=1):
        members = sets[name]
        shared = members[regions[members] != 0]
        if len(shared):
            other = list(names)[regions[shared[0]] - 1]
            raise OptionError(
                f"regions: sets {other!r} and {name!r} share {len(np.unique(shared))} tets, the first of them tet "
                f"{shared.min()}; a tet has one region"
            )
        regions[members] = number
    return Chosen(regions, sets={name: number for number, name in enumerate(names, start=1)})


def usual(arrays: Arrays, sets: Mapping[str, Ints], count: int, *, tag_file: bool = False) -> Chosen | None:
    """The regions that nobody has named: an array of a usual name, or sets that have each tet once; None without.

    ``tag_file``: the only array is taken whatever its name, if it has few values.
    """
    plain = {re.sub(r"[\s_-]", "", name).lower(): name for name in reversed(list(arrays))}
    names = [plain[name] for name in USUAL if name in plain]
    if tag_file and len(arrays) == 1:
        names += [name for name, values in arrays.items() if (found := whole(values)) is not None and _few(found)]
    for name in names:
        found = whole(arrays[name])
        if found is not None and found.any():
            return Chosen(found, name)
    cover = disjoint_cover(sets, count)
    return _of_sets(dict.fromkeys(cover), sets, count) if cover else None


def _few(values: Ints) -> bool:
    return 1 < len(np.unique(values)) <= _FEW


def whole(values: NDArray[Any]) -> Ints | None:
    """The array as integers, where it is one of whole numbers or truth values; else None."""
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1 or values.dtype.kind not in "iufb":
        return None
    if values.dtype.kind == "f":
        wide = values.astype(np.float64)  # halves have no such large number to be compared with
        if not (np.abs(wide) < 2.0**53).all() or (values != np.rint(values)).any():  # also where it is no number
            return None
    found = values.astype(np.int64)
    return found if values.dtype.kind != "u" or (found >= 0).all() else None


def with_regions(mesh: TetMesh, names: Regions) -> TetMesh:
    """The mesh with the array or sets of these names as its regions; tags that it had stay as an array of their name.

    Raises :class:`OptionError` for names that are not there, or that cannot be regions.
    """
    names = single(names)
    if names == mesh.tag_name and mesh.tag_name not in mesh.cell_data:
        return mesh
    chosen = wanted(names, mesh.cell_data, mesh.tet_sets, len(mesh.tets))
    say(mesh.source, chosen)
    of_sets = [name for name, (_, dimension) in mesh.names.items() if dimension == 3 and name in mesh.tet_sets]
    tagged = bool(mesh.regions.any()) and not mesh.region_name and not of_sets
    kept = {name: pair for name, pair in mesh.names.items() if name not in of_sets}
    return replace(
        mesh,
        regions=chosen.regions,
        region_name=chosen.array,
        cell_data={**mesh.cell_data, **({mesh.tag_name: mesh.regions} if tagged else {})},
        names={**kept, **({} if tagged else set_names(chosen, kept))},
    )


def set_names(chosen: Chosen, names: Mapping[str, tuple[int, int]]) -> dict[str, tuple[int, int]]:
    """The sets as physical names of the regions, but for names that are taken."""
    return {name: (number, 3) for name, number in chosen.sets.items() if name not in names}


def warn_of_others(mesh: TetMesh, where: str, stacklevel: int = 3) -> None:
    """Name the arrays and sets that look like materials and are not unions of regions, so that nothing keeps them."""
    found = [("array", name) for name, values in mesh.cell_data.items() if _looks_like_material(mesh, whole(values))]
    for name, members in mesh.tet_sets.items():
        inside = np.zeros(len(mesh.tets), dtype=np.int64)
        inside[members] = 1
        if _looks_like_material(mesh, inside):
            found.append(("set", name))
    if not found:
        return
    _, name = found[0]
    one = len(found) == 1
    warnings.warn(
        f"{where or 'the mesh'}: {', '.join(f'{kind} {called!r}' for kind, called in found)} "
        f"{'looks' if one else 'look'} like materials but {'is' if one else 'are'} not taken as regions, so that new "
        f"tets do not keep {'its' if one else 'their'} interfaces; regions={name!r} (--regions {shlex.quote(name)}) "
        f"takes {'it' if one else 'the first'}",
        WctWarning,
        stacklevel=stacklevel,
    )


def _looks_like_material(mesh: TetMesh, values: Ints | None) -> bool:
    """Whether an array has few values, in patches, that are not constant on the regions."""
    if values is None or not _few(values):
        return False
    first = np.unique(mesh.regions, return_index=True, return_inverse=True)[1:]
    if (values == values[first[0][first[1].ravel()]]).all():
        return False
    pairs = mesh.topology.interior_pairs
    share = np.unique(values, return_counts=True)[1] / len(values)
    at_random = len(pairs) * (1.0 - float((share**2).sum()))
    alike = values[pairs[:, 0]] == values[pairs[:, 2]]
    if (~alike).sum() >= _PATCHY * at_random:
        return False
    patches = components(pairs[alike, 0], pairs[alike, 2], len(values)).max() + 1
    return bool(len(values) >= _TETS_PER_PATCH * patches)


def refuse_for_surface(names: Regions) -> None:
    """Raise :class:`OptionError` if regions are wanted of what has no tets."""
    if names is not None:
        raise OptionError(f"regions is {names!r}, but there are triangles alone; only tets have regions")
