"""The real pymeshlab mends, measures and colours surfaces; what it is asked is checked first."""

import json
import os
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from support.builders import kuhn_cube, sphere_surface

import wct_plugin as wct
from wct_plugin.errors import InputError, NeighbourError, OptionError, WctWarning
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.pipeline.stage import find_filter


def run(surface: SurfaceMesh, name: str, **arguments: object) -> tuple[SurfaceMesh, dict]:
    return wct.apply_filter("meshlab", surface, filter=name, arguments=arguments)


def dressed(count: int = 60) -> SurfaceMesh:
    """A sphere on which everything hangs that a surface can have."""
    bare = sphere_surface(count)
    points, triangles = len(bare.points), len(bare.triangles)
    return replace(
        bare,
        tags=np.arange(1, triangles + 1),
        point_data={"u": np.arange(points) * 0.5, "quality": np.linspace(0, 1, points)},
        cell_data={"id": np.arange(triangles) << 40, "quality": np.linspace(1, 2, triangles)},
        source="ball.ply",
    )


def holes(surface: SurfaceMesh) -> int:
    """How many edges do not lie between exactly two triangles that run along it in opposite directions."""
    starts = surface.triangles.reshape(-1)
    ends = np.roll(surface.triangles, -1, axis=1).reshape(-1)
    edges, count = np.unique(np.column_stack([starts, ends]), axis=0, return_counts=True)
    _, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return int((count > 1).sum() + (times != 2).sum())


def volume(surface: SurfaceMesh) -> float:
    return float(np.linalg.det(surface.points[surface.triangles]).sum() / 6)


def test_duplicate_faces_go_and_all_else_stays():
    good = dressed()
    twice = np.r_[np.arange(len(good.triangles)), 7, 30]
    fault = replace(
        good,
        triangles=np.vstack([good.triangles, np.roll(good.triangles[[7, 30]], 1, axis=1)]),
        tags=good.tags[twice],
        cell_data={name: values[twice] for name, values in good.cell_data.items()},
    )
    assert holes(fault)
    mended, metrics = run(fault, "meshing_remove_duplicate_faces")
    assert not holes(mended)
    assert metrics["triangles"] == len(mended.triangles) == len(good.triangles)
    place = {tuple(sorted(row)): k for k, row in enumerate(good.triangles.tolist())}
    same = [place[tuple(sorted(row))] for row in mended.triangles.tolist()]
    assert np.array_equal(mended.points, good.points)
    assert np.array_equal(mended.tags, good.tags[same])
    assert np.array_equal(mended.cell_data["id"], good.cell_data["id"][same])
    assert np.array_equal(mended.cell_data["quality"], good.cell_data["quality"][same])
    assert np.array_equal(mended.point_data["u"], good.point_data["u"])
    assert mended.source == "ball.ply"


def test_a_hole_is_closed_and_the_new_triangles_have_no_tag():
    good = dressed()
    around = (good.triangles == 20).any(axis=1)  # the fan of one point
    fault = SurfaceMesh(good.points, good.triangles[~around], good.tags[~around], cell_data={"id": good.tags[~around]})
    with pytest.warns(WctWarning) as told:
        mended, metrics = run(fault, "meshing_close_holes", maxholesize=30)
    new = around.sum() - 2
    assert [str(each.message) for each in told] == [
        f"filters.meshlab (meshing_close_holes) drops the tags of {new} of {len(mended.triangles)} triangles, which "
        "are new, triangle data 'id'"
    ]
    assert holes(fault)
    assert not holes(mended)
    assert volume(mended) == pytest.approx(volume(good), rel=0.05)
    assert metrics["measures"] == {"closed_holes": 1, "new_faces": new}
    assert np.array_equal(mended.triangles[: len(fault.triangles)], fault.triangles)
    assert np.array_equal(mended.tags, np.r_[fault.tags, [0] * new])


def test_self_intersections_become_one_skin():
    """Two unit cubes that share an eighth: 2 - 1/8."""
    cube = kuhn_cube(2).boundary_surface()
    count = len(cube.points)
    both = SurfaceMesh(np.vstack([cube.points, cube.points + 0.5]), np.vstack([cube.triangles, cube.triangles + count]))
    assert volume(both) == pytest.approx(2.0)
    union, _ = run(both, "generate_boolean_union")
    assert volume(union) == pytest.approx(1.875)
    assert not holes(union)


def test_unused_points_leave_with_their_data():
    good = dressed()
    spare = SurfaceMesh(
        np.vstack([[5.0, 5, 5], good.points]), good.triangles + 1, point_data={"u": np.r_[-1.0, good.point_data["u"]]}
    )
    mended, _ = run(spare, "meshing_remove_unreferenced_vertices")
    assert np.array_equal(mended.points, good.points)
    assert np.array_equal(mended.point_data["u"], good.point_data["u"])


