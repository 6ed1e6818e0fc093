#include "geometry/predicates.h"
#include "library/well_center.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <map>
#include <stdexcept>
#include <string>

#if __has_include(<sys/wait.h>)
#include <sys/wait.h>
#include <unistd.h>

namespace wct::tests {

namespace {

/// Calls of a run, and of each of its stages, that are forked at: the children of later ones would say no more.
constexpr int kMost = 70;
constexpr int kEach = 12;

struct Stopped : std::runtime_error {
    Stopped() : std::runtime_error("stopped") {}
};

double volume(const WellCenterResult &mesh) {
    double sum = 0.0;
    for (const auto &tet : mesh.tets) {
        std::array<Vec3, 4> p;
        for (int i = 0; i < 4; ++i)
            p[i] = {mesh.points[tet[i]][0], mesh.points[tet[i]][1], mesh.points[tet[i]][2]};
        if (geometry::orient3d(p[0], p[1], p[2], p[3]) <= 0)
            return -1.0;
        sum += dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) / 6.0;
    }
    return sum;
}

/// Positive tets that fill what there was, within the tolerance, and no greater share of them bad.
bool is_sound(const WellCenterResult &made, double before, std::size_t tets) {
    const double share = static_cast<double>(made.metrics.bad_after) / static_cast<double>(made.tets.size());
    return made.metrics.stopped && std::abs(volume(made) / before - 1.0) < 0.05 && made.metrics.facets_off == 0 &&
           share <= static_cast<double>(made.metrics.bad_before) / static_cast<double>(tets);
}

/// How many forked processes were stopped at a call of their own and ended well, by the stage of the call. The parent
/// goes on until it has forked enough; a child's callback throws, or says once that it is to stop.
std::map<std::string, int> stop_everywhere(const Body &body, WellCenterGoal goal, bool throws) {
    std::vector<std::array<double, 3>> points;
    for (const Vec3 &p : body.points)
        points.push_back({p.x, p.y, p.z});
    double before = 0.0;
    for (const double one : volumes(body))
        before += one;
    std::map<std::string, int> ended;
    int calls = 0;
    bool child = false;
    WellCenterOptions options;
    options.goal = goal;
    options.threads = 1; // a fork has one thread only
    options.progress = [&](const WellCenterProgress &state) {
        if (child) // it was to stop
            _exit(3);
        if (++calls > kMost)
            return false;
        if (ended[std::string(state.stage)] == kEach)
            return true;
        const pid_t made = fork();
        if (made == 0) {
            child = true;
            if (throws)
                throw Stopped();
            return false;
        }
        int status = 0;
        waitpid(made, &status, 0);
        CAPTURE(calls);
        CHECK(status == 0);
        ended[std::string(state.stage)] += status == 0;
        return true;
    };
    try {
        const WellCenterResult made = well_center({points, body.tets, body.regions}, options);
        if (child)
            _exit(throws || !is_sound(made, before, body.tets.size()));
    } catch (const Stopped &) {
        _exit(!child || !throws);
    }
    return ended;
}

} // namespace

TEST_CASE("A run that is stopped at any call of its callback leaves a sound mesh, or lets out what was thrown") {
    std::map<std::string, int> ended;
    const auto stop = [&](const Body &body, WellCenterGoal goal) {
        for (const bool throws : {false, true})
            for (const auto &[stage, count] : stop_everywhere(body, goal, throws))
                ended[stage] += count;
    };
    stop(cube(2, 0.2, 1), WellCenterGoal::completely_well_centered);
    stop(cube(2, 0.2, 2, 0.5), WellCenterGoal::well_centered);
    stop(ball(2, 0.1, 3), WellCenterGoal::well_centered);
    int stops = 0;
    for (const auto &[stage, count] : ended) {
        MESSAGE(stage << ": " << count);
        stops += count;
    }
    CHECK(stops >= 40);
    for (const char *stage : {"resampling", "passes", "kicks", "margin"})
        CHECK(ended[stage] > 0);
}

} // namespace wct::tests

#endif
