#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "support/bits.h"

#include <cstdio>
#include <string_view>

/// The tests; with `--bits` what test_recorded_runs.cpp holds, as this build makes it.
int main(int argc, char **argv) {
    if (argc != 2 || std::string_view(argv[1]) != "--bits")
        return doctest::Context(argc, argv).run();
    const auto print = [](const char *name, std::uint64_t bits) {
        std::printf("    {\"%s\", 0x%016llx},\n", name, static_cast<unsigned long long>(bits));
    };
    print("the C library", wct::tests::bits_of_library());
    for (const auto &[name, bits] : wct::tests::whole_runs())
        print(name.c_str(), bits);
    return 0;
}
