"""TetGen: tetrahedra from a triangle surface that stays exactly as it is, by either program of ``tetgen_programs``.

TetGen ends every failure with an abort, says nothing about most, and leaves the tets out where it found none inside;
so the surface is checked before, by TetGen's own search for intersections too, and the result after.
"""

import re
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from wct_plugin.adapters import child_process, tetgen_programs
from wct_plugin.adapters.option_ranges import check_at_least, check_between, check_limit
from wct_plugin.adapters.solid_surface import check_thick, flat_pieces, in_cavity, label, open_edge, shells, weld
from wct_plugin.errors import InputError, NeighbourError, OptionError, WctWarning
from wct_plugin.exact import predicates
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh
from wct_plugin.mesh.index_arrays import among
from wct_plugin.mesh.mesh import show_row
from wct_plugin.mesh.triangle_surfaces import areas
from wct_plugin.types import Floats, Ints

_MEGABYTE = 1 << 20
_LOST = 1e-9  # of the surface's area; rounding is far below, a lost triangle above
# TetGen trips over cospherical and nearly coplanar points, in some orders of theirs. So it is tried again: points one
# after the other (b0) instead of along a curve through space, which is faster; then shuffled, facets as given (M)
# instead of merged where coplanar, which needs fewer tets; at last without splitting them (Y), which hardly ever fails.
_ATTEMPTS = ("", "b0", "b0M", "b0M", "b0Y")
_STEEPEST = 60.0  # degrees; a regular tet has 70.5 and no mesh consists of them


def tetrahedralize(
    surface: SurfaceMesh,
    *,
    edge_length: float = 0.05,
    radius_edge: float = 1.4,
    min_dihedral: float = 10.0,
    keep_boundary: bool = False,
    timeout: float | None = None,
    memory_limit: float | None = None,
    heard: Callable[[str], object] | None = None,
) -> TetMesh:
    """Fill a surface with tetrahedra by TetGen.

    The surface is kept exactly, its points with all their digits; new points split its triangles where the size or
    shape asks for it. What it divides into several volumes becomes as many regions, 1, 2, ...; a single one is 0. A
    closed inner surface whose triangles face inward is the wall of a hollow and is not filled. The ``reference`` is the
    surface without the triangles inside, those between regions and sheets in one. Tags come back on
    ``facets``, on every triangle if any is not 0; of an untagged surface only sheets inside a region do, which nothing
    else would keep. Exactly coplanar triangles of one tag count as one facet, unless ``keep_boundary``.

    Parameters
    ----------
    surface : SurfaceMesh
        What to fill: closed, its triangles meeting in whole edges and points only; sheets may divide the inside.
    edge_length : float
        Edge, as a fraction of the bounding box's diagonal, of the regular tet that no tet may exceed in volume; above
        0, at most 1.
    radius_edge : float
        Greatest ratio of circumradius to shortest edge, at least 1, but where the surface has small angles; below 1.2
        TetGen may not end.
    min_dihedral : float
        Smallest dihedral angle in degrees, 0 to 60; above 20 TetGen may not end.
    keep_boundary : bool
        Split no triangle of the surface; a coarse surface then stops any refinement inside.
    timeout : float or None
        Seconds after which TetGen is stopped; None waits for ever.
    memory_limit : float or None
        Megabytes of address space that TetGen may take; None is no limit.
    heard : callable, optional
        Told about every second where it stands, in a few words.

    Returns
    -------
    TetMesh
        Positively oriented, with ``regions``, ``facets``, ``reference`` and ``source`` set.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For a surface that is planar, open, intersects itself, or has repeated triangles or points too close together.
    NeighbourError
        If TetGen is missing, fails, or runs out of time or memory.
    """
    check_between("edge_length", edge_length, 1.0)
    check_at_least("radius_edge", radius_edge, 1.0)
    if not 0 <= min_dihedral <= _STEEPEST:
        raise OptionError(f"min_dihedral is {min_dihedral}; allowed is 0 to {_STEEPEST:g}")
    check_limit("timeout", timeout, "seconds")
    check_limit("memory_limit", memory_limit, "megabytes")
    program = tetgen_programs.find()
    check_thick(surface, "TetGen")
    points, triangles = weld(surface)
    # TetGen merges facets of one marker that bend by up to 0.1 degrees, and leaves both: a marker per flat piece.
    pieces = flat_pieces(points, triangles, surface.tags)
    volume = (edge_length * surface.diagonal) ** 3 / np.sqrt(72.0)
    # -J no renumbering, -A a number per region
    switches = f"JAq{radius_edge:g}/{min_dihedral:g}a{float(volume)!r}{'Y' if keep_boundary else ''}"
    with tempfile.TemporaryDirectory(prefix="wct_") as name:
        memory = None if memory_limit is None else int(memory_limit * _MEGABYTE)
        job = _Job(program, Path(name), timeout, memory, heard)
        mesh = _fill(job, switches, surface, points, triangles, pieces)
    return _tidied(_without_cavities(mesh, points, triangles), surface, pieces)


