"""The accessor ``.wct`` of pyvista's datasets, a front end like the command line; pyvista >= 0.48 finds it by itself.

It is registered under the entry-point group ``pyvista.accessors``: pyvista imports this module when somebody first
asks a dataset for ``.wct``, so nobody has to import anything of ours.

>>> import pyvista as pv  # doctest: +SKIP
>>> grid = pv.read("part.vtu").wct.optimize(goal="cwc")  # doctest: +SKIP
"""

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pyvista as pv

from wct_plugin.errors import OptionError
from wct_plugin.io.region_choice import Regions
from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.objects.conversions import as_mesh
from wct_plugin.objects.pyvista_meshes import from_pyvista, to_pyvista, without_field_data
from wct_plugin.pipeline.pipeline import mesher_within_tolerance
from wct_plugin.pipeline.stage import FilterStage, find_filter
from wct_plugin.progress import ProgressChoice
from wct_plugin.reports.report import Report, make_report

_OPTIMIZER = "meshing_well_centered"


def _optimized(
    stages: list[FilterStage[Any]], dataset: pv.DataSet, progress: ProgressChoice, regions: Regions = None
) -> pv.UnstructuredGrid:
    mesh, pairs = as_mesh(without_field_data(dataset), regions=regions), None  # field data are put back below
    if regions is not None and isinstance(mesh, TetMesh) and mesh.tag_name in mesh.cell_data:
        # A region of its own for every pair of region and tag, so that the interfaces of both are kept.
        both = np.column_stack([mesh.regions, mesh.cell_data[mesh.tag_name].astype(np.int64)])
        pairs, index = np.unique(both, axis=0, return_inverse=True)
        mesh = replace(mesh, regions=index.ravel())
    for stage in stages:
        mesh, _ = stage(mesh, progress)
    if pairs is not None and isinstance(mesh, TetMesh):
        mesh = replace(mesh, regions=pairs[mesh.regions, 0])
    grid = to_pyvista(mesh)
    for name, values in dataset.field_data.items():
        if name not in grid.field_data:
            grid.field_data[name] = values
    return grid


@pv.register_dataset_accessor("wct", pv.UnstructuredGrid)
class GridAccessor:
    """``grid.wct``: makes a tetrahedral grid well-centered, says and shows how well-centered it is."""

    def __init__(self, grid: pv.UnstructuredGrid) -> None:
        self._grid = grid

    def optimize(
        self, *, regions: Regions = None, progress: ProgressChoice = None, **options: Any
    ) -> pv.UnstructuredGrid:
        """Give a new grid whose tets contain their circumcenters, as far as can be; this one stays as it is.

        Arrays, regions and tagged triangles, lines and vertices are carried over; what cannot be is named in a warning.

        Parameters
        ----------
        regions : str or sequence of str, optional
            A cell array of region numbers, or sets of tets, whose interfaces are kept, as those of a conventional array
            such as ``gmsh:physical`` are in any case.
        progress : bool or callable, optional
            True: print where the work stands. A function is called with that; returning False stops the work.
        **options
            Those of ``filters.meshing_well_centered``: goal, boundary, tolerance, ...; ``reference`` may be a PolyData.
        """
        return _optimized([find_filter(_OPTIMIZER)(**options)], self._grid, progress, regions)

    def report(self, *, worst: int = 10) -> Report:
        """Measure: ranges of h/R and of angles, tiers, flags, histograms and the ``worst`` tets; ``to_dict()`` it."""
        return make_report(self._tets(), worst)

    def plot_bad(
        self, goal: Literal["3wc", "cwc"] = "cwc", *, show: bool = True, off_screen: bool | None = None, **options: Any
    ) -> pv.Plotter:
        """Show the tets that miss the goal in the outline of the domain, coloured by how far they miss it.

        Parameters
        ----------
        goal : str
            3wc: every tet contains its circumcenter; cwc: every triangle too.
        show : bool
            Show it now; else the plotter is given back open, to be added to.
        off_screen : bool, optional
            Draw without a window.
        **options
            For :meth:`pyvista.Plotter.show`, such as ``screenshot="bad.png"``.
        """
        if goal not in ("3wc", "cwc"):
            raise OptionError(f"goal is {goal!r}; allowed are '3wc', 'cwc'")
        mesh = self._tets()
        measured = compiled_quality.measure(mesh)
        margin, title = measured.min_height, "min h/R"
        if goal == "cwc":
            margin = np.minimum(margin, np.cos(np.radians(measured.max_face_angle)))
            title = "h/R or cosine"
        bad = margin <= 0
        plotter = pv.Plotter(off_screen=off_screen)
        skin = to_pyvista(mesh.boundary_surface())
        plotter.add_mesh(skin, color="lightgrey", opacity=0.15)
        creases = skin.extract_feature_edges(feature_angle=40, manifold_edges=False)
        if creases.n_cells:
            plotter.add_mesh(creases, color="black", line_width=1)
        if bad.any():
            tets = to_pyvista(TetMesh(mesh.points, mesh.tets[bad], cell_data={title: margin[bad]}))
            plotter.add_mesh(
                tets,
                scalars=title,
                cmap="inferno",
                clim=(-1, 0),
                lighting=False,  # shadows would change the colours
                show_edges=True,
                scalar_bar_args={"vertical": True, "n_labels": 3, "title_font_size": 16, "label_font_size": 14},
            )
        plotter.add_text(f"{bad.sum()} of {len(bad)} tets are not {goal.upper()}", font_size=10)
        if show:
            plotter.show(**options)
        return plotter

    def _tets(self) -> TetMesh:
        mesh = from_pyvista(without_field_data(self._grid))
        find_filter("get_quality").check_takes(type(mesh))
        assert isinstance(mesh, TetMesh)
        return mesh


@pv.register_dataset_accessor("wct", pv.PolyData)
class SurfaceAccessor:
    """``surface.wct``: fills a closed surface with well-centered tets."""

    def __init__(self, surface: pv.PolyData) -> None:
        self._surface = surface

    def optimize(self, *, progress: ProgressChoice = None, **options: Any) -> pv.UnstructuredGrid:
        """Fill the surface by fTetWild, then optimize against it, as ``wct optimize`` does with a surface.

        For another mesher, or other options of it: ``surface.tetgen.tetrahedralize().wct.optimize(reference=surface)``.

        Parameters
        ----------
        progress : bool or callable, optional
            As of a grid's.
        **options
            Those of ``filters.meshing_well_centered``.
        """
        optimizer = find_filter(_OPTIMIZER)(**options)
        mesher = mesher_within_tolerance(find_filter("generate_tetrahedralization")(), optimizer)
        return _optimized([mesher, optimizer], self._surface, progress)
