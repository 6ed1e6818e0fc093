"""The report: its numbers, their formats, the JSON-able dict and the terminal's lines."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, bcc, jittered_cube, kuhn_cube, rotation, single, two_region_cube
from support.printed import PAPER_TETS

from wct_plugin.measure import quality
from wct_plugin.measure.duals import compute_duals
from wct_plugin.measure.negative_duals import count_negative_duals
from wct_plugin.measure.solver_view import view
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.repairs import Repairs
from wct_plugin.mesh.strata import find_strata
from wct_plugin.obstructions.remaining_tets import list_remaining
from wct_plugin.reports.report import make_report
from wct_plugin.reports.text_histograms import text_histogram, text_histograms


@pytest.mark.parametrize("name", PAPER_TETS)
def test_paper_tets_in_print(name):
    points, printed, letters = PAPER_TETS[name]
    report = make_report(single(points))
    rows = {measure: (low, high) for measure, low, high in report.rows_ranges()}
    assert rows == {
        "h/R": (printed[0], printed[1]),
        "Face angle": (printed[2] + "°", printed[3] + "°"),
        "Dihedral angle": (printed[4] + "°", printed[5] + "°"),
        "R/ℓ": (printed[6], printed[7]),
    }
    percent = {"Y": ("1", "100.000 %"), "N": ("0", "0.000 %")}
    flags = {flag: (count, share) for flag, count, share in report.rows_flags()}
    assert [flags[flag] for flag in ("3WC", "2WC", "Acute")] == [percent[letter] for letter in letters]
    assert flags["CWC"] == percent["Y" if letters.startswith("YY") else "N"]


def test_dict_of_a_mesh():
    mesh = ball(3)
    report = make_report(replace(mesh, source="in.vtu"), worst=5)
    measured = quality.measure(mesh)
    found = report.to_dict()
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert found["source"] == "in.vtu"
    assert (found["points"], found["tets"]) == (len(mesh.points), len(mesh.tets))
    assert found["regions"] == {"0": len(mesh.tets)}
    assert found["boundary_facets"] == len(mesh.topology.boundary)
    assert found["components"] == 1
    assert found["repairs"] == vars(Repairs())
    assert found["volume"] == pytest.approx(measured.volume.sum())
    assert found["ranges"]["h/R"] == {"min": measured.min_height.min(), "max": measured.max_height.max()}
    assert found["ranges"]["face_angle"]["max"] == measured.max_face_angle.max()
    assert found["ranges"]["dihedral_angle"]["min"] == measured.min_dihedral_angle.min()
    assert found["ranges"]["R/l"]["max"] == measured.radius_over_edge.max()
    for name, mask in (
        ("3wc", measured.well_centered_3),
        ("2wc", measured.well_centered_2),
        ("cwc", measured.completely_well_centered),
        ("acute", measured.acute),
    ):
        assert found[name] == {"count": mask.sum(), "percent": pytest.approx(100.0 * mask.mean())}
    assert found["tier"] == "Delaunay"
    assert found["tiers"] == {"valid": True, "Delaunay": True, "one-sided": False, "3WC": False, "CWC": False}
    for name, total in (("h/R", 1), ("face_angle", 1), ("dihedral_angle", 6), ("R/l", 1)):
        histogram = found["histograms"][name]
        assert len(histogram["edges"]) == len(histogram["counts"]) + 1
        assert sum(histogram["counts"]) == total * len(mesh.tets)
    negative = np.array(found["histograms"]["h/R"]["counts"])[np.array(found["histograms"]["h/R"]["edges"])[1:] <= 0]
    assert negative.sum() == (measured.min_height < 0).sum()
    assert found["deviation"] is found["tolerance"] is None
    assert found["negative_duals"] == count_negative_duals(mesh, compute_duals(mesh)).to_dict()
    assert found["solver_view"] == view(mesh).to_dict()
    assert sum(row["tets"] for row in found["bad_by_place"].values()) == len(mesh.tets)
    assert sum(row["not_3wc"] for row in found["bad_by_place"].values()) == (~measured.well_centered_3).sum()
    assert sum(row["not_cwc"] for row in found["bad_by_place"].values()) == (~measured.completely_well_centered).sum()
    assert list(found["bad_by_place"]) == ["interior", "boundary", "crease", "corner"]


def test_worst_tets_come_first_with_where_they_are():
    mesh = two_region_cube(2)
    points = mesh.points.copy()
    centre = int(np.flatnonzero((points == 0.5).all(axis=1))[0])
    points[centre] += [0.2, 0.1, 0.05]
    mesh = TetMesh(points, mesh.tets, mesh.regions)
    measured = quality.measure(mesh)
    report = make_report(mesh, worst=7)
    margin = np.minimum(measured.min_height, np.cos(np.radians(measured.max_face_angle)))
    assert [margin[tet.tet] for tet in report.worst] == sorted(margin)[:7]
    for tet in report.worst:
        assert tet.region == mesh.regions[tet.tet]
        assert tet.min_height == measured.min_height[tet.tet]
        assert tet.max_face_angle == measured.max_face_angle[tet.tet]
        assert tet.centroid == tuple(mesh.points[mesh.tets[tet.tet]].mean(axis=0))
        assert tet.place in ("boundary", "crease", "corner")
    assert len(report.rows_worst()) == 7
    assert all(len(row) == len(report.worst_head()) for row in report.rows_worst())
    assert make_report(mesh, worst=0).worst == ()
    assert len(make_report(single(PAPER_TETS["n2y3y"][0])).worst) == 1


def test_deviation_from_the_reference():
    mesh = kuhn_cube(2)
    surface = mesh.boundary_surface()
    moved = SurfaceMesh(surface.points * 1.1, surface.triangles)
    found = make_report(replace(mesh, reference=moved)).to_dict()["deviation"]
    assert found["max"] == pytest.approx(0.1 * np.sqrt(3.0))
    assert found["from_reference"] == pytest.approx(0.1 * np.sqrt(3.0))
    assert found["to_reference"] == pytest.approx(0.1)
    assert found["fraction_of_diagonal"] == pytest.approx(0.1 / 1.1)
    assert 0 < found["sampling_error"] < 0.2
    assert make_report(replace(mesh, reference=surface)).to_dict()["deviation"]["max"] < 1e-12


def test_what_a_filter_found_goes_in_as_it_is():
    mesh = jittered_cube(4, 1)
    of = find_strata(mesh)
    left = list_remaining(
        mesh, of, quality.measure(mesh), goal="cwc", boundary="keep", crease_angle=40.0, stopped=False
    )
    apart = {"fraction_of_diagonal": 0.25}
    report = make_report(mesh, found={"deviation": apart, "tolerance": 0.3, "remaining": left, "tets": 3})
    found = report.to_dict()
    assert found["tolerance"] == 0.3
    assert (found["deviation"], found["remaining"], found["shape"]) == (apart, left, None)
    assert found["tets"] == len(mesh.tets)
    assert dict(report.rows_summary())["deviation / diagonal"] == "2.50e-01"
    title, head, rows = report.left(most=5)
    assert title.endswith("; the worst 5 of them")
    assert len(rows) == 5
    assert all(len(row) == len(head) for row in rows)
    assert "the worst" not in report.left(most=10_000)[0]
    assert make_report(bcc(2)).left() is None
    assert report.notes == make_report(mesh).notes == ()
    volumes = {tag: {"before": 1.0, "after": 1.1, "change": 0.1} for tag in "12"}
    told = make_report(mesh, found={"volumes": volumes, "interfaces": {"1|2": None}})
    assert told.notes == ("region 1: volume +10.000 %; region 2: volume +10.000 %; interface 1|2: lost",)
    assert make_report(mesh).to_dict()["remaining"] is None


def test_percent_never_rounds_to_all_or_none():
    report = make_report(bcc(2))
    many = replace(report, tets=10_000_000, flags={"3wc": 9_999_999, "2wc": 1, "cwc": 0, "acute": 10_000_000})
    assert [row[2] for row in many.rows_flags()] == ["99.999 %", "0.001 %", "0.000 %", "100.000 %"]
    assert many.to_dict()["3wc"]["percent"] == pytest.approx(99.99999)


def test_infinite_values_become_none():
    report = make_report(bcc(2))
    broken = replace(report, ranges={**report.ranges, "R/l": (1.0, np.inf)}, volume=float("nan"))
    found = broken.to_dict()
    assert found["ranges"]["R/l"] == {"min": 1.0, "max": None}
    assert found["volume"] is None
    json.dumps(found, allow_nan=False)
    assert broken.rows_ranges()[3] == ("R/ℓ", "1.000", "-")


def test_all_but_flat_tets_are_reported_without_complaint():
    """Volumes below rounding: values may be infinite, but nothing warns and no flag is given."""
    rng = np.random.default_rng(0)
    for seed in range(40):
        points = rng.normal(size=(4, 3)) * [1, 1, 0] @ rotation(seed).T + rng.choice([0.0, 1.0, 100.0])
        points[3] = rng.dirichlet(np.ones(3)) @ points[:3]
        report = make_report(single(points))
        json.dumps(report.to_dict(), allow_nan=False)
        assert len(report.rows_worst()) == 1
        assert report.flags["cwc"] == report.flags["acute"] == 0


def test_rows_for_the_terminal():
    report = make_report(replace(bcc(3), source="bcc.vtu"))
    assert report.headline() == "bcc.vtu: 216 tets, 83 points, 100.000 % 3WC, 100.000 % CWC, tier CWC"
    assert [row[:2] for row in report.rows_tiers()] == [
        (tier, "yes") for tier in ("valid", "Delaunay", "one-sided", "3WC", "CWC")
    ]
    assert report.rows_places()[3] == ("corner", "216", "0", "0")
    summary = dict(report.rows_summary())
    assert summary["tets"] == "216"
    assert summary["h/R, min"] == "0.316"
    assert summary["tier"] == "CWC"
    assert summary["deviation / diagonal"] == "-"
    other = make_report(ball(3)).rows_summary()
    assert [name for name, _ in other] == list(summary)
    titles = [title for title, _ in text_histograms([report])]
    assert len(titles) == len(set(titles)) == 4


def test_text_histogram():
    edges, counts = np.linspace(0.0, 5.0, 6), np.array([0, 8, 0, 1, 0])
    assert text_histogram(edges, [counts], "°", width=2) == ["1° ██ 8", "2°    0", "3° ▎  1"]
    assert text_histogram(np.array([-0.5, 0.0, 0.5]), [np.array([1, 1])], width=1) == ["-0.50 █ 1", " 0.00 █ 1"]
    assert text_histogram(edges, [np.zeros(5, dtype=int)]) == []
    both = text_histogram(edges, [counts, np.array([16, 0, 0, 0, 4])], width=2)
    assert both == ["0    0 ██ 16", "1 ██ 8    0", "2    0    0", "3 ▎  1    0", "4    0 ▌  4"]
    tiny = text_histogram(edges, [np.array([1, 0, 0, 0, 10**9])])
    assert "▏" in tiny[0]  # anything above zero shows
    assert "▏" not in tiny[1]


def test_the_mesh_is_not_changed():
    mesh = jittered_cube(3)
    points, tets = mesh.points.copy(), mesh.tets.copy()
    make_report(mesh)
    assert (mesh.points == points).all()
    assert (mesh.tets == tets).all()
