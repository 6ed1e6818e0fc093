"""What is left: the class of each tet, which option would free it, and why."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.builders import cylinder, jittered_cube, kuhn_cube, regular_tet

from wct_plugin.measure import quality
from wct_plugin.mesh import Cells
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions import RECONNECT
from wct_plugin.obstructions.reason import name
from wct_plugin.obstructions.remaining_tets import CLASSES, lines, list_remaining, rows, title


def left(mesh, goal="cwc", boundary="move", crease_angle=40.0, stopped=False, connectivity="free"):
    return list_remaining(
        mesh,
        find_strata(mesh, crease_angle),
        quality.measure(mesh),
        goal=goal,
        boundary=boundary,
        crease_angle=crease_angle,
        stopped=stopped,
        connectivity=connectivity,
    )


@pytest.mark.parametrize("goal", ["3wc", "cwc"])
def test_every_bad_tet_is_listed_once_worst_first(goal):
    mesh = jittered_cube(4, 1)
    measured = quality.measure(mesh)
    good = measured.completely_well_centered if goal == "cwc" else measured.well_centered_3
    found = left(mesh, goal)
    assert sorted(tet["tet"] for tet in found["tets"]) == np.flatnonzero(~good).tolist()
    assert found["count"] == len(found["tets"]) == sum(found["by_place"].values())
    worst = [
        min(t["min_height"], np.cos(np.radians(t["max_face_angle"])) if goal == "cwc" else 1) for t in found["tets"]
    ]
    assert worst == sorted(worst)
    of = find_strata(mesh)
    for tet in found["tets"]:
        assert tet["place"] == CLASSES[max(of.stratum[v] for v in mesh.tets[tet["tet"]])]
        assert ("3WC" in tet["misses"]) == (not measured.well_centered_3[tet["tet"]])
        assert ("goal=3wc" in tet["option"]) == bool(measured.well_centered_3[tet["tet"]])
    assert json.loads(json.dumps(found)) == found
    assert len(rows(found, 7)) == 7
    assert title(found).startswith(f"{found['count']} tets miss the goal: {found['by_place']['interior']} interior")


def test_nothing_is_left_of_a_regular_tet():
    assert left(regular_tet()) == {
        "count": 0,
        "by_place": dict.fromkeys(CLASSES, 0),
        "proven": 0,
        "reasons": [],
        "kinds": [],
        "tets": [],
    }


def options(found):
    """Class -> the options named for it, without the hint about the goal."""
    out = {}
    for tet in found["tets"]:
        out.setdefault(tet["place"], set()).add(tet["option"].removesuffix(", or goal=3wc"))
    return out


def test_options_of_a_polyhedron():
    mesh = jittered_cube(5, 0)
    moved = options(left(mesh))
    assert moved == {
        "interior": {"a larger effort"},
        "patch": {"a larger effort"},
        "crease": {"a smaller edge_length"},
        "corner": {"a smaller edge_length"},
    }
    kept = options(left(mesh, boundary="keep"))
    assert kept == {"interior": {"a larger effort"}} | {name: {"boundary=move"} for name in CLASSES[1:]}
    fixed = options(left(mesh, boundary="fixed"))
    assert fixed == {"interior": {"a larger effort"}} | {name: {"boundary=keep or move"} for name in CLASSES[1:]}
    slid = options(left(mesh, boundary="slide", connectivity="fixed"))
    assert all(slid[name] == {RECONNECT} for name in CLASSES)
    held = options(left(mesh, boundary="fixed", connectivity="fixed"))
    assert held["interior"] == {RECONNECT}
    assert all(f"boundary=slide, or {RECONNECT}" in held[name] for name in CLASSES[1:])
    assert {tet["option"] for tet in left(mesh, goal="3wc", stopped=True)["tets"]} == {"more time: it was stopped"}


def test_options_on_a_curved_surface_and_at_slight_creases():
    """A prism of 8 sides bends by 45 degrees at its long edges, and by 90 round its ends."""
    mesh = cylinder(8, 4)
    smooth = options(left(mesh, crease_angle=50.0))
    assert smooth["patch"] == {"a larger tolerance, or a smaller edge_length"}
    assert smooth["crease"] == {"a larger tolerance, or a smaller edge_length"}
    creased = left(mesh, crease_angle=40.0)
    at = {True: set(), False: set()}
    of = find_strata(mesh, 40.0)
    for tet in creased["tets"]:
        vertices = mesh.tets[tet["tet"]]
        ends = np.isin(mesh.points[vertices[of.stratum[vertices] >= 2]][:, 2], [0.0, 2.0]).any()
        at[bool(ends)].add(tet["option"].removesuffix(", or goal=3wc"))
    assert at == {False: {"a crease_angle above 45.0°: the crease bends no more"}, True: {"a smaller edge_length"}}


def test_a_crease_that_a_tag_makes_is_not_blamed_on_the_angle():
    mesh = cylinder(8, 4)
    triangles = mesh.topology.boundary
    tags = (mesh.points[triangles].mean(axis=1)[:, 2] > 1).astype(int)
    tagged = replace(mesh, facets=Cells(triangles, tags))
    of = find_strata(tagged, 50.0)
    found = options(left(tagged, crease_angle=50.0))
    assert (of.stratum[mesh.points[:, 2] == 1.0] >= 2).any()
    assert not any("crease_angle" in option for said in found.values() for option in said)


def test_reasons_are_counted_by_kind_and_the_first_of_each_named():
    """Each square of Kuhn's boundary is two right triangles."""
    mesh = kuhn_cube(2)
    found = left(mesh, goal="3wc", boundary="fixed")
    assert json.loads(json.dumps(found)) == found
    assert sum(kind["count"] for kind in found["reasons"]) == 24  # one per square
    for kind, line in zip(found["reasons"], lines(found), strict=True):
        assert (kind["option"], len(kind["cells"])) == ("boundary=keep or move", 5)
        assert all(len(cell) in (2, 3) for cells in kind["cells"] for cell in cells)
        first = ", ".join(name(cell) for cell in kind["cells"][0])
        assert line.startswith(f"provably impossible under these options, {kind['count']} times: {kind['why']}")
        assert line.endswith(f"(first at {first}); boundary=keep or move would free it")
    proofs = {tet["proof"] for tet in found["tets"]} - {""}
    assert proofs
    assert all(any(proof.endswith(kind["why"]) for kind in found["reasons"]) for proof in proofs)
    assert f"for {found['proven']} it is provably out of reach" in title(found)
    assert lines(left(mesh, goal="3wc", boundary="keep")) == []
