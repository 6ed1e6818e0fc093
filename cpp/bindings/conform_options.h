#pragma once

#include "bindings/attributes.h"

#include "conform/conform.h"

namespace wct::bindings {

/// A ConformOptions; the tolerance and what of a surface stays are not among them.
inline conform::ConformOptions conform_options_of(nanobind::handle asked) {
    conform::ConformOptions options;
    options.one_sided = attribute<bool>(asked, "one_sided");
    options.effort = attribute<int>(asked, "effort");
    options.seed = attribute<std::uint64_t>(asked, "seed");
    return options;
}

} // namespace wct::bindings
