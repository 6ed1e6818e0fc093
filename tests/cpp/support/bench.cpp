#include "support/bench.h"

#include "search/needle_cosines.h"

namespace wct::tests {

search::TetComplex complex_of(const Body &body) {
    search::TetComplex complex;
    const auto needle = search::needle_cosines(body.points, body.tets, body.regions, body.creases);
    for (std::size_t v = 0; v < body.points.size(); ++v)
        complex.add_vertex({body.points[v], body.stratum[v], body.label[v], body.size, needle[v]});
    for (std::size_t t = 0; t < body.tets.size(); ++t)
        complex.add_tet(body.tets[t], body.regions[t], 0.0);
    for (std::size_t k = 0; k < body.facets.size(); ++k)
        complex.add_facet(search::sorted(body.facets[k][0], body.facets[k][1], body.facets[k][2]), body.patch[k]);
    for (std::size_t k = 0; k < body.creases.size(); ++k)
        complex.add_crease(search::sorted(body.creases[k][0], body.creases[k][1]), body.curve[k]);
    return complex;
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

Bench::Bench(Body made, double tolerance)
    : body(std::move(made)), complex(complex_of(body)), guide(guide_of(body, tolerance, 0.125 * body.size)),
      energy(search_form()), watch(complex, guide), operators(complex, energy, guide, watch),
      descent(complex, energy, guide, watch), group(complex, energy, guide, watch) {
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
