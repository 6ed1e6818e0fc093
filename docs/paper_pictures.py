"""Draws the pictures of docs/paper.md: the paper's figures, from the meshes of ``wct create``.

``python docs/paper_pictures.py`` writes docs/paper/*.png.
"""

from io import BytesIO
from itertools import combinations
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from PIL import Image

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import FACETS

FOLDER = Path(__file__).with_name("paper")
NORM = TwoSlopeNorm(0.0, -1 / 3, 1 / 3)
LIGHT = np.array([0.3, -0.8, 0.52])


def make(what, /, **options):
    """One of the meshes of ``wct create``."""
    return wct.apply_filter(f"create_{what}", **options)[0]


def space(figure, shape, k, title, low, high, view=(18, -65), zoom=1.1):
    """Axes for the box from ``low`` to ``high``, seen from elevation and azimuth ``view``."""
    axes = figure.add_subplot(*shape, k, projection="3d", elev=view[0], azim=view[1])
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(np.subtract(high, low), zoom=zoom)
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)
    return axes


def draw_tets(axes, mesh, which=slice(None), shrink=1.0, spread=0.0, alpha=1.0):
    """Tets as solids, coloured by their smallest h/R, drawn smaller and farther from the middle if so wanted."""
    corners = mesh.points[mesh.tets[which]]
    centers = corners.mean(axis=1, keepdims=True)
    corners = centers + shrink * (corners - centers) + spread * (centers - mesh.points.mean(axis=0))
    triangles = corners[:, FACETS].reshape(-1, 3, 3)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    light = 0.8 + 0.2 * np.abs(normal @ LIGHT) / np.linalg.norm(normal, axis=1)
    colours = colormaps["RdYlBu"](NORM(np.repeat(quality.measure(mesh).min_height[which], 4)))
    colours[:, :3] *= light[:, None]
    colours[:, 3] = alpha
    axes.add_collection3d(Poly3DCollection(triangles, facecolors=colours, edgecolors="#0008", linewidths=0.4))


def save(figure, path, dpi=100, colours=128):
    """Write a figure in so many colours: it takes a third of the bytes."""
    drawn = BytesIO()
    figure.savefig(drawn, dpi=dpi)
    Image.open(drawn).convert("RGB").quantize(colours).save(path, optimize=True)


def draw_sphere(axes, center, radius, colour, alpha=0.12):
    """A translucent sphere."""
    turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 41), np.linspace(0, np.pi, 21))
    unit = np.cos(turn) * np.sin(rise), np.sin(turn) * np.sin(rise), np.cos(rise)
    axes.plot_surface(*(c + radius * u for c, u in zip(center, unit, strict=True)), color=colour, alpha=alpha, lw=0)


def draw_edges(axes, segments, colour="#333", width=0.8):
    """Straight lines (k, 2, 3)."""
    axes.add_collection3d(Line3DCollection(segments, colors=colour, linewidths=width))


def single():
    """Figures 1 to 7: an equatorial ball, and six tetrahedra in their circumspheres."""
    figure = Figure(figsize=(10.5, 5.2), layout="constrained")
    box = -0.95 * np.ones(3), 0.95 * np.ones(3)
    mesh = make("tetrahedron", name="y2y3y")
    axes = space(figure, (2, 4), 1, "figure 1: equatorial ball", *box)
    base = mesh.points[:3]
    up = np.cross(base[1] - base[0], base[2] - base[0])
    center = up * (base[0] @ up) / (up @ up)  # the foot of the circumcenter, which is the origin
    draw_sphere(axes, np.zeros(3), 1.0, "#888")
    draw_sphere(axes, center, np.linalg.norm(base[0] - center), "#2f81f7", 0.25)
    draw_tets(axes, mesh, alpha=0.6)
    names = ("y2y3y", "n2y3y", "n2n3n", "y2y3n", "n2y3n", "n2n3y")
    for k, name in enumerate(names, 2):
        mesh = make("tetrahedron", name=name)
        axes = space(figure, (2, 4), k, f"figure {k}: {name}", *box)
        draw_sphere(axes, np.zeros(3), 1.0, "#888")
        draw_tets(axes, mesh, alpha=0.75)
        draw_edges(axes, 0.12 * np.stack([-np.eye(3), np.eye(3)], axis=1), "black", 1.2)
    return figure


