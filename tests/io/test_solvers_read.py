"""What is written is read by programs: by CalculiX in its input deck, by mmg as Medit's files."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.builders import two_region_cube

import wct_plugin as wct
from wct_plugin.errors import WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, TetMesh
from wct_plugin.mesh.required_sets import REQUIRED_EDGES, REQUIRED_TRIANGLES

#: A model round the mesh: one material, three nodes held, one loaded, the volume of each set printed.
DECK = """*INCLUDE, INPUT=mesh.inp
*MATERIAL, NAME=M
*ELASTIC
1., .3
*SOLID SECTION, ELSET=steel, MATERIAL=M
*SOLID SECTION, ELSET=air, MATERIAL=M
*NSET, NSET=HELD
1, 2, 3
*BOUNDARY
HELD, 1, 3
*STEP
*STATIC
*CLOAD
4, 3, 1.
*EL PRINT, ELSET=steel, TOTALS=ONLY
EVOL
*EL PRINT, ELSET=air, TOTALS=ONLY
EVOL
*END STEP
"""


def run(folder: Path, *command: str) -> str:
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True, timeout=60).stdout


@pytest.fixture
def two() -> TetMesh:
    mesh = two_region_cube(3)
    low, high = np.unique(mesh.regions)
    return replace(mesh, names={"steel": (int(low), 3), "air": (int(high), 3)})


def test_calculix_finds_the_volume_of_each_set(two: TetMesh, tmp_path: Path) -> None:
    wct.write(tmp_path / "mesh.inp", two)
    (tmp_path / "deck.inp").write_text(DECK)
    assert "Job finished" in run(tmp_path, "ccx", "deck")
    printed = re.findall(r"total volume for set (\w+) .*\n\s*\n\s*(\S+)", (tmp_path / "deck.dat").read_text())
    volumes = quality.volumes(two.points, two.tets)
    expected = {name.upper(): volumes[two.regions == tag].sum() for name, (tag, _) in two.names.items()}
    assert {name: float(value) for name, value in printed} == pytest.approx(expected, rel=1e-6)


def test_mmg_keeps_what_must_stay(two: TetMesh, tmp_path: Path) -> None:
    """With all work of mmg switched off, the required triangle and edge come back, and each region with its volume."""
    boundary = two.topology.boundary
    inner = two.topology.interfaces[:1]
    mesh = replace(
        two,
        names={},
        facets=Cells(np.vstack([boundary, inner]), np.full(len(boundary) + 1, 3), sets={REQUIRED_TRIANGLES: [0]}),
        edges=Cells(boundary[:1, :2], [5], sets={REQUIRED_EDGES: [0]}),
    )
    wct.write(tmp_path / "a.mesh", mesh)
    mmg = shutil.which("mmg3d_O3")
    assert mmg
    run(tmp_path, mmg, "-in", "a.mesh", "-out", "b.mesh", "-noinsert", "-noswap", "-nomove", "-nosurf")
    with pytest.warns(WctWarning, match="not read: section 'Normals'"):
        back = wct.read(tmp_path / "b.mesh")
    assert isinstance(back, TetMesh)
    before, after = (
        [tuple(row) for row in np.round(m.points, 12).tolist()] for m in (mesh, back)
    )  # 15 digits are written
    assert sorted(after) == sorted(before)
    for tag in np.unique(mesh.regions):
        one, other = (quality.volumes(m.points, m.tets)[m.regions == tag].sum() for m in (mesh, back))
        assert other == pytest.approx(one, rel=1e-12)
    for cells, name in (("facets", REQUIRED_TRIANGLES), ("edges", REQUIRED_EDGES)):
        held = []
        for m, places in ((mesh, before), (back, after)):
            of = getattr(m, cells)
            held.append({frozenset(places[v] for v in row) for row in of.vertices[of.sets[name]]})
        assert held[0] <= held[1], name