def test_percentages_are_relative_and_numbers_are_lengths():
    surface = sphere_surface(60, radius=10.0)
    longest = max(
        np.linalg.norm(
            surface.points[surface.triangles[:, k]] - surface.points[surface.triangles[:, k - 1]], axis=1
        ).max()
        for k in range(3)
    )
    fraction = longest / surface.diagonal * 100
    for above, given in ((True, f"{fraction * 1.01}%"), (True, longest * 1.01), (False, f"{fraction * 0.99}%")):
        made, metrics = run(surface, "meshing_surface_subdivision_midpoint", iterations=1, threshold=given)
        used = metrics["steps"][0]["arguments"]["threshold"]
        assert used == pytest.approx(longest * (1.01 if above else 0.99), rel=1e-5)
        assert (len(made.triangles) == len(surface.triangles)) is above


def test_measures_are_metrics_and_the_surface_stays():
    surface = dressed()
    same, metrics = run(surface, "get_geometric_measures")
    assert metrics["measures"]["mesh_volume"] == pytest.approx(volume(surface))
    assert metrics["measures"]["bbox"]["max"] == pytest.approx(surface.points.max(axis=0))
    assert json.loads(json.dumps(metrics, allow_nan=False)) == metrics
    for name in ("points", "triangles", "tags"):
        assert np.array_equal(getattr(same, name), getattr(surface, name))
    for kind in ("point_data", "cell_data"):
        assert getattr(same, kind).keys() == getattr(surface, kind).keys()
        for name, values in getattr(surface, kind).items():
            assert np.array_equal(getattr(same, kind)[name], values)


def test_quality_and_colour_are_meshlab_s_own():
    surface = sphere_surface(60)
    scored, _ = run(surface, "compute_scalar_by_function_per_face", q="x0 + 2*y1")
    corners = surface.points[surface.triangles]
    assert scored.cell_data["quality"] == pytest.approx(corners[:, 0, 0] + 2 * corners[:, 1, 1])
    assert not scored.point_data
    painted, _ = run(scored, "compute_color_from_scalar_per_face", colormap="Viridis")
    assert np.array_equal(painted.cell_data["quality"], scored.cell_data["quality"])
    assert painted.cell_data["red"].dtype == np.uint8
    bright, dark = scored.cell_data["quality"].argmax(), scored.cell_data["quality"].argmin()
    assert painted.cell_data["green"][bright] > painted.cell_data["green"][dark] + 100  # from violet to yellow
    same, _ = run(painted, "get_topological_measures")
    assert np.array_equal(same.cell_data["red"], painted.cell_data["red"])


@pytest.mark.parametrize("freeze", [True, False])  # or kept by MeshLab as a matrix beside the points
def test_moved_points_keep_their_data_but_not_their_normals(freeze):
    ball = sphere_surface(60)
    normals = dict(zip(("nx", "ny", "nz"), ball.points.T, strict=True))
    surface = replace(ball, tags=np.arange(len(ball.triangles)), point_data={"u": np.arange(60.0), **normals})
    with pytest.warns(WctWarning, match=r"drops point data 'nx', point data 'ny', point data 'nz'$"):
        moved, _ = run(surface, "compute_matrix_from_translation", axisx=0.25, freeze=freeze)
    assert moved.points == pytest.approx(surface.points + np.array([0.25, 0, 0]), abs=1e-6)
    assert np.array_equal(moved.tags, surface.tags)
    assert np.array_equal(moved.point_data["u"], surface.point_data["u"])


def test_another_surface_has_none_of_the_old_one_s_tags():
    surface = dressed()
    with pytest.warns(WctWarning, match=r"drops the tags of \d+ of \d+ triangles, .*point data 'u'.*'id'"):
        made, _ = run(surface, "generate_resampled_uniform_mesh", cellsize="5%")
    assert not holes(made)
    assert volume(made) == pytest.approx(volume(surface), rel=0.05)
    assert not made.tags.any()
    assert not made.point_data
    assert not made.cell_data


def test_the_convex_hull_has_the_old_points():
    """A new surface of pymeshlab's, but every point and triangle is in its old place."""
    surface = dressed()
    spare = replace(
        surface,
        points=np.vstack([surface.points, np.zeros((1, 3))]),
        point_data={name: np.r_[values, 9.0] for name, values in surface.point_data.items()},
    )
    hull, _ = run(spare, "generate_convex_hull")
    for place, at in enumerate(np.lexsort(hull.points.T)):
        old = np.lexsort(surface.points.T)[place]
        assert np.array_equal(hull.points[at], surface.points[old])
        assert hull.point_data["u"][at] == surface.point_data["u"][old]
        assert hull.point_data["quality"][at] == surface.point_data["quality"][old]
    assert np.array_equal(np.sort(hull.tags), surface.tags)


