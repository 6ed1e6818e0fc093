"""What was wrong with given tets and was mended."""

from dataclasses import dataclass

from wct_plugin.mesh import faults


@dataclass(frozen=True)
class Repairs:
    """What construction mended in the given arrays, so that nothing is changed silently."""

    flipped: int = 0  #: tets whose orientation was reversed (they came with negative volume)
    orphan_points: int = 0  #: points no tet uses, dropped
    stray_cells: int = 0  #: tagged facets, edges and vertices on dropped points, dropped with them
    repeated: int = 0  #: tets whose vertices are those of another one, dropped
    degenerate: int = 0  #: tets with a vertex twice, dropped
    flat: int = 0  #: tets of zero volume with the domain on one side only, dropped
    folded: int = 0  #: tets that lay over others, folded back at the boundary or all but flat, dropped
    mended: int = 0  #: tets of zero volume inside, gone by cutting the tets round them
    added_points: int = 0  #: points where edges of such tets cross, added

    def __bool__(self) -> bool:
        return any(vars(self).values())

    def __add__(self, other: "Repairs") -> "Repairs":
        return Repairs(**{name: count + getattr(other, name) for name, count in vars(self).items()})

    def __str__(self) -> str:
        counts = {
            "repeated tets dropped": self.repeated,
            "tets with a vertex twice dropped": self.degenerate,
            "tets of zero volume dropped": self.flat,
            "tets folded over others dropped": self.folded,
            "tets of zero volume cut away": self.mended,
            "points added for that": self.added_points,
            "negatively oriented tets turned round": self.flipped,
            "points without a tet dropped": self.orphan_points,
            "tagged cells without a tet dropped": self.stray_cells,
        }
        return ", ".join(faults.counted(count, what) for what, count in counts.items() if count) or "nothing"
