"""No two tets overlap: decided exactly, also where they touch; what overlaps is never called valid, nor a success."""

import json
import re

import numpy as np
import pytest
from scipy.optimize import linprog
from support.builders import bcc, jittered_cube, kuhn_cube, kuhn_grid, regular_tet, rotation

from wct_plugin import Pipeline, apply_filter, read, write
from wct_plugin.certify.certificate import certify
from wct_plugin.certify.overlapping_tets import overlap
from wct_plugin.cli import main
from wct_plugin.errors import WctWarning
from wct_plugin.measure.duals import tiers
from wct_plugin.mesh import TetMesh
from wct_plugin.mesh.topology import FACETS
from wct_plugin.meshing import remesh
from wct_plugin.meshing.boundary_choice import PatchChoices
from wct_plugin.meshing.new_mesh_faults import find_fault
from wct_plugin.meshing.normalized_mesh import NormalizedMesh
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.reports.report import make_report


def joined(*meshes):
    """Several meshes in one, sharing no point."""
    offsets = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    tets = [mesh.tets + offset for mesh, offset in zip(meshes, offsets, strict=False)]
    return TetMesh(np.concatenate([mesh.points for mesh in meshes]), np.concatenate(tets))


def moved(mesh, shift, scale=1.0):
    return TetMesh(mesh.points * scale + shift, mesh.tets)


def wheel(wedges):
    """Wedges of 60 degrees around an edge, each on the one before it: beyond six they wind round a second time."""
    turn = np.arange(wedges + 1) * np.pi / 3
    rim = np.column_stack([np.cos(turn), np.sin(turn), 0.01 * turn])
    tets = np.array([[0, 1, 2 + k, 3 + k] for k in range(wedges)])
    return TetMesh(np.vstack([[0, 0, -1], [0, 0, 1], rim]), tets)


def room(one, other):
    """Radius of the largest ball in both of two tets, by linear programming; not positive where none is."""
    corners = np.stack([one, other])[:, FACETS]
    normals = np.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :]).reshape(8, 3)
    heights = (normals * corners[..., 0, :].reshape(8, 3)).sum(axis=1)
    rows = np.column_stack([normals, np.linalg.norm(normals, axis=1)])
    return linprog([0, 0, 0, -1], rows, heights, bounds=(None, None)).x[3]


@pytest.mark.parametrize("turned", [False, True])
def test_random_tets_on_a_lattice_agree_with_linear_programming(turned):
    """On a lattice of three points a side most pairs touch somewhere; turned, they touch by rounding alone."""
    rng = np.random.default_rng(1)
    seen = {True: 0, False: 0}
    while sum(seen.values()) < 40:
        points = rng.integers(0, 3, (8, 3)).astype(float)
        volumes = np.linalg.det(points.reshape(2, 4, 3)[:, 1:] - points.reshape(2, 4, 3)[:, :1])
        if (np.abs(volumes) < 0.5).any():
            continue
        mesh = TetMesh(points @ rotation(2).T if turned else points, np.arange(8).reshape(2, 4))
        overlaps = room(*mesh.points[mesh.tets]) > 1e-9
        if not overlaps and turned:
            continue  # by how much they would is no more than rounding
        seen[overlaps] += 1
        assert overlap(mesh) == ((0, 1) if overlaps else None)
    assert turned or min(seen.values()) > 5


@pytest.mark.parametrize(
    "mesh",
    [
        wheel(9),
        joined(kuhn_cube(2), moved(kuhn_cube(2), [0.5, 0.25, 0.125])),
        joined(kuhn_cube(2), moved(kuhn_cube(2), [0.0, 0.0, 0.0])),  # the same places twice
        joined(kuhn_cube(2), moved(regular_tet(), 0.5, 0.1)),  # inside: the boundaries do not meet
        joined(kuhn_cube(1), moved(kuhn_cube(1), 0.25, 0.5)),
        joined(kuhn_cube(1), moved(kuhn_cube(1), [0.0, 0.0, 0.25], 0.5)),  # inside, and flush with a side
        TetMesh(
            np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, 1], [0.3, 0.3, 2]]), [[0, 1, 2, 3], [0, 1, 2, 4]]
        ),
    ],
    ids=["wheel", "cubes", "twice", "inside", "cube inside", "flush", "one side"],
)
def test_tets_that_overlap_are_named_and_make_no_valid_mesh(mesh):
    first, second = overlap(mesh)
    assert room(*mesh.points[mesh.tets[[first, second]]]) > 1e-3
    assert not tiers(mesh).valid
    report = make_report(mesh)
    assert report.tiers.name == report.to_dict()["tier"] == "not valid"
    assert not any(report.to_dict()["tiers"].values())
    assert not certify(mesh).valid