@pytest.mark.parametrize(
    ("name", "arguments", "reason"),
    [
        ("generate_splitting_by_connected_components", {}, "gives 2 surfaces; allowed is one"),
        ("generate_sampling_montecarlo", {"samplenum": 50}, "gives 50 points without a triangle, not a surface"),
        ("meshing_remove_all_faces", {}, "leaves no triangle"),
        ("compute_scalar_by_function_per_face", {"q": "qu("}, 'failed: func q: Unexpected token "qu" found.*'),
        ("compute_scalar_transfer_face_to_vertex", {}, "failed: .*[Qq]uality.*"),
        ("generate_boolean_union", {"first_mesh": 7}, "crashed with SIGSEGV"),
    ],
)
def test_what_gives_no_surface_is_an_error(name, arguments, reason, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    one = sphere_surface(20)
    two = SurfaceMesh(np.vstack([one.points, one.points + 5]), np.vstack([one.triangles, one.triangles + 20]))
    with pytest.raises(NeighbourError, match=rf"^filters\.meshlab \({name}\) {reason}$"):
        run(two, name, **arguments)
    assert os.listdir(tmp_path) == []


def test_a_timeout_ends_it(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    endless = {"filter": "apply_coord_laplacian_smoothing", "arguments": {"stepsmoothnum": 10**9}}
    with pytest.raises(
        NeighbourError, match=r"\(apply_coord_laplacian_smoothing\) was stopped after 3 s, its timeout$"
    ):
        wct.apply_filter("meshlab", sphere_surface(500), timeout=3, **endless)
    assert os.listdir(tmp_path) == []


def test_a_tet_mesh_is_told_how_to_become_a_surface():
    with pytest.raises(
        OptionError, match=r"needs a surface, here is a tet mesh; put filters\.generate_boundary_surface"
    ):
        wct.apply_filter("meshlab", kuhn_cube(1), filter="meshing_close_holes")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({}, "filters.meshlab: exactly one of 'filter' and 'script' must be given"),
        ({"filter": "a", "script": "b"}, "filters.meshlab: exactly one of 'filter' and 'script' must be given"),
        ({"script": "b", "arguments": {"c": 1}}, "filters.meshlab: 'arguments' go with 'filter'; a script has its own"),
        (
            {"filter": "a", "arguments": {"c": object}},
            "filters.meshlab: option 'arguments' is {'c': <class 'object'>}; argument 'c' is a type; allowed are "
            "numbers, texts, booleans and lists",
        ),
    ],
)
def test_options_that_do_not_go_together(options, reason):
    with pytest.raises(OptionError) as caught:
        find_filter("meshlab")(**options)
    assert str(caught.value) == reason


def test_arguments_are_checked_without_a_mesh():
    stage = find_filter("meshlab")(filter="meshing_close_holes", arguments={"maxholesize": np.int64(20)})
    stage.validate()
    with pytest.raises(OptionError, match=r"argument 'maxholesiz' is unknown; did you mean 'maxholesize'\?"):
        find_filter("meshlab")(filter="meshing_close_holes", arguments={"maxholesiz": 20}).validate()


def test_a_range_that_depends_on_the_mesh_is_checked_on_it():
    """MeshLab moves a mesh by five diagonals at most, and would do that without a word."""
    small, large = sphere_surface(20), sphere_surface(20, radius=50.0)
    reason = f"argument 'axisx' is 30; allowed is at most {5 * small.diagonal:.6g}"
    with pytest.raises(OptionError, match=rf"\(compute_matrix_from_translation\): {reason}$"):
        run(small, "compute_matrix_from_translation", axisx=30)
    moved, _ = run(large, "compute_matrix_from_translation", axisx=30)
    assert moved.points[:, 0] == pytest.approx(large.points[:, 0] + 30.0, abs=1e-5)


