#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "support/bits.h"

#include <cstdio>
#include <string_view>

/// The tests; with `--bits` one number for all bits of three whole runs, for comparing builds.
int main(int argc, char **argv) {
    if (argc == 2 && std::string_view(argv[1]) == "--bits") {
        std::printf("%016llx\n", static_cast<unsigned long long>(wct::tests::bits_of_whole_runs()));
        return 0;
    }
    return doctest::Context(argc, argv).run();
}
