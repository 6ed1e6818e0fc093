"""``skfem.MeshTet``: subdomains and boundaries, there and back, and solved on."""

from pathlib import Path

import numpy as np
import pytest
from skfem import Basis, ElementTetP1, ElementTetP2, Functional, InteriorFacetBasis, MeshTet, MeshTet2
from skfem.generic_utils import OrientedBoundary
from support.builders import two_region_cube
from support.comparing import assert_same

import wct_plugin as wct
from wct_plugin.errors import InputError, WctWarning
from wct_plugin.measure import quality
from wct_plugin.mesh import Cells, TetMesh

DATA = Path(__file__).parents[1] / "data"


def grid(n=2):
    """The unit cube in n³ boxes of six tets each."""
    return MeshTet.init_tensor(*[np.linspace(0, 1, n + 1)] * 3)


def cube():
    """With two halves, the sides left and right, and the wall between the halves from left to right."""
    mesh = grid()
    mesh = mesh.with_subdomains({"cold": lambda x: x[0] < 0.5, "hot": lambda x: x[0] > 0.5})
    wall = mesh.facets_satisfying(lambda x: np.isclose(x[0], 0.5), normal=np.array([1.0, 0.0, 0.0]))
    return mesh.with_boundaries(
        {"left": lambda x: np.isclose(x[0], 0), "right": lambda x: np.isclose(x[0], 1), "wall": wall}
    )


@Functional
def one(w):
    return 1.0 + 0.0 * w.x[0]


@Functional
def along(w):
    return w.n[0]


def volume(mesh, name):
    return one.assemble(Basis(mesh, ElementTetP1(), elements=name))


def test_subdomains_are_regions_and_boundaries_are_facets():
    given = cube()
    mesh = wct.as_mesh(given)
    assert dict(mesh.names) == {"cold": (1, 3), "hot": (2, 3)}
    volumes = quality.volumes(mesh.points, mesh.tets)
    for tag in (1, 2):
        assert volumes[mesh.regions == tag].sum() == pytest.approx(0.5, rel=1e-12)
    assert mesh.tet_sets == {}
    assert {name: len(ids) for name, ids in mesh.facets.sets.items()} == {
        name: len(ids) for name, ids in given.boundaries.items()
    }
    corners = mesh.points[mesh.facets.vertices[mesh.facets.sets["left"]]]
    assert (corners[..., 0] == 0).all()
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    assert area == pytest.approx(1.0, rel=1e-12)


def test_there_and_back():
    given = cube()
    again = wct.to_skfem(wct.as_mesh(given))
    assert np.array_equal(again.p, given.p)
    assert np.array_equal(np.sort(again.t, axis=0), np.sort(given.t, axis=0))
    assert set(again.subdomains) == {"cold", "hot"}
    for name, ids in given.subdomains.items():
        assert again.subdomains[name].tolist() == sorted(ids.tolist())
    for name, ids in given.boundaries.items():
        found = {tuple(row) for row in np.sort(again.facets.T[again.boundaries[name]], axis=1).tolist()}
        assert found == {tuple(row) for row in np.sort(given.facets.T[np.asarray(ids)], axis=1).tolist()}
    assert_same(wct.as_mesh(again), wct.as_mesh(given))


@pytest.mark.parametrize("turned", [False, True])
def test_a_wall_keeps_its_direction(turned):
    given = cube()
    wall = given.boundaries["wall"]
    if turned:
        wall = OrientedBoundary(wall, 1 - wall.ori)
    given = given.with_boundaries({"wall": wall, "mixed": OrientedBoundary([wall[0], wall[1]], [0, 1])})
    again = wct.to_skfem(wct.as_mesh(given))
    for name in ("wall", "mixed"):
        assert isinstance(again.boundaries[name], OrientedBoundary)
        fluxes = [
            along.assemble(InteriorFacetBasis(mesh, ElementTetP1(), facets=mesh.boundaries[name]))
            for mesh in (given, again)
        ]
        assert fluxes[1] == pytest.approx(fluxes[0], rel=1e-12)
    given = given.with_boundaries({"cut": wall[:1]})
    with pytest.raises(InputError, match=r"skfem.MeshTet: boundary 'cut' has 1 facets and 8 directions"):
        wct.as_mesh(given)


def test_optimized_with_materials_and_boundaries():
    given = cube()
    with pytest.warns(WctWarning, match="resampling drops triangle data 'oriented:wall'"):
        made = wct.optimize(given, goal="3wc", seed=1)
    assert type(made) is MeshTet
    assert made.t.shape[1] != given.t.shape[1]
    for name in ("cold", "hot"):
        assert volume(made, name) == pytest.approx(0.5, rel=1e-12)
    assert set(made.boundaries) == {"left", "right", "wall"}
    for name, x in (("left", 0.0), ("wall", 0.5), ("right", 1.0)):
        assert np.allclose(made.p[0, made.facets[:, made.boundaries[name]]], x, rtol=0, atol=1e-12)
    assert wct.report(made).flags["3wc"] == made.t.shape[1]


