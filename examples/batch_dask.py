"""The same batch on the workers of a dask scheduler, here two processes on this machine.

``pip install '.[distributed]'`` in the clone. Run it: ``python examples/batch_dask.py [tcp://host:8786]``, with the
address of a scheduler whose workers see this directory, or without one. The command line does the same:
``wct batch dec-ready '*.vtu' -o out --scheduler tcp://host:8786``.
"""

import sys
from contextlib import nullcontext
from pathlib import Path

from batch_folder import make_meshes
from distributed import LocalCluster

import wct_plugin as wct


def main(address: str | None = None) -> int:
    """Give how many files were done."""
    make_meshes(Path("meshes"), 4)
    chain = wct.Filter.meshing_well_centered(goal="3wc")
    local = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) if address is None else None
    with local or nullcontext():
        scheduler = address or local.scheduler_address
        done = wct.run_batch(chain, ["meshes/part*.msh"], "out", suffix="vtu", scheduler=scheduler, retry_failed=True)
    print(f"{len(done.records)} files by the workers of {scheduler}, {len(done.failed)} failed")
    assert not done.exit_code
    return len(done.records)


if __name__ == "__main__":
    main(*sys.argv[1:])
