"""How well a resampled mesh keeps the domain of the old one: its boundary, its interfaces, its regions' volumes."""

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from wct_plugin.measure import compiled_quality
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.inner_deviation import measure_inner_deviation
from wct_plugin.measure.quantities import Quantity, quantity
from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.mesh.named_groups import tag_names
from wct_plugin.types import Ints


class Fidelity(TypedDict):
    """Deviations as :meth:`wct_plugin.measure.deviation.Deviation.to_dict` gives them, by fractions of one diagonal."""

    deviation: dict[str, float]  #: of the boundary from the reference
    interfaces: dict[str, dict[str, float] | None]  #: "1|2" -> of that interface from the old one; None: it is lost
    inside: dict[str, float]  #: of sheets and wires from the old ones, by kind, where both meshes have them
    volumes: dict[str, Quantity]  #: by region tag, before on the surface that was followed


def measure_fidelity(
    old: TetMesh, new: TetMesh, surface: SurfaceMesh | None, enclosed: Mapping[str, float] | None = None
) -> Fidelity:
    """Measure ``new`` against ``old``, its boundary against ``surface`` if there is one; all distances two-sided.

    ``enclosed``: what volume the surface gives each region, by tag, where that is not the old mesh's.
    """
    target = surface or old.boundary_surface()
    diagonal = target.diagonal
    before, after = _interfaces(old), _interfaces(new)
    return {
        "deviation": measure_deviation(new.boundary_surface(), target, compiled=True).to_dict(diagonal),
        "interfaces": {
            name: measure_deviation(after[name], one, compiled=True).to_dict(diagonal) if name in after else None
            for name, one in before.items()
        },
        "inside": {} if new is old else measure_inner_deviation(old, new, diagonal),
        "volumes": measure_volumes(old, new, enclosed or {}),
    }


def region_names(mesh: TetMesh) -> dict[str, str]:
    """What the mesh calls its regions, by their tags."""
    return {str(tag): name for tag, name in tag_names(mesh.names, 3).items()}


def label(tags: str, names: Mapping[str, str]) -> str:
    """A region's tag, or those of an interface's two, and their names, where any has one: ``1|2 (silicon|2)``."""
    parts = tags.split("|")
    return f"{tags} ({'|'.join(names.get(tag, tag) for tag in parts)})" if any(tag in names for tag in parts) else tags


def beyond(found: Fidelity, allowed: float, names: Mapping[str, str]) -> dict[str, str]:
    """What is farther off than ``allowed``, a fraction of the diagonal, in words: by interface, "" for the boundary.

    Sheets and wires by what they are called in ``found["inside"]``.

    ``names``: of regions, by tag.
    """
    parts = {}
    if found["deviation"]["fraction_of_diagonal"] > allowed:
        parts[""] = (
            f"the boundary is {found['deviation']['fraction_of_diagonal']:.2e} of the diagonal from the reference"
        )
    for name, apart in found["interfaces"].items():
        if apart is None:
            parts[name] = f"the interface {label(name, names)} is lost"
        elif (far := apart["fraction_of_diagonal"]) > allowed:
            parts[name] = f"the interface {label(name, names)} is {far:.2e} of the diagonal from the old one"
    for name, far in found["inside"].items():
        if far > allowed:
            parts[name] = f"{name} are {far:.2e} of the diagonal from the old ones"
    return parts


def describe(
    volumes: Mapping[str, Quantity], interfaces: Mapping[str, dict[str, float] | None], names: Mapping[str, str]
) -> str:
    """One line about several regions for the report, empty for one region; ``names``: of regions, by tag."""
    if len(volumes) == 1:
        return ""
    parts = [f"region {label(tag, names)}: volume {100 * one['change']:+.3f} %" for tag, one in volumes.items()]
    parts += [
        f"interface {label(name, names)}: {apart['fraction_of_diagonal']:.2e} of the diagonal from the old one"
        if apart
        else f"interface {label(name, names)}: lost"
        for name, apart in interfaces.items()
    ]
    return "; ".join(parts)


def interface_rows(mesh: TetMesh) -> dict[str, Ints]:
    """The rows of the topology's interfaces between each two regions that touch, by their tags: ``1|2``."""
    pairs = np.sort(mesh.regions[mesh.topology.interface_pairs[:, ::2]], axis=1)
    names, of = np.unique(pairs, axis=0, return_inverse=True)
    return {f"{low}|{high}": np.flatnonzero(of.reshape(-1) == k) for k, (low, high) in enumerate(names.tolist())}


def _interfaces(mesh: TetMesh) -> dict[str, SurfaceMesh]:
    """The interface of each two regions that touch."""
    out = {}
    for name, rows in interface_rows(mesh).items():
        used, place = np.unique(mesh.topology.interfaces[rows], return_inverse=True)
        out[name] = SurfaceMesh(mesh.points[used], place.reshape(-1, 3))
    return out


def measure_volumes(old: TetMesh, new: TetMesh, enclosed: Mapping[str, float]) -> dict[str, Quantity]:
    """Of each region, by tag; ``enclosed``: what it was, where that is not the old mesh's."""
    of_old = compiled_quality.volumes(old.points, old.tets)
    of_new = of_old if new is old else compiled_quality.volumes(new.points, new.tets)
    out: dict[str, Quantity] = {}
    for tag in np.unique(old.regions):
        before = enclosed.get(str(tag), float(of_old[old.regions == tag].sum()))
        after = float(of_new[new.regions == tag].sum())
        out[str(tag)] = quantity(before, after)
    return out
