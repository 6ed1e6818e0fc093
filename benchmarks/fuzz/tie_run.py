"""Many cases of near ties, one after the other: nothing in them can hang, and what raises is a finding."""

import time
import warnings

from benchmarks.fuzz import tie_case
from benchmarks.fuzz.findings import Finding, Findings


def run(seed: int, cases: int, seconds: float, findings: Findings) -> None:
    """Run so many cases of a seed, or as many as there is time for; findings are added to what there is."""
    end, number = time.monotonic() + seconds, 0
    while number < cases and time.monotonic() < end:
        points, tets = tie_case.make(seed, number)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                faults = tie_case.judged(points, tets)
            except Exception as error:
                faults = [f"{type(error).__name__} is raised: {error}"]
        findings.counts[f"tie meshes of {'one tet' if len(tets) == 1 else 'several tets'}"] += 1
        if faults:
            findings.add(Finding("tie", seed, number, "tie", tuple(faults)), None)
        number += 1