def version() -> str:
    """Which TetGen is used, as in ``1.5 (/usr/bin/tetgen)``. Raises :class:`NeighbourError` where there is none."""
    return tetgen_programs.find().version


class _Job:
    """TetGen on ``surface.poly`` in a folder, several times within one timeout."""

    def __init__(
        self,
        program: tetgen_programs.Program,
        folder: Path,
        timeout: float | None,
        memory: int | None,
        heard: Callable[[str], object] | None = None,
    ) -> None:
        self.folder, self.memory = folder, memory
        self._program = program
        self._heard = None if heard is None else lambda said: heard(_standing(said))
        self._end = None if timeout is None else time.monotonic() + timeout

    def run(self, switches: str) -> str:
        """Give what ``tetgen`` printed; line by line, or an abort would swallow it."""
        command = self._program.command(switches, "surface.poly", self.memory)
        limit = None if self._program.limits_itself else self.memory
        advice = "a larger edge_length or radius_edge, a smaller min_dihedral or a repaired surface is faster"
        left = None if self._end is None else max(round(self._end - time.monotonic(), 2), 0.01)
        try:
            return child_process.run(
                command, self.folder, left, "TetGen", memory=limit, advice=advice, heard=self._heard
            )
        except child_process.ChildError as error:
            raise _explain(error, self.memory) from error


def _standing(said: str) -> str:
    """Where TetGen stands by what it printed: the last thing that it says it is at."""
    steps = re.findall(r"^(\w[\w -]*?) ?\.\.\.$", said, re.M)
    return steps[-1].lower() if steps else ""


class _AbortError(NeighbourError):
    """TetGen aborted; ``starved`` if most likely for want of memory."""

    def __init__(self, message: str, starved: bool = False) -> None:
        super().__init__(message)
        self.starved = starved


def _fill(job: _Job, switches: str, surface: SurfaceMesh, points: Floats, triangles: Ints, pieces: Ints) -> TetMesh:
    """Let TetGen search the surface for faults (-d) and fill it (-p), in several ways if need be."""
    attempt = 0
    while True:
        extra = _ATTEMPTS[attempt].replace("Y", "" if "Y" in switches else "Y")
        order = np.arange(len(points)) if attempt < 2 else np.random.default_rng(attempt).permutation(len(points))
        ordered, renumbered = points[order], np.argsort(order)[triangles]
        for stale in job.folder.iterdir():
            stale.unlink()
        try:
            _write(job.folder / "surface.poly", ordered, renumbered, pieces)
        except OSError as error:
            raise NeighbourError(f"TetGen cannot be given the surface: {error.strerror or error}") from error
        try:
            _check_facets(job.run(f"-dz{extra}"), surface, ordered, renumbered)
            job.run(f"-pz{switches}{extra}")
            mesh = _result(job.folder, surface, ordered, renumbered, keep="Y" in switches)
        except _AbortError as error:
            if "vertices are coplanar" in str(error):  # with 1.6; to 1.5 points are too close then
                raise InputError(
                    f"{label(surface)}its points lie in a plane as far as TetGen can tell; it needs a thicker surface"
                ) from error
            attempt += 1
            if error.starved or attempt == len(_ATTEMPTS):
                raise
            continue
        if "Y" in extra:
            warnings.warn(
                f"{label(surface)}TetGen could not split the surface's triangles and keeps them; tets there may be "
                "larger or flatter than asked for",
                WctWarning,
                stacklevel=2,
            )
        return mesh


