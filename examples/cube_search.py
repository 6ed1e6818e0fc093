"""Search for cubes of few well-centered tets: symmetric point sets, annealed, polished by linear programs, certified.

A mesh of well-centered tets is the Delaunay tetrahedralization of its vertices, so it is enough to search for points.
Chains of random changes to a symmetric arrangement descend the core's energy; the best arrangement of each group and
count of tets is kept, and chains start again from these. What comes near the goal is polished without its symmetry: the
largest least margin that its connectivity allows. What then has clearance is rounded to as few decimals as it bears,
and counts if these pass in rational arithmetic. ``docs/records.md`` tells what was found and what came near.

Run it: ``python examples/cube_search.py --goal cwc --fewer-than 84 --chains 1000 --state cwc.json``, and again to go
on, also after it was killed. The same options and seed find the same. Findings are lines of JSON in
``cwc.found.jsonl``, the nearest failures of each count of tets are under "closest" in ``cwc.json``. The first chains
start from rough sketches of the smallest cubes known; ``--start found.jsonl`` starts from others.
"""

import argparse
import json
import os
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from cubes.descent import Goal, descend, tetrahedralization
from cubes.known import sketches
from cubes.moves import changed, layered_arrangement, random_arrangement
from cubes.obstructions import obstructions
from cubes.polish import polished
from cubes.symmetry import Arrangement, Floats, Ints, subgroups

from wct_plugin.certify.certificate import certify
from wct_plugin.mesh import TetMesh

PATIENCE = 60  # changes without gain before a chain ends
STARTS = 200  # new arrangements of which a chain takes the best
LARGEST_GROUP = 8
MOST_POINTS = {"cwc": 60, "3wc": 36}
PROMISING = {"cwc": 0.2, "3wc": 0.08}  # energy from which polishing is worth its while
PER_TET, PER_OBSTRUCTION = 0.008, 0.05  # what a tet too many costs, and a place known to be impossible
STATE = ("aim", "target", "chains", "archive", "dead_ends", "closest", "found")


@dataclass(frozen=True)
class Tried:
    """An arrangement after descent."""

    arrangement: Arrangement
    tets: Ints
    energy: float
    obstructed: int

    @property
    def count(self) -> int:
        """Tets."""
        return len(self.tets)

    @property
    def cell(self) -> str:
        """Where the archive keeps it."""
        return f"{self.arrangement.group}/{self.count}"


def _name(energy: float, tets: Ints) -> str:
    """What tells one end of descents from another."""
    return f"{len(tets)} {energy:.2e}"


