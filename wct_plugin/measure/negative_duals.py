"""How many duals of a mesh are negative, by degree and by place: what breaks a diagonal Hodge star."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.measure.duals import Duals
from wct_plugin.mesh import TetMesh

#: Degree k of the Hodge star -> what each of its diagonal's entries measures. k = 3 is 1 / volume, never negative.
CELLS = ("dual volume per vertex", "dual area per edge", "dual length per facet")

#: Column names of :meth:`NegativeDuals.rows`.
HEAD = ("", "interior", "boundary", "zero")


@dataclass(frozen=True)
class Signs:
    """The entries of one degree at one place."""

    count: int
    negative: int  #: below zero by more than their rounding error
    zero: int  #: zero within it: cospherical neighbours, as in a Cartesian grid


@dataclass(frozen=True)
class NegativeDuals:
    """The signs of a mesh's duals, k = 0, 1, 2 in turn."""

    interior: tuple[Signs, ...]
    boundary: tuple[Signs, ...]  #: vertices, edges and facets on the boundary

    @property
    def none(self) -> bool:
        """Whether every dual is positive, beyond its rounding error."""
        return not any(one.negative or one.zero for one in self.interior + self.boundary)

    def to_dict(self) -> dict[str, dict[str, dict[str, int]]]:
        """Plain numbers by degree, ``star0`` to ``star2``, and place."""
        places: Mapping[str, tuple[Signs, ...]] = {"interior": self.interior, "boundary": self.boundary}
        return {f"star{k}": {place: vars(of[k]) for place, of in places.items()} for k in range(len(CELLS))}

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Degree and what its entries measure, negative ones inside, on the boundary, and those that are zero."""
        return [
            (
                f"★{k}: {name}",
                f"{inside.negative} of {inside.count}",
                f"{outside.negative} of {outside.count}",
                str(inside.zero + outside.zero),
            )
            for k, (name, inside, outside) in enumerate(zip(CELLS, self.interior, self.boundary, strict=True))
        ]


def count_negative_duals(mesh: TetMesh, of: Duals) -> NegativeDuals:
    """Count the signs of what :func:`wct_plugin.measure.duals.compute_duals` gave for ``mesh``."""
    topology = mesh.topology
    at_facets = np.arange(len(of.lengths)) >= len(topology.interior_pairs)
    tables = (
        (of.volumes, of.volume_errors, topology.boundary_points),
        (of.areas, of.area_errors, topology.boundary_edges),
        (of.lengths, of.errors, at_facets),
    )
    return NegativeDuals(
        tuple(_signs(values, errors, ~outside) for values, errors, outside in tables),
        tuple(_signs(values, errors, outside) for values, errors, outside in tables),
    )


def _signs(values: NDArray[np.float64], errors: NDArray[np.float64], where: NDArray[np.bool_]) -> Signs:
    values, errors = values[where], errors[where]
    return Signs(int(where.sum()), int((values < -errors).sum()), int((np.abs(values) <= errors).sum()))
