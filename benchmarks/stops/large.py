"""CPU seconds until a large mesh has stopped: ``PYTHONPATH=tests python -W ignore -m benchmarks.stops.large 0 10 20``.

A cube of about a million tets is stopped so many CPU seconds after it began, at the next call of its callback.
"""

import argparse
import time

from support.builders import kuhn_cube

import wct_plugin as wct
from wct_plugin.progress import Progress


class _Stop:
    """A callback that goes on for so many CPU seconds."""

    def __init__(self, after: float) -> None:
        self.began, self.after = time.process_time(), after
        self.asked, self.stage = 0.0, ""  #: seconds after which it said no, and where; 0 where it never did

    def __call__(self, said: Progress) -> bool:
        now = time.process_time() - self.began
        if now > self.after and not self.asked:
            self.asked, self.stage = now, said.stage
        return not self.asked


def main() -> None:
    """Print a row per stop: when it was asked for, in which stage, and how long it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float, nargs="+", help="after which it is stopped, each in a run of its own")
    parser.add_argument("--cells", type=int, default=56, help="along an edge of the cube; six tets to each")
    given = parser.parse_args()
    mesh = kuhn_cube(given.cells)
    print(f"{len(mesh.tets)} tets\n\n| asked after | in | over after so many s |\n|---:|---|---:|")  # noqa: T201
    for seconds in given.seconds:
        stop = _Stop(seconds)
        wct.apply_filter("meshing_well_centered", mesh, progress=stop)
        took = time.process_time() - stop.began - stop.asked
        print(f"| {stop.asked:.1f} | {stop.stage or 'it was never asked'} | {took:.1f} |")  # noqa: T201


if __name__ == "__main__":
    main()
