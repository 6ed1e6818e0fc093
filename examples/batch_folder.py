"""A folder of meshes: one broken file costs that file alone, and a second run does only what is left.

Run it: ``python examples/batch_folder.py [folder]``; it makes its own small meshes there.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

import wct_plugin as wct


def make_meshes(folder: Path, count: int) -> None:
    """Write ``count`` Delaunay meshes of random points, and a file that is none."""
    folder.mkdir(parents=True, exist_ok=True)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    for seed in range(count):
        points = np.vstack([corners, np.random.default_rng(seed).uniform(0.1, 0.9, (30, 3))])
        wct.write(folder / f"part{seed}.msh", wct.TetMesh(points, Delaunay(points).simplices))
    (folder / "broken.msh").write_text("no mesh at all")


def main(target: str = "parts") -> tuple[int, int]:
    """Give how many files were done by the first run and how many by the second one."""
    folder, out = Path(target), Path(target, "out")
    make_meshes(folder, 4)
    chain = wct.Filter.meshing_well_centered(goal="3wc")

    first = wct.run_batch(chain, [folder / "*.msh"], out, suffix="vtu", jobs=2, timeout=120)
    make_meshes(folder, 6)  # two more have come
    second = wct.run_batch(chain, [folder / "*.msh"], out, suffix="vtu", jobs=2, timeout=120, resume=True)

    good = [record for record in second.records if not record.failed]
    (failed,) = second.failed
    print(
        f"{first.done_now} files, then {second.done_now} more: {len(good)} are done, {Path(failed.input).name} failed:"
        f" {failed.cause}; see {second.html.name}"
    )
    assert (first.done_now, second.done_now, len(good)) == (5, 2, 6)
    assert all(record.after and record.after["3wc"] == 100 for record in good)
    return first.done_now, second.done_now


if __name__ == "__main__":
    main(*sys.argv[1:])
