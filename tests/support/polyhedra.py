"""Volumes and areas of polyhedra from their faces alone, by the divergence theorem."""

import numpy as np


def area_vector(ring):
    """Of a polygon (k, 3), plane or not."""
    return np.cross(ring[1:-1] - ring[0], ring[2:] - ring[0]).sum(axis=0) / 2.0


def cone(ring, apex):
    """The volume of the pyramid from ``apex`` over a polygon that runs counter-clockwise seen from outside."""
    return np.linalg.det(np.stack([ring[0] - apex + 0 * ring[1:-1], ring[1:-1] - apex, ring[2:] - apex], 1)).sum() / 6.0


def measured(points, rings, owner, neighbour):
    """(c,) volumes, and (c,) how far each cell is from closed: the size of its faces' sum."""
    count = int(max(owner.max(), neighbour.max(initial=0))) + 1
    apex = np.zeros((count, 3))
    apex[owner] = [points[ring[0]] for ring in rings]  # a point of the cell, so that no digits are lost
    volumes, sums = np.zeros(count), np.zeros((count, 3))
    for face, ring in enumerate(rings):
        corners, area = points[ring], area_vector(points[ring])
        volumes[owner[face]] += cone(corners, apex[owner[face]])
        sums[owner[face]] += area
        if face < len(neighbour):
            volumes[neighbour[face]] -= cone(corners, apex[neighbour[face]])
            sums[neighbour[face]] -= area
    return volumes, np.linalg.norm(sums, axis=1)
