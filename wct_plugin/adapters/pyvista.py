"""Pyvista's datasets as meshes and back, and the accessor ``.wct`` that pyvista >= 0.48 finds by itself.

The accessor is registered under the entry-point group ``pyvista.accessors``: pyvista imports this module when somebody
first asks a dataset for ``.wct``, so nobody has to import anything of ours.

>>> import pyvista as pv  # doctest: +SKIP
>>> grid = pv.read("part.vtu").wct.optimize(goal="cwc")  # doctest: +SKIP
"""

import warnings
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from wct_plugin import quality
from wct_plugin.adapters.formats import PYVISTA
from wct_plugin.adapters.meshio_read import NAME, TAGS, from_meshio
from wct_plugin.adapters.meshio_write import contents
from wct_plugin.errors import InputError, OptionError, WctWarning
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline import mesher_within_tolerance
from wct_plugin.report import Report, make_report
from wct_plugin.stage import Filter, find_filter

#: VTK's types of cells by meshio's names, and the number of points each has.
_TYPES = {"tetra": 10, "triangle": 5, "line": 3, "vertex": 1}
_WIDTHS = {"tetra": 4, "triangle": 3, "line": 2, "vertex": 1}
#: Types of any number of points, which are one of these where the number fits: polygon, polyline, polyvertex.
_ANY_NUMBER = {7: "triangle", 4: "line", 2: "vertex"}
_OPTIMIZER = "meshing_well_centered"


def from_pyvista(dataset: pv.DataSet) -> TetMesh | SurfaceMesh:
    """Make a mesh of a dataset: tets with the triangles, lines and vertices beside them, or a surface of triangles.

    Arrays go by the conventions of VTU files: integer tags from the first of the conventional cell arrays
    (``gmsh:physical``, ``medit:ref``, ...) that is there, ``set:NAME`` arrays as named sets.

    Parameters
    ----------
    dataset : pyvista.UnstructuredGrid or pyvista.PolyData
        What to take; it is left as it is.

    Raises
    ------
    InputError
        For other cells than tets, triangles, lines and vertices.
    """
    import meshio

    grid = dataset if isinstance(dataset, pv.UnstructuredGrid) else dataset.cast_to_unstructured_grid()
    what = type(dataset).__name__
    types, starts = np.array(grid.celltypes), np.asarray(pv.convert_array(grid.GetCells().GetOffsetsArray()))
    for code, kind in _ANY_NUMBER.items():
        types[(types == code) & (np.diff(starts) == _WIDTHS[kind])] = _TYPES[kind]
    for code in np.setdiff1d(types, list(_TYPES.values())).tolist():
        raise InputError(
            f"{what}: has {(types == code).sum()} {pv.CellType(code).name.lower()} cells; "
            "allowed are tetra, triangle, line and vertex (triangulate() makes these of most others)"
        )
    connectivity = np.asarray(grid.cell_connectivity)
    present = [(kind, code) for kind, code in _TYPES.items() if (types == code).any()]
    raw = meshio.Mesh(
        np.asarray(grid.points),
        [
            (kind, connectivity[starts[:-1][types == code][:, None] + np.arange(_WIDTHS[kind])])
            for kind, code in present
        ],
        point_data={name: np.asarray(values) for name, values in grid.point_data.items()},
        cell_data={
            name: [np.asarray(values)[types == code] for _, code in present] for name, values in grid.cell_data.items()
        },
        field_data={name: np.asarray(values) for name, values in grid.field_data.items()},
    )
    lost: list[str] = []
    try:
        mesh = from_meshio(raw, PYVISTA, lost, "", _tags(grid))
    except InputError as error:
        raise InputError(f"{what}: {error}") from error
    if lost:
        warnings.warn(f"{what}: not read: {', '.join(lost)}", WctWarning, stacklevel=2)
    return mesh


def _tags(grid: pv.UnstructuredGrid) -> tuple[str, ...]:
    """The name of the array of tags, if there is one."""
    return tuple(name for name in TAGS if name in grid.cell_data and np.any(grid.cell_data[name]))[:1]


def to_pyvista(mesh: TetMesh | SurfaceMesh) -> pv.UnstructuredGrid | pv.PolyData:
    """Make a dataset of a mesh: a grid of tets, then tagged facets, edges and vertices; a surface becomes PolyData.

    Every array spans all cells, with zero or NaN where a kind of cell lacks it. What does not go in, such as arrays of
    words, is named in a :class:`WctWarning`.
    """
    content, lost = contents(mesh, PYVISTA)
    if lost:
        warnings.warn(f"pyvista's dataset cannot carry, so dropped: {', '.join(lost)}", WctWarning, stacklevel=2)
    dataset: pv.UnstructuredGrid | pv.PolyData
    if isinstance(mesh, SurfaceMesh):
        triangles: Any = content.cells[0][1]  # its own type says "int", which no array of NumPy's is
        dataset = pv.PolyData.from_regular_faces(content.points, triangles)
    else:
        rows = [np.insert(cells, 0, cells.shape[1], axis=1).ravel() for _, cells in content.cells]
        types = [np.full(len(cells), _TYPES[kind], dtype=np.uint8) for kind, cells in content.cells]
        dataset = pv.UnstructuredGrid(np.concatenate(rows), np.concatenate(types), content.points)
    for name, values in content.point_data.items():
        dataset.point_data[name] = values
    for name, columns in content.cell_data.items():
        dataset.cell_data[name] = np.concatenate(columns)
    for name, pair in content.names.items():
        dataset.field_data[NAME + name] = pair
    return dataset


