"""What of a domain a new mesh did not keep, each loss in words: the reasons for exit code 1 beside bad tets."""

from collections.abc import Mapping
from typing import TypedDict

from wct_plugin.measure.conserved import CHANGE, Sharp
from wct_plugin.measure.fidelity import Fidelity, beyond, label
from wct_plugin.measure.quantities import Quantity
from wct_plugin.measure.region_topology import RegionTopology, changes
from wct_plugin.measure.released_creases import Released

_TOPOLOGY = {
    "components": "pieces",
    "euler_characteristic": "the Euler characteristic",
    "joined_edges": "edges that join other than two facets",
    "pinched_vertices": "pinched vertices",
}


class Loss(TypedDict):
    """Something that was to be kept: ``before``, ``after`` and the greatest or smallest ``allowed``, in its unit."""

    kind: str  #: deviation, interface, volume, group, sharp edges, creases, topology, periodic
    name: str  #: region, group, interface or what is inside; empty for the whole
    before: float
    after: float
    allowed: float
    text: str


def find_losses(
    kept: Fidelity,
    groups: Mapping[str, Quantity],
    sharp: Sharp | None,
    topology: tuple[dict[str, RegionTopology], dict[str, RegionTopology]],
    released: Released,
    sides: Mapping[str, int] | None,
    *,
    allowed: float,
    allow_released: bool,
    names: Mapping[str, str],
) -> list[Loss]:
    """Everything that is farther off than it may be; ``allowed``: the tolerance, as a fraction of the diagonal.

    ``sides``: how many pairs of periodic sides match, before and after, where they are to. ``allow_released``: creases
    that were given up, and more edges that bend, are none. ``names``: of regions, by tag.
    """
    out: list[Loss] = []
    far = {"": kept["deviation"]["fraction_of_diagonal"]} | {
        name: one["fraction_of_diagonal"] if one else float("inf") for name, one in kept["interfaces"].items()
    }
    far |= kept["inside"]
    for name, phrase in beyond(kept, allowed, names).items():
        kind = "interface" if name in kept["interfaces"] else "deviation"
        out.append(_loss(kind, name, 0.0, far[name], allowed, f"{phrase}; the tolerance is {allowed:.2e}"))
    out += find_changes(kept["volumes"], groups, names)
    if sharp and sharp["after"] > sharp["allowed"] and not allow_released:
        text = (
            f"edges that bend more than the crease angle are {sharp['after']:.4g} long, {sharp['before']:.4g} before;"
            f" allowed is {sharp['allowed']:.4g}"
        )
        out.append(_loss("sharp edges", "", sharp["before"], sharp["after"], sharp["allowed"], text))
    if released["creases"] and not allow_released:
        count = released["creases"]
        text = f"{count} crease{' was' if count == 1 else 's were'} given up (allow_released accepts that)"
        out.append(_loss("creases", "", 0.0, float(count), 0.0, text))
    for tag, name, before, after in changes(*topology):
        text = f"region {label(tag, names)}: {_TOPOLOGY[name]}: {before} before, {after} now"
        out.append(_loss("topology", tag, float(before), float(after), float(before), text))
    if sides and sides["after"] < sides["before"]:
        before, after = sides["before"], sides["after"]
        text = f"{before} pairs of periodic sides matched, vertex for vertex; {after} do now"
        out.append(_loss("periodic", "", float(before), float(after), float(before), text))
    return out


def find_changes(
    volumes: Mapping[str, Quantity], groups: Mapping[str, Quantity], names: Mapping[str, str]
) -> list[Loss]:
    """The regions, by tag, and groups whose size is another than allowed; ``names``: of regions, by tag."""
    out: list[Loss] = []
    for tag, volume in volumes.items():
        if abs(volume["change"]) > CHANGE:
            what = "the volume" if len(volumes) == 1 else f"the volume of region {label(tag, names)}"
            out.append(_changed("volume", tag, volume, what))
    for name, size in groups.items():
        if not size["after"] and size["before"]:
            text = f"{name} is lost" if name.startswith("interface ") else f"the group {name} is lost"
            out.append(_loss("group", name, size["before"], 0.0, size["before"], text))
        elif abs(size["change"]) > CHANGE:
            out.append(_changed("group", name, size, f"the size of {name}"))
    return out


def _changed(kind: str, name: str, size: Quantity, what: str) -> Loss:
    more = size["after"] > size["before"]
    allowed = size["before"] * (1.0 + CHANGE if more else 1.0 - CHANGE)
    text = f"{what} changed by {100.0 * size['change']:+.2f} %; allowed is {100.0 * CHANGE:g} %"
    return _loss(kind, name, size["before"], size["after"], allowed, text)


def _loss(kind: str, name: str, before: float, after: float, allowed: float, text: str) -> Loss:
    return {"kind": kind, "name": name, "before": before, "after": after, "allowed": allowed, "text": text}
