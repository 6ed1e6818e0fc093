"""Draws the pictures of docs/how_it_works.md: a plate with a hole, stage by stage.

``python docs/stage_pictures.py`` writes docs/stages/*.png.
"""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from paper_pictures import LIGHT, draw_edges, save, space

import wct_plugin as wct
from wct_plugin.core import _core
from wct_plugin.measure import quality
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.strata import find_strata
from wct_plugin.mesh.topology import FACETS, Topology

FOLDER = Path(__file__).with_name("stages")
SAMPLE = Path(wct.__file__).with_name("cli") / "samples" / "part.msh"
GOOD, BAD = "#cfe3f5", "#d7301f"


def recorded(mesh, **changes):
    """The new start, what the first search made of it with these options changed, and the mesh in the end."""
    starts, results = [], []
    resample, search = _core.resample, _core.search_well_centered

    def resampled(*given, **named):
        starts.append(resample(*given, **named))
        return starts[-1]

    def searched(start, surface, options, progress):
        results.append(search(start, surface, replace(options, **changes), progress))
        return results[-1]

    _core.resample, _core.search_well_centered = resampled, searched
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made, _ = wct.apply_filter("meshing_well_centered", mesh)
    finally:
        _core.resample, _core.search_well_centered = resample, search
    return starts[-1].mesh, results[0].mesh, made


def axes_of(figure, count, k, points, title):
    """Axes that hold all the points."""
    return space(figure, (1, count), k, title, points.min(axis=0), points.max(axis=0), (38, -62), zoom=1.05)


def add_triangles(axes, corners, colours):
    """Triangles (k, 3, 3), lit from one side."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    light = 0.72 + 0.28 * np.abs(normal @ LIGHT) / np.linalg.norm(normal, axis=1)
    shaded = np.array(colours, dtype=float)
    shaded[:, :3] *= light[:, None]
    axes.add_collection3d(Poly3DCollection(corners, facecolors=shaded, edgecolors="#0007", linewidths=0.25))


def draw_open(axes, points, tets):
    """The lower half of a mesh, its bad tets red; whole tets, so that the cut is rough."""
    mesh = TetMesh(points, tets)
    good = quality.measure(mesh).completely_well_centered
    centroids = mesh.points[mesh.tets].mean(axis=1)
    keep = np.flatnonzero(centroids[:, 2] < 0.5 * (points[:, 2].min() + points[:, 2].max()))
    topology = Topology(mesh.tets[keep], mesh.regions[keep], len(mesh.points))
    tet, local = topology.boundary_half_facets.T
    colours = np.where(good[keep[tet], None], to_rgba(GOOD), to_rgba(BAD))
    add_triangles(axes, mesh.points[mesh.tets[keep][tet[:, None], FACETS[local]]], colours)
    return int((~good).sum())


def strata(mesh):
    """Patches in colours, creases black, corners as dots."""
    found = find_strata(mesh)
    figure = Figure(figsize=(6.0, 2.9), layout="constrained")
    axes = axes_of(figure, 1, 1, mesh.points, "patches, creases (black) and corners (dots)")
    corners = mesh.points[found.triangles]
    add_triangles(axes, corners, colormaps["tab20"](found.patch % 20))
    draw_edges(axes, mesh.points[found.segments], "black", 1.4)
    dots = mesh.points[found.stratum == 3]
    axes.scatter(*dots.T, color="black", s=14, depthshade=False)
    return figure


def side_by_side(states):
    """Meshes cut open; ``states``: titles, points and tets."""
    figure = Figure(figsize=(4.6 * len(states), 2.7), layout="constrained")
    for k, (title, points, tets) in enumerate(states, 1):
        axes = axes_of(figure, len(states), k, points, "")
        bad = draw_open(axes, points, tets)
        axes.set_title(f"{title}: {len(tets)} tets, {bad} bad", fontsize=9)
    return figure


def main():
    """Write them all."""
    FOLDER.mkdir(exist_ok=True)
    mesh = wct.read(SAMPLE)
    start, _, made = recorded(mesh)
    _, repaired, _ = recorded(mesh, kicks=0)
    figures = {
        "strata": strata(mesh),
        "start": side_by_side(
            [("the mesh that came", mesh.points, mesh.tets), ("the new start", start.points, start.tets)]
        ),
        "search": side_by_side(
            [("repaired", repaired.points, repaired.tets), ("kicked and repaired again", made.points, made.tets)]
        ),
    }
    for name, figure in figures.items():
        save(figure, FOLDER / f"{name}.png", dpi=110, colours=48)


if __name__ == "__main__":
    main()
