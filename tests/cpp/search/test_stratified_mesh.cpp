#include "search/stratified_mesh.h"

#include "support/bench.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace wct::tests {

TEST_CASE("Stratified meshes: sound ones pass, and come back as they went in") {
    for (const Body &body : {cube(3, 0.2, 1, 1.0 / 3.0), cylinder(3, 0.1, 2)}) {
        const search::StratifiedMesh mesh = stratified_mesh(body);
        CHECK_NOTHROW(search::expect_conforming(mesh));
        const search::TetComplex complex = search::complex_of(mesh);
        CHECK_NOTHROW(search::expect_kept(complex));
        const search::StratifiedMesh back = search::mesh_of(complex);
        CHECK(back.points == mesh.points);
        CHECK(back.stratum == mesh.stratum);
        CHECK(back.label == mesh.label);
        CHECK(back.size == mesh.size);
        CHECK(back.tets == mesh.tets);
        CHECK(back.region == mesh.region);
        CHECK(back.facets.size() == mesh.facets.size());
        CHECK(back.creases.size() == mesh.creases.size());
        CHECK(search::rows_of(complex, {0, 5, 7}) == std::vector<int>{0, 5, 7});
    }
}

TEST_CASE("Stratified meshes: vertices that went are not in what comes back") {
    Bench bench(cube(4, 0.2, 4));
    int gone = 0;
    for (std::size_t k = 0; k < bench.complex.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        if (bench.complex.vertex(v).stratum != Stratum::interior)
            continue;
        std::vector<int> around;
        for (const int t : bench.complex.star(v))
            for (const int w : bench.complex.tet(t))
                if (w != v)
                    around.push_back(w);
        for (const int w : around) {
            bench.complex.mark();
            if (bench.operators.collapse(v, w, 1e9)) {
                bench.complex.commit();
                ++gone;
                break;
            }
            bench.complex.rollback();
        }
    }
    REQUIRE(gone > 0);
    const search::StratifiedMesh mesh = search::mesh_of(bench.complex);
    CHECK(mesh.points.size() == bench.body.points.size() - static_cast<std::size_t>(gone));
    std::vector<char> used(mesh.points.size(), 0);
    for (const Tet &tet : mesh.tets)
        for (const int v : tet)
            used[static_cast<std::size_t>(v)] = 1;
    CHECK(std::count(used.begin(), used.end(), 1) == static_cast<std::ptrdiff_t>(used.size()));
    CHECK_NOTHROW(search::expect_conforming(mesh));
}

TEST_CASE("Stratified meshes: what is wrong is refused by name") {
    const search::StratifiedMesh mesh = stratified_mesh(cube(2, 0.2, 3));
    for (const std::size_t t : {std::size_t{0}, std::size_t{17}, mesh.tets.size() - 1}) {
        search::StratifiedMesh wrong = mesh;
        std::swap(wrong.tets[t][1], wrong.tets[t][2]);
        CHECK_THROWS_WITH_AS(search::expect_conforming(wrong),
                             ("tet " + std::to_string(t) + " is inverted or flat").c_str(), std::invalid_argument);
        wrong = mesh;
        wrong.points[static_cast<std::size_t>(wrong.tets[t][3])] =
            wrong.points[static_cast<std::size_t>(wrong.tets[t][0])];
        CHECK_THROWS_AS(search::expect_conforming(wrong), std::invalid_argument);
    }
    search::StratifiedMesh wrong = mesh;
    wrong.tets.push_back(mesh.tets[4]);
    wrong.region.push_back(0);
    CHECK_THROWS_AS(search::expect_conforming(wrong), std::invalid_argument); // its inner facets have three tets
    for (std::size_t k = 0; k < mesh.facets.size(); ++k) {
        wrong = mesh;
        wrong.facets.erase(wrong.facets.begin() + static_cast<std::ptrdiff_t>(k));
        CHECK_THROWS_AS(search::expect_conforming(wrong), std::invalid_argument);
    }
    // Opposite corners of the cube: no tet has both.
    const auto corner = [&](double x) {
        return static_cast<int>(std::find(mesh.points.begin(), mesh.points.end(), Vec3{x, x, x}) - mesh.points.begin());
    };
    wrong = mesh;
    wrong.facets.push_back(
        {corner(0.0), corner(1.0), mesh.tets[0][0] == corner(0.0) ? mesh.tets[0][1] : mesh.tets[0][0]});
    wrong.facet_patch.push_back(0);
    CHECK_THROWS_AS(search::expect_conforming(wrong), std::invalid_argument);
    wrong = mesh;
    wrong.creases.push_back({corner(0.0), corner(1.0)});
    wrong.crease_curve.push_back(0);
    CHECK_THROWS_AS(search::expect_conforming(wrong), std::invalid_argument);
}

TEST_CASE("Stratified meshes: a surface facet or a crease that no tet has any more is a fault") {
    const Body body = cube(2, 0.2, 4);
    search::TetComplex complex = complex_of(body);
    complex.add_crease({0, static_cast<int>(body.points.size()) - 1}, 0);
    CHECK_THROWS_AS(search::expect_kept(complex), std::logic_error);
    search::TetComplex other = complex_of(body);
    other.add_facet({0, 1, static_cast<int>(body.points.size()) - 1}, 0);
    CHECK_THROWS_AS(search::expect_kept(other), std::logic_error);
}

TEST_CASE("Stratified meshes: the mean size at the surface, and where there is none") {
    search::StratifiedMesh mesh = stratified_mesh(cube(2, 0.0, 5));
    double sum = 0.0, count = 0.0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        mesh.size[v] = mesh.stratum[v] == Stratum::interior ? 100.0 : 0.1 + 0.01 * static_cast<double>(v);
        if (mesh.stratum[v] != Stratum::interior) {
            sum += mesh.size[v];
            count += 1.0;
        }
    }
    CHECK(search::mean_surface_size(mesh) == doctest::Approx(sum / count));
    std::fill(mesh.stratum.begin(), mesh.stratum.end(), Stratum::interior);
    CHECK(search::mean_surface_size(mesh) == 1.0);
}

} // namespace wct::tests