def tilings():
    """Figures 8 to 10, and a prism."""
    figure = Figure(figsize=(10.5, 2.9), layout="constrained")
    tet = make("tetrahedron", name="sommerville")
    axes = space(figure, (1, 4), 1, "figure 8: Sommerville's", -1.5 * np.ones(3), 1.5 * np.ones(3), (11, -35))
    draw_tets(axes, tet)
    block = make("lattice_tiling", nx=4, p=3, q=2)
    height = block.points[:, 2]
    edges = block.points[block.topology.edges]
    flat = edges[np.ptp(edges[:, :, 2], axis=1) == 0]
    low, high = block.points.min(axis=0), block.points.max(axis=0)
    axes = space(figure, (1, 4), 2, "figure 9: a plane", low, high, (75, -90), 1.3)
    draw_edges(axes, flat[flat[:, 0, 2] == 0])
    axes = space(figure, (1, 4), 3, "figure 10: between planes", low, high, (12, -75), 1.3)
    draw_edges(axes, flat, "#999")
    at = block.points[block.tets].mean(axis=1)
    lower = (height[block.tets] == height[block.tets].min(axis=1, keepdims=True)).sum(axis=1)  # vertices below
    near = ((3, (1.0, 0.6, 0.2)), (1, (1.5, 1.5, 1.2)), (2, (3.6, 0.9, 0.9)))
    draw_tets(axes, block, [np.argmin(np.where(lower == k, ((at - x) ** 2).sum(axis=1), np.inf)) for k, x in near])
    prism = make("lattice_tiling", domain="prism", nx=4, p=3, q=2)
    axes = space(figure, (1, 4), 4, "a prism, 3 : 2", prism.points.min(axis=0), prism.points.max(axis=0), (20, -60))
    draw_tets(axes, prism, shrink=0.93)
    return figure


def cubes():
    """Figure 11 and the other cubes, cut open; the corner of a cube, taken apart."""
    figure = Figure(figsize=(10.5, 5.4), layout="constrained")
    box = -0.12 * np.ones(3), 1.12 * np.ones(3)
    for k, variant in enumerate(("194_paper", "194", "194_best", "84", "32", "30"), 1):
        mesh = make("cube", variant=variant)
        axes = space(figure, (2, 4), k, f"create_cube variant={variant}", *box)
        near = mesh.points[mesh.tets].mean(axis=1) @ [0.35, -0.85, 0.4]
        draw_tets(axes, mesh, np.flatnonzero(near < np.quantile(near, 0.75)), shrink=0.97)
        corners = np.array(list(np.ndindex(2, 2, 2)), dtype=float)
        frame = [pair for pair in combinations(corners, 2) if np.abs(pair[0] - pair[1]).sum() == 1]
        draw_edges(axes, np.array(frame), "#999", 0.6)
    corner = make("cube_corner")
    axes = space(figure, (2, 4), 7, "create_cube_corner, 34 tets", -0.25 * np.ones(3), 1.05 * np.ones(3), (20, 35))
    draw_tets(axes, corner, shrink=0.95, spread=0.35)
    image = np.ones((2, 2, 2), dtype=bool)
    image[1, 0, 1] = image[1, 0, 0] = False
    voxels = make("from_voxels", voxels=image)
    axes = space(figure, (2, 4), 8, "create_from_voxels, 6 voxels", np.zeros(3), 2.0 * np.ones(3), zoom=0.95)
    draw_tets(axes, voxels)
    return figure


def subdivisions():
    """Figures 12 to 15: the regular tetrahedron, taken apart."""
    figure = Figure(figsize=(10.5, 2.9), layout="constrained")
    for k, (variant, title) in enumerate(
        {"8a": "figure 12: 8a", "8b": "figure 13: 8b", "8": "8, ours", "49": "figures 14, 15: 49"}.items(), 1
    ):
        mesh = make("tetrahedron_subdivision", variant=variant)
        axes = space(figure, (1, 4), k, title, -4 * np.ones(3), 4 * np.ones(3), (22, -62))
        draw_tets(axes, mesh, shrink=0.96, spread=0.3)
        draw_edges(axes, np.array(list(combinations(mesh.points[:4], 2))), "#999", 0.6)
    return figure


def main():
    """Write all pictures, in 128 colours."""
    FOLDER.mkdir(exist_ok=True)
    for draw in (single, tilings, cubes, subdivisions):
        figure = draw()
        figure.colorbar(ScalarMappable(NORM, "RdYlBu"), ax=figure.axes, shrink=0.8, aspect=30, label="smallest h/R")
        save(figure, FOLDER / f"{draw.__name__}.png")


if __name__ == "__main__":
    main()
