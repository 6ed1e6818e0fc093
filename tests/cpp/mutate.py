"""Changes of the operators and predicates, drawn by a seed, and whether the C++ tests notice them.

``python tests/cpp/mutate.py --count 200 --seed 1`` builds a copy of the core with WCT_CHECKS in build/mutants, changes
one place of it at a time, and writes build/mutants/table.md: what was changed where, and the test that noticed. A
change that does not compile is drawn again. What no test notices is run under the sanitizers at the end. It takes about
half a minute for each on an idle core, and ``--jobs`` of them are tried at a time, each in a copy of its own; what was
seen is kept, and a run with the same seed and sources goes on there.
"""

import argparse
import hashlib
import json
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from threading import Lock

import cmake
import ninja

ROOT = Path(__file__).parents[2]
WORK = ROOT / "build" / "mutants"
#: The builds: one whose library checks what it is asked, and what else CI runs the tests under, which looks at what the
#: first leaves.
BUILD, SANITIZED = "build", "sanitized"
FLAGS = {
    BUILD: "-O1 -DWCT_BASELINE -D_GLIBCXX_ASSERTIONS",
    SANITIZED: "-O1 -DWCT_BASELINE -fsanitize=address,undefined -fno-sanitize-recover=all",
}

#: What is changed: a pattern in the code, and what may take its place.
SWAPS = (
    (re.compile(r" (<=?|>=?) "), {"<": ("<=", ">"), "<=": ("<", ">"), ">": (">=", "<"), ">=": (">", "<")}),
    (re.compile(r" (==|!=) "), {"==": ("!=",), "!=": ("==",)}),
    (re.compile(r" ([-+*]) "), {"+": ("-",), "-": ("+",), "*": ("+",)}),
    (re.compile(r" ([-+]=) "), {"+=": ("-=",), "-=": ("+=",)}),
    (re.compile(r" (&&|\|\|) "), {"&&": ("||",), "||": ("&&",)}),
    (re.compile(r"\b(true|false)\b"), {"true": ("false",), "false": ("true",)}),
)
_CONSTANT = re.compile(r"(?<![\w.])(\d+)(?![\w.'])")
_CONDITION = re.compile(r"^\s*(?:\} else )?if \(")
#: Bytes that a build or a run may take: a changed loop may never end.
_MEMORY = 4 << 30
#: Lines without work: comments, directives, declarations of templates, checks that only this build has.
_IDLE = re.compile(r"^\s*(//|///|#|template|namespace|using|WCT_)|^\s*$")


@dataclass(frozen=True)
class Change:
    """One place, by line (from 0) and columns, and the text that takes its place."""

    path: Path  #: within the sources
    line: int
    start: int
    end: int
    text: str

    def applied(self, lines: list[str]) -> str:
        line = lines[self.line]
        changed = line[: self.start] + self.text + line[self.end :]
        return "\n".join([*lines[: self.line], changed, *lines[self.line + 1 :]])

    def described(self, lines: list[str]) -> str:
        line = lines[self.line]
        return f"`{line[self.start : self.end]}` to `{self.text}` in `{line.strip()}`".replace("|", "\\|")


def condition_of(line: str) -> tuple[int, int] | None:
    """The columns of what stands in the parentheses of an ``if``, where they close on the same line."""
    found = _CONDITION.match(line)
    if not found:
        return None
    depth = 1
    for column in range(found.end(), len(line)):
        depth += {"(": 1, ")": -1}.get(line[column], 0)
        if depth == 0:
            return found.end(), column
    return None


def changes_of(path: Path) -> Iterator[Change]:
    for number, line in enumerate((ROOT / path).read_text(encoding="utf-8").split("\n")):
        code = line.split(" //")[0]
        if _IDLE.match(code):
            continue
        for pattern, others in SWAPS:
            for found in pattern.finditer(code):
                for text in others[found[1]]:
                    yield Change(path, number, found.start(1), found.end(1), text)
        for found in _CONSTANT.finditer(code):
            yield Change(path, number, found.start(1), found.end(1), str(int(found[1]) + 1))
        condition = condition_of(code)
        if condition:
            start, end = condition
            if ";" not in code[start:end]:
                yield Change(path, number, start, end, f"!({code[start:end]})")
                yield Change(path, number, start, end, "false")


