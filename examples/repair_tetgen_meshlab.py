"""From a faulty scan to MeshLab's histogram: repair, TetGen, well-centered, and back to MeshLab, coloured by quality.

The scan is bone.ply, which ships in the pymeshlab wheel, with a hole torn into it and some triangles doubled; TetGen
takes no such surface. Run it: ``python examples/repair_tetgen_meshlab.py [bone.ply]``, then open the file in MeshLab.
"""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pymeshlab

import wct_plugin as wct

BINS = {"histmin": 0.0, "histmax": 0.34, "binnum": 20}  # a regular tet has h/R = 1/3, none has more


def faulty_bone() -> wct.SurfaceMesh:
    """The bone without the triangles around one point, and with ten others twice."""
    spec = importlib.util.find_spec("pymeshlab")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    bone = wct.read(Path(spec.submodule_search_locations[0]) / "tests/sample_meshes/bone.ply")
    assert isinstance(bone, wct.SurfaceMesh)
    whole = bone.triangles[(bone.triangles != 100).all(axis=1)]
    return wct.SurfaceMesh(bone.points, np.vstack([whole, whole[:10]]))


def histogram(path: str) -> tuple[np.ndarray, np.ndarray]:
    """What MeshLab counts below, in and above the bins of the quality per face, and that quality as MeshLab has it."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(path)
    counts = meshes.get_scalar_histogram_per_face(**BINS)["hist_count"]
    return np.asarray(counts), meshes.current_mesh().face_scalar_array()


def main(target: str = "bone.ply") -> float:
    """Give the smallest h/R of the tets at the surface, as MeshLab reads it."""
    meshlab = wct.Filter.meshlab
    repair = (
        meshlab(filter="meshing_remove_duplicate_faces")
        | meshlab(filter="meshing_close_holes", arguments={"maxholesize": 30})
        | meshlab(filter="meshing_isotropic_explicit_remeshing", arguments={"targetlen": "3%"})
    )
    chain = (
        wct.Reader(faulty_bone())
        | repair
        | wct.Filter.generate_tetrahedralization(mesher="tetgen", tag="tets")
        | wct.Filter.meshing_well_centered(goal="3wc", tag="better")
        | wct.Filter.generate_boundary_surface()
        | wct.Writer(target)
    )
    result = chain.execute()

    counts, quality = histogram(target)
    before, after = (result[tag].flow.report().to_dict()["3wc"]["percent"] for tag in ("tets", "better"))
    print(
        f"{before:.1f} % of TetGen's tets contained their circumcenter, {after:.1f} % of ours do; "
        f"MeshLab counts {counts.sum():.0f} triangles, the smallest h/R behind them is {quality.min():.4f}"
    )
    assert after == 100.0 > before
    assert quality.min() > 0
    edges = np.linspace(BINS["histmin"], BINS["histmax"], BINS["binnum"] + 1)
    expected, _ = np.histogram(result.mesh.cell_data["quality"], edges)
    assert counts.tolist() == [0, *expected.tolist(), 0]
    return float(quality.min())


if __name__ == "__main__":
    main(*sys.argv[1:])
