"""Pyvista in five lines: a surface, filled, made well-centered, measured, shown.

The accessors ``.tetwild`` and ``.wct`` are there as soon as pytetwild and wct_plugin are installed.
Run it: ``python examples/pyvista_in_five_lines.py [bad.png]``, which draws the mesher's bad tets.
"""

import sys

import pyvista as pv


def main(picture: str = "bad.png") -> float:
    """Give the percentage of tets that contain their circumcenter."""
    surface = pv.Icosphere(nsub=3)
    grid = surface.tetwild.tetrahedralize(edge_length_fac=0.1)
    better = grid.wct.optimize(goal="3wc", reference=surface)
    report = better.wct.report().to_dict()
    grid.wct.plot_bad(goal="3wc", off_screen=True, screenshot=picture)

    before = grid.wct.report().to_dict()
    print(
        f"{before['3wc']['percent']:.1f} % of {before['tets']} tets contained their circumcenter, "
        f"{report['3wc']['percent']:.1f} % of {report['tets']} do now"
    )
    assert report["3wc"]["percent"] > 99.0 > before["3wc"]["percent"]
    assert abs(report["volume"] / surface.volume - 1) < 2e-3
    return float(report["3wc"]["percent"])


if __name__ == "__main__":
    main(*sys.argv[1:])
