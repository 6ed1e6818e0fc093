"""The tets that miss the goal: where each sits, what it misses, and which option would free it."""

from collections import Counter
from collections.abc import Iterator
from typing import TypedDict

import numpy as np

from wct_plugin.measure.goals import DUAL, Dual, misses
from wct_plugin.measure.quality import Quality
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import Strata
from wct_plugin.mesh.triangle_surfaces import bends
from wct_plugin.obstructions import RECONNECT, Boundary, Connectivity, Goal, Reason, find_reasons
from wct_plugin.obstructions.reason import name
from wct_plugin.types import Bools, Ints

#: Class of a tet, by the highest stratum among its vertices.
CLASSES = ("interior", "patch", "crease", "corner")
#: What tets miss where the goal is one of the whole mesh.
_TIER = {"delaunay": "Delaunay", "one-sided": "one-sided"}
#: The same of other goals, by whether a tet is 3WC and 2WC.
_MISSED = {(False, False): "3WC, 2WC", (False, True): "3WC", (True, False): "2WC", (True, True): ""}
#: A patch that bends by less than this at a vertex, in degrees, is flat there.
_FLAT = 0.1
#: A crease is slight if it bends by at most this much more than the angle that makes it one, in degrees.
_SLIGHT = 10.0
#: How many reasons of each kind are named.
_NAMED = 5
#: How many tets are listed one by one: of more nobody reads, and to write them down takes longer than to measure them.
MOST_LISTED = 100_000


class RemainingTet(TypedDict):
    """One tet that misses the goal."""

    tet: int
    place: str  #: one of :data:`CLASSES`
    misses: str  #: "3WC", "2WC" or "3WC, 2WC"; "Delaunay" or "one-sided" where that is the goal
    min_height: float  #: smallest h/R
    max_face_angle: float  #: in degrees
    centroid: list[float]
    option: str  #: what would free it
    proof: str  #: why it, or one of a few that include it, never meets the goal under the options given; "" where open


class ReasonKind(TypedDict):
    """All reasons of one kind why the goal is out of reach."""

    why: str
    option: str  #: what would take them away
    count: int
    cells: list[list[list[int]]]  #: of the first few: the vertices, edges, facets and tets to blame, by their vertices


class RemainingKind(TypedDict):
    """The tets of one class that miss the same and that the same option would free."""

    place: str
    misses: str
    option: str
    count: int
    proven: int


class Remaining(TypedDict):
    """The tets that miss the goal, their number by class and by kind, and why the goal is out of reach."""

    count: int
    by_place: dict[str, int]
    proven: int  #: those with a proof that the options given rule the goal out
    reasons: list[ReasonKind]
    kinds: list[RemainingKind]  #: of all of them, most first
    tets: list[RemainingTet]  #: the worst :data:`MOST_LISTED`, worst first


