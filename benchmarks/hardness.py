"""Which corners, edges and joints come right how often: random bodies of several regions, well-centered and counted.

``python -m benchmarks.hardness SEED...`` prints a line per body, drawn by these seeds, and the tables that
docs/hardness.md shows.
"""

import tempfile
import time
import warnings
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import click
import numpy as np
from support.gmsh_bodies import random_body

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.measure.goals import misses
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import EDGES
from wct_plugin.types import Bools, Floats, Ints

_CREASE_ANGLE = 40.0
_EDGE_BINS = (0, 50, 75, 105, 140, 220, 300, 360)  # degrees that a region fills at an edge
_CORNER_BINS = (0, 0.04, 0.09, 0.16, 0.3, 0.6, 1)  # of the full solid angle that a region fills at a corner
_PLACES = ("outer", "interface meets outside", "inside")

Counts = dict[tuple[int, str], list[int]]  # bin, place -> how many there are, and how many have no bad tet


@click.command()
@click.argument("seeds", nargs=-1, type=int)
def main(seeds: tuple[int, ...]) -> None:
    """Print it all."""
    edges: Counts = defaultdict(lambda: [0, 0])
    corners: Counts = defaultdict(lambda: [0, 0])
    seeds = seeds or tuple(range(20))
    right = 0
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            body = random_body(Path(folder), seed)
        began = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh, metrics = wct.apply_filter("meshing_well_centered", body)
        seconds = time.process_time() - began
        bad = misses(mesh, quality.measure(mesh), "cwc")
        right += not bad.any()
        click.echo(
            f"{seed}: {len(np.unique(body.regions))} regions, {len(body.tets)} -> {len(mesh.tets)} tets, "
            f"{bad.sum()} bad, {seconds:.1f} s, losses {[loss['kind'] for loss in metrics['losses']]}"
        )
        _count_edges(mesh, bad, edges)
        _count_corners(mesh, bad, corners)
    click.echo(f"\n{right} of {len(seeds)} bodies come right\n")
    _print("a region fills at an edge, degrees", _EDGE_BINS, edges)
    _print("a region fills at a corner, of all round", _CORNER_BINS, corners)


def _count_edges(mesh: TetMesh, bad: Bools, into: Counts) -> None:
    """Per crease edge and region at it: the angle that the region fills there, and whether one of its tets is bad."""
    strata = find_strata(mesh, _CREASE_ANGLE)
    count = len(mesh.points)
    creases = np.unique(np.sort(strata.segments, axis=1) @ [count, 1])
    ends = np.sort(mesh.tets[:, EDGES], axis=2) @ np.array([count, 1])
    tet, k = np.nonzero(np.isin(ends, creases))
    _count(
        ends[tet, k],
        mesh.regions[tet],
        quality.dihedral_angles(mesh.points, mesh.tets)[tet, k],
        bad[tet],
        _EDGE_BINS,
        into,
    )


def _count_corners(mesh: TetMesh, bad: Bools, into: Counts) -> None:
    """The same per corner, with solid angles."""
    strata = find_strata(mesh, _CREASE_ANGLE)
    tet, k = np.nonzero((strata.stratum == 3)[mesh.tets])
    apex = mesh.tets[tet, k]
    rest = mesh.tets[tet][np.arange(4) != k[:, None]].reshape(-1, 3)
    a, b, c = np.moveaxis(mesh.points[rest] - mesh.points[apex][:, None], 1, 0)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    det = np.abs((a * np.cross(b, c)).sum(axis=1))
    dots = (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    solid = 2.0 * np.arctan2(det, la * lb * lc + dots) / (4.0 * np.pi)  # Van Oosterom and Strackee 1983
    _count(apex, mesh.regions[tet], solid, bad[tet], _CORNER_BINS, into)


def _count(place: Ints, region: Ints, angle: Floats, bad: Bools, bins: tuple[float, ...], into: Counts) -> None:
    """Add up per place and region; all round is 360, or 1, as the last of the bins."""
    keys, index = np.unique(np.column_stack([place, region]), axis=0, return_inverse=True)
    filled = np.bincount(index.ravel(), angle)
    wrong = np.bincount(index.ravel(), bad) > 0
    of_place = np.unique(keys[:, 0], return_inverse=True)[1]
    inside = np.bincount(of_place, filled) > bins[-1] * (1.0 - 1e-6)
    many = np.bincount(of_place) > 1
    for k, which in enumerate(np.searchsorted(bins, filled, side="right") - 1):
        one = of_place[k]
        kind = _PLACES[2] if inside[one] else _PLACES[1] if many[one] else _PLACES[0]
        entry = into[min(int(which), len(bins) - 2), kind]
        entry[0] += 1
        entry[1] += not wrong[k]


def _print(title: str, bins: tuple[float, ...], counts: Counts) -> None:
    click.echo(f"| {title} | " + " | ".join(_PLACES) + " |\n|" + " --- |" * (len(_PLACES) + 1))
    for k, (low, high) in enumerate(pairwise(bins)):
        cells = [counts.get((k, place), [0, 0]) for place in _PLACES]
        said = [f"{100.0 * good / all_:.1f} % of {all_}" if all_ else "-" for all_, good in cells]
        click.echo(f"| {low:g} to {high:g} | " + " | ".join(said) + " |")
    click.echo()


if __name__ == "__main__":
    main()