def test_overlapping_subdomains_all_keep_their_borders():
    given = grid().with_subdomains(
        {
            "all": lambda x: x[0] > -1,
            "half": lambda x: x[0] < 0.5,
            "quarter": lambda x: (x[0] < 0.5) & (x[1] < 0.5),
            "3": lambda x: (x[0] > 0.5) & (x[2] > 0.5),
        }
    )
    mesh = wct.as_mesh(given)
    assert set(mesh.tet_sets) == {"all", "half"}
    assert set(mesh.names) == {"quarter", "3"}
    assert mesh.names["3"] == (3, 3)  # a number is its own tag
    assert len(np.unique(mesh.regions)) == 4
    again = wct.to_skfem(mesh)
    assert set(again.subdomains) == set(given.subdomains)
    for name, ids in given.subdomains.items():
        assert again.subdomains[name].tolist() == sorted(ids.tolist())
    for ids in mesh.tet_sets.values():  # unions of regions, whose interfaces are kept
        assert np.array_equal(np.flatnonzero(np.isin(mesh.regions, mesh.regions[ids])), ids)


def test_overlapping_subdomains_optimized():
    given = grid().with_subdomains({"all": lambda x: x[0] > -1, "half": lambda x: x[0] < 0.5})
    made = wct.optimize(given, goal="3wc", seed=1)
    assert made.t.shape[1] != given.t.shape[1]
    for name, size in (("all", 1.0), ("half", 0.5)):
        assert volume(made, name) == pytest.approx(size, rel=1e-12), name


def test_one_subdomain_and_a_rest():
    given = grid().with_subdomains({"core": lambda x: x[0] < 0.5})
    mesh = wct.as_mesh(given)
    assert sorted(np.unique(mesh.regions).tolist()) == [0, 1]
    assert list(wct.to_skfem(mesh).subdomains) == ["core"]


def test_tags_without_names_are_named_by_number(full: TetMesh):
    mesh = TetMesh(full.points, full.tets, full.regions, Cells(full.facets.vertices, full.facets.tags))
    made = wct.to_skfem(mesh)
    assert set(made.subdomains) == {"3", "4"}
    assert set(made.boundaries) == {"7", "8", "9"}
    again = wct.as_mesh(made)
    assert again.regions.tolist() == mesh.regions.tolist()


def test_what_it_cannot_carry_is_named(full: TetMesh):
    with pytest.warns(WctWarning, match="skfem.MeshTet cannot carry, so dropped: ") as caught:
        made = wct.to_skfem(full)
    said = str(caught[0].message)
    for name in ("point data 'u'", "cell data 'heat'", "facet data 'flux'", "set 'fixed' of points", "5 tagged edges"):
        assert name in said
    assert set(made.subdomains) == {"steel", "air", "core"}
    assert set(made.boundaries) == {"the wall", "8", "9", "inlet"}


def test_a_quadratic_mesh_there_and_back():
    given = MeshTet2.from_mesh(grid()).with_subdomains(cube().subdomains).with_boundaries(cube().boundaries)
    with pytest.warns(WctWarning, match=r"skfem.MeshTet: the corners of 48 tetra10 cells are taken"):
        mesh = wct.as_mesh(given)
    assert quality.volumes(mesh.points, mesh.tets).sum() == pytest.approx(1.0, rel=1e-12)
    assert not mesh.repairs.orphan_points
    made = wct.to_skfem(mesh)
    assert type(made) is MeshTet2
    for name in ("cold", "hot"):
        elements = Basis(made, ElementTetP2(), elements=name)
        assert one.assemble(elements) == pytest.approx(0.5, rel=1e-12)
    for name, x in (("left", 0.0), ("right", 1.0), ("wall", 0.5)):
        assert (made.p[0, made.facets[:, made.boundaries[name]]] == x).all()


@pytest.mark.filterwarnings("ignore::wct_plugin.errors.WctWarning")
def test_curved_tets_stay_curved():
    """A ball, which has less between straight edges."""
    given = MeshTet2.init_ball(1)
    made = wct.to_skfem(wct.as_mesh(given))
    whole = one.assemble(Basis(given, ElementTetP2()))
    assert one.assemble(Basis(made, ElementTetP2())) == pytest.approx(whole, rel=1e-12)
    assert one.assemble(Basis(MeshTet(made.p[:, : made.nvertices], made.t), ElementTetP1())) < 0.95 * whole


def test_groups_without_a_member_are_named():
    given = grid().with_subdomains({"none": np.empty(0, dtype=int), "all": np.arange(48)})
    given = given.with_boundaries({"far": lambda x: x[0] > 5})
    with pytest.warns(WctWarning, match="not read: subdomain 'none', which is empty, boundary 'far', which is empty"):
        mesh = wct.as_mesh(given)
    assert dict(mesh.names) == {"all": (1, 3)}


@pytest.mark.filterwarnings("ignore:.*stay as they are:wct_plugin.errors.WctWarning")
def test_cells_beside_tets_are_named():
    with pytest.warns(WctWarning, match=r"skfem.MeshTet cannot carry, so dropped: .*\d+ wedge cells"):
        wct.to_skfem(wct.read(DATA / "prismlayer.msh"))


def test_regions_come_out_as_they_are():
    mesh = two_region_cube(2)
    made = wct.to_skfem(mesh)
    assert {name: volume(made, name) for name in made.subdomains} == {
        "1": pytest.approx(0.5, rel=1e-12),
        "2": pytest.approx(0.5, rel=1e-12),
    }