def list_remaining(
    mesh: TetMesh,
    of: Strata,
    measured: Quality,
    *,
    goal: Goal | Dual,
    boundary: Boundary,
    crease_angle: float,
    stopped: bool,
    needed: int | None = None,
    connectivity: Connectivity = "free",
    fixed: Bools | None = None,
) -> Remaining:
    """Classify every tet that misses ``goal``, worst first by the smaller of min h/R and the smallest cosine.

    The options as of :func:`wct_plugin.obstructions.find_reasons`. ``needed``: tets without which there was no new
    start.
    """
    acute, dual = goal == "cwc", goal in DUAL
    bad = np.flatnonzero(misses(mesh, measured, goal))
    clearance = measured.min_height[bad]
    if acute:
        clearance = np.minimum(clearance, np.cos(np.radians(measured.max_face_angle[bad])))
    bad = bad[np.argsort(np.nan_to_num(clearance, nan=-np.inf), kind="stable")]
    place = of.stratum[mesh.tets[bad]].max(axis=1, initial=0)
    why = []
    if len(bad) and goal != "delaunay" and goal != "one-sided":
        why = find_reasons(mesh, of, bad, goal=goal, boundary=boundary, connectivity=connectivity, fixed=fixed)
    proofs: dict[int, Reason] = {}
    for reason in why:
        for tet in reason.tets:
            proofs.setdefault(tet, reason)
    proven = np.isin(bad, list(proofs))
    all_alike = "more time: it was stopped" if stopped else f"max_tets={needed}" if needed else ""
    if all_alike:
        options = [all_alike] * len(bad)
    else:
        advice = _Advice(mesh, of, boundary, crease_angle, connectivity, dual=dual)
        options = [advice.option(*one) for one in zip(bad.tolist(), place.tolist(), strict=True)]
    for k in np.flatnonzero(proven):
        options[k] = proofs[int(bad[k])].frees
    if not dual:
        holds = measured.well_centered_3[bad].tolist()
        options = [option + (", or goal=3wc" if one else "") for option, one in zip(options, holds, strict=True)]
    missed = _missed(measured, bad, _TIER[goal] if dual else "")
    places = [CLASSES[stratum] for stratum in place.tolist()]
    kinds = Counter(zip(places, missed, options, proven.tolist(), strict=True))
    listed = zip(_columns(mesh, measured, bad[:MOST_LISTED]), places, missed, options, strict=False)
    return {
        "count": len(bad),
        "by_place": {name: int((place == stratum).sum()) for stratum, name in enumerate(CLASSES)},
        "proven": int(proven.sum()),
        "reasons": _kinds_of_reasons(why),
        "kinds": _kinds_of_tets(kinds),
        "tets": [_described(*one, str(proofs.get(one[0][0], ""))) for one in listed],
    }


def _described(
    of: tuple[int, float, float, list[float]], place: str, missed: str, option: str, proof: str
) -> RemainingTet:
    tet, height, angle, centroid = of
    return {
        "tet": tet,
        "place": place,
        "misses": missed,
        "min_height": height,
        "max_face_angle": angle,
        "centroid": centroid,
        "option": option,
        "proof": proof,
    }


def _missed(measured: Quality, bad: Ints, tier: str) -> list[str]:
    """What each misses: the ``tier`` where the goal is one of the whole mesh."""
    if tier:
        return [tier] * len(bad)
    holds = zip(measured.well_centered_3[bad].tolist(), measured.well_centered_2[bad].tolist(), strict=True)
    return [_MISSED[both] for both in holds]


def _columns(mesh: TetMesh, measured: Quality, bad: Ints) -> Iterator[tuple[int, float, float, list[float]]]:
    """Number, smallest h/R, largest angle of a facet and centroid of each."""
    columns = (
        bad,
        measured.min_height[bad],
        measured.max_face_angle[bad],
        mesh.points[mesh.tets[bad]].mean(axis=1),
    )
    return zip(*(column.tolist() for column in columns), strict=True)


def _kinds_of_tets(counts: Counter[tuple[str, str, str, bool]]) -> list[RemainingKind]:
    """By class, what is missed, what would free it and whether there is a proof, as they are counted."""
    kinds: dict[tuple[str, str, str], RemainingKind] = {}
    for (place, missed, option, proven), count in counts.items():
        kind = kinds.setdefault(
            (place, missed, option), {"place": place, "misses": missed, "option": option, "count": 0, "proven": 0}
        )
        kind["count"] += count
        kind["proven"] += count * proven
    return sorted(kinds.values(), key=lambda kind: -kind["count"])


def _kinds_of_reasons(found: list[Reason]) -> list[ReasonKind]:
    kinds: dict[str, ReasonKind] = {}
    for one in found:
        kind = kinds.setdefault(one.why, {"why": one.why, "option": one.frees, "count": 0, "cells": []})
        kind["count"] += 1
        if len(kind["cells"]) < _NAMED:
            kind["cells"].append([list(cell) for cell in one.cells])
    return list(kinds.values())


