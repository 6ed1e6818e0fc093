"""A junction diode in DEVSIM, by its own simple physics: on a gmsh file, and in one dimension as the reference."""

import contextlib
import io
from pathlib import Path

from devices.laplace import DEVICE, devsim, load, unload

with contextlib.redirect_stdout(io.StringIO()):
    from devsim.python_packages import model_create, simple_physics

#: Net doping of each region, per cubic centimeter.
DOPING = {"p": -1e16, "n": 1e16}
#: Of each half, in centimeters.
LENGTH = 1e-4
BIAS = 0.5


def current_of(file: str | Path, area: float) -> float:
    """Amperes per square centimeter through a gmsh file with the regions p and n in centimeters, of this cross-section.

    Its contacts are named anode and cathode, the interface junction.
    """
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            load(file, DOPING, {"anode": "p", "cathode": "n"}, {"junction": ("p", "n")})
            return _current() / area
        finally:
            unload()


def current_in_one_dimension(spacing: float) -> float:
    """The same on points that are ``spacing`` apart at the contacts, a tenth of that at the junction."""
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            devsim.create_1d_mesh(mesh=DEVICE)
            for tag, place, apart in (
                ("anode", 0.0, spacing),
                ("junction", LENGTH, 0.1 * spacing),
                ("cathode", 2.0 * LENGTH, spacing),
            ):
                devsim.add_1d_mesh_line(mesh=DEVICE, pos=place, ps=apart, tag=tag)
            for name in ("anode", "cathode"):
                devsim.add_1d_contact(mesh=DEVICE, name=name, tag=name, material="metal")
            devsim.add_1d_interface(mesh=DEVICE, name="junction", tag="junction")
            for region, ends in (("p", ("anode", "junction")), ("n", ("junction", "cathode"))):
                devsim.add_1d_region(mesh=DEVICE, region=region, material="Si", tag1=ends[0], tag2=ends[1])
            devsim.finalize_mesh(mesh=DEVICE)
            devsim.create_device(mesh=DEVICE, device=DEVICE)
            return _current()
        finally:
            unload()


def _current() -> float:
    """Through the anode, after the bias was raised in steps."""
    for region, doping in DOPING.items():
        simple_physics.SetSiliconParameters(DEVICE, region, 300)
        model_create.CreateNodeModel(DEVICE, region, "NetDoping", repr(doping))
        model_create.CreateSolution(DEVICE, region, "Potential")
        simple_physics.CreateSiliconPotentialOnly(DEVICE, region)
    contacts = {"anode": "p", "cathode": "n"}
    for contact, region in contacts.items():
        devsim.set_parameter(device=DEVICE, name=simple_physics.GetContactBiasName(contact), value=0.0)
        simple_physics.CreateSiliconPotentialOnlyContact(DEVICE, region, contact)
    simple_physics.CreateSiliconOxideInterface(DEVICE, "junction")
    _solve(1.0)
    for region in DOPING:
        for carrier in ("Electrons", "Holes"):
            model_create.CreateSolution(DEVICE, region, carrier)
            devsim.set_node_values(device=DEVICE, region=region, name=carrier, init_from=f"Intrinsic{carrier}")
        simple_physics.CreateSiliconDriftDiffusion(DEVICE, region)
    for contact, region in contacts.items():
        simple_physics.CreateSiliconDriftDiffusionAtContact(DEVICE, region, contact)
    simple_physics.CreateSiliconSiliconInterface(DEVICE, "junction")
    for step in range(6):
        bias = BIAS * step / 5
        devsim.set_parameter(device=DEVICE, name=simple_physics.GetContactBiasName("anode"), value=bias)
        _solve(1e10)
    equations = (simple_physics.ece_name, simple_physics.hce_name)
    return sum(devsim.get_contact_current(device=DEVICE, contact="anode", equation=each) for each in equations)


def _solve(absolute: float) -> None:
    devsim.solve(type="dc", absolute_error=absolute, relative_error=1e-6, maximum_iterations=60)
