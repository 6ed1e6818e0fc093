"""A resistor in DEVSIM: gmsh's mesh conducts a fifth too well, the well-centered one as it should, to rounding.

DEVSIM adds up the dual areas across an edge without their signs, so that it is right where no part of them is
negative, on completely well-centered meshes. The report foresees what it comes to: unsigned over signed volume.
Run it: ``python examples/devsim_resistor.py [bar.msh]``.
"""

import sys
from pathlib import Path

from devices.laplace import flux
from devices.stack import stack

import wct_plugin as wct

CONDUCTIVITY, LENGTH, WIDTH = 3.0, 2.0, 0.5


def conductance(file: str | Path) -> float:
    """Solve with a volt between the contacts, for the current."""
    return flux(file, {"bar": CONDUCTIVITY}, {"left": ("bar", 1.0), "right": ("bar", 0.0)})


def main(target: str | Path = "bar.msh") -> float:
    """Give the error of the conductance on the well-centered mesh, relative."""
    stack(target, {"bar": LENGTH}, ("left", "right"), 0.15, width=WIDTH)
    exact = CONDUCTIVITY * WIDTH**2 / LENGTH
    before, ratio = conductance(target) / exact - 1.0, wct.report(target).solver_view.total.unsigned_over_signed
    wct.optimize(target, target)
    after = conductance(target) / exact - 1.0
    print(
        f"error of the conductance: {100 * before:.1f} % -> {after:.1e}; unsigned duals: {100 * (ratio - 1):.1f} % more"
    )
    assert before > 0.1 < ratio - 1.0
    assert abs(after) < 1e-12
    return after


if __name__ == "__main__":
    main(*sys.argv[1:])
