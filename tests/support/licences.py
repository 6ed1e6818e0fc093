"""What the installed packages say about their licences, and which of them ours needs."""

import re
import tomllib
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

#: What each family is known by; the first that fits, as AGPL has GPL in it.
_FAMILIES = {
    "AGPL": r"AGPL|Affero",
    "LGPL": r"LGPL|Lesser General Public",
    "GPL": r"GPL|General Public",
    "MPL": r"MPL|Mozilla",
    "Apache": r"Apache",
    "BSD": r"BSD|Kiwi licensing|Enthought|matplotlib project",
    "PSF": r"PSF|Python Software Foundation|matplotlib versions",
    "MIT": r"MIT|HPND|ISC",
    "0BSD": r"Zlib|CC0",
}
#: Those that ask of who passes them on more than to name them.
SHARING = ("AGPL", "GPL", "LGPL", "MPL")


def family(found: Distribution) -> str:
    """The licence of a package; empty where it does not say."""
    said = found.metadata
    classifiers = [one for one in said.get_all("Classifier", []) if one.startswith("License ::")]
    for text in (said.get("License-Expression"), " ".join(classifiers), said.get("License")):
        for name, pattern in _FAMILIES.items():
            if text and re.search(pattern, text):
                return name
    return ""


def declared(project: Path) -> dict[str, set[str]]:
    """The packages that a pyproject.toml names, each with the extras that do; the empty one is always needed."""
    own = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    found: dict[str, set[str]] = {}
    for extra, lines in {"": own["dependencies"], **own["optional-dependencies"]}.items():
        for line in lines:
            name = canonicalize_name(Requirement(line).name)
            if name != canonicalize_name(own["name"]):
                found.setdefault(name, set()).add(extra)
    return found


def installed(names: set[str]) -> dict[str, Distribution]:
    """These packages, as far as they are installed."""
    return {name: found for name in sorted(names) for found in _found(name)}


def needed(project: Path, *, without: str) -> dict[str, Distribution]:
    """All installed packages that ours needs in the end, but for those of one extra alone."""
    own = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    extras = {name: lines for name, lines in own["optional-dependencies"].items() if name != without}
    waiting = [Requirement(line) for lines in (own["dependencies"], *extras.values()) for line in lines]
    found: dict[str, Distribution] = {}
    seen: set[tuple[str, str]] = set()
    while waiting:
        asked = waiting.pop()
        for extra in ("", *asked.extras):
            if (asked.name, extra) in seen:
                continue
            seen.add((asked.name, extra))
            for one in _found(asked.name):
                found[canonicalize_name(asked.name)] = one
                more = map(Requirement, one.requires or ())
                waiting += [each for each in more if each.marker is None or each.marker.evaluate({"extra": extra})]
    return found


def _found(name: str) -> Iterator[Distribution]:
    try:
        yield distribution(name)
    except PackageNotFoundError:
        return
