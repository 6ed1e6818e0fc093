#include "search/workbench.h"

namespace wct::search {

Workbench::Workbench(TetComplex &mesh, const SurfaceGuide &guide, const SearchForm &form, const SearchOptions &options,
                     bool divides_corners)
    : complex(mesh), energy(form), watch(complex, guide), operators(complex, energy, guide, watch),
      descent(complex, energy, guide, watch), group(complex, energy, guide, watch), random(options.seed),
      repair(complex, energy, operators, descent, group, random),
      kick(complex, energy, operators, descent, watch, repair, random) {
    watch.crease = options.crease;
    watch.divides_corners = divides_corners;
    operators.flip_surface = options.flip_surface;
    operators.split_surface = options.split_surface;
    operators.most = options.most;
    operators.fixed = options.fixed;
    operators.fixed_curves = options.fixed_curves;
}

} // namespace wct::search
