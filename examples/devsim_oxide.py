"""Silicon and oxide in DEVSIM: a capacitor of two layers, its regions, contacts and interface found by their names.

Each region has nodes of its own at the interface, and duals that end there, so that each must be right by itself. The
layers are in series: the exact capacitance is width^2 / (t_si / eps_si + t_ox / eps_ox).
Run it: ``python examples/devsim_oxide.py [layers.msh]``.
"""

import sys
from pathlib import Path

from devices.laplace import flux
from devices.stack import stack

import wct_plugin as wct

PERMITTIVITY = {"silicon": 11.7, "oxide": 3.9}
THICKNESS, WIDTH = {"silicon": 0.3, "oxide": 0.12}, 0.5


def capacitance(file: str | Path) -> float:
    """Solve with a volt between gate and body, for the charge."""
    contacts = {"gate": ("oxide", 1.0), "body": ("silicon", 0.0)}
    return flux(file, PERMITTIVITY, contacts, {"si_ox": ("silicon", "oxide")})


def main(target: str | Path = "layers.msh") -> float:
    """Give the error of the capacitance on the well-centered mesh, relative."""
    stack(target, THICKNESS, ("body", "gate"), 0.08, interfaces=["si_ox"], width=WIDTH)
    exact = WIDTH**2 / sum(THICKNESS[name] / PERMITTIVITY[name] for name in PERMITTIVITY)
    before = capacitance(target) / exact - 1.0
    wct.optimize(target, target)
    after = capacitance(target) / exact - 1.0
    negative = [one.negative_couples for one in wct.report(target).solver_view.regions.values()]
    print(f"error of the capacitance: {100 * before:.1f} % -> {after:.1e}; negative couples {negative}")
    assert before > 0.1
    assert negative == [0, 0]
    assert abs(after) < 1e-12
    return after


if __name__ == "__main__":
    main(*sys.argv[1:])
