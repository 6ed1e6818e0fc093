#include "support/bodies.h"

#include "base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace wct::tests {

namespace {

struct Sheet { // a facet of the surface and the tets on its sides
    Facet facet;
    int inside, outside = -1;
};

double six_volumes(const std::vector<Vec3> &p, const Tet &t) {
    return dot(p[t[1]] - p[t[0]], cross(p[t[2]] - p[t[0]], p[t[3]] - p[t[0]]));
}

/// Facets of one tet, or of two of different regions, seen from the region with the smaller number.
std::vector<Sheet> sheets_of(const Body &body) {
    std::map<Facet, std::vector<std::pair<int, int>>> uses; // sorted corners: tet, corner opposite
    for (std::size_t t = 0; t < body.tets.size(); ++t)
        for (int i = 0; i < 4; ++i) {
            Facet key{body.tets[t][kFacets[i][0]], body.tets[t][kFacets[i][1]], body.tets[t][kFacets[i][2]]};
            ascend(key);
            uses[key].push_back({static_cast<int>(t), i});
        }
    std::vector<Sheet> sheets;
    for (const auto &[key, both] : uses) {
        auto [t, i] = both[0];
        int other = -1;
        if (both.size() == 2) {
            other = both[1].first;
            if (body.regions[t] == body.regions[other])
                continue;
            if (body.regions[other] < body.regions[t]) {
                std::swap(t, other);
                i = both[1].second;
            }
        }
        const Tet &tet = body.tets[t]; // kFacets wind towards the corner opposite: turned round they wind outward
        sheets.push_back({{tet[kFacets[i][0]], tet[kFacets[i][2]], tet[kFacets[i][1]]}, t, other});
    }
    return sheets;
}

template <class Key> int number_of(std::map<Key, int> &numbers, const Key &key) {
    return numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
}

void find_patches(Body &body, const FaceOf &face_of) {
    std::map<std::array<int, 3>, int> numbers;
    for (const Sheet &sheet : sheets_of(body)) {
        const auto &[a, b, c] = sheet.facet;
        const std::array<Vec3, 3> corners{body.points[a], body.points[b], body.points[c]};
        const Vec3 middle = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]);
        const int inside = body.regions[sheet.inside], outside = sheet.outside < 0 ? -1 : body.regions[sheet.outside];
        const int patch = number_of(numbers, {face_of(middle, unit(normal_of(corners))), inside, outside});
        if (patch == static_cast<int>(body.sides.size()))
            body.sides.push_back({inside, outside});
        body.facets.push_back(sheet.facet);
        body.patch.push_back(patch);
    }
}

void find_creases(Body &body) {
    std::map<Edge, std::set<int>> at_edge;
    for (std::size_t k = 0; k < body.facets.size(); ++k)
        for (int i = 0; i < 3; ++i) {
            const int a = body.facets[k][i], b = body.facets[k][(i + 1) % 3];
            at_edge[sorted(a, b)].insert(body.patch[k]);
        }
    std::map<std::set<int>, int> numbers;
    for (const auto &[edge, patches] : at_edge)
        if (patches.size() > 1) {
            body.creases.push_back(edge);
            body.curve.push_back(number_of(numbers, patches));
        }
}

void find_strata(Body &body) {
    body.stratum.assign(body.points.size(), Stratum::interior);
    body.label.assign(body.points.size(), -1);
    for (std::size_t k = 0; k < body.facets.size(); ++k)
        for (const int v : body.facets[k]) {
            body.stratum[v] = Stratum::patch;
            body.label[v] = body.patch[k];
        }
    std::map<int, std::set<int>> curves_at;
    for (std::size_t k = 0; k < body.creases.size(); ++k)
        for (const int v : body.creases[k]) {
            curves_at[v].insert(body.curve[k]);
            body.stratum[v] = Stratum::crease;
            body.label[v] = body.curve[k];
        }
    for (const auto &[v, curves] : curves_at)
        if (curves.size() > 1) {
            body.stratum[v] = Stratum::corner;
            body.label[v] = v;
            body.corners.push_back(v);
        }
}

/// A lattice point off its place by at most so much, but for along axes at whose ends it lies, and off the split.
Vec3 shifted(const Vec3 &p, double most, double split, Random &random) {
    const auto along = [&](double x, bool held) {
        const double by = most * (2.0 * random.uniform() - 1.0);
        return held || x == 0.0 || x == 1.0 ? x : x + by;
    };
    const double x = along(p.x, p.x == split), y = along(p.y, false), z = along(p.z, false);
    return {x, y, z};
}