@pytest.mark.parametrize(
    "mesh",
    [
        wheel(5),
        bcc(2),
        joined(kuhn_cube(2), moved(kuhn_cube(2), [1.0, 0.0, 0.0])),  # in contact, facet by facet
        joined(kuhn_cube(2), moved(kuhn_cube(1), [1.0, 0.5, 0.5])),  # in contact, and facets do not match
        joined(kuhn_cube(1), moved(kuhn_cube(1), [1.0, 1.0, 0.3])),  # along part of an edge
        joined(kuhn_grid((3, 3, 3), lambda c: np.abs(c - 1.5).max(axis=1) > 0.6), moved(kuhn_cube(1), 1.0)),  # filled
    ],
    ids=["wheel", "bcc", "contact", "sliding contact", "edge", "filled cavity"],
)
def test_tets_that_touch_do_not_overlap(mesh):
    assert overlap(mesh) is None
    assert tiers(mesh).valid
    assert make_report(mesh).to_dict()["tiers"]["valid"]


def test_a_new_mesh_that_overlaps_itself_has_a_fault():
    box = kuhn_cube(2)
    old, beside = joined(box, moved(box, [2.0, 0.0, 0.0])), joined(box, moved(box, [3.0, 0.0, 0.0]))
    own = own_boundary(old, 40.0)
    given = NormalizedMesh(old, own, PatchChoices("move", old, own.strata), unit=1, tangled=False)
    assert find_fault(given, beside, own, 1e-3, stopped=False) == ""
    assert find_fault(given, box, own, 1e-3, stopped=False) == "the new mesh has another topology"
    through = find_fault(given, joined(box, moved(box, [0.7, 0.0, 0.0])), own, 1e-3, stopped=False)
    x, y, z = map(float, through.removeprefix("the new mesh overlaps itself near (").rstrip(")").split(","))
    assert 2.0 * 0.6 < x < 2.0 * 1.1  # in the user's unit
    assert 0.0 < y < 2.0
    assert 0.0 < z < 2.0


@pytest.fixture
def overlapping(monkeypatch):
    """Whatever new mesh is made overlaps itself."""
    fault = "the new mesh overlaps itself near (1, 2, 3)"
    monkeypatch.setattr(remesh, "find_fault", lambda *_, **__: fault)
    return f"{fault}; the mesh stays as it is: a smaller tolerance"


def test_a_result_that_overlaps_itself_is_not_taken(overlapping):
    mesh = jittered_cube(3)
    with pytest.warns(WctWarning, match=re.escape(overlapping)):
        same, metrics = apply_filter("meshing_well_centered", mesh)
    assert np.array_equal(same.points, mesh.points)
    assert np.array_equal(same.tets, mesh.tets)
    assert metrics["bad"] > 0


def test_nor_is_it_a_success_on_the_command_line(overlapping, tmp_path, capsys):
    given, out = str(tmp_path / "in.vtu"), str(tmp_path / "out.vtu")
    write(given, jittered_cube(3))
    assert main.run(["optimize", given, out]) == 1
    assert overlapping in capsys.readouterr().err
    assert np.array_equal(read(out).points, read(given).points)


def test_a_mesh_that_overlaps_itself_is_named_before_the_work_and_meets_no_goal(tmp_path, capsys):
    """All its tets are completely well-centered."""
    names = [str(tmp_path / name) for name in ("in.vtu", "out.vtu")]
    tet = regular_tet()
    write(names[0], joined(tet, moved(tet, 0.1)))
    assert main.run(["optimize", *names]) == 1
    said = capsys.readouterr()
    assert f"{names[0]} overlaps itself: tets 0 and 1 do, near (" in " ".join(said.err.split())
    assert "not valid" in said.out
    assert main.run(["report", names[0], "--goal", "cwc"]) == 1
    chain = Pipeline.from_json(json.dumps([names[0], {"type": "filters.meshing_well_centered"}]))
    with pytest.warns(WctWarning, match="overlaps itself: tets 0 and 1 do"):
        result = chain.execute()
    assert not result.goal_met
    assert [(goal.missed, goal.valid) for goal in result.goals] == [(0, False)]