def command(*words: str | Path, timeout: float | None = None, limited: bool = True) -> tuple[int, str]:
    """Exit status, -1 where it took too long, and what was said; ``limited``: it may take so much memory."""
    limit = ("prlimit", f"--as={_MEMORY}") if limited else ()  # the sanitizers' shadows take more room than there is
    try:
        done = subprocess.run(
            [*limit, *words], capture_output=True, text=True, check=False, timeout=timeout, errors="replace"
        )
    except subprocess.TimeoutExpired:
        return -1, ""
    return done.returncode, done.stdout + done.stderr


@dataclass(frozen=True)
class Copy:
    """Sources of their own and their builds, in which one change at a time is made."""

    folder: Path

    def fill(self) -> None:
        """Make the sources anew."""
        shutil.rmtree(self.folder, ignore_errors=True)  # a copy that was left changed would not be compiled again
        for folder in ("cpp", "tests/cpp"):
            shutil.copytree(ROOT / folder, self.folder / "source" / folder)
        shutil.copy(ROOT / "CMakeLists.txt", self.folder / "source")

    def prepare(self, name: str) -> None:
        """Make one of the builds."""
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        options = ["-DWCT_TESTS=ON", "-DWCT_CHECKS=ON", "-DCMAKE_BUILD_TYPE=None"]
        maker = f"-DCMAKE_MAKE_PROGRAM={Path(ninja.BIN_DIR) / 'ninja'}"
        places = ("-S", self.folder / "source", "-B", self.folder / name)
        words = ("-G", "Ninja", maker, *options, f"-DCMAKE_CXX_FLAGS={FLAGS[name]}", *launcher)
        code, said = command(Path(cmake.CMAKE_BIN_DIR) / "cmake", *places, *words)
        if code or not self._build(name):
            sys.exit(f"the core does not build\n{said[-4000:]}")

    def check(self, name: str, *chosen: str) -> float:
        """See that the tests chosen pass; the seconds that they take."""
        began = time.monotonic()
        if noticed := self._verdict(name, 3600.0, *chosen):
            sys.exit(f"without any change this test fails: {noticed}")
        return time.monotonic() - began

    def tried(self, change: Change, seconds: float, *, sanitized: bool) -> str | None:
        """The test that notices a change, "" where none does, None where it does not compile."""
        path = self.folder / "source" / change.path
        original = path.read_text(encoding="utf-8")
        path.write_text(change.applied(original.split("\n")), encoding="utf-8")
        beside = f"=*/tests/cpp/{change.path.parent.name}*"  # tests that notice most
        longest = 30.0 + 3.0 * seconds
        name = SANITIZED if sanitized else BUILD
        try:
            if not self._build(name):
                return None
            first = self._verdict(name, 4.0 * longest if sanitized else longest, f"--source-file{beside}")
            return first if first or sanitized else self._verdict(name, longest, f"--source-file-exclude{beside}")
        finally:
            path.write_text(original, encoding="utf-8")

    def _build(self, name: str) -> bool:
        tool = Path(cmake.CMAKE_BIN_DIR) / "cmake"
        return command(tool, "--build", self.folder / name, "--target", "wct_tests")[0] == 0

    def _verdict(self, name: str, timeout: float, *chosen: str) -> str:
        """The test that notices, of those chosen, empty where none does."""
        program = self.folder / name / "tests" / "cpp" / "wct_tests"
        code, said = command(program, "--abort-after=1", *chosen, timeout=timeout, limited=name != SANITIZED)
        if code == 0:
            return ""
        if code == -1:
            return "takes too long"
        found = re.search(r"TEST CASE:\s*(.*)", said)
        return found[1] if found else f"ends with {code}"


