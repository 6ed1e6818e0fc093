"""``devsim`` and ``fipy`` as the examples make them ready, and what DEVSIM makes of a mesh."""

import numpy as np
from devices.fipy_meshes import fipy
from devices.laplace import DEVICE, devsim, load, unload

__all__ = ["devsim", "fipy", "node_volumes"]


def node_volumes(path, regions):
    """{region: (n,) volumes} that DEVSIM gives the nodes of the named regions of a gmsh file."""
    load(path, dict.fromkeys(regions), {}, {})
    try:
        return {
            region: np.array(devsim.get_node_model_values(device=DEVICE, region=region, name="NodeVolume"))
            for region in regions
        }
    finally:
        unload()
