"""Search for cubes of few well-centered tets: symmetric point sets, annealed, polished by linear programs, certified.

A mesh of well-centered tets is the Delaunay tetrahedralization of its vertices, so it is enough to search for points.
Chains of random changes to a symmetric arrangement descend the core's energy; the best arrangement of each group and
count of tets is kept, and chains start again from these. What comes near the goal is polished without its symmetry: the
largest least margin that its connectivity allows. What then has clearance is rounded to as few decimals as it bears,
and counts if these pass in rational arithmetic.

Run it: ``python examples/cube_search.py --goal cwc --fewer-than 84 --chains 1000 --state cwc.json``, and again to go
on, also after it was killed. The same options and seed find the same. Findings are lines of JSON in
``cwc.found.jsonl``. ``--start found.jsonl`` starts from cubes instead of from nothing.
"""

import argparse
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from cubes.descent import Goal, descend, tetrahedralization
from cubes.moves import changed, layered_arrangement, random_arrangement
from cubes.obstructions import obstructions
from cubes.polish import polished
from cubes.symmetry import Arrangement, Floats, Ints, subgroups

PATIENCE = 60  # changes without gain before a chain ends
LARGEST_GROUP = 8
MOST_POINTS = {"cwc": 60, "3wc": 36}
PROMISING = {"cwc": 0.2, "3wc": 0.03}  # energy from which polishing is worth its while
PER_TET, PER_OBSTRUCTION = 0.008, 0.05  # what a tet too many costs, and a place known to be impossible


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


class Search:
    """The state of a search: what it is for, the chains done, the best of each kind, and the findings."""

    def __init__(self, goal: Goal, fewer_than: int, margin: float, seed: int) -> None:
        self.aim: dict[str, Any] = {"goal": goal, "fewer_than": fewer_than, "margin": margin, "seed": seed}
        self.goal = goal
        self.target = fewer_than
        self.chains = 0
        self.archive: dict[str, dict[str, Any]] = {}
        self.found: list[dict[str, Any]] = []

    def chain(self) -> None:
        """One chain from a new arrangement or a kept one, until it stalls."""
        rng = np.random.default_rng([self.aim["seed"], self.chains])
        self.chains += 1
        now = self._descended(self._beginning(rng))
        if now is None:
            return
        best, idle = now, 0
        self._keep(now, rng)
        while idle < PATIENCE:
            idle += 1
            arrangement = changed(rng, now.arrangement)
            if arrangement is None or not 8 < 8 + arrangement.sizes.sum() <= MOST_POINTS[self.goal]:
                continue
            tried = self._descended(arrangement, below=2.5 * self._score(now) + 0.05)
            if tried is None:
                continue
            self._keep(tried, rng)
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

    def _beginning(self, rng: np.random.Generator) -> Arrangement:
        kept = sorted(
            (self._cost(one["energy"], int(cell.split("/")[1]), one["obstructed"]), cell)
            for cell, one in self.archive.items()
        )
        if kept and rng.random() < 0.7:
            rank = min(int(rng.exponential(0.12 * len(kept))), len(kept) - 1)
            cell = kept[rank][1]
            arrangement = Arrangement(int(cell.split("/")[0]), np.array(self.archive[cell]["seats"]))
            return arrangement.released() if rng.random() < 0.15 else arrangement
        sizes = np.array([len(group) for group in subgroups()])
        group = int(rng.choice(np.flatnonzero(sizes <= LARGEST_GROUP)))
        if self.goal == "cwc" and rng.random() < 0.8:
            return layered_arrangement(rng, group, int(rng.integers(1, 8)))
        return random_arrangement(rng, group, int(rng.integers(12, MOST_POINTS[self.goal])))

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
        return Tried(arrangement, tets, energy, obstructed)

    def _keep(self, tried: Tried, rng: np.random.Generator) -> None:
        """In the archive, if it is the best of its group and count; polish it if it is near a find."""
        score, kept = self._score(tried), self.archive.get(tried.cell)
        if kept is not None and score > 0.98 * self._cost(kept["energy"], tried.count, kept["obstructed"]):
            return
        entry = {"energy": tried.energy, "obstructed": tried.obstructed, "seats": tried.arrangement.seats.tolist()}
        self.archive[tried.cell] = entry
        if tried.count < self.target + 3 and tried.obstructed == 0 and tried.energy < PROMISING[self.goal]:
            points, tets, least = polished(tried.arrangement.points(), self.goal)
            entry |= {"margin": least, "polished_tets": len(tets), "polished": points.tolist()}
            if least >= self.aim["margin"] and len(tets) < self.target:
                self._publish(points, tets, least)

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

    def nearest(self) -> dict[int, float]:
        """The largest margin reached so far for each count of tets polished."""
        best: dict[int, float] = {}
        for entry in self.archive.values():
            if "margin" in entry:
                count = entry["polished_tets"]
                best[count] = max(entry["margin"], best.get(count, -np.inf))
        return dict(sorted(best.items()))

    def add(self, points: Floats, rng: np.random.Generator) -> None:
        """Start from a cube of unit size with a corner at the origin."""
        seats = points - 0.5
        seats[np.abs(np.abs(seats) - 0.5) < 1e-9] = np.sign(seats[np.abs(np.abs(seats) - 0.5) < 1e-9]) * 0.5
        tried = self._descended(Arrangement(0, seats[(np.abs(seats) == 0.5).sum(1) < 3]))
        if tried is not None:
            self._keep(tried, rng)

    def save(self, path: Path) -> None:
        """State and findings, each written whole or not at all."""
        state = {name: getattr(self, name) for name in ("aim", "target", "chains", "archive", "found")}
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
        for name in ("target", "chains", "archive", "found"):
            setattr(self, name, state[name])


def certified(points: Floats, tets: Ints, goal: str, decimals: int) -> bool:
    from cubes_exact import certified as exact
    size = 10**decimals
    return exact(np.round(points * size).astype(int), tets, size, goal)


def main(arguments: list[str] | None = None) -> Search:
    """Search, and print what was found and what came nearest."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--goal", choices=("cwc", "3wc"), default="3wc")
    parser.add_argument("--fewer-than", type=int, default=70, help="tets; after a finding, fewer than it has")
    parser.add_argument("--margin", type=float, default=1e-4, help="least h/R, and for cwc cosine, of a finding")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chains", type=int, default=3, help="how many more chains")
    parser.add_argument("--state", type=Path, help="file to go on from, and to write after every chain")
    parser.add_argument("--start", type=Path, nargs="*", default=[], help="lines of JSON with points of unit cubes")
    given = parser.parse_args(arguments)
    search = Search(given.goal, given.fewer_than, given.margin, given.seed)
    if given.state and given.state.exists():
        search.resume(given.state)
    else:
        for path in given.start:
            for line in path.read_text().splitlines():
                search.add(np.array(json.loads(line)["points"]), np.random.default_rng(given.seed))
    for _ in range(given.chains):
        search.chain()
        if given.state:
            search.save(given.state)
    near = ", ".join(f"{count}: {margin:.1e}" for count, margin in search.nearest().items())
    finds = [f"{find['count']} (margin {find['margin']:.4f})" for find in search.found] or ["none"]
    print(f"{search.chains} chains for {given.goal}; found {', '.join(finds)}; best margins by tets {near}")
    return search


if __name__ == "__main__":
    main()
