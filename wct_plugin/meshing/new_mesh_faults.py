"""Why a new mesh is no better than the one that came, whatever its tets are like."""

import warnings

from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.errors import WctWarning
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.region_topology import changes, measure_region_topology
from wct_plugin.mesh import TetMesh, unit_scaling
from wct_plugin.meshing.followed_surface import outer
from wct_plugin.meshing.normalized_mesh import NormalizedMesh
from wct_plugin.meshing.reference import Reference


def find_fault(old: NormalizedMesh, new: TetMesh, on: Reference, tolerance: float, *, stopped: bool) -> str:
    """What is wrong with the ``new`` mesh, in words; empty where nothing is.

    ``stopped``: the work was cut short, when its surface may not be near the one that is followed yet: ``on``, within
    the ``tolerance``, a length.
    """
    crossed = None if old.tangled else overlap(new)
    if crossed:
        return f"the new mesh overlaps itself {describe_place(unit_scaling.scaled(new, old.unit), crossed)}"
    if changes(measure_region_topology(old.mesh), measure_region_topology(new)):
        return "the new mesh has another topology"
    if stopped:
        surface = outer(on)
        far = measure_deviation(new.boundary_surface(), surface, compiled=True).max
        if far > tolerance and far > measure_deviation(old.mesh.boundary_surface(), surface, compiled=True).max:
            return "the new mesh is not near the surface yet"
    return ""


def describe_place(mesh: TetMesh, tets: tuple[int, int]) -> str:
    """The place of two tets that overlap."""
    x, y, z = mesh.points[mesh.tets[list(tets)]].mean(axis=(0, 1)).tolist()
    return f"near ({x:.4g}, {y:.4g}, {z:.4g})"


def warn_of_fault(fault: str) -> None:
    """Say that the mesh that came is given back, and what may help."""
    said = f"{fault}; the mesh stays as it is: a smaller tolerance or shorter edges may help"
    warnings.warn(said, WctWarning, stacklevel=3)


def warn_that_nothing_was_found() -> None:
    """Say that the mesh that came is given back."""
    warnings.warn("nothing better was found; the mesh stays as it is", WctWarning, stacklevel=3)
