"""The whole job in one call, for whatever holds the mesh: :func:`optimize` and :func:`report`."""

import os
import warnings
from typing import Any

from wct_plugin.errors import OptionError, WctWarning
from wct_plugin.io.region_choice import Regions
from wct_plugin.mesh import TetMesh
from wct_plugin.objects import conversions
from wct_plugin.pipeline.fractions import told_as_lengths
from wct_plugin.pipeline.graph import Step, find_stage, unplaced_errors
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.pipeline.readers_writers import ReadMesh, writer_type
from wct_plugin.pipeline.stage import check_kind, find_filter
from wct_plugin.progress import ProgressChoice
from wct_plugin.reports.report import Report, make_report

#: The filter that :func:`optimize` runs.
OPTIMIZER = "meshing_well_centered"
_MESHER = "generate_tetrahedralization"


def optimize(
    source: Any,
    target: str | os.PathLike[str] | None = None,
    *,
    to: str | None = None,
    regions: Regions = None,
    progress: ProgressChoice = None,
    **options: Any,
) -> Any:
    """Make the tets of a mesh contain their circumcenters, and give back what came in; ``source`` stays as it is.

    >>> better = optimize(meshio.read("part.msh"), goal="3wc")  # doctest: +SKIP
    >>> points, tets = optimize((points, tets))  # doctest: +SKIP
    >>> optimize("part.msh", "part.vtu")  # doctest: +SKIP

    Parameters
    ----------
    source : object
        A file's name, a mesh of ours, or what :func:`wct_plugin.objects.conversions.as_mesh` takes. A surface is filled
        by fTetWild first.
    target : str or Path, optional
        A file to write too; its report where the name ends in .html or .json.
    to : str, optional
        What to give back, one of ``conversions.TARGETS``. Without it what came in; a mesh of ours for a file, and
        where what came in cannot hold tets, as a ``trimesh.Trimesh``. For gmsh it is the name of a new model.
    regions : str or sequence of str, optional
        What the regions are, as of :func:`wct_plugin.read`.
    progress : bool or callable, optional
        True: print where the work stands. A function is called with that; returning False stops the work.
    **options
        Those of ``filters.meshing_well_centered``.

    Warns
    -----
    WctWarning
        If tets miss the goal or something of the domain was not kept, and for what cannot be carried along.

    Raises
    ------
    ObjectError
        For an object that no mesh can be made of.
    OptionError
        For options and values of ``to`` that are not there.
    """
    if to is not None and to not in conversions.TARGETS:
        raise OptionError(f"to is {to!r}; allowed are {', '.join(conversions.TARGETS)}")
    with told_as_lengths(lambda: conversions.as_mesh(source, regions=regions)):
        optimizer = find_filter(OPTIMIZER)(**options)
    mesh = conversions.as_mesh(source, regions=regions)
    mesher = [] if isinstance(mesh, TetMesh) else [find_filter(_MESHER)()]
    steps = [ReadMesh(filename=mesh), *mesher, optimizer]
    if target is not None:
        steps.append(find_stage(writer_type(os.fspath(target)))(filename=target))
    with unplaced_errors():
        result = Pipeline(map(Step, steps)).execute(progress)
    for goal in result.goals:
        if not goal.met:
            warnings.warn(f"missed: {goal}", WctWarning, stacklevel=2)
    return conversions.like(result.mesh, source) if to is None else conversions.converted(result.mesh, to)


def report(source: Any, *, worst: int = 10, exact: bool = False) -> Report:
    """Measure a tet mesh: ranges of h/R and of angles, tiers, flags, histograms, the worst tets; ``to_dict()`` it.

    Parameters
    ----------
    source : object
        A file's name, a mesh of ours, or what :func:`wct_plugin.objects.conversions.as_mesh` takes.
    worst : int
        How many of the worst tets to list.
    exact : bool
        Prove the flags in exact arithmetic.

    Raises
    ------
    OptionError
        For a surface, and a number of tets below zero.
    """
    find_filter("get_quality")(worst=worst)  # which declares it
    mesh = conversions.as_mesh(source)
    check_kind("report", TetMesh, type(mesh))
    assert isinstance(mesh, TetMesh)
    return make_report(mesh, worst, exact=exact)
