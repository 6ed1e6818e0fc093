"""Sets of an Abaqus file: what of the numbers and names that stand in them are rows of points and cells."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.abaqus_scope import Members, NamedSet, Scope
from wct_plugin.types import Ints

_NONE = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Numbered:
    """The numbers of what is in one place, and what each stands for; a number may be there several times."""

    ids: Ints  #: (k,) ascending
    values: Ints  #: (k,)
    others: Ints  #: numbers of what is known and not read

    @classmethod
    def of(cls, ids: Ints, values: Ints, others: Ints = _NONE) -> "Numbered":
        """From numbers in any order."""
        order = np.argsort(ids, kind="stable")
        return cls(ids[order], values[order], others)

    def find(self, members: Members) -> tuple[Ints, int]:
        """What members stand for, and how many of those named one by one are not there."""
        first = np.searchsorted(self.ids, members.ids, side="left")
        count = np.searchsorted(self.ids, members.ids, side="right") - first
        at = np.repeat(first - np.cumsum(count) + count, count) + np.arange(count.sum())
        missing = members.ids[(count == 0) & ~np.isin(members.ids, self.others)]
        chosen = np.zeros(len(self.ids), dtype=bool)
        chosen[at] = True
        for start, last, step in members.ranges.tolist():
            chosen |= (self.ids >= start) & (self.ids <= last) & ((self.ids - start) % step == 0)
        return self.values[chosen], len(missing)


class Sets:
    """The sets of one kind, of nodes or of elements."""

    def __init__(
        self,
        names: list[str],
        scopes: list[list[Scope]],
        numbered: list[Numbered],
        of: Callable[[Scope], dict[str, NamedSet]],
        lost: list[str],
    ) -> None:
        """For each place its name, which is empty for the whole, its scopes and its numbers."""
        self._places = {name.lower(): place for place, name in enumerate(names) if name}
        self._known: dict[tuple[int, str], Ints] = {}
        self._names, self._scopes, self._numbered, self._of, self._lost = names, scopes, numbered, of, lost

    def every(self) -> dict[str, tuple[int, str]]:
        """Place and key of each set by its name; where several places have one of that name, with the place's."""
        found: dict[str, tuple[int, str]] = {}
        for place, scopes in enumerate(self._scopes):
            for key, one in {key: one for scope in scopes for key, one in self._of(scope).items()}.items():
                several = sum(any(key in self._of(scope) for scope in other) for other in self._scopes) > 1
                name = f"{self._names[place]}.{one.name}" if several and self._names[place] else one.name
                found[name] = (place, key)
        return found

    def members(self, place: int, key: str, within: tuple[tuple[int, str], ...] = ()) -> Ints:
        """What is in a set, each once, ascending."""
        if (place, key) in self._known:
            return self._known[place, key]
        if (place, key) in within:
            raise InputError(f"has set {key!r}, which has itself among its members")
        parts = [_NONE]
        for one in (self._of(scope)[key] for scope in self._scopes[place] if key in self._of(scope)):
            for piece in one.pieces:
                where = self._place(piece.instance, one.name) if piece.instance else place
                values, missing = self._numbered[where].find(piece)
                parts.append(values)
                if missing:
                    self._lost.append(f"{missing} members of set {one.name!r}, which are not there")
                for name in piece.names:
                    parts.append(self._named(where, name, one.name, (*within, (place, key))))
        found = np.unique(np.concatenate(parts))
        read_limit.claim(found.nbytes, f"set {key!r}")
        self._known[place, key] = found
        return found

    def _place(self, instance: str, of: str) -> int:
        if instance not in self._places:
            raise InputError(f"has set {of!r} of instance {instance!r}, which is not there")
        return self._places[instance]

    def _named(self, place: int, name: str, of: str, within: tuple[tuple[int, str], ...]) -> Ints:
        """The members of a set by its name, or of one in an instance or a number there, by INSTANCE.NAME."""
        instance, dot, rest = name.lower().partition(".")
        if any(name.lower() in self._of(scope) for scope in self._scopes[place]):
            return self.members(place, name.lower(), within)
        if dot and instance in self._places:
            place = self._places[instance]
            if rest.isdigit():
                return self._numbered[place].find(Members(ids=np.array([int(rest)])))[0]
            if any(rest in self._of(scope) for scope in self._scopes[place]):
                return self.members(place, rest, within)
        self._lost.append(f"{name!r} in set {of!r}, which is no set")
        return _NONE
