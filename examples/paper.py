"""Every figure and table of the paper, beside what this package makes: printed, certified exactly, and asserted.

E. VanderZee, A. N. Hirani, D. Guoy, "Triangulation of Simple 3D Shapes with Well-Centered Tetrahedra" (2008).
What comes out is Markdown: ``python examples/paper.py > docs/paper.md``; ``docs/paper_pictures.py`` draws the pictures.
"""

from collections.abc import Iterator

import numpy as np

import wct_plugin as wct
from wct_plugin.certify.certificate import certify
from wct_plugin.measure import quality

#: What the paper prints: minimum and maximum of h/R, face angle, dihedral angle and R/l.
SINGLE = {
    "y2y3y": (2, "0.254 0.371 50.92 67.08 58.76 76.98 0.690 0.690", "YYY"),
    "n2y3y": (3, "0.224 0.427 46.26 77.62 52.71 94.15 0.733 0.733", "YYN"),
    "n2n3n": (4, "-0.029 0.600 29.89 106.26 35.42 116.68 1.042 1.042", "NNN"),
    "y2y3n": (5, "-0.109 0.562 41.71 83.76 53.33 85.72 0.863 0.863", "NYY"),
    "n2y3n": (6, "-0.024 0.630 42.08 85.44 59.94 91.20 0.806 0.806", "NYN"),
    "n2n3y": (7, "0.112 0.765 25.69 95.94 40.33 105.62 1.161 1.161", "YNN"),
}
SOMMERVILLE = "0.316 0.316 54.74 70.53 60.00 90.00 0.645 0.645"
EIGHT = {
    "8a": (12, "0.0345 0.712 38.87 86.76 38.44 121.37 0.702 0.934"),
    "8b": (13, "0.0448 0.584 39.63 87.43 46.72 105.95 0.777 0.826"),
}
FORTY_NINE = "0.0146 0.845 23.36 89.07 29.93 107.73 0.612 1.305"
CUBES = {
    224: "0.041 0.850 21.01 87.49 24.91 105.61 0.618 1.569",
    194: "0.005 0.790 26.93 89.61 28.26 126.64 0.612 1.134",
    146: "0.016 0.854 17.09 112.60 10.73 163.17 0.711 1.835",
}
#: Whether more is better, column by column.
MORE_IS_BETTER = (True, False, True, False, True, False, False, False)