struct Lattice {
    std::vector<Vec3> points;
    std::vector<Tet> tets;
};

/// Six tets round a diagonal of each cube (Kuhn's): neighbours fit.
Lattice lattice(int n, double jitter, std::uint64_t seed, double split) {
    Lattice out;
    Random random(seed);
    for (int k = 0; k <= n; ++k)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                const Vec3 p{static_cast<double>(i) / n, static_cast<double>(j) / n, static_cast<double>(k) / n};
                out.points.push_back(shifted(p, jitter / n, split, random));
            }
    static constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const int step[3] = {1, n + 1, (n + 1) * (n + 1)};
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                for (const auto &order : orders) {
                    Tet tet{i * step[0] + j * step[1] + k * step[2], 0, 0, 0};
                    for (int c = 0; c < 3; ++c)
                        tet[c + 1] = tet[c] + step[order[c]];
                    if (six_volumes(out.points, tet) < 0.0)
                        std::swap(tet[2], tet[3]);
                    out.tets.push_back(tet);
                }
    return out;
}

/// Which of the three axes the normal is nearest to, and which way it looks.
int axis_face(const Vec3 &n) {
    const double size[3] = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    const int axis = static_cast<int>(std::max_element(size, size + 3) - size);
    return 2 * axis + ((axis == 0 ? n.x : axis == 1 ? n.y : n.z) > 0.0);
}

} // namespace

domain::SurfaceData Body::surface() const {
    domain::SurfaceData data;
    data.points = points;
    data.triangles = facets;
    data.patch = patch;
    data.segments = creases;
    data.curve = curve;
    data.corners = corners;
    data.sides = sides;
    return data;
}

Body stratified(std::vector<Vec3> points, std::vector<Tet> tets, std::vector<int> regions, const FaceOf &face_of) {
    Body body;
    body.points = std::move(points);
    body.tets = std::move(tets);
    body.regions = std::move(regions);
    find_patches(body, face_of);
    find_creases(body);
    find_strata(body);
    return body;
}

Body cube(int n, double jitter, std::uint64_t seed, double split) {
    Lattice made = lattice(n, jitter, seed, split);
    std::vector<int> regions;
    for (const Tet &tet : made.tets) {
        double middle = 0.0;
        for (const int v : tet)
            middle += 0.25 * made.points[v].x;
        regions.push_back(middle > split);
    }
    Body body = stratified(std::move(made.points), std::move(made.tets), std::move(regions),
                           [](const Vec3 &, const Vec3 &normal) { return axis_face(normal); });
    body.size = 1.0 / n;
    return body;
}

Body ball(int n, double jitter, std::uint64_t seed) {
    Lattice made = lattice(n, jitter, seed, 2.0);
    for (Vec3 &p : made.points) {
        const Vec3 q = 2.0 * p - Vec3{1.0, 1.0, 1.0};
        const double most = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
        p = most * unit(q); // the cube's shells become spheres
    }
    std::vector<int> regions(made.tets.size(), 0);
    Body body = stratified(std::move(made.points), std::move(made.tets), std::move(regions),
                           [](const Vec3 &, const Vec3 &) { return 0; });
    body.size = 1.6 / n;
    return body;
}

Body cut_ball(int n, double jitter, std::uint64_t seed) {
    Body made = ball(n, jitter, seed);
    Body body = stratified(std::move(made.points), std::move(made.tets), std::move(made.regions),
                           [](const Vec3 &middle, const Vec3 &) { return middle.z > 0.03 ? 0 : 1; });
    body.size = made.size;
    return body;
}

namespace {
/// The side of a cylinder, its lower and its upper end.
int face_of_cylinder(const Vec3 &, const Vec3 &normal) {
    return std::abs(normal.z) < 0.5 ? 0 : normal.z < 0.0 ? 1 : 2;
}
} // namespace

Body cylinder(int n, double jitter, std::uint64_t seed) {
    Lattice made = lattice(n, jitter, seed, 2.0);
    for (Vec3 &p : made.points) {
        const Vec3 q{2.0 * p.x - 1.0, 2.0 * p.y - 1.0, 0.0};
        const Vec3 flat = std::max(std::abs(q.x), std::abs(q.y)) * unit(q);
        p = {flat.x, flat.y, p.z};
    }
    std::vector<int> regions(made.tets.size(), 0);
    Body body = stratified(std::move(made.points), std::move(made.tets), std::move(regions), face_of_cylinder);
    body.size = 1.6 / n;
    return body;
}