def _write(path: Path, points: Floats, triangles: Ints, pieces: Ints) -> None:
    with path.open("w") as file:
        file.write(f"{len(points)} 3 0 0\n")
        file.writelines(f"{k} {x!r} {y!r} {z!r}\n" for k, (x, y, z) in enumerate(points.tolist()))
        file.write(f"{len(triangles)} 1\n")
        rows = zip(triangles.tolist(), (pieces + 1).tolist(), strict=True)  # TetGen's 0 is "none"
        file.writelines(f"1 0 {marker}\n3 {a} {b} {c}\n" for (a, b, c), marker in rows)
        file.write("0\n0\n")  # no holes, no seeds of regions


def _explain(error: child_process.ChildError, memory: int | None) -> _AbortError:
    """Say in one line why TetGen failed; out of memory is the one thing that 1.5 never says."""
    noise = re.compile(r"seconds:|^terminate called|^Aborted|^\s*$")
    lines = [" ".join(line.split()) for line in error.output.splitlines() if not noise.search(line)]
    if found := re.search(r"Found two .*", " ".join(lines)):  # the faults' places are on the lines after
        return _AbortError(f"TetGen: {found[0]}")
    last = re.sub(r".*: (?=Assertion|error)|^Error: ", "", lines[-1]).rstrip(". ") if lines else "its start"
    # Elsewhere it is rather a fault of TetGen's; 1.6 does say it.
    growing = last in ("Refining mesh", "Out of memory") or "shared object" in last
    if memory is not None and growing:
        limit = f"memory_limit is {memory / _MEGABYTE:g} MB"
        return _AbortError(f"TetGen ran out of memory in {last!r}: {limit}; a larger edge_length needs less", True)
    if "SIGKILL" in str(error):
        return _AbortError(f"TetGen was killed in {last!r}, most likely because the system ran out of memory", True)
    if lines and not lines[-1].endswith("..."):
        return _AbortError(f"TetGen: {last}")
    return _AbortError(f"TetGen failed in {last!r} and does not say why; a repaired surface may help")


def _check_facets(said: str, surface: SurfaceMesh, points: Floats, triangles: Ints) -> None:
    """Read what TetGen's own search for faults of the surface printed."""
    if found := re.search(r"Point (\d+) is replaced by point (\d+)", said):
        first, second = points[int(found[1])], points[int(found[2])]
        distance = float(np.linalg.norm(first - second))
        raise InputError(
            f"{label(surface)}the points at {show_row(first)} and {show_row(second)} are {distance:.1e} apart, too "
            "close for TetGen, which tells points apart down to 1e-8 of the diagonal; merge close vertices first"
        )
    if where := _crossings(said, points, triangles):
        raise InputError(
            f"{label(surface)}the surface intersects itself: {where}; TetGen needs triangles that meet in whole edges "
            "and points only, mesher 'ftetwild' does not"
        )


def _crossings(said: str, points: Floats, triangles: Ints) -> str:
    """Where the surface intersects itself, in words: 1.5 names pairs of triangles, 1.6 those that it left out."""

    def named(index: int) -> str:
        return f"triangle {index}, {show_row(points[triangles[index]].mean(axis=0))}"

    found = re.findall(r"Facet #(\d+) intersects facet #(\d+)", said)
    if pairs := {tuple(sorted((int(first) - 1, int(second) - 1))) for first, second in found}:
        more = f" (and {len(pairs) - 1} more pairs)" if len(pairs) > 1 else ""
        return " and ".join(map(named, min(pairs))) + more
    if skipped := re.search(r"^Skipped facets ([\d ]+)", said, re.M):
        crossing = {int(number) - 1 for number in skipped[1].split()}
        more = f" (and {len(crossing) - 1} more triangles)" if len(crossing) > 1 else ""
        return f"at {named(min(crossing))}{more}"
    return ""


