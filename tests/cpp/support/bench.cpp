#include "support/bench.h"

#include <utility>

namespace wct::tests {

search::StratifiedMesh stratified_mesh(const Body &body, std::vector<double> size) {
    if (size.empty())
        size.assign(body.points.size(), body.size);
    return {body.points,  body.stratum, body.label, std::move(size), body.tets,
            body.regions, body.facets,  body.patch, body.creases,    body.curve};
}

search::TetComplex complex_of(const Body &body) {
    return search::complex_of(stratified_mesh(body));
}

search::SurfaceGuide guide_of(const Body &body, double tolerance, double spacing) {
    return {{body.points, body.facets, body.patch, body.creases, body.curve, 0.0, {}}, tolerance, spacing};
}

search::SearchForm search_form() {
    search::SearchForm form;
    form.shape = {
        .margin3 = 0.03, .power3 = 1.0, .margin2 = 0.02, .power2 = 2.0, .weight2 = 0.5, .weight_quality = 0.0};
    form.count = 0.3;
    return form;
}

Bodied::Bodied(Body made, double tolerance)
    : body(std::move(made)), mesh(complex_of(body)), guide(guide_of(body, tolerance, 0.125 * body.size)) {}

Bench::Bench(Body made, double tolerance)
    : Bodied(std::move(made), tolerance), Workbench(mesh, guide, search_form(), search::SearchOptions(), false) {
    watch.begin();
    measure();
}

void Bench::measure() {
    for (std::size_t t = 0; t < complex.tet_slots(); ++t)
        if (complex.alive(static_cast<int>(t)))
            complex.set_energy(static_cast<int>(t), energy.of_present(complex, complex.tet(static_cast<int>(t))));
    complex.resum();
}

} // namespace wct::tests