class _Advice:
    """Which option takes away what holds a tet, from its class and the shape of the surface at its vertices."""

    def __init__(
        self,
        mesh: TetMesh,
        of: Strata,
        boundary: Boundary,
        crease_angle: float,
        connectivity: Connectivity,
        *,
        dual: bool,
    ) -> None:
        self._mesh, self._of, self._boundary, self._crease_angle = mesh, of, boundary, crease_angle
        self._connectivity, self._dual = connectivity, dual
        edges, bend, smooth = bends(mesh.points, of.triangles, of.patch)
        count = len(mesh.points)
        self._patch_bend = np.zeros(count)
        np.maximum.at(self._patch_bend, edges[smooth].ravel(), np.repeat(bend[smooth], 2))
        # Creases that their angle does not make (tags, regions, more than two sheets) no angle takes away.
        of_edge = dict(zip((edges @ [count, 1]).tolist(), bend.tolist(), strict=True))
        bend_of = np.array([of_edge.get(key, np.inf) for key in (of.segments @ [count, 1]).tolist()])
        bend_of[bend_of <= crease_angle] = np.inf
        self._crease_bend = np.zeros(count)
        np.maximum.at(self._crease_bend, of.segments.ravel(), np.repeat(bend_of, 2))

    def option(self, tet: int, stratum: int) -> str:
        if self._connectivity == "fixed":
            slide = "boundary=slide, or " if stratum and self._boundary == "fixed" else ""
            return slide + RECONNECT
        if stratum == 0:
            return "a larger effort"
        if self._dual:  # the surface's vertices stay in any case, so keep and move are the same
            return "boundary=keep or move" if self._boundary == "fixed" else "a larger tolerance, or a larger effort"
        if self._boundary != "move":
            return "boundary=move" if self._boundary == "keep" else "boundary=keep or move"
        vertices = self._mesh.tets[tet]
        on_crease = vertices[self._of.stratum[vertices] >= 2]
        if len(on_crease):
            bend = float(self._crease_bend[on_crease].max())
            if self._crease_angle < bend <= self._crease_angle + _SLIGHT:
                return f"a crease_angle above {bend:.1f}°: the crease bends no more"
        curved = bool((self._patch_bend[vertices] > _FLAT).any())
        if stratum == 1 and not curved:
            return "a larger effort"
        return "a larger tolerance, or a smaller edge_length" if curved else "a smaller edge_length"


def title(found: Remaining) -> str:
    """What is left in one line."""
    places = ", ".join(f"{count} {place}" for place, count in found["by_place"].items() if count)
    proven = f"; for {found['proven']} it is provably out of reach under the options given" if found["proven"] else ""
    return f"{found['count']} tets miss the goal: {places}{proven}"


def lines(found: Remaining) -> list[str]:
    """Why the goal is out of reach, one line per kind of reason: how often, where first, and what would help."""
    return [
        f"provably impossible under these options, {kind['count']} times: {kind['why']}"
        f" (first at {', '.join(map(name, kind['cells'][0]))}); {kind['option']} would free it"
        for kind in found["reasons"]
    ]


HEAD = ("tet", "class", "misses", "min h/R", "max face angle", "centroid", "what would free it")


def rows(found: Remaining, most: int) -> list[tuple[str, ...]]:
    """Up to ``most`` tets, worst first, in the columns of :data:`HEAD`."""
    return [
        (
            str(tet["tet"]),
            tet["place"],
            tet["misses"],
            f"{tet['min_height']:.3f}",
            f"{tet['max_face_angle']:.2f}°",
            "(" + ", ".join(f"{x:.4g}" for x in tet["centroid"]) + ")",
            "; ".join(filter(None, (tet["option"], tet["proof"]))),
        )
        for tet in found["tets"][:most]
    ]


#: Columns of :func:`kinds`.
KINDS = ("class", "tets", "misses", "what would free them", "provably bad")


def kinds(found: Remaining) -> list[tuple[str, ...]]:
    """How many tets there are of each class that miss the same and that the same option would free, most first."""
    return [
        (kind["place"], str(kind["count"]), kind["misses"], kind["option"], str(kind["proven"]))
        for kind in found["kinds"]
    ]