def _result(folder: Path, surface: SurfaceMesh, points: Floats, triangles: Ints, keep: bool) -> TetMesh:
    """Read TetGen's files and check that the whole surface came back; facets are tagged by their piece."""
    tets, vertices, faces = (_table(folder / f"surface.1.{part}") for part in ("ele", "node", "face"))
    edge = open_edge(points, triangles)
    if not len(tets):
        raise InputError(f"{label(surface)}the surface encloses nothing{f', it is open: {edge}' if edge else ''}")
    nodes, cells, facets = vertices[:, 1:4].copy(), tets[:, 1:6].astype(np.int64), faces[:, 1:5].astype(np.int64)
    nodes[: len(points)] = points  # TetGen writes 16 digits, which are not always all
    lost = 1 - float(areas(nodes, facets[:, :3]).sum() / areas(points, triangles).sum())
    if edge and lost > _LOST:  # TetGen drops facets that bound nothing without a word
        raise InputError(f"{label(surface)}{100 * lost:.3g} % of the surface's area bounds nothing; it is open: {edge}")
    if abs(lost) > _LOST or (keep and len(facets) != len(triangles)):
        raise _AbortError(f"TetGen did not keep the surface: {len(triangles)} triangles became {len(facets)}")
    return _mesh(nodes, cells, facets, surface.source)


def _table(path: Path) -> Floats:
    """The rows of one of TetGen's files; none where it is missing."""
    if not path.exists():
        return np.empty((0, 6))
    try:
        with path.open() as file:
            count = int(file.readline().split()[0])
            rows: Floats = np.loadtxt(file, ndmin=2) if count else np.empty((0, 6))
    except (OSError, ValueError, IndexError) as error:
        raise NeighbourError(f"TetGen's {path.name} cannot be read: {error}") from error
    if len(rows) != count:
        raise NeighbourError(f"TetGen's {path.name} has {len(rows)} rows of {count}; is the disk full?")
    return rows


def _mesh(nodes: Floats, tets: Ints, facets: Ints, source: str) -> TetMesh:
    # TetGen's tets are turned here, so that the mesh's count of repairs is about the user's own data.
    cells, regions = predicates.turned(nodes, tets[:, :4])[0], tets[:, 4]
    used = np.unique(cells)  # -J keeps points that no tet uses too
    number = np.full(len(nodes), -1)
    number[used] = np.arange(len(used))
    try:
        return TetMesh(
            nodes[used],
            number[cells],
            regions=regions,
            facets=Cells(number[facets[:, :3]], facets[:, 3] - 1),
            source=source,
        )
    except InputError as error:
        raise _AbortError(f"TetGen gave an unusable mesh: {error}") from error


def _without_cavities(mesh: TetMesh, points: Floats, triangles: Ints) -> TetMesh:
    """Take out the regions inside walls that face inward; TetGen fills whatever is closed."""
    outer = np.unique(mesh.regions[mesh.topology.boundary_half_facets[:, 0]])
    inner = np.setdiff1d(mesh.regions, outer)
    if not len(inner):
        return mesh
    walls = shells(points, triangles)
    size = np.abs(np.linalg.det(mesh.points[mesh.tets[:, 1:]] - mesh.points[mesh.tets[:, :1]]))
    hollow = []
    for region in inner:
        own = np.flatnonzero(mesh.regions == region)
        biggest = own[np.argmax(size[own])]
        if in_cavity(mesh.points[mesh.tets[biggest]].mean(axis=0), walls):
            hollow.append(region)
    filled = ~np.isin(mesh.regions, hollow)
    kept = replace(mesh, tets=mesh.tets[filled], regions=mesh.regions[filled])
    return replace(kept, repairs=mesh.repairs)  # points inside a hollow were never the user's


def _tidied(mesh: TetMesh, surface: SurfaceMesh, pieces: Ints) -> TetMesh:
    """Number the regions from 1, or all 0 for one; give facets the surface's tags; keep the outside as reference.

    Until here ``facets`` carry numbers of ``pieces``, each of which is outside or inside as a whole.
    """
    found, regions = np.unique(mesh.regions, return_inverse=True)
    mesh = replace(mesh, regions=regions.ravel() + 1 if len(found) > 1 else np.zeros_like(mesh.regions))
    outside = among(mesh.facets.vertices, mesh.topology.boundary, len(mesh.points))
    outer = np.isin(pieces, mesh.facets.tags[outside])
    reference = surface
    if not outer.all():
        reference = SurfaceMesh(surface.points, surface.triangles[outer], surface.tags[outer], source=surface.source)
    tags = surface.tags[np.unique(pieces, return_index=True)[1]][mesh.facets.tags]
    facets = Cells(mesh.facets.vertices, tags)
    if not tags.any():  # then those are left out that say nothing the tets do not say
        facets = facets.select(~outside & ~among(facets.vertices, mesh.topology.interfaces, len(mesh.points)))
    return mesh.altered(facets=facets, reference=reference)
