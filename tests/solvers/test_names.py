"""A bar of two materials, made well-centered: what solvers find by gmsh's names, the interface inside included."""

from pathlib import Path

import ngsolve
import numpy as np
import pytest
import skfem
from devices.laplace import DEVICE, devsim, flux, load, unload
from devices.stack import stack
from netgen.read_gmsh import ReadGmsh
from support.couples import couples

import wct_plugin as wct
from wct_plugin.mesh import TetMesh

REGIONS = {"steel": 1.5, "copper": 1.0}
FACETS = ("hot", "weld", "cold")
AREA = 1.0


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bar") / "bar.msh"
    stack(path, REGIONS, ("hot", "cold"), 0.25, interfaces=["weld"])
    wct.optimize(path, path)
    return path


def test_the_mesh_meets_the_goal_and_has_no_negative_couple(file: Path) -> None:
    mesh = wct.read(file)
    assert isinstance(mesh, TetMesh)
    report = wct.report(mesh)
    assert report.flags["cwc"] == report.tets
    assert report.solver_view.total.negative_couples == 0
    assert report.solver_view.total.unsigned_over_signed == pytest.approx(1.0, abs=1e-12)
    assert min(couples(mesh).values()) > 0


def test_devsim(file: Path) -> None:
    """Regions with their volumes, contacts and the interface with their areas."""
    load(file, REGIONS, {"hot": "steel", "cold": "copper"}, {"weld": ("steel", "copper")})
    try:
        for region, thickness in REGIONS.items():
            volumes = devsim.get_node_model_values(device=DEVICE, region=region, name="NodeVolume")
            assert sum(volumes) == pytest.approx(thickness * AREA, rel=1e-12)
        for contact, region in (("hot", "steel"), ("cold", "copper")):
            areas = devsim.get_node_model_values(device=DEVICE, region=region, name="ContactSurfaceArea")
            assert sum(areas) == pytest.approx(AREA, rel=1e-12), contact
        for region in REGIONS:
            areas = devsim.get_node_model_values(device=DEVICE, region=region, name="SurfaceArea")
            assert sum(areas) == pytest.approx(AREA, rel=1e-12)
    finally:
        unload()


@pytest.mark.parametrize("ratio", [1.0, 1e4])
def test_devsim_is_exact_however_far_apart_the_coefficients_are(file: Path, ratio: float) -> None:
    coefficients = {"steel": 1.0, "copper": ratio}
    found = flux(file, coefficients, {"hot": ("steel", 1.0), "cold": ("copper", 0.0)}, {"weld": ("steel", "copper")})
    exact = AREA / sum(thickness / coefficients[name] for name, thickness in REGIONS.items())
    assert found == pytest.approx(exact, rel=1e-12)


@pytest.mark.filterwarnings("ignore:Exception ignored:pytest.PytestUnraisableExceptionWarning")  # it leaves files open
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")
def test_ngsolve(file: Path) -> None:
    mesh = ngsolve.Mesh(ReadGmsh(str(file)))
    assert set(mesh.GetMaterials()) == set(REGIONS)
    for region, thickness in REGIONS.items():
        volume = ngsolve.Integrate(1.0, mesh, definedon=mesh.Materials(region))
        assert volume == pytest.approx(thickness * AREA, rel=1e-12)
    for name, place in zip(FACETS, (0.0, 1.5, 2.5), strict=True):
        on = mesh.Boundaries(name)
        assert ngsolve.Integrate(1.0, mesh, definedon=on) == pytest.approx(AREA, rel=1e-12)
        assert ngsolve.Integrate(ngsolve.x, mesh, definedon=on) == pytest.approx(place * AREA, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("how", ["to_skfem", "4.1"])
def test_scikit_fem(how: str, file: Path, tmp_path: Path) -> None:
    """Of files of version 2.2 its own reader takes the groups on the boundary alone."""
    if how == "4.1":
        wct.write(tmp_path / "bar.msh", wct.read(file), version="4.1")
        mesh = skfem.MeshTet.load(tmp_path / "bar.msh")
    else:
        mesh = wct.to_skfem(wct.read(file))
    one = skfem.Functional(lambda w: np.ones_like(w.x[0]))
    for region, thickness in REGIONS.items():
        inside = skfem.Basis(mesh, skfem.ElementTetP1(), elements=region)
        assert one.assemble(inside) == pytest.approx(thickness * AREA, rel=1e-12)
    for name in FACETS:
        on = skfem.FacetBasis(mesh, skfem.ElementTetP1(), facets=name)
        assert one.assemble(on) == pytest.approx(AREA, rel=1e-12)
    assert (mesh.f2t[1, np.asarray(mesh.boundaries["weld"])] >= 0).all()  # inside
