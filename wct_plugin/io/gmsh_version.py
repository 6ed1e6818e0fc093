"""Which version of gmsh's format carries the groups of a mesh: 2.2 has one per cell, 4.1 any number."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import OutputError
from wct_plugin.io.gmsh_options import MshOptions
from wct_plugin.io.meshio_writers import Content
from wct_plugin.mesh import cell_kinds

_CALLED = {"tetra": "tets", "triangle": "facets", "line": "edges", "vertex": "vertices"}

_HIGHEST = 2**31 - 1


def settle(content: Content, msh: MshOptions) -> tuple[MshOptions, list[str]]:
    """The options with the version that will be written, and what there is to say of it.

    With ``groups`` "first", and where no cell is in several, the first group of each cell becomes its tag and
    ``content`` has no further groups. Raises :class:`OutputError` for cells in several groups that are all to be kept
    in version 2.2, and for tags beyond 4 bytes.
    """
    tags = dict(zip((kind for kind, _ in content.cells), content.cell_data["gmsh:physical"], strict=True))
    first = {kind: _first(own, content.groups.get(kind, {})) for kind, own in tags.items()}
    numbers = [*first.values(), *content.cell_data["gmsh:geometrical"]]
    highest = max(int(np.abs(own).max(initial=0)) for own in numbers)
    if highest > _HIGHEST:
        raise OutputError(f"has tag {highest}; gmsh files hold tags up to {_HIGHEST}")
    lost = {
        (kind, tag): count
        for kind, groups in content.groups.items()
        for tag, members in groups.items()
        if (count := int((first[kind][members] != tag).sum()))
    }
    if lost and msh.groups != "first":
        if msh.version == "4.1":
            return msh, []
        shared = _shared(content, first)
        if msh.version == "2.2":
            raise OutputError(
                f"{shared} are in several groups, and version 2.2 has one per cell; allowed are version 4.1, "
                "or groups 'first', which keeps the first of each cell"
            )
        said = (
            f"written as version 4.1, as {shared} are in several groups; DEVSIM, FiPy, gmshToFoam and NGSolve do not "
            "read it (groups 'first' writes version 2.2, with the first group of each cell)"
        )
        return replace(msh, version="4.1"), [said]
    content.cell_data["gmsh:physical"] = list(first.values())
    content.groups = {}
    said_lost = [
        f"group {_name(content, kind, tag)} lost {count} {_CALLED.get(kind, f'{kind} cells')}"
        for (kind, tag), count in lost.items()
    ]
    told = [f"each cell has its first group alone: {', '.join(said_lost)}"] if lost else []
    return replace(msh, version=msh.version or "2.2"), told


def _first(tags: NDArray[np.int64], groups: dict[int, NDArray[np.int64]]) -> NDArray[np.int64]:
    """The tag of each cell, or where it has none its first further group."""
    first = tags.copy()
    for tag, members in groups.items():
        bare = members[first[members] == 0]
        first[bare] = tag
    return first


def _shared(content: Content, first: dict[str, NDArray[np.int64]]) -> str:
    counts = []
    for kind, groups in content.groups.items():
        several = [members[first[kind][members] != tag] for tag, members in groups.items()]
        count = len(np.unique(np.concatenate(several))) if several else 0
        counts += [f"{count} {_CALLED.get(kind, f'{kind} cells')}"] * bool(count)
    return " and ".join(counts)


def _name(content: Content, kind: str, tag: int) -> str:
    own = tag, cell_kinds.dimension(kind)
    return next(repr(name) for name, pair in content.names.items() if tuple(pair) == own)
