"""Findings: each in a folder of its own, with its files, what was found, and the command that does it again."""

import json
import re
import shutil
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

#: Findings of one signature that are kept; the others are counted only.
_KEPT = 2


@dataclass(frozen=True)
class Finding:
    """What a judge found in a case."""

    kind: str  #: file or command
    seed: int
    number: int
    name: str  #: of the file that was read, or the command that was run
    faults: tuple[str, ...]
    said: str = ""

    @property
    def case(self) -> str:
        """The case, as ``--case`` takes it."""
        return f"{self.kind}:{self.seed}:{self.number}"

    @property
    def signature(self) -> str:
        """What findings with the same cause have in common, most likely: faults and words without their values."""
        told = f"{self.name.rpartition('.')[2]} {self.faults[0]} {self.said if 'message' in self.faults[0] else ''}"
        return re.sub(r"'[^']*'|\"[^\"]*\"|[-+]?[\d.]+(e[-+]?\d+)?", "#", told)[:200]


@dataclass
class Findings:
    """All findings of a run, and how many cases there were of which outcome."""

    folder: Path
    counts: Counter[str] = field(default_factory=Counter)
    found: Counter[str] = field(default_factory=Counter)
    first: dict[str, Finding] = field(default_factory=dict)

    def add(self, finding: Finding, files: Path | None) -> None:
        """Count a finding; the first ones of a signature are saved, with copies of the ``files`` of a folder."""
        self.found[finding.signature] += 1
        self.first.setdefault(finding.signature, finding)
        if self.found[finding.signature] > _KEPT:
            return
        place = self.folder / finding.case.replace(":", "-")
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        if files is not None:
            shutil.copytree(files, place / "files")
        told = {
            "case": finding.case, "what": finding.name, "faults": finding.faults, "said": finding.said,
            "again": f"python -m benchmarks.fuzz --case {finding.case}",
        }  # fmt: skip
        (place / "finding.json").write_text(json.dumps(told, indent=2, ensure_ascii=True) + "\n")

    def lines(self) -> list[str]:
        """What to print at the end: outcomes, then findings, the most frequent first."""
        lines = [f"{count:>8} {what}" for what, count in sorted(self.counts.items())]
        lines.append(f"{sum(self.found.values())} findings of {len(self.found)} kinds in {self.folder}")
        for signature, count in self.found.most_common():
            first = self.first[signature]
            lines.append(f"{count:>8} {first.case}  {first.name}: {'; '.join(first.faults)} {first.said}"[:300])
        return lines
