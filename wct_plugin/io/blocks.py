"""The cells of a kind with all that hangs on them, on the way into a file."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from wct_plugin.mesh import cell_kinds
from wct_plugin.types import Ints


@dataclass
class Block:
    """One kind of cell as it will be written."""

    kind: str
    cells: Ints
    tags: Ints
    data: dict[str, NDArray[Any]]
    sets: dict[str, Ints]

    @property
    def dimension(self) -> int:
        """Of its cells."""
        return cell_kinds.dimension(self.kind)