HEAD = (
    "| | h/R min | max | face angle min | max | dihedral angle min | max | R/ℓ min | max | proven |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


def make(what: str, /, **options: object) -> wct.TetMesh:
    """One of the meshes of ``wct create``."""
    mesh, _ = wct.apply_filter(f"create_{what}", **options)
    return mesh


def extremes(mesh: wct.TetMesh) -> list[float]:
    """The eight numbers of the paper's tables."""
    q = quality.measure(mesh)
    lows = q.min_height, q.min_face_angle, q.min_dihedral_angle, q.radius_over_edge
    highs = q.max_height, q.max_face_angle, q.max_dihedral_angle, q.radius_over_edge
    return [float(value) for low, high in zip(lows, highs, strict=True) for value in (low.min(), high.max())]


def proven(mesh: wct.TetMesh) -> str:
    """The most that exact arithmetic proves, on the coordinates as they are."""
    certificate = certify(mesh)
    assert certificate.valid
    return next((name.upper() for name in ("cwc", "3wc", "2wc") if certificate.meets(name)), "valid")


class Comparison:
    """Rows of the paper and of ours, and in which columns ours are better (+), as printed (=) or worse (-)."""

    def __init__(self, printed: str, label: str) -> None:
        self.printed = printed.split()
        self.lines = [HEAD, f"| paper, {label} | {' | '.join(self.printed)} | |"]

    def ours(self, mesh: wct.TetMesh, label: str) -> str:
        """Add a row of ours; gives the eight marks."""
        marks, cells = "", []
        for value, printed, more in zip(extremes(mesh), self.printed, MORE_IS_BETTER, strict=True):
            shown = f"{value:.{len(printed.split('.')[1])}f}"
            marks += "=" if shown == printed else "+" if (float(shown) > float(printed)) == more else "-"
            cells.append(f"{shown} {marks[-1]}")
        self.lines.append(f"| {label} | {' | '.join(cells)} | {proven(mesh)} |")
        return marks


def picture(name: str, what: str) -> str:
    """Markdown for a picture beside the page."""
    return f"![{what}](paper/{name}.png)"


def single_tetrahedra() -> Iterator[str]:
    """Figures 1 to 8 and table 1."""
    yield "## Single tetrahedra: figures 1 to 7, table 1\n"
    yield picture("single", "An equatorial ball, and six tetrahedra in their circumspheres") + "\n"
    yield "| figure | 3-WC | 2-WC | acute |\n|---|---|---|---|"
    tables = []
    for name, (figure, printed, letters) in SINGLE.items():
        mesh = make("tetrahedron", name=name)
        measured, certificate = quality.measure(mesh), certify(mesh)
        found = [certificate.meets("3wc"), certificate.meets("2wc"), bool(measured.acute[0])]
        assert [letter == "Y" for letter in letters] == found
        assert np.allclose(np.linalg.norm(mesh.points, axis=1), 1.0, rtol=1e-15)  # the circumcenter is the origin
        assert outside_equatorial_balls(mesh) == certificate.meets("3wc")
        yield f"| {figure}, `create_tetrahedron name={name}` | {' | '.join(letters)} |"
        comparison = Comparison(printed, f"figure {figure}")
        assert comparison.ours(mesh, f"`{name}`") == "=" * 8
        tables += ["", *comparison.lines]
    yield "\nFigure 1 is the criterion behind the first column: a tet is 3-well-centered if and only if each vertex"
    yield "lies outside the equatorial ball of the facet opposite to it. It tells these six apart as the table does."
    yield from tables


def outside_equatorial_balls(mesh: wct.TetMesh) -> bool:
    """Whether each vertex of a single tet lies outside the ball about the opposite facet's circumcircle."""
    found = []
    for vertex in range(4):
        a, b, c = np.delete(mesh.points, vertex, axis=0)
        normal = np.cross(b - a, c - a)
        center = a + (
            np.dot(c - a, c - a) * np.cross(normal, b - a) + np.dot(b - a, b - a) * np.cross(c - a, normal)
        ) / (2 * np.dot(normal, normal))
        found.append(np.linalg.norm(mesh.points[vertex] - center) > np.linalg.norm(a - center))
    return all(found)


def tilings() -> Iterator[str]:
    """Figures 8 to 10, the condition on a and b, slab and prism."""
    yield "\n## Space, slabs and prisms: figures 8 to 10\n"
    yield (picture("tilings", "Sommerville's tetrahedron, a plane of the lattice, tets between planes, a prism") + "\n")
    comparison = Comparison(SOMMERVILLE, "figure 8")
    assert comparison.ours(make("tetrahedron", name="sommerville"), "`create_tetrahedron name=sommerville`") == "=" * 8
    pieces = {
        "cell": make("lattice_tiling", nx=3, p=4, q=2),
        "slab": make("lattice_tiling", domain="slab", nx=3, p=4, q=3, size=1.0),
        "prism": make("lattice_tiling", domain="prism", nx=4, p=3, q=2, size=1.5),
    }
    for domain, mesh in pieces.items():
        assert comparison.ours(mesh, f"`create_lattice_tiling domain={domain}`, {len(mesh.tets)} tets") == "=" * 8
    yield from comparison.lines
    thickness, prism = np.ptp(pieces["slab"].points, axis=0)[2], np.ptp(pieces["prism"].points, axis=0)
    assert np.isclose(thickness, 1.0, rtol=1e-15)
    assert np.allclose(prism[1:], [1.5, 1.0], rtol=1e-15)
    yield f"\nThe slab is {thickness:g} thick; the prism of p : q = 3 : 2 is {prism[1]:g} wide and {prism[2]:g} high.\n"
    yield "Every tet is completely well-centered if and only if a > 1/2 and b > 1/2, proven at each point of a grid:\n"
    steps = (0.25, 0.4, 0.5, 0.501, 0.6, 0.7071, 1.0, 2.0)
    yield f"| a \\ b | {' | '.join(map(str, steps))} |\n|{'---|' * (len(steps) + 1)}"
    for a in steps:
        found = [certify(make("lattice_tiling", a=a, b=b, nx=1, p=1, q=1)).meets("cwc") for b in steps]
        assert found == [a > 0.5 and b > 0.5 for b in steps]
        yield f"| {a} | {' | '.join('CWC' if yes else '-' for yes in found)} |"


def cubes() -> Iterator[str]:
    """Figure 11 and table 2."""
    yield "\n## The cube: figure 11, table 2\n"
    yield picture("cubes", "Five cubes, cut open, and the corner of a cube") + "\n"
    yield "The paper prints no coordinates of its cubes; these are ours. All but those of 33, 32 and 30 tets are"
    yield "completely well-centered, as the 224 and the 194 are; those three are 3-well-centered, as the 146 is.\n"
    beaten = {
        224: ("194_best", []),
        194: ("194", ["194_paper"]),
        146: ("32", []),
    }
    for count, (best, others) in beaten.items():
        comparison = Comparison(CUBES[count], f"{count} tets")
        marks = comparison.ours(make("cube", variant=best), f"`create_cube variant={best}`")
        assert "-" not in marks, f"{best} against {count}: {marks}"
        for variant in others:
            comparison.ours(make("cube", variant=variant), f"`variant={variant}`, on the surface it describes")
        yield from [*comparison.lines, ""]
    yield "The fewest tets known: the paper has 194 completely and 146 3-well-centered ones, and shows that fewer than"
    yield "30 and 9 are impossible. Ours, and the corner of the cube, for which it prints no numbers:\n"
    yield HEAD
    variants = ("104", "87", "84", "33", "30")
    few = {f"`create_cube variant={variant}`": make("cube", variant=variant) for variant in variants}
    for label, mesh in {**few, "`create_cube_corner`": make("cube_corner")}.items():
        numbers = (f"{value:.{4 if k < 1 else 2 if 2 <= k < 6 else 3}f}" for k, value in enumerate(extremes(mesh)))
        yield f"| {label} | {' | '.join(numbers)} | {proven(mesh)} |"
    assert [proven(mesh) for mesh in few.values()] == ["CWC", "CWC", "CWC", "3WC", "3WC"]
    voxels = np.ones((2, 2, 2), dtype=bool)
    voxels[1, 0] = False
    figure = make("from_voxels", voxels=voxels)
    assert len(figure.tets) == 6 * 194
    assert proven(figure) == "CWC"
    yield "\nThe faces of the 194 match each other up to rotation and reflection, so that any figure of unit cubes has"
    yield "a completely well-centered mesh, `create_from_voxels`; that of 6 cubes in an L is proven to be one.\n"
    alone = certify(wct.TetMesh(np.vstack([np.zeros(3), np.eye(3)]), np.arange(4)[None]))
    assert not alone.meets("3wc")
    yield "The corner of the cube as one tet is not 3-well-centered, as none with three orthogonal facets is: the"
    yield f"circumcenter's smallest barycentric coordinate is {alone.checks['3wc'].first[0].value}."


def subdivisions() -> Iterator[str]:
    """Figures 12 to 15."""
    yield "\n## The regular tetrahedron: figures 12 to 15\n"
    yield picture("subdivisions", "Subdivisions of the regular tetrahedron into 8 and 49 tets") + "\n"
    ours = make("tetrahedron_subdivision", variant="8")
    for variant, (figure, printed) in EIGHT.items():
        comparison = Comparison(printed, f"figure {figure}")
        made = make("tetrahedron_subdivision", variant=variant)
        assert comparison.ours(made, f"`create_tetrahedron_subdivision variant={variant}`") == "=" * 8
        comparison.ours(ours, "`variant=8`, the largest min h/R we know")
        yield from [*comparison.lines, ""]
    comparison = Comparison(FORTY_NINE, "figure 15")
    marks = comparison.ours(make("tetrahedron_subdivision", variant="49"), "`variant=49`")
    assert "-" not in marks, f"49: {marks}"
    yield from comparison.lines


def main() -> None:
    """Print the page."""
    print("# The paper, figure by figure\n")
    print("Made by `python examples/paper.py`, which asserts what it prints. Marks: `=` equals the paper's printed")
    print("digits, `+` is better, `-` worse; better is a larger minimum of h/R and of angles, and less in all other")
    print("columns. The last column is the most that [exact arithmetic](certificates.md) proves of our mesh.\n")
    for part in (single_tetrahedra, tilings, cubes, subdivisions):
        for line in part():
            print(line)


if __name__ == "__main__":
    main()
