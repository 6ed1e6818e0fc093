"""One run of a filter that is stopped at every call of its progress callback, each time in a process of its own.

``python stopping.py mesh.vtu filter '{"option": value}' 60`` forks at every call, 60 times at most. The child stops
there and checks what it is given; the parent goes on, to the end of the run, or stops too after so many calls.
Prints how many children stopped in each phase of the work.
"""

import json
import os
import sys
import traceback
import warnings
from collections import Counter

import numpy as np

from wct_plugin import apply_filter, read
from wct_plugin.measure import quality
from wct_plugin.measure.goals import misses
from wct_plugin.mesh import TetMesh


def volumes(mesh: TetMesh) -> np.ndarray:
    """Of the tets, six times."""
    a, b, c, d = np.moveaxis(mesh.points[mesh.tets], 1, 0)
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)


def check(old: TetMesh, new: TetMesh, metrics: dict, goal: str) -> None:
    """A mesh of positive tets that fills what the old one filled, with no greater share of bad tets."""
    assert metrics["stopped"], "the metrics do not say that it was stopped"
    TetMesh(new.points, new.tets)  # indices, twins, flat tets
    assert (volumes(new) > 0).all()
    assert abs(volumes(new).sum() / volumes(old).sum() - 1.0) < 0.05
    assert set(new.regions.tolist()) == set(old.regions.tolist())
    assert not np.isnan(new.points).any()
    before, after = (misses(mesh, quality.measure(mesh), goal).mean() for mesh in (old, new))
    assert after <= before, (before, after)


def main(path: str, name: str, options: dict, most: int) -> None:
    """Run, fork, check and print."""
    warnings.simplefilter("ignore")
    mesh = read(path)
    parent, stopped = os.getpid(), Counter()

    def progress(state) -> bool:
        if os.getpid() != parent:
            return False
        if stopped.total() == most:
            return False
        phase = state.stage.partition(",")[0]
        if phase == "measuring":  # all is done
            return True
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            return False
        status = os.waitpid(child, 0)[1]
        assert status == 0, f"stopped at call {stopped.total()}, {phase}: status {status}"
        stopped[phase] += 1
        return True

    try:
        new, metrics = apply_filter(name, mesh, progress=progress, **options)
        if os.getpid() != parent or stopped.total() == most:
            check(mesh, new, metrics, options.get("goal", "cwc"))
        if os.getpid() != parent:
            os._exit(0)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
    sys.stdout.write(json.dumps(stopped))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], json.loads(sys.argv[3]), int(sys.argv[4]))
