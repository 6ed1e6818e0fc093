"""How meshes show themselves: a line where they are printed, a card in a notebook, a picture by pyvista."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import OptionError, WctError, how_to_install
from wct_plugin.mesh.in_words import few, in_words
from wct_plugin.types import Floats, Ints

#: VTK's types of triangles and tets.
_TYPES = {3: 5, 4: 10}
_STYLE = "display:inline-block;border:1px solid #8888;border-radius:.4em;padding:.4em .8em;line-height:1.5"


class Shown(ABC):
    """Base of meshes of one kind of cell."""

    points: Floats
    source: str
    point_data: Mapping[str, NDArray[Any]]
    cell_data: Mapping[str, NDArray[Any]]

    @abstractmethod
    def _counts(self) -> dict[str, int]:
        """How many there are of what, the cells second."""

    @abstractmethod
    def _named(self) -> dict[str, Iterable[Any]]:
        """What has names, by what it is."""

    @abstractmethod
    def _cells(self) -> tuple[Ints, Ints]:
        """Vertices of the cells and their tags."""

    def __repr__(self) -> str:
        return in_words(self, self.source, self._counts(), self._named())

    def _repr_html_(self) -> str:
        """The card that notebooks show."""
        title = " ".join(filter(None, (type(self).__name__, self.source)))
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        box = " × ".join(f"{low[k]:.4g} … {high[k]:.4g}" for k in range(3))
        rows = [(what, f"{count:,}".replace(",", " ")) for what, count in self._counts().items() if count]
        rows += [("box", box), *((what, few(list(names))) for what, names in self._named().items() if names)]
        body = "".join(
            f'<tr><td style="text-align:left">{escape(what)}</td><td style="text-align:left">{escape(said)}</td></tr>'
            for what, said in rows
        )
        return f'<div style="{_STYLE}"><b>{escape(title)}</b><table>{body}</table></div>'

    def plot(self, scalars: str | None = None, **options: Any) -> Any:
        """Show it by pyvista, in a window or in the notebook.

        Parameters
        ----------
        scalars : str, optional
            Name of point data or cell data to colour it by, or ``region``; without it regions, if there are several.
        **options
            Of :meth:`pyvista.DataSet.plot`, as ``off_screen=True, screenshot="part.png"``; edges are shown, if it does
            not say otherwise.

        Raises
        ------
        OptionError
            For a name that no array has.
        WctError
            Without pyvista.
        """
        vertices, tags = self._cells()
        point_data, cell_data = dict(self.point_data), {"region": tags, **self.cell_data}
        if scalars is not None and scalars not in (*point_data, *cell_data):
            raise OptionError(f"scalars is {scalars!r}; allowed are {', '.join(map(repr, (*point_data, *cell_data)))}")
        try:
            import pyvista as pv
        except ImportError:
            raise WctError(f"plot() needs pyvista: {how_to_install('pyvista')}") from None
        grid = pv.UnstructuredGrid({_TYPES[vertices.shape[1]]: vertices}, self.points)
        for name, values in point_data.items():
            grid.point_data[name] = values
        for name, values in cell_data.items():
            grid.cell_data[name] = values
        if scalars is None and len(np.unique(tags)) > 1:
            scalars = "region"
        return grid.plot(**{"scalars": scalars, "show_edges": True, **options})
