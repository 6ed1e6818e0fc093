"""Made by `make docs` from the declarations of filters, readers and writers: their types."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, overload

from numpy.typing import ArrayLike

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.pipeline import Pipeline
from wct_plugin.progress import ProgressChoice
from wct_plugin.types import Metrics


class _Filters:
    def apply_coord_well_centering(
        self,
        *,
        goal: Literal["3wc", "cwc"] = "cwc",
        boundary: Literal["fixed", "slide"] = "slide",
        tolerance: float | None = 0.001,
        margin: float = 0.02,
        crease_angle: float = 40.0,
        effort: int = 1,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Move vertices so that more tets are well-centered; connectivity, ids, tags and data stay.

        No tet is ever inverted and never fewer tets contain their circumcenter than before. Sliding vertices stay on the
        surface that came in, and the facets between them, where it is curved, within the tolerance of it. Interfaces
        between regions and tagged facets count as boundary; tagged edges as creases, tagged vertices as corners. Vertices
        shared with other cells, and those of the sets RequiredTriangles and RequiredEdges, stay.
        Volumes of regions and sizes of tagged groups that change by more than .5 % are among the losses, and no success.
        The metrics say which tets miss the goal, and what in the connectivity or the boundary provably rules it out.

        Parameters
        ----------
        goal : 3wc | cwc, default cwc
            3wc: every tet contains its circumcenter; cwc: every triangle too.
        boundary : fixed | slide, default slide
            fixed: boundary vertices stay; slide: they move on their own patch or crease.
        tolerance : float or None, > 0, <= 0.1, default 0.001
            Farthest that sliding may take curved surfaces off where they were, as a fraction of the bounding-box diagonal; null: no limit.
        margin : float, >= 0, <= 0.3, default 0.02
            Clearance aimed at: smallest h/R and smallest cosine.
        crease_angle : float, > 0, < 180, default 40.0
            Boundary edges that bend more than this stay, in degrees.
        effort : int, >= 1, <= 100, default 1
            Multiplies the iterations; time grows with it.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def compute_power_weights(
        self,
        *,
        margin: float = 0.1,
        strict: bool = False,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Give each vertex a weight so that every tet contains its orthocenter: weighted well-centered.

        The mesh stays as it is. With a power distance |x - x_i|^2 - w_i in the place of the distance, the dual is still
        orthogonal to the mesh, and positive where every tet contains its orthocenter, also where it does not contain its
        circumcenter; it is not well-centered for that. Weights come from descent over the whole mesh and, where that leaves
        tets without or with a small margin, sparse linear programmes around them. Point data: ``power_weight`` (length
        squared, the smallest 0) and ``weighted_dual_volume``. Cell data: ``orthocenter_margin``, its smallest height over a
        facet in the tet's root mean square edge length (positive: contained), and ``min_weighted_dual_length``.
        ``compute_duals(mesh, weights)`` has all.
        Where a tet goes without, it is often because no weights exist: ``contradictions`` in the metrics names groups of
        tets, each proven in exact arithmetic to hold one at least that no weights can help together with the others.
        Refused are meshes with two points in one place and those whose boundary is no manifold.

        Parameters
        ----------
        margin : float, > 0, <= 0.2, default 0.1
            Height of the orthocenter over each facet aimed at, in the tet's root mean square edge length.
        strict : bool, default False
            Refuse a mesh for which no weights were found that give every tet its orthocenter.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def compute_scalar_by_well_centeredness(
        self,
        *,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Write per tet min_h_over_R, largest angles, flags and the shortest dual edge; per point the dual volume.

        Cell data: ``min_h_over_R`` (positive: 3WC), ``max_face_angle`` and ``max_dihedral_angle`` in degrees, ``is_3wc``,
        ``is_2wc``, ``is_cwc``, ``is_acute`` as 0 or 1, ``min_dual_length``, the shortest signed dual edge through the tet's
        facets. Point data: ``dual_volume``, the signed volume of the point's circumcentric dual cell.

        Parameters
        ----------
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def create_cube(
        self,
        *,
        variant: Literal["194", "194_paper", "194_best", "104", "87", "84", "33", "32", "30"] = "194",
        size: float = 1.0,
        tag: str = "",
    ) -> Pipeline:
        """Make a cube of few tets that are all well-centered, completely so in all variants of 84 and more.

        ``194_best`` has better quality than the paper's best cube, of 224 tets; ``32`` than its 3-well-centered one of 146.
        Coordinates have five decimals. The smaller the mesh, the narrower its margin: in h/R and in the
        cosines of the facet angles, that of ``104`` is 0.034, of ``87`` 0.008, of ``84`` 0.0002. The facets of the faces
        are tagged 1 to 6, ``x_min`` to ``z_max``.

        Parameters
        ----------
        variant : 194 | 194_paper | 194_best | 104 | 87 | 84 | 33 | 32 | 30, default 194
            Number of tets. 194: its faces match each other; 194_paper: on the paper's surface; 194_best: best quality; 104; 87: the fewest with clearance; 84: the fewest known; 33, 32, 30: 3-well-centered only.
        size : float, > 0, default 1.0
            Edge length.
        tag : str
            Name of the stage, for the inputs of others.
        """

    def create_cube_corner(
        self,
        *,
        size: float = 1.0,
        tag: str = "",
    ) -> Pipeline:
        """Make the corner of a cube, cut off by the plane through its neighbours, of 34 completely well-centered tets.

        No tet with three mutually orthogonal faces contains its circumcenter, so that the corner itself needs the most
        work in any well-centered mesh of a box. This one looks the same from each of its three legs. The
        facets of the faces are tagged: ``x_min``, ``y_min``, ``z_min``, and ``face_1`` for the cut.

        Parameters
        ----------
        size : float, > 0, default 1.0
            Length of the three edges at the right-angled corner.
        tag : str
            Name of the stage, for the inputs of others.
        """

    def create_from_voxels(
        self,
        *,
        voxels: ArrayLike | str,
        spacing: float | Sequence[float] = 1.0,
        max_bytes: int | None = None,
        variant: Literal["194", "194_paper", "194_best", "104", "87", "84", "33", "32", "30"] = "194",
        tag: str = "",
    ) -> Pipeline:
        """Fill every voxel with a well-centered mesh of the cube; neighbours match, so that the whole is well-centered too.

        Each voxel has the same mesh, reflected along the axes where its index is odd; neighbours are mirror images and
        share the triangles of their common face. The values of the voxels become regions; facets of the boundary are tagged
        1 to 6, ``x_min`` to ``z_max``, by the way they face. Voxels that touch only along an
        edge or at a vertex are refused. Voxels need not quite be cubes: variant 194 stays completely well-centered while
        the longest spacing is at most 1.04 times the shortest. Variants below 84 are 3-well-centered only.

        Parameters
        ----------
        voxels : ndarray or str
            Array indexed x, y, z, or its file: .npy, .tif of many pages, or a folder of images, one per z; 0 is empty, other values (true: 1) become regions.
        spacing : float or tuple, default 1.0
            Edge length of a voxel, or three (from the shell x,y,z) as far as the tets stay well-centered.
        max_bytes : int or None, >= 1, default none
            Most bytes that images may become (none: 100 times their files, at least 256 MiB).
        variant : 194 | 194_paper | 194_best | 104 | 87 | 84 | 33 | 32 | 30, default 194
            What fills a voxel: a variant of create_cube.
        tag : str
            Name of the stage, for the inputs of others.
        """

    def create_lattice_tiling(
        self,
        *,
        a: float = 0.7071067811865476,
        b: float = 0.7071067811865476,
        domain: Literal["cell", "slab", "prism"] = "cell",
        nx: int = 2,
        p: int = 2,
        q: int = 2,
        edge_length: float | None = None,
        size: float | None = None,
        tag: str = "",
    ) -> Pipeline:
        """Make one period of a tiling of space, of a slab or of a rectangular prism by two tetrahedra of equal volume.

        The vertices are the lattice of (1, 0, 0), (1/2, a, 0) and (1/2, 0, b). All tets are completely well-centered if and
        only if a and b are above 1/2; the metric ``condition_met`` says so. With a = b = 0.5 ** 0.5, the default, both are
        Sommerville's tetrahedron and the lattice is body-centered cubic. The block is flat in y and z; its two ends in x
        are ragged and fit each other. Point data ``periodic_class`` is equal where periods, listed in the metrics, take
        points to each other. The facets of the sides are tagged 1 to 6, ``x_min`` to ``z_max``.

        Parameters
        ----------
        a : float, > 0, default 0.7071067811865476
            Distance of rows of a plane, in edges along x; above 1/2: CWC.
        b : float, > 0, default 0.7071067811865476
            Distance of planes, in edges along x; above 1/2: CWC.
        domain : cell | slab | prism, default cell
            cell: repeats in x, y and z and so fills space; slab: in x and y; prism: in x only.
        nx : int, >= 1, default 2
            Edges along x in one period.
        p : int, >= 1, default 2
            Rows along y: the block is p a wide; p : q is the prism's ratio where a = b.
        q : int, >= 1, default 2
            Planes along z: the block is q b high.
        edge_length : float or None, > 0, default none
            Length of the edges along x (none: 1, or as size says).
        size : float or None, > 0, default none
            Length wanted: of the cell along x, of the slab along z (its thickness), of the prism along y.
        tag : str
            Name of the stage, for the inputs of others.
        """

    def create_tetrahedron(
        self,
        *,
        name: Literal["regular", "sommerville", "y2y3y", "n2y3y", "n2n3n", "y2y3n", "n2y3n", "n2n3y"] = "regular",
        size: float | None = None,
        tag: str = "",
    ) -> Pipeline:
        """Make one tetrahedron: the regular one, Sommerville's, or one of the six figures of the paper.

        The figures are named by what they show: dihedral acute, 2-well-centered (``2``), 3-well-centered (``3``), each
        with y or n; ``n2y3y`` is completely well-centered and not acute. Its facets are tagged, ``face_1`` to ``face_4``;
        one that faces along an axis is ``x_min``, ...

        Parameters
        ----------
        name : regular | sommerville | y2y3y | n2y3y | n2n3n | y2y3n | n2y3n | n2n3y, default regular
            regular; sommerville tiles space; the paper's others: acute, 2WC, 3WC, each y or n.
        size : float or None, > 0, default none
            Length of the longest edge (none: the paper's coordinates; regular: 8 ** 0.5).
        tag : str
            Name of the stage, for the inputs of others.
        """

    def create_tetrahedron_subdivision(
        self,
        *,
        variant: Literal["8a", "8b", "8", "49"] = "8",
        size: float | None = None,
        tag: str = "",
    ) -> Pipeline:
        """Make a regular tetrahedron of 8 or 49 completely well-centered ones.

        8: the midpoints of four edges slide off so that the octahedron between the cut corners becomes well-centered.
        49: its four faces match each other; better than the paper's in every column it prints. The facets of the faces are
        tagged, ``face_1`` to ``face_4``.

        Parameters
        ----------
        variant : 8a | 8b | 8 | 49, default 8
            8a, 8b: the paper's; 8: a better one of theirs; 49: the paper's, its four faces alike.
        size : float or None, > 0, default none
            Edge length (none: 72 ** 0.5, corners at (3, 3, 3), (3, -3, -3) and so on).
        tag : str
            Name of the stage, for the inputs of others.
        """

    def generate_boundary_surface(
        self,
        *,
        interfaces: bool = False,
        quality: Literal["min_h_over_R", "max_face_angle", "max_dihedral_angle"] = "min_h_over_R",
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Give the boundary of a tet mesh, each triangle with the quality of the tet behind it, for MeshLab to colour.

        In a PLY file the array ``quality`` is what MeshLab calls quality per face. An interface's tet is the worse of its
        two, and the triangle faces out of it. Tags and data of facets, data of points and of the tet behind are carried;
        where a facet's array and a tet's share a name, the facet's counts.

        Parameters
        ----------
        interfaces : bool, default False
            Take the facets between regions, too, each once.
        quality : min_h_over_R | max_face_angle | max_dihedral_angle, default min_h_over_R
            Which measure of the tet behind a facet becomes its quality; angles in degrees.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def generate_tetrahedralization(
        self,
        *,
        mesher: Literal["ftetwild", "tetgen"] = "ftetwild",
        edge_length: float = 0.05,
        epsilon: float = 0.0005,
        stop_energy: float = 10.0,
        num_opt_iter: int = 80,
        radius_edge: float = 1.4,
        min_dihedral: float = 10.0,
        keep_boundary: bool = False,
        timeout: float | None = None,
        memory_limit: float | None = None,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Fill a surface with tetrahedra by fTetWild or TetGen; the surface travels on as the mesh's reference.

        fTetWild is not reproducible: two runs give two meshes. It heals gaps and self-intersections within ``epsilon``.
        TetGen keeps the surface exactly, facet tags included, and makes regions of the volumes it divides; it needs a
        closed surface that does not intersect itself. A closed inner surface that faces inward is left hollow by both.

        Parameters
        ----------
        mesher : ftetwild | tetgen, default ftetwild
            fTetWild heals the surface and stays near it; TetGen needs a sound one and keeps it.
        edge_length : float, > 0, <= 1, default 0.05
            Target edge length, as a fraction of the diagonal; TetGen: of the largest tet.
        epsilon : float, > 0, <= 0.1, default 0.0005
            fTetWild: greatest distance of the boundary from the surface, as a fraction of the diagonal.
        stop_energy : float, >= 3, default 10.0
            fTetWild: stop when the worst AMIPS energy falls below (3 is a regular tet).
        num_opt_iter : int, >= 1, default 80
            fTetWild: greatest number of its optimisation passes.
        radius_edge : float, >= 1, default 1.4
            TetGen: greatest ratio of circumradius to shortest edge; it may not end below 1.2.
        min_dihedral : float, >= 0, <= 60, default 10.0
            TetGen: smallest dihedral angle in degrees; it may not end above 20.
        keep_boundary : bool, default False
            TetGen: split no triangle of the surface.
        timeout : float or None, > 0, default none
            Seconds after which the mesher is ended (default: none).
        memory_limit : float or None, > 0, default none
            TetGen: memory it may take, in MB.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def get_quality(
        self,
        *,
        worst: int = 10,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Measure a tet mesh: ranges of h/R, angles and R/l, tiers, flags, and the worst tets with their place.

        Parameters
        ----------
        worst : int, >= 0, default 10
            How many of the worst tets to list.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def meshing_well_centered(
        self,
        *,
        goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = "cwc",
        boundary: Literal["move", "keep", "fixed"] | Mapping[str, Literal["move", "keep", "fixed"]] = "move",
        tolerance: float | None = None,
        local_tolerance: bool = True,
        reference: Any = None,
        edge_length: float | str | Mapping[str, float] | ArrayLike | None = None,
        surface_edges: float = 1.25,
        crease_angle: float = 40.0,
        planes: Literal["exact", "input"] = "exact",
        merge: Literal["auto", "none", "all"] = "auto",
        max_tets: int | None = None,
        margin: float = 0.02,
        effort: int = 1,
        seed: int = 0,
        allow_released: bool = False,
        periodic: bool | None = None,
        force: bool = False,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Resample, reconnect and move until every tet contains its circumcenter; the surface stays within a tolerance.

        A lattice-like start (graded body-centered cubic inside, evenly spaced on patches and creases, relaxed) is repaired
        by local search: flips, edge removal, collapse, split, insertion and relocation round every tet that falls short.
        Where that is stuck, it goes on for longer, then starts again with shorter edges there, five times at most; if few
        tets are, the rest stays. All that ends after so much work, counted, as takes about 5 s and 5 ms per tet of CPU
        time; ``effort`` multiplies it.
        Regions and their interfaces, creases, corners and tagged facets and edges are kept, point data interpolated.
        Facets of a set RequiredTriangles and edges of a set RequiredEdges, as Medit's files have them, stay to the bit;
        other words of ``boundary`` for RequiredTriangles free its facets.
        Planes, straight creases and corners at them are kept exactly, and those that a file rounded are put right first;
        but for those smaller than 28 tolerances and 3 % of the diagonal: these move within the tolerance, as all that is
        curved does. Of the other creases, those that their angle alone makes and that hold tets back for long become
        ordinary surface within the tolerance, as on scans.
        With ``boundary`` keep or fixed the inside is filled anew between the surface facets, with up to twice the tets;
        where only some groups of facets stay, all else is resampled round them. With ``periodic``, and where the file
        says so, sides that are translates of each other match again, vertex for vertex.
        Where those or facets and edges tagged inside a region rule a new start out, the search starts from the mesh itself.
        Holes of the reference are closed and what of it runs on inside the body is cut off, by MeshLab, and followed where
        that bounds the mesh. Meshes of several regions, with tagged edges or vertices, or with tags that change where the
        reference has no edges follow their own facets instead of it, as do those that it does not bound.
        The goals delaunay and one-sided take the cheapest change instead: vertices of the surface stay with ``boundary``
        move too, but for some in thin layers, which delaunay moves a little within their plane where tets would be flat;
        those inside go where they crowd it, new ones come on it where its own are too far apart.
        A mesh that meets the goal, with its boundary within the tolerance, stays as it is, to the bit, also where it falls
        short of the margin; ``force`` or an edge length makes it anew.
        The metrics say which tets miss the goal, which option would free each, and how well the domain is kept.
        Hexahedra, wedges and pyramids stay as they are, and so do the facets that tets share with them. Tets with mid nodes
        are worked on by their corners; where they are curved the boundary stays near the curved surface.
        The unit of length is no matter: bounding boxes of 1e-90 to 1e90 across are taken, others are refused.

        Parameters
        ----------
        goal : delaunay | one-sided | 3wc | cwc, default cwc
            delaunay: no vertex inside a tet's sphere, and of several regions none with a negative couple; one-sided: all signed duals of every region positive; 3wc: every tet contains its circumcenter; cwc: every triangle too.
        boundary : move | keep | fixed or dict, default move
            move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay; or one of them per group of facets, set or tag, * for the rest: contact=fixed,*=move.
        tolerance : float or None, > 0, <= 0.1, default none
            Greatest distance from the reference, both ways, as a fraction of the diagonal (none: 1e-3, or the sag of the reference's own facets if larger).
        local_tolerance : bool, default True
            Locally never more than a tenth of the wall, gap or radius there, nor less than a quarter.
        reference : SurfaceMesh or str or None, default none
            Surface to stay near, or its file (none: the surface read at the start, or the own boundary).
        edge_length : float or str or dict or ndarray or None, default none
            Edge length in the mesh's unit: a number > 0, one per point, the name of point data, or one per region or group of facets, * for the rest: oxide=0.01,*=0.1 (none, or no *: the input's own); shorter where the tolerance needs it.
        surface_edges : float, > 0, default 1.25
            How long edges of the surface may be on average, in the input's own there; on groups and interfaces 0.82 of that; of no effect with edge_length.
        crease_angle : float, > 0, < 180, default 40.0
            Boundary edges that bend more than this are creases, in degrees.
        planes : exact | input, default exact
            exact: what is plane but for the rounding of a file becomes plane; input: all stays as it came.
        merge : auto | none | all, default auto
            Points that coincide exactly: auto: facets that do match again, other points stay apart; none: all stay apart; all: all are joined.
        max_tets : int or None, >= 1, default none
            Most tets that the new mesh may have (none: two million, or 20 times those that came if more).
        margin : float, >= 0, <= 0.1, default 0.02
            Clearance aimed at: smallest h/R and smallest cosine.
        effort : int, >= 1, <= 100, default 1
            Multiplies the work after which the search ends.
        seed : int, >= 0, default 0
            Of the random choices.
        allow_released : bool, default False
            Accept, as on scans, that creases which leave well-centered tets no place become ordinary surface, and that more of its edges bend.
        periodic : bool or None, default none
            Sides that are translates of each other, as a periodic cell's are, match again (none: where the file says that they are periodic).
        force : bool, default False
            Make the mesh anew although it meets the goal.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def meshlab(
        self,
        *,
        filter: str | None = None,
        arguments: Mapping[str, Any] = ...,
        script: str | PathLike[str] | None = None,
        timeout: float | None = None,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Run any pymeshlab filter, or an .mlx script of MeshLab, on a surface: repair, remesh, smooth, measure.

        Names, types, choices and declared ranges of all arguments are checked before anything runs. The metrics hold what
        the filters measure and every argument used, lengths in the mesh's unit. Tags and data stay with the points and
        triangles that keep their place; a warning names what is dropped. ``quality`` and the colours ``red``, ``green``,
        ``blue``, ``alpha`` are MeshLab's own, per point and per triangle.

        Parameters
        ----------
        filter : str or None, default none
            pymeshlab's name of a filter, as meshing_close_holes.
        arguments : dict, default {}
            The filter's arguments by name; a length is a number in the mesh's unit or a text like '1%', of the argument's greatest value, mostly the bounding box's diagonal.
        script : Path or None, default none
            A filter script of MeshLab (.mlx) to run instead.
        timeout : float or None, > 0, default none
            Seconds after which MeshLab is ended (default: none).
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

class _Readers:
    def __call__(
        self,
        source: Any,
        *,
        tag: str = "",
        regions: str | Sequence[str] | None = None,
        format: str | None = None,
        repair: bool = False,
        max_bytes: int | None = None,
    ) -> Pipeline: ...

    def mesh(
        self,
        *,
        filename: Any,
        regions: str | Sequence[str] | None = None,
        format: str | None = None,
        repair: bool = False,
        max_bytes: int | None = None,
        tag: str = "",
    ) -> Pipeline:
        """Read a surface or tet mesh in any format of :func:`wct_plugin.read`.

        Parameters
        ----------
        regions : str or list or None, default none
            What the regions are: the name of an array of whole numbers, or names of sets of tets (none: as the file says it).
        filename : Any
            The file, - for standard input; its suffix tells the format.
        format : str or None, default none
            Suffix of the format, as vtu, of a file whose name does not tell it (none: it does).
        repair : bool, default False
            Drop or mend broken tets: repeated, flat, or with a vertex twice.
        max_bytes : int or None, >= 1, default none
            Most bytes that packed or declared arrays may become (none: 100 times the files, or 256 MiB).
        tag : str
            Name of the stage, for the inputs of others.
        """

class _Writers:
    @overload
    def __call__(
        self,
        target: str | PathLike[str],
        *,
        tag: str = "",
        inputs: str | Sequence[str] = (),
        format: str | None = None,
        order: Literal[1, 2] | None = None,
        version: Literal["2.2", "4.1"] | None = None,
        binary: bool | None = None,
        groups: Literal["all", "first"] | None = None,
    ) -> Pipeline: ...

    @overload
    def __call__(
        self,
        target: str | PathLike[str],
        *,
        tag: str = "",
        inputs: str | Sequence[str] = (),
        format: Literal["html", "json"] | None = None,
        worst: int = 10,
    ) -> Pipeline: ...

    def mesh(
        self,
        *,
        filename: str,
        format: str | None = None,
        order: Literal[1, 2] | None = None,
        version: Literal["2.2", "4.1"] | None = None,
        binary: bool | None = None,
        groups: Literal["all", "first"] | None = None,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Write the mesh in any format of :func:`wct_plugin.write` and hand it on.

        Parameters
        ----------
        filename : str
            The file, - for standard output; its suffix tells the format.
        format : str or None, default none
            Suffix of the format, as vtu, of a file whose name does not tell it (none: it does).
        order : 1 | 2 or None, default none
            2: tets with nodes in the middle of their edges (none: as the tets that were read).
        version : 2.2 | 4.1 or None, default none
            Version of a .msh file (none: 2.2, or 4.1 where cells are in several groups).
        binary : bool or None, default none
            Whether a .msh file is binary (none: it is text).
        groups : all | first or None, default none
            Groups that a cell in several keeps in a .msh file (none: all).
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def report(
        self,
        *,
        filename: str,
        format: Literal["html", "json"] | None = None,
        worst: int = 10,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Write the report of a tet mesh, or of several side by side, as an HTML page or as JSON, and hand the last one on.

        JSON of one mesh is the object that ``wct report --json`` gives. JSON of several has the reports under their tags,
        and of the last one under ``filters`` the metrics of the filters it came through and under ``provenance`` its
        stages with options and seconds, and the versions. All are measured against the reference of the last one.

        Parameters
        ----------
        filename : str
            The file to write.
        format : html | json or None, default none
            html: a page that needs nothing else; json: numbers (none: as the file's suffix says).
        worst : int, >= 0, default 10
            How many of the worst tets to list.
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

    def dual(
        self,
        *,
        filename: str,
        format: Literal["vtu", "npz", "openfoam", "matrix-market"] | None = None,
        tag: str = "",
        inputs: str | Sequence[str] = (),
    ) -> Pipeline:
        """Write the circumcentric dual of a tet mesh, as Voronoi cells or as Hodge stars, and hand the mesh on.

        Voronoi cells: NAME.vtu, or constant/polyMesh in a folder, which is OpenFOAM's. Hodge stars and exterior
        derivatives: NAME.npz, or Matrix Market files in a folder.

        Parameters
        ----------
        filename : str
            The file, NAME.vtu or NAME.npz, or the folder to write.
        format : vtu | npz | openfoam | matrix-market or None, default none
            vtu: polyhedra; openfoam: polyMesh in a folder; npz, matrix-market: Hodge stars and derivatives (none: as the suffix says, a folder is openfoam).
        tag : str
            Name of the stage, for the inputs of others.
        inputs : str or list of str
            Tag of the stage whose mesh it takes (default: the stage before).
        """

Filter: _Filters
Reader: _Readers
Writer: _Writers

@overload
def apply_filter(
    stage: Literal["apply_coord_well_centering", "filters.apply_coord_well_centering"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    goal: Literal["3wc", "cwc"] = "cwc",
    boundary: Literal["fixed", "slide"] = "slide",
    tolerance: float | None = 0.001,
    margin: float = 0.02,
    crease_angle: float = 40.0,
    effort: int = 1,
) -> tuple[TetMesh, Metrics]:
    """Move vertices so that more tets are well-centered; connectivity, ids, tags and data stay.

    No tet is ever inverted and never fewer tets contain their circumcenter than before. Sliding vertices stay on the
    surface that came in, and the facets between them, where it is curved, within the tolerance of it. Interfaces
    between regions and tagged facets count as boundary; tagged edges as creases, tagged vertices as corners. Vertices
    shared with other cells, and those of the sets RequiredTriangles and RequiredEdges, stay.
    Volumes of regions and sizes of tagged groups that change by more than .5 % are among the losses, and no success.
    The metrics say which tets miss the goal, and what in the connectivity or the boundary provably rules it out.

    Parameters
    ----------
    goal : 3wc | cwc, default cwc
        3wc: every tet contains its circumcenter; cwc: every triangle too.
    boundary : fixed | slide, default slide
        fixed: boundary vertices stay; slide: they move on their own patch or crease.
    tolerance : float or None, > 0, <= 0.1, default 0.001
        Farthest that sliding may take curved surfaces off where they were, as a fraction of the bounding-box diagonal; null: no limit.
    margin : float, >= 0, <= 0.3, default 0.02
        Clearance aimed at: smallest h/R and smallest cosine.
    crease_angle : float, > 0, < 180, default 40.0
        Boundary edges that bend more than this stay, in degrees.
    effort : int, >= 1, <= 100, default 1
        Multiplies the iterations; time grows with it.
    """

@overload
def apply_filter(
    stage: Literal["compute_power_weights", "filters.compute_power_weights"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    margin: float = 0.1,
    strict: bool = False,
) -> tuple[TetMesh, Metrics]:
    """Give each vertex a weight so that every tet contains its orthocenter: weighted well-centered.

    The mesh stays as it is. With a power distance |x - x_i|^2 - w_i in the place of the distance, the dual is still
    orthogonal to the mesh, and positive where every tet contains its orthocenter, also where it does not contain its
    circumcenter; it is not well-centered for that. Weights come from descent over the whole mesh and, where that leaves
    tets without or with a small margin, sparse linear programmes around them. Point data: ``power_weight`` (length
    squared, the smallest 0) and ``weighted_dual_volume``. Cell data: ``orthocenter_margin``, its smallest height over a
    facet in the tet's root mean square edge length (positive: contained), and ``min_weighted_dual_length``.
    ``compute_duals(mesh, weights)`` has all.
    Where a tet goes without, it is often because no weights exist: ``contradictions`` in the metrics names groups of
    tets, each proven in exact arithmetic to hold one at least that no weights can help together with the others.
    Refused are meshes with two points in one place and those whose boundary is no manifold.

    Parameters
    ----------
    margin : float, > 0, <= 0.2, default 0.1
        Height of the orthocenter over each facet aimed at, in the tet's root mean square edge length.
    strict : bool, default False
        Refuse a mesh for which no weights were found that give every tet its orthocenter.
    """

@overload
def apply_filter(
    stage: Literal["compute_scalar_by_well_centeredness", "filters.compute_scalar_by_well_centeredness"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
) -> tuple[TetMesh, Metrics]:
    """Write per tet min_h_over_R, largest angles, flags and the shortest dual edge; per point the dual volume.

    Cell data: ``min_h_over_R`` (positive: 3WC), ``max_face_angle`` and ``max_dihedral_angle`` in degrees, ``is_3wc``,
    ``is_2wc``, ``is_cwc``, ``is_acute`` as 0 or 1, ``min_dual_length``, the shortest signed dual edge through the tet's
    facets. Point data: ``dual_volume``, the signed volume of the point's circumcentric dual cell.
    """

@overload
def apply_filter(
    stage: Literal["create_cube", "filters.create_cube"],
    /,
    *,
    progress: ProgressChoice = None,
    variant: Literal["194", "194_paper", "194_best", "104", "87", "84", "33", "32", "30"] = "194",
    size: float = 1.0,
) -> tuple[TetMesh, Metrics]:
    """Make a cube of few tets that are all well-centered, completely so in all variants of 84 and more.

    ``194_best`` has better quality than the paper's best cube, of 224 tets; ``32`` than its 3-well-centered one of 146.
    Coordinates have five decimals. The smaller the mesh, the narrower its margin: in h/R and in the
    cosines of the facet angles, that of ``104`` is 0.034, of ``87`` 0.008, of ``84`` 0.0002. The facets of the faces
    are tagged 1 to 6, ``x_min`` to ``z_max``.

    Parameters
    ----------
    variant : 194 | 194_paper | 194_best | 104 | 87 | 84 | 33 | 32 | 30, default 194
        Number of tets. 194: its faces match each other; 194_paper: on the paper's surface; 194_best: best quality; 104; 87: the fewest with clearance; 84: the fewest known; 33, 32, 30: 3-well-centered only.
    size : float, > 0, default 1.0
        Edge length.
    """

@overload
def apply_filter(
    stage: Literal["create_cube_corner", "filters.create_cube_corner"],
    /,
    *,
    progress: ProgressChoice = None,
    size: float = 1.0,
) -> tuple[TetMesh, Metrics]:
    """Make the corner of a cube, cut off by the plane through its neighbours, of 34 completely well-centered tets.

    No tet with three mutually orthogonal faces contains its circumcenter, so that the corner itself needs the most
    work in any well-centered mesh of a box. This one looks the same from each of its three legs. The
    facets of the faces are tagged: ``x_min``, ``y_min``, ``z_min``, and ``face_1`` for the cut.

    Parameters
    ----------
    size : float, > 0, default 1.0
        Length of the three edges at the right-angled corner.
    """

@overload
def apply_filter(
    stage: Literal["create_from_voxels", "filters.create_from_voxels"],
    /,
    *,
    progress: ProgressChoice = None,
    voxels: ArrayLike | str,
    spacing: float | Sequence[float] = 1.0,
    max_bytes: int | None = None,
    variant: Literal["194", "194_paper", "194_best", "104", "87", "84", "33", "32", "30"] = "194",
) -> tuple[TetMesh, Metrics]:
    """Fill every voxel with a well-centered mesh of the cube; neighbours match, so that the whole is well-centered too.

    Each voxel has the same mesh, reflected along the axes where its index is odd; neighbours are mirror images and
    share the triangles of their common face. The values of the voxels become regions; facets of the boundary are tagged
    1 to 6, ``x_min`` to ``z_max``, by the way they face. Voxels that touch only along an
    edge or at a vertex are refused. Voxels need not quite be cubes: variant 194 stays completely well-centered while
    the longest spacing is at most 1.04 times the shortest. Variants below 84 are 3-well-centered only.

    Parameters
    ----------
    voxels : ndarray or str
        Array indexed x, y, z, or its file: .npy, .tif of many pages, or a folder of images, one per z; 0 is empty, other values (true: 1) become regions.
    spacing : float or tuple, default 1.0
        Edge length of a voxel, or three (from the shell x,y,z) as far as the tets stay well-centered.
    max_bytes : int or None, >= 1, default none
        Most bytes that images may become (none: 100 times their files, at least 256 MiB).
    variant : 194 | 194_paper | 194_best | 104 | 87 | 84 | 33 | 32 | 30, default 194
        What fills a voxel: a variant of create_cube.
    """

@overload
def apply_filter(
    stage: Literal["create_lattice_tiling", "filters.create_lattice_tiling"],
    /,
    *,
    progress: ProgressChoice = None,
    a: float = 0.7071067811865476,
    b: float = 0.7071067811865476,
    domain: Literal["cell", "slab", "prism"] = "cell",
    nx: int = 2,
    p: int = 2,
    q: int = 2,
    edge_length: float | None = None,
    size: float | None = None,
) -> tuple[TetMesh, Metrics]:
    """Make one period of a tiling of space, of a slab or of a rectangular prism by two tetrahedra of equal volume.

    The vertices are the lattice of (1, 0, 0), (1/2, a, 0) and (1/2, 0, b). All tets are completely well-centered if and
    only if a and b are above 1/2; the metric ``condition_met`` says so. With a = b = 0.5 ** 0.5, the default, both are
    Sommerville's tetrahedron and the lattice is body-centered cubic. The block is flat in y and z; its two ends in x
    are ragged and fit each other. Point data ``periodic_class`` is equal where periods, listed in the metrics, take
    points to each other. The facets of the sides are tagged 1 to 6, ``x_min`` to ``z_max``.

    Parameters
    ----------
    a : float, > 0, default 0.7071067811865476
        Distance of rows of a plane, in edges along x; above 1/2: CWC.
    b : float, > 0, default 0.7071067811865476
        Distance of planes, in edges along x; above 1/2: CWC.
    domain : cell | slab | prism, default cell
        cell: repeats in x, y and z and so fills space; slab: in x and y; prism: in x only.
    nx : int, >= 1, default 2
        Edges along x in one period.
    p : int, >= 1, default 2
        Rows along y: the block is p a wide; p : q is the prism's ratio where a = b.
    q : int, >= 1, default 2
        Planes along z: the block is q b high.
    edge_length : float or None, > 0, default none
        Length of the edges along x (none: 1, or as size says).
    size : float or None, > 0, default none
        Length wanted: of the cell along x, of the slab along z (its thickness), of the prism along y.
    """

@overload
def apply_filter(
    stage: Literal["create_tetrahedron", "filters.create_tetrahedron"],
    /,
    *,
    progress: ProgressChoice = None,
    name: Literal["regular", "sommerville", "y2y3y", "n2y3y", "n2n3n", "y2y3n", "n2y3n", "n2n3y"] = "regular",
    size: float | None = None,
) -> tuple[TetMesh, Metrics]:
    """Make one tetrahedron: the regular one, Sommerville's, or one of the six figures of the paper.

    The figures are named by what they show: dihedral acute, 2-well-centered (``2``), 3-well-centered (``3``), each
    with y or n; ``n2y3y`` is completely well-centered and not acute. Its facets are tagged, ``face_1`` to ``face_4``;
    one that faces along an axis is ``x_min``, ...

    Parameters
    ----------
    name : regular | sommerville | y2y3y | n2y3y | n2n3n | y2y3n | n2y3n | n2n3y, default regular
        regular; sommerville tiles space; the paper's others: acute, 2WC, 3WC, each y or n.
    size : float or None, > 0, default none
        Length of the longest edge (none: the paper's coordinates; regular: 8 ** 0.5).
    """

@overload
def apply_filter(
    stage: Literal["create_tetrahedron_subdivision", "filters.create_tetrahedron_subdivision"],
    /,
    *,
    progress: ProgressChoice = None,
    variant: Literal["8a", "8b", "8", "49"] = "8",
    size: float | None = None,
) -> tuple[TetMesh, Metrics]:
    """Make a regular tetrahedron of 8 or 49 completely well-centered ones.

    8: the midpoints of four edges slide off so that the octahedron between the cut corners becomes well-centered.
    49: its four faces match each other; better than the paper's in every column it prints. The facets of the faces are
    tagged, ``face_1`` to ``face_4``.

    Parameters
    ----------
    variant : 8a | 8b | 8 | 49, default 8
        8a, 8b: the paper's; 8: a better one of theirs; 49: the paper's, its four faces alike.
    size : float or None, > 0, default none
        Edge length (none: 72 ** 0.5, corners at (3, 3, 3), (3, -3, -3) and so on).
    """

@overload
def apply_filter(
    stage: Literal["generate_boundary_surface", "filters.generate_boundary_surface"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    interfaces: bool = False,
    quality: Literal["min_h_over_R", "max_face_angle", "max_dihedral_angle"] = "min_h_over_R",
) -> tuple[SurfaceMesh, Metrics]:
    """Give the boundary of a tet mesh, each triangle with the quality of the tet behind it, for MeshLab to colour.

    In a PLY file the array ``quality`` is what MeshLab calls quality per face. An interface's tet is the worse of its
    two, and the triangle faces out of it. Tags and data of facets, data of points and of the tet behind are carried;
    where a facet's array and a tet's share a name, the facet's counts.

    Parameters
    ----------
    interfaces : bool, default False
        Take the facets between regions, too, each once.
    quality : min_h_over_R | max_face_angle | max_dihedral_angle, default min_h_over_R
        Which measure of the tet behind a facet becomes its quality; angles in degrees.
    """

@overload
def apply_filter(
    stage: Literal["generate_tetrahedralization", "filters.generate_tetrahedralization"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    mesher: Literal["ftetwild", "tetgen"] = "ftetwild",
    edge_length: float = 0.05,
    epsilon: float = 0.0005,
    stop_energy: float = 10.0,
    num_opt_iter: int = 80,
    radius_edge: float = 1.4,
    min_dihedral: float = 10.0,
    keep_boundary: bool = False,
    timeout: float | None = None,
    memory_limit: float | None = None,
) -> tuple[TetMesh, Metrics]:
    """Fill a surface with tetrahedra by fTetWild or TetGen; the surface travels on as the mesh's reference.

    fTetWild is not reproducible: two runs give two meshes. It heals gaps and self-intersections within ``epsilon``.
    TetGen keeps the surface exactly, facet tags included, and makes regions of the volumes it divides; it needs a
    closed surface that does not intersect itself. A closed inner surface that faces inward is left hollow by both.

    Parameters
    ----------
    mesher : ftetwild | tetgen, default ftetwild
        fTetWild heals the surface and stays near it; TetGen needs a sound one and keeps it.
    edge_length : float, > 0, <= 1, default 0.05
        Target edge length, as a fraction of the diagonal; TetGen: of the largest tet.
    epsilon : float, > 0, <= 0.1, default 0.0005
        fTetWild: greatest distance of the boundary from the surface, as a fraction of the diagonal.
    stop_energy : float, >= 3, default 10.0
        fTetWild: stop when the worst AMIPS energy falls below (3 is a regular tet).
    num_opt_iter : int, >= 1, default 80
        fTetWild: greatest number of its optimisation passes.
    radius_edge : float, >= 1, default 1.4
        TetGen: greatest ratio of circumradius to shortest edge; it may not end below 1.2.
    min_dihedral : float, >= 0, <= 60, default 10.0
        TetGen: smallest dihedral angle in degrees; it may not end above 20.
    keep_boundary : bool, default False
        TetGen: split no triangle of the surface.
    timeout : float or None, > 0, default none
        Seconds after which the mesher is ended (default: none).
    memory_limit : float or None, > 0, default none
        TetGen: memory it may take, in MB.
    """

@overload
def apply_filter(
    stage: Literal["get_quality", "filters.get_quality"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    worst: int = 10,
) -> tuple[TetMesh, Metrics]:
    """Measure a tet mesh: ranges of h/R, angles and R/l, tiers, flags, and the worst tets with their place.

    Parameters
    ----------
    worst : int, >= 0, default 10
        How many of the worst tets to list.
    """

@overload
def apply_filter(
    stage: Literal["meshing_well_centered", "filters.meshing_well_centered"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = "cwc",
    boundary: Literal["move", "keep", "fixed"] | Mapping[str, Literal["move", "keep", "fixed"]] = "move",
    tolerance: float | None = None,
    local_tolerance: bool = True,
    reference: Any = None,
    edge_length: float | str | Mapping[str, float] | ArrayLike | None = None,
    surface_edges: float = 1.25,
    crease_angle: float = 40.0,
    planes: Literal["exact", "input"] = "exact",
    merge: Literal["auto", "none", "all"] = "auto",
    max_tets: int | None = None,
    margin: float = 0.02,
    effort: int = 1,
    seed: int = 0,
    allow_released: bool = False,
    periodic: bool | None = None,
    force: bool = False,
) -> tuple[TetMesh, Metrics]:
    """Resample, reconnect and move until every tet contains its circumcenter; the surface stays within a tolerance.

    A lattice-like start (graded body-centered cubic inside, evenly spaced on patches and creases, relaxed) is repaired
    by local search: flips, edge removal, collapse, split, insertion and relocation round every tet that falls short.
    Where that is stuck, it goes on for longer, then starts again with shorter edges there, five times at most; if few
    tets are, the rest stays. All that ends after so much work, counted, as takes about 5 s and 5 ms per tet of CPU
    time; ``effort`` multiplies it.
    Regions and their interfaces, creases, corners and tagged facets and edges are kept, point data interpolated.
    Facets of a set RequiredTriangles and edges of a set RequiredEdges, as Medit's files have them, stay to the bit;
    other words of ``boundary`` for RequiredTriangles free its facets.
    Planes, straight creases and corners at them are kept exactly, and those that a file rounded are put right first;
    but for those smaller than 28 tolerances and 3 % of the diagonal: these move within the tolerance, as all that is
    curved does. Of the other creases, those that their angle alone makes and that hold tets back for long become
    ordinary surface within the tolerance, as on scans.
    With ``boundary`` keep or fixed the inside is filled anew between the surface facets, with up to twice the tets;
    where only some groups of facets stay, all else is resampled round them. With ``periodic``, and where the file
    says so, sides that are translates of each other match again, vertex for vertex.
    Where those or facets and edges tagged inside a region rule a new start out, the search starts from the mesh itself.
    Holes of the reference are closed and what of it runs on inside the body is cut off, by MeshLab, and followed where
    that bounds the mesh. Meshes of several regions, with tagged edges or vertices, or with tags that change where the
    reference has no edges follow their own facets instead of it, as do those that it does not bound.
    The goals delaunay and one-sided take the cheapest change instead: vertices of the surface stay with ``boundary``
    move too, but for some in thin layers, which delaunay moves a little within their plane where tets would be flat;
    those inside go where they crowd it, new ones come on it where its own are too far apart.
    A mesh that meets the goal, with its boundary within the tolerance, stays as it is, to the bit, also where it falls
    short of the margin; ``force`` or an edge length makes it anew.
    The metrics say which tets miss the goal, which option would free each, and how well the domain is kept.
    Hexahedra, wedges and pyramids stay as they are, and so do the facets that tets share with them. Tets with mid nodes
    are worked on by their corners; where they are curved the boundary stays near the curved surface.
    The unit of length is no matter: bounding boxes of 1e-90 to 1e90 across are taken, others are refused.

    Parameters
    ----------
    goal : delaunay | one-sided | 3wc | cwc, default cwc
        delaunay: no vertex inside a tet's sphere, and of several regions none with a negative couple; one-sided: all signed duals of every region positive; 3wc: every tet contains its circumcenter; cwc: every triangle too.
    boundary : move | keep | fixed or dict, default move
        move: resampled; keep: vertices stay, facets may flip or split; fixed: facets stay; or one of them per group of facets, set or tag, * for the rest: contact=fixed,*=move.
    tolerance : float or None, > 0, <= 0.1, default none
        Greatest distance from the reference, both ways, as a fraction of the diagonal (none: 1e-3, or the sag of the reference's own facets if larger).
    local_tolerance : bool, default True
        Locally never more than a tenth of the wall, gap or radius there, nor less than a quarter.
    reference : SurfaceMesh or str or None, default none
        Surface to stay near, or its file (none: the surface read at the start, or the own boundary).
    edge_length : float or str or dict or ndarray or None, default none
        Edge length in the mesh's unit: a number > 0, one per point, the name of point data, or one per region or group of facets, * for the rest: oxide=0.01,*=0.1 (none, or no *: the input's own); shorter where the tolerance needs it.
    surface_edges : float, > 0, default 1.25
        How long edges of the surface may be on average, in the input's own there; on groups and interfaces 0.82 of that; of no effect with edge_length.
    crease_angle : float, > 0, < 180, default 40.0
        Boundary edges that bend more than this are creases, in degrees.
    planes : exact | input, default exact
        exact: what is plane but for the rounding of a file becomes plane; input: all stays as it came.
    merge : auto | none | all, default auto
        Points that coincide exactly: auto: facets that do match again, other points stay apart; none: all stay apart; all: all are joined.
    max_tets : int or None, >= 1, default none
        Most tets that the new mesh may have (none: two million, or 20 times those that came if more).
    margin : float, >= 0, <= 0.1, default 0.02
        Clearance aimed at: smallest h/R and smallest cosine.
    effort : int, >= 1, <= 100, default 1
        Multiplies the work after which the search ends.
    seed : int, >= 0, default 0
        Of the random choices.
    allow_released : bool, default False
        Accept, as on scans, that creases which leave well-centered tets no place become ordinary surface, and that more of its edges bend.
    periodic : bool or None, default none
        Sides that are translates of each other, as a periodic cell's are, match again (none: where the file says that they are periodic).
    force : bool, default False
        Make the mesh anew although it meets the goal.
    """

@overload
def apply_filter(
    stage: Literal["meshlab", "filters.meshlab"],
    mesh: Any,
    /,
    *,
    progress: ProgressChoice = None,
    filter: str | None = None,
    arguments: Mapping[str, Any] = ...,
    script: str | PathLike[str] | None = None,
    timeout: float | None = None,
) -> tuple[SurfaceMesh, Metrics]:
    """Run any pymeshlab filter, or an .mlx script of MeshLab, on a surface: repair, remesh, smooth, measure.

    Names, types, choices and declared ranges of all arguments are checked before anything runs. The metrics hold what
    the filters measure and every argument used, lengths in the mesh's unit. Tags and data stay with the points and
    triangles that keep their place; a warning names what is dropped. ``quality`` and the colours ``red``, ``green``,
    ``blue``, ``alpha`` are MeshLab's own, per point and per triangle.

    Parameters
    ----------
    filter : str or None, default none
        pymeshlab's name of a filter, as meshing_close_holes.
    arguments : dict, default {}
        The filter's arguments by name; a length is a number in the mesh's unit or a text like '1%', of the argument's greatest value, mostly the bounding box's diagonal.
    script : Path or None, default none
        A filter script of MeshLab (.mlx) to run instead.
    timeout : float or None, > 0, default none
        Seconds after which MeshLab is ended (default: none).
    """

@overload
def optimize(
    source: str | PathLike[str] | TetMesh | SurfaceMesh,
    target: str | PathLike[str] | None = None,
    *,
    to: None = None,
    regions: str | Sequence[str] | None = None,
    progress: ProgressChoice = None,
    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = "cwc",
    boundary: Literal["move", "keep", "fixed"] | Mapping[str, Literal["move", "keep", "fixed"]] = "move",
    tolerance: float | None = None,
    local_tolerance: bool = True,
    reference: Any = None,
    edge_length: float | str | Mapping[str, float] | ArrayLike | None = None,
    surface_edges: float = 1.25,
    crease_angle: float = 40.0,
    planes: Literal["exact", "input"] = "exact",
    merge: Literal["auto", "none", "all"] = "auto",
    max_tets: int | None = None,
    margin: float = 0.02,
    effort: int = 1,
    seed: int = 0,
    allow_released: bool = False,
    periodic: bool | None = None,
    force: bool = False,
) -> TetMesh:
    """Make the tets of a mesh contain their circumcenters, and give back what came in; ``source`` stays as it is."""

@overload
def optimize(
    source: Any,
    target: str | PathLike[str] | None = None,
    *,
    to: Literal["arrays", "meshio", "pyvista", "skfem", "gmsh", "pymeshlab", "trimesh"] | None = None,
    regions: str | Sequence[str] | None = None,
    progress: ProgressChoice = None,
    goal: Literal["delaunay", "one-sided", "3wc", "cwc"] = "cwc",
    boundary: Literal["move", "keep", "fixed"] | Mapping[str, Literal["move", "keep", "fixed"]] = "move",
    tolerance: float | None = None,
    local_tolerance: bool = True,
    reference: Any = None,
    edge_length: float | str | Mapping[str, float] | ArrayLike | None = None,
    surface_edges: float = 1.25,
    crease_angle: float = 40.0,
    planes: Literal["exact", "input"] = "exact",
    merge: Literal["auto", "none", "all"] = "auto",
    max_tets: int | None = None,
    margin: float = 0.02,
    effort: int = 1,
    seed: int = 0,
    allow_released: bool = False,
    periodic: bool | None = None,
    force: bool = False,
) -> Any:
    """Make the tets of a mesh contain their circumcenters, and give back what came in; ``source`` stays as it is."""
