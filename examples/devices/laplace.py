"""Laplace's equation in DEVSIM on a gmsh file: a coefficient per region, contacts and an interface by their names.

DEVSIM prints much, which is held back here, and wants a LAPACK to be named before it is imported. That of NGSolve,
which is a wheel of its own, serves also where both are in one process: two different ones end in a crash there. macOS
has one that DEVSIM finds by itself.
"""

import contextlib
import io
import os
import sys
from collections.abc import Mapping
from pathlib import Path

if sys.platform != "darwin":
    import ngsolve_openblas

    os.environ.setdefault("DEVSIM_MATH_LIBS", ngsolve_openblas.get_libraries()[0])
with contextlib.redirect_stdout(io.StringIO()):
    import devsim

__all__ = ["devsim", "flux"]

#: The device and the mesh of it, which there are one at a time.
DEVICE = "device"


def flux(
    file: str | Path,
    coefficients: Mapping[str, float],
    contacts: Mapping[str, tuple[str, float]],
    interfaces: Mapping[str, tuple[str, str]] | None = None,
) -> float:
    """Solve on ``file`` and give what flows in through the first contact, through the last one out.

    ``coefficients``: of each region. ``contacts``: the region of each, and the potential there. ``interfaces``: the two
    regions of each, which have nodes of their own there.
    """
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            load(file, coefficients, {name: region for name, (region, _) in contacts.items()}, interfaces or {})
            for region, coefficient in coefficients.items():
                _equation(region, coefficient)
            for contact, (_, potential) in contacts.items():
                _hold(contact, potential)
            for interface in interfaces or {}:
                _join(interface)
            devsim.solve(type="dc", absolute_error=1e-12, relative_error=1e-12, maximum_iterations=9)
            return float(devsim.get_contact_current(device=DEVICE, contact=next(iter(contacts)), equation="Laplace"))
        finally:
            unload()


def load(
    file: str | Path,
    regions: Mapping[str, object],
    contacts: Mapping[str, str],
    interfaces: Mapping[str, tuple[str, str]],
) -> None:
    """Make the device of a gmsh file, by the names of its physical groups."""
    devsim.create_gmsh_mesh(mesh=DEVICE, file=str(file))
    for region in regions:
        devsim.add_gmsh_region(mesh=DEVICE, gmsh_name=region, region=region, material=region)
    for contact, region in contacts.items():
        devsim.add_gmsh_contact(mesh=DEVICE, gmsh_name=contact, name=contact, region=region, material="metal")
    for interface, (one, other) in interfaces.items():
        devsim.add_gmsh_interface(mesh=DEVICE, gmsh_name=interface, name=interface, region0=one, region1=other)
    devsim.finalize_mesh(mesh=DEVICE)
    devsim.create_device(mesh=DEVICE, device=DEVICE)


def unload() -> None:
    """Forget what there is of it."""
    if DEVICE in devsim.get_device_list():
        devsim.delete_device(device=DEVICE)
    if DEVICE in devsim.get_mesh_list():
        devsim.delete_mesh(mesh=DEVICE)


def _equation(region: str, coefficient: float) -> None:
    of = {"device": DEVICE, "region": region}
    devsim.node_solution(**of, name="V")
    devsim.edge_from_node_model(**of, node_model="V")
    devsim.edge_model(**of, name="Flux", equation=f"{coefficient!r}*(V@n0-V@n1)*EdgeInverseLength")
    devsim.edge_model(**of, name="Flux:V@n0", equation=f"{coefficient!r}*EdgeInverseLength")
    devsim.edge_model(**of, name="Flux:V@n1", equation=f"-{coefficient!r}*EdgeInverseLength")
    devsim.equation(**of, name="Laplace", variable_name="V", edge_model="Flux", variable_update="default")


def _hold(contact: str, potential: float) -> None:
    of = {"device": DEVICE, "contact": contact}
    devsim.contact_node_model(**of, name=f"{contact}_held", equation=f"V-{potential!r}")
    devsim.contact_node_model(**of, name=f"{contact}_held:V", equation="1")
    devsim.contact_equation(**of, name="Laplace", node_model=f"{contact}_held", edge_current_model="Flux")


def _join(interface: str) -> None:
    of = {"device": DEVICE, "interface": interface}
    for name, equation in (("joined", "V@r0-V@r1"), ("joined:V@r0", "1"), ("joined:V@r1", "-1")):
        devsim.interface_model(**of, name=name, equation=equation)
    devsim.interface_equation(**of, name="Laplace", interface_model="joined", type="continuous")
