"""What ``move_vertices`` promises, whatever the mesh, and that it finds what there is to find."""

import os
import signal
import threading
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from support.core_meshes import (
    NO_LABELS,
    NO_SEGMENTS,
    NO_TRIANGLES,
    Movable,
    ball,
    completely_well_centered,
    cosines,
    cube,
    flatness,
    heights,
    rotation,
    volumes,
    well_centered,
)

from wct_plugin.core import _core
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.mesh import SurfaceMesh

MESHES = {"ball": ball(150), "cube": cube(), "turned cube": cube(seed=3, turned=True)}
ONE_TET = np.array([[0, 1, 2, 3]])


def move(mesh, *, slide=False, goal="3wc", margin=0.02, effort=1, tolerance=np.inf, progress=None):
    return _core.move_vertices(
        *mesh.arguments(slide=slide), goal=goal, margin=margin, effort=effort, tolerance=tolerance, progress=progress
    )


@pytest.fixture(
    scope="module", params=[(n, s, g) for n in MESHES for s in (False, True) for g in ("3wc", "cwc")], ids=str
)
def moved(request):
    """A mesh, whether it slid, the goal, and what came of it."""
    name, slide, goal = request.param
    mesh = MESHES[name]
    before = deepcopy(vars(mesh))
    points, report = move(mesh, slide=slide, goal=goal)
    for name, values in vars(mesh).items():
        np.testing.assert_array_equal(values, before[name])
    return mesh, slide, goal, points, report


def test_no_tet_is_inverted(moved):
    mesh, _, _, points, _ = moved
    assert (_core.orientation(points, mesh.tets) == 1).all()


def test_no_tet_is_squeezed_flat(moved):
    mesh, _, _, points, _ = moved
    assert (flatness(points, mesh.tets) >= np.minimum(0.03, flatness(mesh.points, mesh.tets)) - 1e-8).all()


def test_fixed_points_keep_their_bits(moved):
    mesh, slide, _, points, _ = moved
    fixed = mesh.stratum == 3 if slide else mesh.stratum > 0
    assert fixed.any() or slide
    assert points[fixed].tobytes() == mesh.points[fixed].tobytes()
    assert not np.array_equal(points, mesh.points)


def test_more_tets_are_well_centered(moved):
    mesh, _, goal, points, report = moved
    meets = well_centered if goal == "3wc" else completely_well_centered
    before, after = meets(mesh.points, mesh.tets).sum(), meets(points, mesh.tets).sum()
    assert well_centered(points, mesh.tets).sum() >= well_centered(mesh.points, mesh.tets).sum()
    assert after > before
    assert report["bad_after"] == len(mesh.tets) - after
    assert report["bad_before"] == pytest.approx(len(mesh.tets) - before, abs=2)  # right angles in or out by rounding
    worst = heights(points, mesh.tets).min()
    if goal == "cwc":
        worst = min(worst, cosines(points, mesh.tets).min())
    assert report["worst_after"] == pytest.approx(worst, abs=1e-9)
    assert report["evaluations"] > 0
    assert report["iterations"] > 0
    assert report["stopped"] is False


