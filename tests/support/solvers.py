"""``devsim`` and ``fipy``, which cannot be imported as they are, and what DEVSIM makes of a mesh.

DEVSIM wants a LAPACK to be named before, and the wheel of cvxopt has one. FiPy uses parts of NumPy that are on their
way out, which would be errors here.
"""

import importlib
import os
import warnings
from pathlib import Path

import cvxopt
import numpy as np

(_LAPACK,) = (Path(cvxopt.__file__).parents[1] / "cvxopt.libs").glob("libopenblas*")
os.environ.setdefault("DEVSIM_MATH_LIBS", str(_LAPACK))
devsim = importlib.import_module("devsim")
with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    fipy = importlib.import_module("fipy")


def node_volumes(path, regions):
    """{region: (n,) volumes} that DEVSIM gives the nodes of the named regions of a gmsh file."""
    devsim.create_gmsh_mesh(mesh="m", file=str(path))
    for region in regions:
        devsim.add_gmsh_region(mesh="m", gmsh_name=region, region=region, material="any")
    devsim.finalize_mesh(mesh="m")
    devsim.create_device(mesh="m", device="d")
    try:
        return {
            region: np.array(devsim.get_node_model_values(device="d", region=region, name="NodeVolume"))
            for region in regions
        }
    finally:
        devsim.delete_device(device="d")
        devsim.delete_mesh(mesh="m")
