"""What DEVSIM makes of devices that gmsh meshed, before and after: ``python -m benchmarks.devices``.

Conductances, capacitances and a diode's current against closed forms, and against one dimension for the diode. Exit
code 1 where an error is above its limit. With ``examples`` among the places of modules.
"""

import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import click
import devsim_oxide
import devsim_resistor
import gmsh
from devices import diode
from devices.laplace import flux
from devices.stack import stack
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk

import wct_plugin as wct

_DIODE_WIDTH = 0.3  # micrometers
#: Of the MOSFET: length, depth and height of the silicon, length of source and drain, start of the gate, its thickness.
_LENGTH, _DEPTH, _HEIGHT, _CONTACT, _GATE, _OXIDE = 2.0, 0.25, 0.5, 0.4, 0.75, 0.025


@dataclass(frozen=True)
class Device:
    """How gmsh makes its mesh, the quantity DEVSIM computes on a file, what it is, and how wrong it may be after."""

    name: str
    build: Callable[[Path], None]
    quantity: Callable[[Path], float]
    exact: float
    limit: float
    options: Mapping[str, Any] = field(default_factory=dict)  #: of the optimizer


def devices() -> list[Device]:
    """All of them; the resistor and the layers with every goal."""
    goals = {"delaunay": 1.0, "one-sided": 1.0, "3wc": 0.01, "cwc": 1e-12}
    return [
        *(_resistor(goal, limit) for goal, limit in goals.items()),
        *(_layers(0.12, 0.08, goal, limit) for goal, limit in goals.items()),
        _layers(0.06, 0.06, "cwc", 1e-3),
        _diode(),
        _mosfet(),
    ]


def _resistor(goal: str, limit: float) -> Device:
    length, width = devsim_resistor.LENGTH, devsim_resistor.WIDTH
    return Device(
        f"resistor, {goal}",
        lambda file: stack(file, {"bar": length}, ("left", "right"), 0.15, width=width),
        devsim_resistor.conductance,
        devsim_resistor.CONDUCTIVITY * width**2 / length,
        limit,
        {"goal": goal},
    )


def _layers(oxide: float, size: float, goal: str, limit: float) -> Device:
    thickness, width = {"silicon": 0.3, "oxide": oxide}, 0.5
    return Device(
        f"silicon and {oxide} of oxide, {goal}",
        lambda file: stack(file, thickness, ("body", "gate"), size, interfaces=["si_ox"], width=width),
        devsim_oxide.capacitance,
        width**2 / sum(thickness[name] / devsim_oxide.PERMITTIVITY[name] for name in thickness),
        limit,
        {"goal": goal},
    )


def _diode() -> Device:
    ends, width = ("anode", "cathode"), _DIODE_WIDTH
    return Device(
        "diode",
        lambda file: stack(
            file, {"p": 1.0, "n": 1.0}, ends, 0.08, interfaces=["junction"], width=width, unit=diode.LENGTH
        ),
        lambda file: diode.current_of(file, (width * diode.LENGTH) ** 2),
        diode.current_in_one_dimension(3e-7),
        0.03,
    )


def _mosfet() -> Device:
    """From source to drain through the silicon, with short edges at the contacts, at whose rims the field peaks."""
    contacts = {"source": ("silicon", 1.0), "drain": ("silicon", 0.0)}
    lengths = {"oxide": 0.02, "source": 0.015, "drain": 0.015, "*": 0.1}
    return Device(
        "MOSFET, source to drain",
        _mesh_mosfet,
        lambda file: flux(file, {"silicon": 1.0}, contacts),
        _DEPTH * 0.5 * _half_of_the_mosfet(),
        0.01,
        {"edge_length": lengths},
    )


