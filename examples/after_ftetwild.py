"""After fTetWild: hand pytetwild's arrays to one filter, compare, write.

The surface is bone.ply, which ships in the pymeshlab wheel. pytetwild needs pyvista when it is imported:
``pip install '.[pyvista]'`` in the clone. Run it: ``python examples/after_ftetwild.py [out.vtu]``.
"""

import importlib.util
import sys
from pathlib import Path

import pytetwild

import wct_plugin as wct


def bone() -> Path:
    """Path of the scanned bone among pymeshlab's sample meshes."""
    spec = importlib.util.find_spec("pymeshlab")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    return Path(spec.submodule_search_locations[0]) / "tests/sample_meshes/bone.ply"


def main(target: str = "bone.vtu") -> tuple[float, float]:
    """Give the percentage of tets that contain their circumcenter, before and after."""
    surface = wct.read(bone())
    points, triangles, _ = wct.to_arrays(surface)  # copies: our own arrays are read-only, and it takes none of those
    points, tets = pytetwild.tetrahedralize(points, triangles, edge_length_fac=0.05, quiet=True)

    mesh = wct.TetMesh(points, tets)  # fTetWild's negative orientation is turned round here
    better, _ = wct.apply_filter("meshing_well_centered", mesh, goal="3wc", reference=surface)
    wct.write(target, better)

    before, after = (wct.apply_filter("get_quality", one)[1]["3wc"]["percent"] for one in (mesh, better))
    print(
        f"{before:.1f} % of {len(tets)} tets contained their circumcenter, {after:.1f} % of {len(better.tets)} do now"
    )
    assert after > 99.0 > before
    return before, after


if __name__ == "__main__":
    main(*sys.argv[1:])