def test_a_script_written_by_pymeshlab_does_what_its_filters_do(tmp_path):
    good = sphere_surface(60)
    fault = SurfaceMesh(good.points, good.triangles[~(good.triangles == 20).any(axis=1)])
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(fault.points, fault.triangles.astype(np.int32)))
    meshes.meshing_close_holes(maxholesize=12, refinehole=True, refineholeedgelen=pymeshlab.PercentageValue(4))
    meshes.apply_coord_taubin_smoothing(lambda_=0.4, stepsmoothnum=3)
    meshes.compute_color_from_scalar_per_vertex(colormap="Plasma")
    meshes.compute_matrix_from_rotation(rotaxis="custom axis", customaxis=[1.0, 2.0, 3.0], angle=30.0)
    meshes.set_color_per_vertex(color1=pymeshlab.Color(1, 2, 3, 4))
    meshes.save_filter_script(str(tmp_path / "repair.mlx"))
    made, metrics = wct.apply_filter("meshlab", fault, script=tmp_path / "repair.mlx")
    expected = meshes.current_mesh()
    assert made.points == pytest.approx(expected.vertex_matrix(), abs=1e-6)
    assert np.array_equal(made.triangles, expected.face_matrix())
    assert {name: int(values[0]) for name, values in made.point_data.items() if name != "quality"} == {
        "red": 1, "green": 2, "blue": 3, "alpha": 4
    }  # fmt: skip
    assert [step["filter"] for step in metrics["steps"]] == [
        "meshing_close_holes",
        "apply_coord_taubin_smoothing",
        "compute_color_from_scalar_per_vertex",
        "compute_matrix_from_rotation",
        "set_color_per_vertex",
    ]
    assert metrics["steps"][1]["arguments"]["lambda_"] == pytest.approx(0.4)


CLOSE = '<filter name="Close Holes">{}</filter>'


@pytest.mark.parametrize(
    ("content", "error", "reason"),
    [
        (None, InputError, ": No such file or directory"),
        ("garbage", InputError, ": is not XML: syntax error: line 1, column 0"),
        ("<!DOCTYPE FilterScript>\n<FilterScript>", InputError, ": is not XML: no element found: line 2, column 14"),
        (
            "<MeshLabProject/>",
            InputError,
            ": its root is <MeshLabProject>; MeshLab's filter scripts have <FilterScript>",
        ),
        ("", InputError, ": the script has no filter"),
        ('<xmlfilter name="a"/>', InputError, ": element 1 is <xmlfilter>; allowed is <filter name=...>"),
        ("<filter/>", InputError, ": element 1 is <filter> without a name; allowed is <filter name=...>"),
        (CLOSE.format('<Param name="a"/>'), InputError, ": element 1 'Close Holes': parameter 'a' has no value"),
        (
            CLOSE.format("") + '<filter name="Cloze Holes"/>',
            OptionError,
            ", filter 2 ('Cloze Holes'): MeshLab has no such filter; did you mean 'close_holes'?",
        ),
        (
            CLOSE.format('<Param name="MaxHoleSise" value="3"/>'),
            OptionError,
            ", filter 1 ('Close Holes'): argument 'MaxHoleSise' is unknown; did you mean 'maxholesize'? (allowed: "
            "maxholesize, selected, newfaceselected, selfintersection, refinehole, refineholeedgelen)",
        ),
        (
            CLOSE.format('<Param name="MaxHoleSize" value="many"/>'),
            OptionError,
            ", filter 1 ('Close Holes'): argument 'MaxHoleSize' is 'many'; allowed is an integer of 32 bits",
        ),
    ],
)
def test_a_script_is_checked_name_by_name(content, error, reason, tmp_path, monkeypatch):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(scratch))
    path = tmp_path / "repair.mlx"
    if content is not None:
        whole = content[:1] in "g<" and not content.startswith(("<filter", "<xmlfilter"))
        path.write_text(content if content and whole else f"<FilterScript>{content}</FilterScript>")
    with pytest.raises(error) as caught:
        find_filter("meshlab")(script=path).validate()
    assert str(caught.value) == f"{path}{reason}"
    assert os.listdir(scratch) == []


def test_a_crash_names_the_step_of_the_script(tmp_path):
    script = tmp_path / "crash.mlx"
    crash = '<filter name="Mesh Boolean: Union"><Param name="first_mesh" value="7"/></filter>'
    script.write_text(f"<FilterScript>{CLOSE.format('')}{crash}</FilterScript>")
    with pytest.raises(
        NeighbourError, match=r"crashed with SIG.*said: .*crash\.mlx, filter 2 \('Mesh Boolean: Union'\)$"
    ):
        wct.apply_filter("meshlab", sphere_surface(20), script=script)


def test_the_sample_script_of_pymeshlab():
    script = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "sample_filter_script.mlx"
    made, metrics = wct.apply_filter("meshlab", sphere_surface(10), script=script)
    assert [step["filter"] for step in metrics["steps"]] == [
        "create_cube",
        "meshing_surface_subdivision_catmull_clark",
        "meshing_surface_subdivision_butterfly",
    ]
    assert np.ptp(made.points, axis=0).max() < 2.0 + 1e-9
    assert not holes(made)
