// What the C++ library makes of a mesh, for tests: arrays come from a folder and go to one, each in a file of its own.
//
//     library_program surface|well_center FOLDER [option=value ...]
#include <wct/well_center.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>

namespace {

template <class T> std::vector<T> read(const std::string &file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    std::vector<T> out(static_cast<std::size_t>(in.tellg()) / sizeof(T));
    in.seekg(0).read(reinterpret_cast<char *>(out.data()), static_cast<std::streamsize>(out.size() * sizeof(T)));
    if (!in)
        throw std::runtime_error("cannot read " + file);
    return out;
}

template <class T> void write(const std::string &file, const std::vector<T> &values) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char *>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void write(const std::string &folder, const wct::WellCenterSurface &surface) {
    std::vector<int> sides; // region behind, whether there is one before, region before
    for (const auto &[behind, before] : surface.sides)
        sides.insert(sides.end(), {behind, before.has_value(), before.value_or(0)});
    write(folder + "facets", surface.facets);
    write(folder + "patch", surface.patch);
    write(folder + "sides", sides);
    write(folder + "creases", surface.creases);
    write(folder + "curve", surface.curve);
    write(folder + "corners", surface.corners);
}

void write(const std::string &folder, const wct::WellCenterResult &made) {
    write(folder + "new_points", made.points);
    write(folder + "new_tets", made.tets);
    write(folder + "new_regions", made.regions);
    write(folder, made.surface);
    const wct::WellCenterMetrics &metrics = made.metrics;
    std::cout << "bad_before " << metrics.bad_before << "\nbad_after " << metrics.bad_after << "\nfacets_off "
              << metrics.facets_off << "\nreached " << metrics.reached << "\nkept " << metrics.kept << "\nstopped "
              << metrics.stopped << "\nexhausted " << metrics.exhausted << "\nstarts " << metrics.starts << "\npasses "
              << metrics.passes << "\nkicks " << metrics.kicks << "\nevaluations " << metrics.evaluations
              << "\nreleased " << metrics.released.size() << "\ntolerance " << metrics.tolerance << "\n";
    std::cout.precision(17);
    for (const auto &[region, before, after] : metrics.volumes)
        std::cout << "volume_" << region << "_before " << before << "\nvolume_" << region << "_after " << after << "\n";
}

/// The options, and in which call of the callback to stop.
wct::WellCenterOptions options_of(const std::map<std::string, std::string> &given) {
    wct::WellCenterOptions options;
    for (const auto &[name, value] : given)
        if (name == "goal")
            options.goal =
                value == "3wc" ? wct::WellCenterGoal::well_centered : wct::WellCenterGoal::completely_well_centered;
        else if (name == "tolerance")
            options.tolerance = std::stod(value);
        else if (name == "crease_angle")
            options.crease_angle = std::stod(value);
        else if (name == "edge_length")
            options.edge_length = std::stod(value);
        else if (name == "margin")
            options.margin = std::stod(value);
        else if (name == "effort")
            options.effort = std::stoi(value);
        else if (name == "max_tets")
            options.max_tets = std::stoul(value);
        else if (name == "seed")
            options.seed = std::stoul(value);
        else if (name == "threads")
            options.threads = static_cast<unsigned>(std::stoul(value));
        else if (name == "stop_at")
            options.progress = [left = std::stol(value)](const wct::WellCenterProgress &heard) mutable {
                if (!(heard.done >= 0.0 && heard.done <= 1.0) || heard.stage.empty())
                    throw std::logic_error("progress out of range");
                return left-- > 0;
            };
        else
            throw std::runtime_error("no option " + name);
    return options;
}

} // namespace

int main(int count, char **words) {
    try {
        const std::string job = words[1], folder = std::string(words[2]) + "/";
        std::map<std::string, std::string> given;
        for (int k = 3; k < count; ++k) {
            const std::string word = words[k];
            const std::size_t at = word.find('=');
            given[word.substr(0, at)] = word.substr(at + 1);
        }
        const auto points = read<std::array<double, 3>>(folder + "points");
        const auto tets = read<std::array<int, 4>>(folder + "tets");
        const auto regions = read<int>(folder + "regions");
        const wct::WellCenterInput mesh{points, tets, regions};
        const wct::WellCenterOptions options = options_of(given);
        if (job == "surface")
            write(folder, wct::find_surface(mesh, options.crease_angle));
        else
            write(folder, wct::well_center(mesh, options));
        return 0;
    } catch (const std::invalid_argument &refused) {
        std::cerr << refused.what() << "\n";
        return 2;
    } catch (const std::exception &wrong) {
        std::cerr << wrong.what() << "\n";
        return 3;
    }
}