def test_sliding_points_stay_on_the_boundary(moved):
    mesh, slide, _, points, _ = moved
    if not slide:
        np.testing.assert_array_equal(points[mesh.stratum > 0], mesh.points[mesh.stratum > 0])
        return
    if mesh.stratum.max() == 1:  # the ball: convex, so its boundary is where the farthest hull plane is at distance 0
        planes = ConvexHull(mesh.points).equations
        out = (points[mesh.stratum == 1] @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        np.testing.assert_allclose(out, 0, atol=1e-12)
    else:
        turn, shift = (rotation(3), [3.0, -1.0, 0.5]) if mesh is MESHES["turned cube"] else (np.eye(3), 0.0)
        was, now = ((x - shift) @ turn for x in (mesh.points, points))
        held = np.abs(was - 0.5) > 0.5 - 1e-12  # per point and axis: on a face across this axis
        np.testing.assert_array_equal(held.sum(axis=1), mesh.stratum)
        np.testing.assert_allclose(now[held], was[held], atol=1e-12)
        assert volumes(points, mesh.tets).sum() == pytest.approx(1, abs=1e-12)
    for stratum in (1, 2):
        if (mesh.stratum == stratum).any():
            assert np.ptp(points[mesh.stratum == stratum] - mesh.points[mesh.stratum == stratum]) > 1e-3


@pytest.mark.parametrize("name", ["ball", "cube"])
def test_acute_facets_are_not_paid_for_with_well_centered_tets(name):
    """From where most tets are well-centered, more completely well-centered ones could be had by giving those up."""
    mesh = MESHES[name]
    points, _ = move(mesh, slide=True)
    arguments = (points, *mesh.arguments(slide=True)[1:])
    again, _ = _core.move_vertices(*arguments, goal="cwc", margin=0.02, effort=1)
    direct, _ = move(mesh, slide=True, goal="cwc")
    assert well_centered(direct, mesh.tets).sum() < well_centered(points, mesh.tets).sum()
    assert well_centered(again, mesh.tets).sum() >= well_centered(points, mesh.tets).sum()


def test_sliding_serves_more_tets():
    mesh = MESHES["cube"]
    stay, slide = (move(mesh, slide=s)[1]["bad_after"] for s in (False, True))
    assert slide < 0.8 * stay


def test_search_beats_descent():
    """The first stage descends a smooth energy; the search that follows finds places for far more tets."""
    heard = []
    _, report = move(ball(300, seed=5), progress=lambda done, bad: heard.append((done, bad)))
    descended = next(bad for done, bad in heard if done > 0.05)
    assert descended < report["bad_before"]
    assert report["bad_after"] < 0.75 * descended


@pytest.mark.parametrize("slide", [False, True])
def test_the_same_input_gives_the_same_bits(slide):
    mesh = MESHES["ball"]
    first, second = (move(mesh, slide=slide) for _ in range(2))
    assert first[0].tobytes() == second[0].tobytes()
    assert first[1] == second[1]


def test_effort_multiplies_the_work():
    mesh = MESHES["cube"]
    once, thrice = (move(mesh, effort=e)[1] for e in (1, 3))
    assert 2 < thrice["evaluations"] / once["evaluations"] < 4


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_units_do_not_matter(scale):
    mesh = MESHES["ball"]
    arguments = (np.ascontiguousarray(mesh.points * scale), *mesh.arguments(slide=True)[1:])
    points, report = _core.move_vertices(*arguments, goal="3wc", margin=0.02, effort=1)
    assert (_core.orientation(points, mesh.tets) == 1).all()
    assert report["bad_after"] == pytest.approx(move(mesh, slide=True)[1]["bad_after"], rel=0.25)


class TestTolerance:
    @pytest.mark.parametrize("goal", ["3wc", "cwc"])
    @pytest.mark.parametrize("tolerance", [3e-2, 3e-3])
    def test_a_curved_surface_stays_near(self, goal, tolerance):
        mesh = MESHES["ball"]
        points, report = move(mesh, slide=True, goal=goal, tolerance=tolerance)
        apart = measure_deviation(
            SurfaceMesh(points, mesh.triangles), SurfaceMesh(mesh.points, mesh.triangles), spacing=0.02
        )
        assert 0.3 * tolerance < apart.max <= tolerance
        assert report["bad_after"] < report["bad_before"]

    def test_a_wider_one_serves_more_tets(self):
        narrow, wide = (move(MESHES["ball"], slide=True, tolerance=t)[1]["bad_after"] for t in (1e-3, 1e-1))
        assert wide < narrow

    @pytest.mark.parametrize("name", ["cube", "turned cube"])
    def test_planes_know_none(self, name):
        free, held = (move(MESHES[name], slide=True, tolerance=t) for t in (np.inf, 1e-6))
        assert free[0].tobytes() == held[0].tobytes()
        assert free[1] == held[1]

    def test_a_fixed_boundary_knows_none(self):
        free, held = (move(MESHES["ball"], tolerance=t)[0] for t in (np.inf, 1e-6))
        assert free.tobytes() == held.tobytes()

    def test_the_same_input_gives_the_same_bits(self):
        first, second = (move(MESHES["ball"], slide=True, tolerance=1e-2) for _ in range(2))
        assert first[0].tobytes() == second[0].tobytes()
        assert first[1] == second[1]

    def test_it_holds_when_stopped(self):
        mesh, heard = MESHES["ball"], []

        def listen(done, bad):
            heard.append(done)
            return done < 0.5

        points, report = move(mesh, slide=True, tolerance=3e-3, effort=5, progress=listen)
        assert report["stopped"] is True
        apart = measure_deviation(
            SurfaceMesh(points, mesh.triangles), SurfaceMesh(mesh.points, mesh.triangles), spacing=0.02
        )
        assert apart.max <= 3e-3


class TestNothingToDo:
    def test_no_free_point(self):
        mesh = MESHES["cube"]
        stratum = np.full(len(mesh.points), 3, dtype=np.int8)
        held = replace(mesh.pinned, stratum=stratum)
        points, report = _core.move_vertices(mesh.points, mesh.tets, held, goal="cwc", margin=0.02, effort=1)
        assert points.tobytes() == mesh.points.tobytes()
        assert report["bad_before"] == report["bad_after"] > 0

    def test_no_tets(self):
        points, report = _core.move_vertices(
            *without_surface(np.zeros((3, 3)), np.zeros((0, 4), dtype=np.int64), np.zeros(3, dtype=np.int8)),
            goal="3wc",
            margin=0.02,
            effort=1,
        )
        assert (points == 0).all()
        assert report["bad_after"] == 0

    @pytest.mark.parametrize("goal", ["3wc", "cwc"])
    def test_well_centered_with_room_to_spare(self, goal):
        """An octahedron about a point, slightly off its center: all tets meet the goal by more than the margin."""
        mesh = star_of_octahedron(0.0)
        points, report = _core.move_vertices(*mesh, goal=goal, margin=0.0, effort=1)
        assert points.tobytes() == mesh[0].tobytes()
        assert report["evaluations"] == 0


def without_surface(points, tets, stratum):
    """The arguments for a mesh whose points move freely or stay."""
    label = np.full(len(points), -1)
    return points, tets, Movable(points, tets, stratum, label, NO_TRIANGLES, NO_LABELS, NO_SEGMENTS, NO_LABELS)


def star_of_octahedron(off):
    """An icosahedron about one free point: the twenty tets are well-centered."""
    golden = (1 + 5**0.5) / 2
    corners = np.array([[0, s, t * golden] for s in (1, -1) for t in (1, -1)], dtype=float)
    corners = np.concatenate([np.roll(corners, k, axis=1) for k in range(3)])
    points = np.concatenate([corners, [[off, 0.7 * off, -0.4 * off]]])
    hull = ConvexHull(corners)
    tets = np.column_stack([np.full(len(hull.simplices), 12), hull.simplices]).astype(np.int64)
    flipped = volumes(points, tets) < 0
    tets[flipped] = tets[flipped][:, [0, 1, 3, 2]]
    stratum = np.array([3] * 12 + [0], dtype=np.int8)
    return without_surface(points, tets, stratum)


@pytest.mark.parametrize("goal", ["3wc", "cwc"])
def test_margins_widen_where_all_is_well_centered(goal):
    mesh = star_of_octahedron(0.2)
    reach = heights(star_of_octahedron(0.0)[0], mesh[1]).min()
    before = heights(mesh[0], mesh[1]).min()
    margin = min(0.3, 0.5 * (before + reach))
    assert 0 < before < margin < reach
    points, report = _core.move_vertices(*mesh, goal=goal, margin=margin, effort=1)
    assert report["bad_before"] == report["bad_after"] == 0
    assert heights(points, mesh[1]).min() > before + 0.8 * (margin - before)


@pytest.mark.parametrize(("moving", "goal"), [([3], "3wc"), ([0, 1, 2, 3], "cwc")])
def test_one_tet(moving, goal):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    stratum = np.full(4, 3, dtype=np.int8)
    stratum[moving] = 0
    out, report = _core.move_vertices(*without_surface(points, ONE_TET, stratum), goal=goal, margin=0.02, effort=1)
    assert (report["bad_before"], report["bad_after"]) == (1, 0)
    assert (well_centered if goal == "3wc" else completely_well_centered)(out, ONE_TET).all()
    assert out[stratum == 3].tobytes() == points[stratum == 3].tobytes()


def test_right_angles_are_counted_exactly():
    """In boxes cut Kuhn's way the circumcenter lies on an edge of every tet: exactly none is well-centered."""
    mesh = cube(cells=3, jitter=0.0)
    sides = np.cumsum(np.random.default_rng(2).uniform(0.8, 1.2, (3, 4)), axis=1)
    points = np.stack([sides[axis][np.rint(3 * mesh.points[:, axis]).astype(int)] for axis in range(3)], axis=1)
    assert well_centered(points, mesh.tets).any()
    _, report = _core.move_vertices(points, *mesh.arguments(slide=False)[1:], goal="3wc", margin=0.02, effort=1)
    assert report["bad_before"] == len(mesh.tets) == 162


@pytest.mark.parametrize("thin", [1e-3, 1e-7, 1e-12, 1e-15])
def test_a_flat_tet_frees_its_corners(thin):
    """Four points nearly in a plane, in a mesh that has room: the sliver must not nail them down."""
    mesh = squeezed(thin)
    flat = flatness(mesh[0], mesh[1]).argmin()
    points, _ = _core.move_vertices(*mesh, goal="3wc", margin=0.02, effort=1)
    assert (_core.orientation(points, mesh[1]) == 1).all()
    assert flatness(points, mesh[1])[flat] > max(2 * thin, 1e-3)


def squeezed(thin):
    """A jittered cube with one interior tet squeezed by moving a corner towards the opposite facet."""
    mesh = cube(cells=4, jitter=0.05)
    inner = np.flatnonzero((mesh.stratum[mesh.tets] == 0).all(axis=1))
    for tet in inner:
        for k in range(4):
            points = mesh.points.copy()
            apex, base = mesh.tets[tet, k], points[np.delete(mesh.tets[tet], k)]
            normal = np.cross(base[1] - base[0], base[2] - base[0])
            normal /= np.linalg.norm(normal)
            depth = (points[apex] - base[0]) @ normal
            points[apex] -= (depth - np.sign(depth) * thin / 4) * normal
            if (_core.orientation(points, mesh.tets) == 1).all():
                return (points, *mesh.arguments(slide=False)[1:])
    raise AssertionError("no tet can be squeezed")


class TestProgress:
    def test_it_hears_the_work_go_on(self):
        heard = []
        _, report = move(MESHES["ball"], slide=True, progress=lambda done, bad: heard.append((done, bad)))
        done, bad = zip(*heard, strict=True)
        assert len(heard) > 4
        assert list(done) == sorted(done)
        assert done[0] == 0
        assert done[-1] == 1
        assert list(bad) == sorted(bad, reverse=True)
        assert (bad[0], bad[-1]) == (report["bad_before"], report["bad_after"])

    @pytest.mark.parametrize("calls", [1, 3, 6])
    def test_false_stops_with_the_best_so_far(self, calls):
        mesh, heard = MESHES["ball"], []

        def listen(done, bad):
            heard.append(bad)
            return len(heard) < calls

        points, report = move(mesh, effort=50, progress=listen)
        assert len(heard) == calls
        assert report["stopped"] is True
        assert report["evaluations"] < 10_000_000
        assert well_centered(points, mesh.tets).sum() == len(mesh.tets) - report["bad_after"]
        assert report["bad_after"] <= heard[-1]
        assert (_core.orientation(points, mesh.tets) == 1).all()
        if calls == 1:
            assert points.tobytes() == mesh.points.tobytes()

    def test_an_exception_passes_through(self):
        def listen(done, bad):
            if done > 0:
                raise LookupError("enough")

        with pytest.raises(LookupError, match="enough"):
            move(MESHES["ball"], progress=listen)

    def test_control_c(self):
        """Without a listener too; and other threads run meanwhile, else this one could not send the signal."""
        timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            move(MESHES["ball"], slide=True, effort=1000)
        timer.join()


class TestRefusals:
    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"goal": "2wc"}, "goal 2wc"),
            ({"margin": -0.1}, "margin"),
            ({"margin": float("nan")}, "margin"),
            ({"margin": 0.4}, "margin"),
            ({"effort": 0}, "effort"),
            ({"tolerance": 0.0}, "tolerance"),
            ({"tolerance": float("nan")}, "tolerance"),
        ],
    )
    def test_options(self, change, message):
        with pytest.raises(ValueError, match=message):
            move(MESHES["cube"], **change)

    @pytest.mark.parametrize(
        ("name", "value", "message"),
        [
            ("points", np.zeros((125, 2)), "points has shape"),
            ("tets", np.array([[0, 1, 2, 125]]), "tets names point 125"),
            ("tets", np.array([[0, 1, 2, 2]]), "tet 0 is inverted or flat"),
            ("stratum", np.zeros(124, dtype=np.int8), "stratum has length 124; it must be 125"),
            ("stratum", np.zeros(125, dtype=np.int64), "stratum must hold int8"),
            ("stratum", np.full(125, 4, dtype=np.int8), "stratum 4"),
            ("label", np.zeros((125, 1), dtype=np.int64), r"label has shape \(125, 1\)"),
            ("label", np.full(125, 999), "has points that move but no piece"),
            ("triangles", np.array([[0, 1, -1]]), "triangles names point -1"),
            ("patch", np.zeros(3, dtype=np.int64), "patch has length 3"),
            ("segments", np.array([[0, 125]]), "segments names point 125"),
            ("curve", np.zeros(3, dtype=np.int64), "curve has length 3"),
        ],
    )
    def test_arrays(self, name, value, message):
        changed = replace(MESHES["cube"], **{name: value})
        with pytest.raises(ValueError, match=message):
            _core.move_vertices(*changed.arguments(slide=True), goal="3wc", margin=0.02, effort=1)

    def test_inverted_tets(self):
        mesh = MESHES["cube"]
        tets = np.ascontiguousarray(mesh.tets[:, [0, 1, 3, 2]])
        with pytest.raises(ValueError, match="tet 0 is inverted or flat"):
            _core.move_vertices(mesh.points, tets, *mesh.arguments(slide=False)[2:], goal="3wc", margin=0.02, effort=1)
