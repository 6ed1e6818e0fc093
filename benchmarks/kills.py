"""Kill -9 at random moments over ``optimize``, ``run`` and ``batch``: after each, every output is whole or as it was.

``python -m benchmarks.kills [COUNT]`` prints what was found as a table in Markdown.
"""

import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import wct_plugin as wct

_WCT = Path(sys.executable).with_name("wct")
_CHAIN = [{"type": "filters.meshing_well_centered", "goal": "delaunay"}]


@dataclass
class Found:
    """What a command left behind over many kills."""

    command: str
    kills: int = 0
    finished: int = 0  #: ended before the kill came
    old: int = 0  #: outputs that were as before
    new: int = 0  #: outputs that were whole and new
    broken: list[str] = field(default_factory=list)  #: outputs that were neither
    hidden: int = 0  #: hidden folders left beside them
    after: list[str] = field(default_factory=list)  #: what was left once the command had run to its end


def _kill(command: Sequence[str], folder: Path, after: float) -> bool:
    """Start a command and kill it after so many seconds; whether it was still at work."""
    process = subprocess.Popen(
        [_WCT, *command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, process_group=0
    )
    try:
        process.wait(after)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
    process.wait()
    return process.returncode == -signal.SIGKILL


def _is_whole(path: Path, tets: int) -> bool:
    try:
        mesh = wct.read(path)
    except wct.WctError:
        return False
    return isinstance(mesh, wct.TetMesh) and len(mesh.tets) >= tets


def _over(
    name: str, command: Sequence[str], outputs: Sequence[str], count: int, place: Path, random_: random.Random
) -> Found:
    """Kill the command ``count`` times; each of the outputs is an older mesh, or not there, when it starts."""
    found = Found(name)
    start = time.monotonic()
    subprocess.run([_WCT, *command], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    whole = time.monotonic() - start
    old = (place / "part1.vtu").read_bytes()  # another mesh than comes out
    for _ in range(count):
        for output in outputs:
            (place / output).write_bytes(old)
        killed = _kill(command, place, random_.uniform(0.2, 1.05) * whole)
        found.kills += killed
        found.finished += not killed
        for output in outputs:
            if (place / output).read_bytes() == old:
                found.old += 1
            elif _is_whole(place / output, 1):
                found.new += 1
            else:
                found.broken.append(output)
        found.hidden += len(list(place.glob(".*.wct-*")))
    subprocess.run([_WCT, *command], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    found.after = sorted(one.name for one in place.iterdir() if one.name.startswith("."))
    return found


def _over_batch(count: int, place: Path, random_: random.Random) -> Found:
    """Kill a batch ``count`` times, each going on with the one before or beginning anew."""
    found = Found("batch")
    command = ["batch", "chain.json", "part*.vtu", "-o", "out", "--jobs", "2", "--resume"]
    out = place / "out"
    start = time.monotonic()
    subprocess.run([_WCT, *command], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    whole = time.monotonic() - start
    for _ in range(count):
        if len(list(out.glob("*.vtu"))) == len(list(place.glob("part*.vtu"))):
            shutil.rmtree(out)
        killed = _kill(command, place, random_.uniform(0.3, 1.05) * whole)
        found.kills += killed
        found.finished += not killed
        for output in out.glob("*.vtu"):
            if _is_whole(output, 1):
                found.new += 1
            else:
                found.broken.append(output.name)
        found.hidden += len(list(out.glob(".wct-batch*/*")))
    subprocess.run([_WCT, *command], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    lines = (out / "manifest.jsonl").read_text().splitlines()
    named = [json.loads(line)["output"] for line in lines]
    if sorted(named) != sorted(one.name for one in place.glob("part*.vtu")):
        found.broken.append(f"manifest.jsonl with {len(named)} lines")
    found.after = sorted(one.name for one in out.iterdir() if one.name.startswith("."))
    return found


def run(count: int, seed: int = 0) -> list[Found]:
    """Kill each of the commands ``count`` times in a temporary folder."""
    random_ = random.Random(seed)
    makers: list[Callable[[Path], Found]] = [
        lambda place: _over(
            "optimize",
            ["optimize", "old.vtu", "out.vtu", "--goal", "delaunay", "--json", "out.json"],
            ["out.vtu"], count, place, random_,
        ),
        lambda place: _over(
            "run", ["run", "chain.json", "old.vtu", "a.vtu", "b.vtu"], ["a.vtu", "b.vtu"], count, place, random_
        ),
        lambda place: _over_batch(count, place, random_),
    ]  # fmt: skip
    done = []
    for make in makers:
        with tempfile.TemporaryDirectory(prefix="wct-kills-") as name:
            place = Path(name)
            for k, variant in enumerate(("194", "84", "194")):
                mesh, _ = wct.apply_filter("create_cube", variant=variant)
                wct.write(place / f"part{k}.vtu", mesh)
            shutil.copy(place / "part0.vtu", place / "old.vtu")
            (place / "chain.json").write_text(json.dumps(_CHAIN))
            done.append(make(place))
    return done


def main() -> None:
    """Print a row for each command."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 90
    rows = [
        "command | killed | ended before | outputs as before | new and whole | partial | hidden folders | after all"
    ]
    rows.append("--- | ---: | ---: | ---: | ---: | ---: | ---: | ---")
    for one in run(count):
        after = ", ".join(one.after) or "nothing hidden"
        counts = (one.kills, one.finished, one.old, one.new, len(one.broken), one.hidden)
        rows.append(f"`{one.command}` | {' | '.join(map(str, counts))} | {after}")
    print("\n".join(f"| {row} |" for row in rows))  # noqa: T201


if __name__ == "__main__":
    main()