def _half_of_the_mosfet() -> float:
    """Conductance per depth from the source to the plane of symmetry, by conformal mapping.

    The elliptic sine's square maps the half, a rectangle, onto the upper half plane: the contact onto [0, b], the plane
    onto [1, 1 / m]. Between segments [0, b] and [1, d] of the axis it is K(k) / K(1 - k) with the parameter
    k = b (d - 1) / (d - b).
    """
    aspect = 0.5 * _LENGTH / _HEIGHT
    m = float(brentq(lambda m: ellipk(m) / ellipk(1.0 - m) - aspect, 1e-6, 1.0 - 1e-12, xtol=1e-15))
    b, d = ellipj(_CONTACT / (0.5 * _LENGTH) * ellipk(m), m)[0] ** 2, 1.0 / m
    k = b * (d - 1.0) / (d - b)
    return float(ellipk(k) / ellipk(1.0 - k))


def _mesh_mosfet(file: Path) -> None:
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ, near = gmsh.model.occ, 1e-4
    silicon = occ.addBox(0, 0, 0, _LENGTH, _DEPTH, _HEIGHT)
    oxide = occ.addBox(_GATE, 0, _HEIGHT, _LENGTH - 2 * _GATE, _DEPTH, _OXIDE)
    pads = [occ.addRectangle(x, 0, _HEIGHT, _CONTACT, _DEPTH) for x in (0, _LENGTH - _CONTACT)]
    occ.fragment([(3, silicon)], [(3, oxide), *((2, pad) for pad in pads)])
    occ.synchronize()
    for name, box in (("silicon", silicon), ("oxide", oxide)):
        gmsh.model.addPhysicalGroup(3, [box], name=name)
    places = {
        "source": (0, _CONTACT, _HEIGHT),
        "drain": (_LENGTH - _CONTACT, _LENGTH, _HEIGHT),
        "si_ox": (_GATE, _LENGTH - _GATE, _HEIGHT),
        "gate": (_GATE, _LENGTH - _GATE, _HEIGHT + _OXIDE),
    }
    for name, (start, end, z) in places.items():
        within = (start - near, -near, z - near, end + near, _DEPTH + near, z + near)
        gmsh.model.addPhysicalGroup(2, [face for _, face in gmsh.model.getEntitiesInBoundingBox(*within, 2)], name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.1)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(file))
    gmsh.finalize()


@click.command()
@click.option("--out", default=Path("build/devices"), type=click.Path(path_type=Path), show_default=True)
def main(out: Path) -> None:
    """Write devices.md: errors of DEVSIM before and after."""
    out.mkdir(parents=True, exist_ok=True)
    head = "device", "tets", "CWC %", "negative couples", "unsigned / signed", "DEVSIM's error", "limit", "seconds"
    lines = [f"| {' | '.join(head)} |", "| --- " * len(head) + "|"]
    met = True
    for device in devices():
        before, after = out / "before.msh", out / "after.msh"
        device.build(before)
        start = time.process_time()
        wct.optimize(before, after, **device.options)
        seconds = time.process_time() - start
        reports = [wct.report(file) for file in (before, after)]
        errors = [device.quantity(file) / device.exact - 1.0 for file in (before, after)]
        met &= abs(errors[1]) <= device.limit
        views = [one.solver_view.total for one in reports]
        cells = (
            device.name,
            _pair(str(one.tets) for one in reports),
            _pair(f"{100 * one.flags['cwc'] / one.tets:.2f}" for one in reports),
            _pair(str(one.negative_couples) for one in views),
            _pair(f"{one.unsigned_over_signed:.4f}" for one in views),
            _pair(f"{100 * one:.1f} %" if abs(one) >= 1e-3 else f"{one:.0e}" for one in errors),
            f"{device.limit:g}",
            f"{seconds:.1f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
        click.echo(lines[-1])
    (out / "devices.md").write_text("\n".join(lines) + "\n")
    sys.exit(0 if met else 1)


def _pair(values: Any) -> str:
    return " -> ".join(values)


if __name__ == "__main__":
    main()
