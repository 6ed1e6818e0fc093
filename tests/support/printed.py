"""The paper's single tets and what it prints of them, and a mesh's extremes as it would print them, or beside it."""

from paper import MORE_IS_BETTER, SINGLE, SOMMERVILLE, extremes

from wct_plugin.mesh import TetMesh

_CORNERS: dict[str, list[list[float]]] = {
    "y2y3y": [[0.6, -0.64, -0.48], [0.48, 0.8, -0.36], [-0.96, 0, -0.28], [0, 0, 1]],
    "n2y3y": [[0, 0.96, -0.28], [-0.744, -0.64, -0.192], [0.856, -0.48, -0.192], [-0.48, 0.192, 0.856]],
    "n2n3n": [[0.224, -0.768, -0.6], [0.8, 0, -0.6], [0.224, 0.768, -0.6], [-0.28, 0, 0.96]],
    "y2y3n": [[0.36, -0.8, -0.48], [0.768, 0.28, -0.576], [-0.6, 0.64, -0.48], [0.576, 0.168, 0.8]],
    "n2y3n": [[-0.152, 0.864, -0.48], [-0.64, -0.6, -0.48], [0.6, -0.64, -0.48], [-0.192, -0.64, 0.744]],
    "n2n3y": [[0, -0.6, -0.8], [0.64, -0.024, -0.768], [-0.64, -0.024, -0.768], [0, 0.352, 0.936]],
    "sommerville": [[-1, -2, 0], [1, 0, -2], [-1, 2, 0], [1, 0, 2]],
}
_ROWS = {name: (row, letters) for name, (_, row, letters) in SINGLE.items()} | {"sommerville": (SOMMERVILLE, "YYN")}

#: Figures 2 to 8: coordinates, the printed minima and maxima of h/R, face angle, dihedral angle and R/l, and the
#: letters of table 1 (3-WC, 2-WC, acute).
PAPER_TETS = {name: (_CORNERS[name], row.split(), letters) for name, (row, letters) in _ROWS.items()}


def columns(mesh: TetMesh, places: int = 3) -> list[str]:
    """Min and max of h/R, face angle, dihedral angle and R/l; h/R and R/l with three decimals, angles with two.

    ``places``: decimals of min h/R, of which some of the paper's tables print four.
    """
    return [f"{value:.{k}f}" for value, k in zip(extremes(mesh), (places, 3, 2, 2, 2, 2, 3, 3), strict=True)]


def beaten(printed: str, mesh: TetMesh) -> list[bool]:
    """Column by column, whether the unrounded number of the mesh is strictly better than the printed one."""
    pairs = zip(extremes(mesh), map(float, printed.split()), MORE_IS_BETTER, strict=True)
    return [ours > papers if more else ours < papers for ours, papers, more in pairs]