class Search:
    """The state of a search: what it is for, the chains done, the best of each kind, and the findings."""

    def __init__(self, goal: Goal, fewer_than: int, margin: float, seed: int) -> None:
        self.aim: dict[str, Any] = {"goal": goal, "fewer_than": fewer_than, "margin": margin, "seed": seed}
        self.goal = goal
        self.target = fewer_than
        self.chains = 0
        self.archive: dict[str, dict[str, Any]] = {}
        self.dead_ends: dict[str, float] = {}
        self.closest: dict[str, dict[str, Any]] = {}
        self.found: list[dict[str, Any]] = []

    def chain(self) -> None:
        """One chain from a new arrangement or a kept one, until it stalls."""
        rng = np.random.default_rng([self.aim["seed"], self.chains])
        self.chains += 1
        now = self._beginning(rng)
        now = best = self._kept(now)
        idle = 0
        while idle < PATIENCE:
            idle += 1
            arrangement = changed(rng, now.arrangement)
            if arrangement is None or not 8 < 8 + arrangement.sizes.sum() <= MOST_POINTS[self.goal]:
                continue
            tried = self._descended(arrangement, below=2.5 * self._score(now) + 0.05)
            if tried is None:
                continue
            tried = self._kept(tried)
            if self._score(tried) < self._score(now) * (1 + 0.06 * rng.exponential()) + 0.0005:
                now = tried
            if self._score(tried) < self._score(best) - 1e-5:
                best, idle = tried, 0
            elif idle % (PATIENCE // 3) == 0:
                now = best

    def _score(self, tried: Tried) -> float:
        return self._cost(tried.energy, tried.count, tried.obstructed)

    def _cost(self, energy: float, count: int, obstructed: int) -> float:
        return energy + PER_TET * max(0, count - self.target + 1) + PER_OBSTRUCTION * obstructed

    def _beginning(self, rng: np.random.Generator) -> Tried:
        """A kept arrangement, sooner one of low cost, with its symmetry or without; or the best of many new ones."""
        kept = sorted(
            (self._cost(one["energy"], int(cell.split("/")[1]), one["obstructed"]), cell)
            for cell, one in self.archive.items()
        )
        if kept and rng.random() < 0.7:
            rank = min(int(rng.exponential(0.12 * len(kept))), len(kept) - 1)
            cell = kept[rank][1]
            arrangement = Arrangement(int(cell.split("/")[0]), np.array(self.archive[cell]["seats"]))
            tried = self._descended(arrangement.released() if rng.random() < 0.15 else arrangement)
            if tried is not None:
                return tried
        best: Tried | None = None
        tried_so_far = 0
        while best is None or tried_so_far < STARTS:
            tried_so_far += 1
            tried = self._descended(self._new(rng), below=2.5 * self._score(best) + 0.05 if best else np.inf)
            if tried is not None and (best is None or self._score(tried) < self._score(best)):
                best = tried
        return best

    def _new(self, rng: np.random.Generator) -> Arrangement:
        """From nothing: a random group, and about as many points as so few tets have."""
        sizes = np.array([len(group) for group in subgroups()])
        group = int(rng.choice(np.flatnonzero(sizes <= LARGEST_GROUP)))
        if self.goal == "cwc" and rng.random() < 0.8:
            return layered_arrangement(rng, group, int(rng.integers(1, 8)))
        return random_arrangement(rng, group, int(rng.integers(self.target // 3 + 2, self.target * 2 // 3 + 4)))

    def _descended(self, arrangement: Arrangement, below: float = np.inf) -> Tried | None:
        """After descent; None where points met, or left the face or edge of the cube they were on, or far above."""
        if len(arrangement.parameters) == 0:
            return None
        arrangement, energy = descend(arrangement, self.goal, 25)
        if energy >= below:
            return None
        arrangement, energy = descend(arrangement, self.goal, 90)
        if not energy < np.inf:
            return None
        points = arrangement.points()
        gaps = np.linalg.norm(points[:, None] - points, axis=2)
        if gaps[np.triu_indices(len(points), 1)].min() < 0.02:
            return None
        tets, obstructed = tetrahedralization(points)
        if self.goal == "cwc" and energy < 1:
            obstructed += obstructions(points, tets)
        if _name(energy, tets) in self.dead_ends:
            obstructed += 1
        return Tried(arrangement, tets, energy, obstructed)

    def _kept(self, tried: Tried) -> Tried:
        """Keep it if it is the best of its group and count, and polish it if it is near a find; what is known then."""
        kept = self.archive.get(tried.cell)
        if kept and self._score(tried) > 0.98 * self._cost(kept["energy"], tried.count, kept["obstructed"]):
            return tried
        if tried.count < self.target + 3 and tried.obstructed == 0 and tried.energy < PROMISING[self.goal]:
            points, tets, least = polished(tried.arrangement.points(), self.goal)
            if least > self.closest.get(str(len(tets)), {"margin": -1.0})["margin"]:
                self.closest[str(len(tets))] = {"margin": least, "points": (points + 0.5).tolist()}
            if least < self.aim["margin"]:
                tried = replace(tried, obstructed=1)
                self.dead_ends[_name(tried.energy, tried.tets)] = least
            elif len(tets) < self.target:
                self._publish(points, tets, least)
        self.archive[tried.cell] = {
            "energy": tried.energy,
            "obstructed": tried.obstructed,
            "seats": tried.arrangement.seats.tolist(),
        }
        return tried

    def _publish(self, points: Floats, tets: Ints, least: float) -> None:
        """A finding, if its decimals pass exactly."""
        for decimals in range(2, 8):
            rounded = np.round(points + 0.5, decimals)
            if certified(rounded, tets, self.goal, decimals):
                find = {"goal": self.goal, "count": len(tets), "vertices": len(points), "margin": least}
                find |= {"decimals": decimals, "chain": self.chains, "points": rounded.tolist(), "tets": tets.tolist()}
                self.found.append(find)
                self.target = len(tets)
                return

    def add(self, points: Floats) -> None:
        """Start from a cube of unit size with a corner at the origin."""
        seats = points - 0.5
        seats[np.abs(np.abs(seats) - 0.5) < 1e-9] = np.sign(seats[np.abs(np.abs(seats) - 0.5) < 1e-9]) * 0.5
        tried = self._descended(Arrangement(0, seats[(np.abs(seats) == 0.5).sum(1) < 3]))
        if tried is not None:
            self._kept(tried)

    def save(self, path: Path) -> None:
        """State and findings, each written whole or not at all."""
        state = {name: getattr(self, name) for name in STATE}
        lines = "".join(json.dumps(find) + "\n" for find in self.found)
        for target, text in ((path.with_suffix(".found.jsonl"), lines), (path, json.dumps(state))):
            scratch = target.with_name(target.name + ".part")
            scratch.write_text(text)
            os.replace(scratch, target)

    def resume(self, path: Path) -> None:
        """Go on from a saved state, which must be of a search for the same."""
        state = json.loads(path.read_text())
        if state["aim"] != self.aim:
            raise SystemExit(f"{path} is of a search for {state['aim']}, not for {self.aim}")
        for name in STATE:
            setattr(self, name, state[name])


def certified(points: Floats, tets: Ints, goal: Goal, decimals: int) -> bool:
    """Whether tets of a cube with these decimals are proven to meet the goal and to fill it, in rational arithmetic.

    The coordinates are scaled to integers, which floating point holds exactly.
    """
    side = 10**decimals
    whole = np.rint(points * side)
    x = whole.astype(object)[tets]
    a, b, c = (x[:, i] - x[:, 0] for i in (1, 2, 3))
    sixfold = sum(a[:, i] * (b[:, i - 2] * c[:, i - 1] - b[:, i - 1] * c[:, i - 2]) for i in range(3))
    fills = min(sixfold) > 0 and sum(sixfold) == 6 * side**3 and whole.min() == 0 and whole.max() == side
    return bool(fills and certify(TetMesh(whole, tets)).meets(goal))


def main(arguments: list[str] | None = None) -> Search:
    """Search, and print what was found and what came nearest; by default find the 30 tets again from their sketch."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--goal", choices=("cwc", "3wc"), default="3wc")
    parser.add_argument("--fewer-than", type=int, default=31, help="tets; after a finding, than it has")
    parser.add_argument("--margin", type=float, default=1e-4, help="least h/R, and for cwc cosine, of a finding")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chains", type=int, default=1, help="how many more chains")
    parser.add_argument("--state", type=Path, help="file to go on from, and to write after every chain")
    parser.add_argument("--start", type=Path, nargs="*", help="lines of JSON with points of unit cubes")
    given = parser.parse_args(arguments)
    search = Search(given.goal, given.fewer_than, given.margin, given.seed)
    if given.state and given.state.exists():
        search.resume(given.state)
    else:
        lines = [line for path in given.start or [] for line in path.read_text().splitlines()]
        for points in [np.array(json.loads(line)["points"]) for line in lines] or sketches(given.goal):
            search.add(points)
    for remaining in range(given.chains, -1, -1):
        if given.state:
            search.save(given.state)
        if remaining:
            search.chain()
    counts = sorted(search.closest, key=int)
    near = ", ".join(f"{count}: {search.closest[count]['margin']:.1e}" for count in counts)
    finds = [f"{find['count']} (margin {find['margin']:.4f})" for find in search.found] or ["none"]
    for find in search.found:
        assert certified(np.array(find["points"]), np.array(find["tets"]), search.goal, find["decimals"])
        assert len(find["tets"]) == find["count"] < given.fewer_than
    print(f"{search.chains} chains for {given.goal}; found {', '.join(finds)}; best margins by tets {near}")
    return search


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main()
    else:
        assert main().found[0]["count"] == 30
