"""What a mesh can be made for, and which tets keep it from that."""

from typing import Literal, get_args

from wct_plugin.measure import duals
from wct_plugin.measure.quality import Quality
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Bools

#: Flags of single tets, by the goal that every tet has one.
FLAGS = {
    "3wc": "well_centered_3",
    "2wc": "well_centered_2",
    "cwc": "completely_well_centered",
    "acute": "acute",
}
#: Goals of the whole mesh: the tiers below 3WC.
Dual = Literal["delaunay", "one-sided"]
DUAL: tuple[Dual, ...] = get_args(Dual)


def misses(mesh: TetMesh, measured: Quality, goal: str) -> Bools:
    """(m,) the tets that keep a mesh from its goal: one of :data:`FLAGS`, or of :data:`DUAL`."""
    if goal in FLAGS:
        missing: Bools = ~getattr(measured, FLAGS[goal])
        return missing
    return duals.misses(mesh, measured, one_sided=goal == "one-sided")
