"""``wct demo``: samples that the README's commands can be tried on, and the main job done on one of them."""

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.cli.demo import NEXT, SAMPLES

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "wct_plugin/cli/samples"
WCT = Path(sys.executable).with_name("wct")


def content(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_it_writes_the_samples_and_makes_the_bone_well_centered(demo, tmp_path):
    said = demo[1]
    shutil.copytree(demo[0], tmp_path, dirs_exist_ok=True)
    assert sorted(content(tmp_path)) == sorted([*SAMPLES, "bone.vtu", "bone.html"])
    assert "$ wct optimize bone.ply bone.vtu --allow-released --html bone.html" in said
    (percent,) = [line.split() for line in said.splitlines() if line.split()[:1] == ["CWC"]]
    assert float(percent[1]) < 50 < float(percent[3]) == 100.0
    assert [line.strip() for line in said.splitlines()[-len(NEXT) :]] == list(NEXT)
    wct.read(tmp_path / "bone.vtu").topology  # noqa: B018  # a mesh like any other
    before = content(tmp_path)
    again = subprocess.run([WCT, "demo"], cwd=tmp_path, capture_output=True, text=True)
    assert again.returncode == 2
    assert again.stderr.startswith("error: bone.vtu: a file of this name is there already")
    assert content(tmp_path) == before


@pytest.mark.parametrize("name", [*SAMPLES, "bone.vtu", "bone.html"])
def test_it_writes_over_nothing(name, tmp_path, capsys):
    (tmp_path / name).write_text("mine")
    said = refused(capsys, "demo", tmp_path)
    assert said.startswith(f"{tmp_path / name}: a file of this name is there already")
    assert content(tmp_path) == {name: b"mine"}


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, capsys):
    said = refused(capsys, "demo", tmp_path / "no" / "where")
    assert said == f"{tmp_path}/no/where: there is no directory {tmp_path}/no; create it first"
    assert not content(tmp_path)


def test_a_new_folder_is_made_and_samples_of_before_may_be_there(tmp_path, capsys):
    folder = tmp_path / "new"
    folder.mkdir()
    for name in ("part.msh", "part.stl"):
        (folder / name).write_bytes((SHIPPED / name).read_bytes())
    assert main.run(["demo", str(folder), "--quiet"]) == 0
    assert {*SAMPLES, "bone.vtu"} <= {*content(folder)}
    assert capsys.readouterr().out == ""


def test_the_commands_to_try_next_are_taken():
    for line in NEXT:
        program, name, *arguments = shlex.split(line)
        assert program == "wct"
        main.cli.get_command(None, name).make_context(
            name, arguments
        )  # parses, runs nothing; the README's test runs them


# --- the samples ----------------------------------------------------------------------------------------------------


def test_the_samples_are_few_and_small():
    assert sorted(content(SHIPPED)) == sorted(SAMPLES)
    assert sum(map(len, content(SHIPPED).values())) < 500_000


def test_the_materials_and_contacts_have_names():
    mesh = wct.read(SHIPPED / "two_material.msh")
    assert mesh.names == {"bottom": (1, 2), "top": (2, 2), "inclusion": (10, 3), "matrix": (11, 3)}
    assert set(mesh.regions) == {10, 11}
    assert set(mesh.facets.tags) == {1, 2}
    corners = mesh.points[mesh.tets]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volumes.sum() == pytest.approx(8)
    assert volumes[mesh.regions == 10].sum() == pytest.approx(4 / 3 * np.pi * 0.6**3, rel=0.2)


def test_two_materials_come_right_with_contacts_and_volumes():
    mesh = wct.read(SHIPPED / "two_material.msh")
    better, metrics = wct.apply_filter("meshing_well_centered", mesh)
    assert metrics["bad"] == 0
    assert better.names == mesh.names
    assert set(better.facets.tags) == {1, 2}
    assert all(abs(one["change"]) < 5e-3 for one in metrics["volumes"].values())


def test_the_surface_of_the_part_is_finer_than_the_part():
    part, surface = wct.read(SHIPPED / "part.msh"), wct.read(SHIPPED / "part.stl")
    assert set(part.names) == {"clamped", "pulled", "free", "steel"}
    assert np.ptp(surface.points, axis=0) == pytest.approx(np.ptp(part.points, axis=0))
    for points, least in ((part.points, 0.0), (surface.points, 64)):
        radius = np.linalg.norm(points[:, :2] - [2, 1], axis=1)
        assert radius.min() == pytest.approx(0.5, abs=1e-6)
        assert np.count_nonzero((radius < 0.5 + 1e-6) & (points[:, 2] == 0)) >= least


def test_our_bone_can_be_filled():
    bone = wct.read(SHIPPED / "bone.ply")
    mesh, _ = wct.apply_filter("generate_tetrahedralization", bone)
    assert np.ptp(mesh.points, axis=0) == pytest.approx(np.ptp(bone.points, axis=0), rel=0.01)
