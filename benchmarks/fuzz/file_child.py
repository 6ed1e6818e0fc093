"""The child that reads mutated files, many one after the other: ``python -m benchmarks.fuzz.file_child``.

Before each case it prints the number, after it a line of JSON where there is a fault; so that of a child that dies
the case is known. Which cases are its own is told by its arguments.
"""

import json
import resource
import sys
import tempfile
from collections import Counter
from dataclasses import asdict
from pathlib import Path

from benchmarks.fuzz import file_case, seed_files, telling

#: Address space of the child.
SPACE = 6 << 30


def main() -> None:
    """Run the cases ``first`` to ``last`` of a seed."""
    seed, first, last = map(int, sys.argv[2:5])
    tell = telling.alone()
    seeds = seed_files.made(Path(sys.argv[1]))
    import wct_plugin as wct

    for place in seeds:  # imports what readers import, so that no case pays for it
        try:
            wct.read(seed_files.main_file(place))
        except wct.WctError:
            continue
    resource.setrlimit(resource.RLIMIT_AS, (SPACE, SPACE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
        for number in range(first, last):
            tell(str(number))
            place = Path(name) / str(number)
            place.mkdir()
            path = file_case.make(seeds, seed, number, place)
            outcome = file_case.read_and_judge(path)
            counts[f"{path.suffixes[0]} {outcome.what}"] += 1
            if outcome.faults:
                tell(json.dumps({"number": number, "file": path.name, **asdict(outcome)}))
            for left in place.iterdir():
                left.unlink()
            place.rmdir()
    tell(json.dumps({"counts": counts}))


if __name__ == "__main__":
    main()
