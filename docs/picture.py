"""Draws the README's picture: two meshes cut open, each tet coloured by its smallest h/R.

``python docs/picture.py before.vtu after.vtu docs/bone.png``
"""

import sys

import numpy as np
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import wct_plugin as wct
from wct_plugin.measure import quality
from wct_plugin.mesh.topology import FACETS, Topology


def draw(axes, mesh, title, cut, norm):
    """Draw the tets beyond the plane through the middle, their outer facets coloured."""
    height = quality.measure(mesh).min_height
    centroids = mesh.points[mesh.tets].mean(axis=1)
    keep = np.flatnonzero(centroids @ cut > np.median(mesh.points @ cut))
    topology = Topology(mesh.tets[keep], mesh.regions[keep], len(mesh.points))
    tet, local = topology.boundary_half_facets.T
    corners = mesh.points[mesh.tets[keep][tet[:, None], FACETS[local]]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    light = 0.75 + 0.25 * np.abs(normal @ [0.3, -0.8, 0.52]) / np.linalg.norm(normal, axis=1)
    from matplotlib import colormaps

    colours = colormaps["RdYlBu"](norm(height[keep][tet]))
    colours[:, :3] *= light[:, None]
    axes.add_collection3d(Poly3DCollection(corners, facecolors=colours, edgecolors="#0006", linewidths=0.2))
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.0)
    axes.set_axis_off()
    share = 100 * (height > 0).mean()
    axes.set_title(f"{title}: {len(mesh.tets)} tets, {share:.1f} % contain their circumcenter", fontsize=10)


def main(before, after, target):
    """Write the picture of two mesh files."""
    figure = Figure(figsize=(11, 3.6), layout="constrained")
    meshes = [wct.read(before), wct.read(after)]
    thin = np.eye(3)[np.argmin(np.ptp(meshes[0].points, axis=0))]
    norm = TwoSlopeNorm(0.0, -0.4, 0.4)
    for k, (mesh, title) in enumerate(zip(meshes, ("fTetWild", "wct_plugin"), strict=True)):
        draw(figure.add_subplot(1, 2, k + 1, projection="3d", elev=20, azim=-75), mesh, title, thin, norm)
    from matplotlib.cm import ScalarMappable

    figure.colorbar(
        ScalarMappable(norm, "RdYlBu"), ax=figure.axes, shrink=0.6, label="smallest h/R (below 0: circumcenter outside)"
    )
    figure.savefig(target, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