class Seen:
    """What is known of the changes drawn, kept in a file as long as sources, tests and builds are the same."""

    def __init__(self, seed: int, drawn: list[Change]) -> None:
        folders = (ROOT / "cpp", ROOT / "tests" / "cpp")
        sources = [path for folder in folders for path in sorted(folder.rglob("*")) if path.suffix in (".cpp", ".h")]
        known = [str(FLAGS).encode(), *(path.read_bytes() for path in sources)]
        digest = hashlib.sha256(b"".join(known)).hexdigest()[:12]
        self._file = WORK / f"seen_{seed}_{digest}.json"
        self._seed, self._drawn, self._lock = seed, drawn, Lock()
        #: By the number of the change: the test that notices; "": none does; None: it does not compile.
        self.noticed: dict[int, str | None] = {}
        if self._file.exists():
            self.noticed = {int(k): test for k, test in json.loads(self._file.read_text(encoding="utf-8")).items()}

    def add(self, k: int, test: str | None) -> None:
        with self._lock:
            self.noticed[k] = test
            self._file.write_text(json.dumps(self.noticed), encoding="utf-8")
            self._write_table()
            sys.stderr.write(f"{len(self.compiled())}: {test}\n")

    def compiled(self) -> list[int]:
        return [k for k, test in list(self.noticed.items()) if test is not None]

    def _write_table(self) -> None:
        rows = []
        for k in self.compiled():
            change = self._drawn[k]
            place = f"{change.path}:{change.line + 1}"
            lines = (ROOT / change.path).read_text(encoding="utf-8").split("\n")
            rows.append(f"| {place} | {change.described(lines)} | {self.noticed[k] or '**survives**'} |")
        killed = sum(bool(self.noticed[k]) for k in self.compiled())
        head = f"{killed} of {len(rows)} changes are noticed (seed {self._seed}, {len(self._drawn)} places).\n\n"
        table = head + "| place | change | noticed by |\n|---|---|---|\n" + "\n".join(rows) + "\n"
        (WORK / "table.md").write_text(table, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=200, help="changes that compile")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="how many are tried at a time")
    asked = parser.parse_args()
    copies = [Copy(WORK / str(job)) for job in range(asked.jobs)]
    for copy in copies:
        copy.fill()
        copy.prepare(BUILD)
    seconds = copies[0].check(BUILD)
    sources = [*sorted((ROOT / "cpp" / "search").glob("*.cpp")), ROOT / "cpp" / "geometry" / "predicates.cpp"]
    files = [path.relative_to(ROOT) for path in sources if path.name != "checks.cpp"]
    drawn = [change for path in files for change in changes_of(path)]
    random.Random(asked.seed).shuffle(drawn)
    seen = Seen(asked.seed, drawn)

    def work(copy: Copy, numbers: Iterator[int], *, sanitized: bool) -> None:
        for k in numbers:
            seen.add(k, copy.tried(drawn[k], seconds, sanitized=sanitized))

    def share(numbers: Iterator[int], *, sanitized: bool) -> None:
        one_by_one = _Shared(numbers)
        with ThreadPoolExecutor(len(copies)) as pool:
            for done in [pool.submit(work, copy, one_by_one, sanitized=sanitized) for copy in copies]:
                done.result()

    new = (k for k in range(len(drawn)) if k not in seen.noticed)
    share(takewhile(lambda _: len(seen.compiled()) < asked.count, new), sanitized=False)
    for copy in copies:
        copy.prepare(SANITIZED)
    copies[0].check(SANITIZED, "--source-file=*/tests/cpp/search*")
    share(iter([k for k in seen.compiled() if not seen.noticed[k]]), sanitized=True)
    sys.stderr.write((WORK / "table.md").read_text(encoding="utf-8"))


class _Shared(Iterator[int]):
    """An iterator that several threads take from."""

    def __init__(self, numbers: Iterator[int]) -> None:
        self._numbers, self._lock = numbers, Lock()

    def __next__(self) -> int:
        with self._lock:
            return next(self._numbers)


if __name__ == "__main__":
    main()
