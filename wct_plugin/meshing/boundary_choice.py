"""The option of what the boundary may do: one word for all of it, or one per group of facets."""

from collections.abc import Mapping
from typing import Any, Literal, get_args

import numpy as np

from wct_plugin.errors import OptionError
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.index_arrays import find_rows
from wct_plugin.mesh.strata import Strata
from wct_plugin.meshing import per_group
from wct_plugin.types import Bools, Ints

Choice = Literal["move", "keep", "fixed"]
Boundary = Choice | dict[str, Choice]

#: From free to fixed: where groups share a facet, the last of their choices holds.
CHOICES: tuple[Choice, ...] = get_args(Choice)

_ALLOWED = f"input should be {', '.join(map(repr, CHOICES[:-1]))} or {CHOICES[-1]!r}"


def parse(value: Any) -> Any:
    """Check what can be checked without the mesh; the command line gives mappings as text.

    Raises :class:`ValueError`, naming the group.
    """
    if isinstance(value, str) and "=" in value:
        value = per_group.parse(value)
    if isinstance(value, Mapping):
        for name, choice in value.items():
            if not isinstance(name, str) or choice not in CHOICES:
                raise ValueError(f"says {choice!r} of {name!r}; {_ALLOWED}")
        return dict(value)
    if value not in CHOICES:
        raise ValueError(f"{_ALLOWED}, or one of them per group of facets: NAME=CHOICE,*=CHOICE")
    return value


def in_part(wanted: Boundary, part: TetMesh, fixed: str) -> Boundary:
    """What is wanted of the groups that a part of a mesh has; the set ``fixed`` is, if any facet is in it."""
    if isinstance(wanted, str):
        if wanted == "fixed" or not len(part.facets.sets[fixed]):
            return wanted
        wanted = {per_group.REST: wanted}
    there = {per_group.REST, *part.names, *part.facets.sets, *map(str, np.unique(part.facets.tags).tolist())}
    return {group: choice for group, choice in wanted.items() if group in there} | {fixed: "fixed"}


class PatchChoices:
    """Which patches of the surface move, keep their vertices, or their facets too."""

    def __init__(self, wanted: Boundary, mesh: TetMesh, of: Strata) -> None:
        """Raises :class:`OptionError` for a group that the mesh has not."""
        count = int(of.patch.max(initial=-1)) + 1
        self._rank = np.zeros(count, dtype=np.int64)  # per patch, in CHOICES
        if isinstance(wanted, str):
            self._rank[:] = CHOICES.index(wanted)
            return
        self._rank[:] = CHOICES.index(wanted.get(per_group.REST, "move"))
        named = np.zeros(count, dtype=bool)
        row = find_rows(np.sort(of.triangles, axis=1), np.sort(mesh.facets.vertices, axis=1), len(mesh.points))
        for group, choice in wanted.items():
            if group == per_group.REST:
                continue
            patches = np.unique(of.patch[row[_members(mesh, group) & (row >= 0)]])
            before = np.where(named[patches], self._rank[patches], 0)
            self._rank[patches] = np.maximum(before, CHOICES.index(choice))
            named[patches] = True

    def level(self, patches: Ints) -> None:
        """Let these patches (k,) do no more than the one of them that is held most."""
        self._rank[patches] = self._rank[patches].max()

    @property
    def word(self) -> Choice:
        """What the patch that is freest may do."""
        return CHOICES[int(self._rank.min(initial=len(CHOICES) - 1))]

    @property
    def stays(self) -> Bools:
        """(patches,) whose vertices stay."""
        found: Bools = self._rank > 0
        return found

    @property
    def fixed(self) -> Bools:
        """(patches,) whose facets stay."""
        found: Bools = self._rank == len(CHOICES) - 1
        return found


def _members(mesh: TetMesh, group: str) -> Bools:
    """(k,) which tagged facets are of the group: a physical name, a set, or a tag as text."""
    facets = mesh.facets
    tags = {name: tag for name, (tag, dimension) in mesh.names.items() if dimension == 2}
    tags |= {str(tag): tag for tag in np.unique(facets.tags).tolist() if str(tag) not in tags}
    if group not in tags and group not in facets.sets:
        known = ", ".join(map(repr, dict.fromkeys([*tags, *facets.sets]))) or "none"
        where = mesh.source or "the mesh"
        raise OptionError(f"option 'boundary' names {group!r}, which is no group of facets of {where} (there: {known})")
    found: Bools = facets.tags == tags[group] if group in tags else np.zeros(len(facets), dtype=bool)
    if group in facets.sets:
        found[facets.sets[group]] = True
    return found
