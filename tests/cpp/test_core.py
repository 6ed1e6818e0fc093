"""The tests of the C++ core: one program for all of them."""

from support.core_build import built_core, run


def test_the_core_keeps_its_promises():
    run(built_core() / "tests" / "cpp" / "wct_tests")
