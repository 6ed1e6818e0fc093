"""How a gmsh file is to be written: its version, as text or binary, and what becomes of cells in several groups."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wct_plugin.errors import OptionError
from wct_plugin.io.formats import Format

VERSIONS = ("2.2", "4.1")
GROUPS = ("all", "first")


@dataclass(frozen=True)
class MshOptions:
    """What was asked for; None is what was not."""

    version: str | None = None  #: none: 2.2, or 4.1 where cells are in several groups and are to stay there
    binary: bool | None = None  #: none: text
    groups: str | None = None  #: none: all

    def check(self, path: str | Path, form: Format) -> None:
        """Raise :class:`OptionError` for values there are not, and for a format that has no such options."""
        for name, allowed in (("version", VERSIONS), ("groups", GROUPS)):
            value = getattr(self, name)
            if value is not None and value not in allowed:
                raise OptionError(f"{path}: option {name!r} is {value!r}; allowed are {', '.join(allowed)}")
        if self.binary is not None and not isinstance(self.binary, bool):
            raise OptionError(f"{path}: option 'binary' is {self.binary!r}; allowed are True, False")
        given = [name for name in ("version", "binary", "groups") if getattr(self, name) is not None]
        if given and form.name != "gmsh":
            raise OptionError(f"{path}: {form.name} has no option {given[0]!r}; only gmsh files (.msh) have it")


def number_as_text(version: Any) -> Any:
    """The version as text where it came as a number, as in JSON; all else as it is."""
    return repr(version) if isinstance(version, float) else version
