"""The goals delaunay and one-sided: as little as possible is changed."""

import numpy as np

from wct_plugin.core.requests import ConformOptions
from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.meshing import conforming
from wct_plugin.meshing.judgement import Found
from wct_plugin.meshing.new_mesh_faults import find_fault, warn_of_fault, warn_that_nothing_was_found
from wct_plugin.meshing.normalized_mesh import NormalizedMesh, count_bad
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.transfer import carry, in_strata_of_mesh
from wct_plugin.meshing.well_center_options import WellCenterOptions
from wct_plugin.progress import ProgressCallback


def change_least(given: NormalizedMesh, options: WellCenterOptions, progress: ProgressCallback) -> Found:
    """The cheapest change that makes the mesh Delaunay or one-sided: none, where it is."""
    mesh, own = given.mesh, given.own
    tolerance = (options.tolerance or own.auto_tolerance()) * given.diagonal
    better, after = mesh, given.measured
    bad = given.count_bad(options.goal)
    if not bad:
        return Found(mesh, after, tolerance, {"stopped": False, "kept": True}, own)
    if options.boundary != "fixed":
        given.warn_of_thin_walls(tolerance)
    listen = Listener(progress, bad)
    if not listen.stopped:
        new = _conformed(given, tolerance, options, listen)
        measured = compiled_quality.measure(new)
        left = count_bad(new, measured, options.goal)
        fault = "" if new is mesh else find_fault(given, new, own, tolerance, stopped=False)
        if fault:
            warn_of_fault(fault)
        elif left * len(mesh.tets) < bad * len(new.tets):  # the output is never worse
            better, after, bad = new, measured, left
        elif not listen.stopped:
            warn_that_nothing_was_found()
        listen.measure(bad)
    return Found(better, after, tolerance, {"stopped": listen.stopped, "kept": False}, own)


def _conformed(given: NormalizedMesh, tolerance: float, options: WellCenterOptions, listen: Listener) -> TetMesh:
    """The mesh made so; itself where none was found, or with more tets than there may be."""
    mesh, own = given.mesh, given.own
    asked = ConformOptions(
        one_sided=options.goal == "one-sided",
        effort=options.effort,
        seed=options.seed + 1,
        stays=np.flatnonzero(given.choices.stays),
    )
    if given.choices.fixed.any() or _has_sheets(given):
        found = conforming.conform_inside(mesh, own, asked, listen.conform)
    else:
        found = conforming.conform(mesh, own, mesh.reference, tolerance, asked, listen.conform)
    if found is None:
        return mesh
    new = carry(mesh, own.strata, in_strata_of_mesh(found, own))
    return mesh if options.max_tets is not None and len(new.tets) > options.max_tets else new


def _has_sheets(given: NormalizedMesh) -> bool:
    """Whether facets inside a region are tagged."""
    topology = given.mesh.topology
    return len(given.own.strata.triangles) > len(topology.boundary) + len(topology.interfaces)