Body drum(int n) {
    const Body whole = cylinder(n, 0.0, 1);
    std::vector<int> regions;
    for (const Tet &tet : whole.tets) {
        double z = 0.0;
        for (const int v : tet)
            z += 0.25 * whole.points[v].z;
        regions.push_back(z < 0.5);
    }
    return stratified(whole.points, whole.tets, regions, face_of_cylinder);
}

int facing(const Vec3 &, const Vec3 &normal) {
    const double turn = std::atan2(normal.y, normal.x) * 180.0 / std::numbers::pi;
    return std::abs(normal.z) > 0.5 ? (normal.z > 0.0 ? 1000 : 1001) : static_cast<int>(std::lround(turn / 3.0));
}

Body round_axis(const std::vector<Turn> &turns, int parts) {
    constexpr double widest = 31.0; // degrees, of a sector
    std::vector<double> at;
    std::vector<int> of;
    for (std::size_t k = 0; k < turns.size(); ++k) {
        const double to = k + 1 < turns.size() ? turns[k + 1].from : turns[0].from + 360.0;
        // No points where there is nothing.
        const int sectors = turns[k].region < 0 ? 1 : static_cast<int>(std::ceil((to - turns[k].from) / widest));
        for (int i = 0; i < sectors; ++i) {
            at.push_back(turns[k].from + (to - turns[k].from) * i / sectors);
            of.push_back(turns[k].region);
        }
    }
    const int across = static_cast<int>(at.size());
    std::vector<Vec3> points; // layer by layer: the axis, then ring by ring
    for (int layer = 0; layer <= parts; ++layer) {
        const double z = static_cast<double>(layer) / parts;
        points.push_back({0.0, 0.0, z});
        for (int ring = 1; ring <= parts; ++ring)
            for (const double degrees : at) {
                const double turn = degrees * std::numbers::pi / 180.0, r = static_cast<double>(ring) / parts;
                points.push_back({r * std::cos(turn), r * std::sin(turn), z});
            }
    }
    const auto id = [&](int layer, int ring, int sector) {
        const int first = layer * (1 + parts * across);
        return ring == 0 ? first : first + 1 + (ring - 1) * across + sector % across;
    };
    std::vector<Tet> tets;
    std::vector<int> regions;
    const auto prism = [&](const std::array<std::array<int, 2>, 3> &base, int layer, int region) {
        std::array<int, 3> low{}, high{};
        for (int i = 0; i < 3; ++i) {
            low[i] = id(layer, base[i][0], base[i][1]);
            high[i] = id(layer + 1, base[i][0], base[i][1]);
        }
        std::sort(low.begin(), low.end()); // cut alike from both sides of each face
        std::sort(high.begin(), high.end());
        for (Tet tet : {Tet{low[0], low[1], low[2], high[2]}, Tet{low[0], low[1], high[1], high[2]},
                        Tet{low[0], high[0], high[1], high[2]}}) {
            if (six_volumes(points, tet) < 0.0)
                std::swap(tet[2], tet[3]);
            tets.push_back(tet);
            regions.push_back(region);
        }
    };
    for (int layer = 0; layer < parts; ++layer)
        for (int sector = 0; sector < across; ++sector) {
            if (of[sector] < 0)
                continue;
            prism({{{0, 0}, {1, sector}, {1, sector + 1}}}, layer, of[sector]);
            for (int ring = 1; ring < parts; ++ring) {
                prism({{{ring, sector}, {ring + 1, sector}, {ring + 1, sector + 1}}}, layer, of[sector]);
                prism({{{ring, sector}, {ring, sector + 1}, {ring + 1, sector + 1}}}, layer, of[sector]);
            }
        }
    Body body = stratified(std::move(points), std::move(tets), std::move(regions), facing);
    body.size = 1.0 / parts;
    return body;
}

std::vector<double> volumes(const Body &body) {
    std::vector<double> sums;
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
        sums.resize(std::max<std::size_t>(sums.size(), static_cast<std::size_t>(body.regions[t]) + 1), 0.0);
        sums[body.regions[t]] += six_volumes(body.points, body.tets[t]) / 6.0;
    }
    return sums;
}

} // namespace wct::tests