def _optimized(stages: list[Filter[Any]], dataset: pv.DataSet, regions: str | None = None) -> pv.UnstructuredGrid:
    mesh, pairs = from_pyvista(dataset), None
    if isinstance(mesh, TetMesh) and regions == mesh.tag_name and regions not in mesh.cell_data:
        regions = None  # the tags are the regions as it is
    if regions is not None and isinstance(mesh, TetMesh):
        # A region of its own for every pair of tag and number in the array, so that the interfaces of both are kept.
        both = np.column_stack([mesh.regions, _whole(mesh, regions)])
        pairs, index = np.unique(both, axis=0, return_inverse=True)
        mesh = replace(mesh, regions=index.ravel())
    for stage in stages:
        mesh, _ = stage(mesh)
    if regions is not None and pairs is not None and isinstance(mesh, TetMesh):
        tags, numbers = pairs[mesh.regions].T
        numbers = numbers.astype(mesh.cell_data[regions].dtype)
        mesh = replace(mesh, regions=tags, cell_data={**mesh.cell_data, regions: numbers})
    grid = to_pyvista(mesh)
    for name, values in dataset.field_data.items():
        if name not in grid.field_data:
            grid.field_data[name] = values
    return grid


def _whole(mesh: TetMesh, regions: str) -> NDArray[np.int64]:
    if regions not in mesh.cell_data:
        raise OptionError(f"regions is {regions!r}; allowed are the cell arrays: {', '.join(mesh.cell_data) or 'none'}")
    values = mesh.cell_data[regions]
    if values.ndim != 1 or values.dtype.kind not in "iuf" or (values != np.rint(values)).any():
        raise OptionError(f"regions is {regions!r}, {values.dtype} of shape {values.shape}; allowed are whole numbers")
    return values.astype(np.int64)


def _stage(name: str, options: dict[str, Any]) -> Filter[Any]:
    if isinstance(options.get("reference"), pv.DataSet):
        options = {**options, "reference": from_pyvista(options["reference"])}
    return find_filter(name)(**options)


@pv.register_dataset_accessor("wct", pv.UnstructuredGrid)
class GridAccessor:
    """``grid.wct``: makes a tetrahedral grid well-centered, says and shows how well-centered it is."""

    def __init__(self, grid: pv.UnstructuredGrid) -> None:
        self._grid = grid

    def optimize(self, *, regions: str | None = None, **options: Any) -> pv.UnstructuredGrid:
        """Give a new grid whose tets contain their circumcenters, as far as can be; this one stays as it is.

        Arrays, regions and tagged triangles, lines and vertices are carried over; what cannot be is named in a warning.

        Parameters
        ----------
        regions : str, optional
            A cell array of region numbers, whose interfaces are kept, as those of a conventional array such as
            ``gmsh:physical`` are in any case.
        **options
            Those of ``filters.meshing_well_centered``: goal, boundary, tolerance, ...; ``reference`` may be a PolyData.
        """
        return _optimized([_stage(_OPTIMIZER, options)], self._grid, regions)

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
        measured = quality.measure(mesh)
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
        mesh = from_pyvista(self._grid)
        find_filter("get_quality").check_takes(type(mesh))
        assert isinstance(mesh, TetMesh)
        return mesh


@pv.register_dataset_accessor("wct", pv.PolyData)
class SurfaceAccessor:
    """``surface.wct``: fills a closed surface with well-centered tets."""

    def __init__(self, surface: pv.PolyData) -> None:
        self._surface = surface

    def optimize(self, **options: Any) -> pv.UnstructuredGrid:
        """Fill the surface by fTetWild, then optimize against it, as ``wct optimize`` does with a surface.

        For another mesher, or other options of it: ``surface.tetgen.tetrahedralize().wct.optimize(reference=surface)``.

        Parameters
        ----------
        **options
            Those of ``filters.meshing_well_centered``.
        """
        optimizer = _stage(_OPTIMIZER, options)
        mesher = mesher_within_tolerance(find_filter("generate_tetrahedralization")(), optimizer)
        return _optimized([mesher, optimizer], self._surface)
