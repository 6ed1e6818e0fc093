"""Changes of the operators and predicates, drawn by a seed, and whether the C++ tests notice them.

``python tests/cpp/mutate.py --count 200 --seed 1`` builds a copy of the core with WCT_CHECKS in build/mutants, changes
one place of it at a time, and writes build/mutants/table.md: what was changed where, and the test that noticed. A
change that does not compile is drawn again. What no test notices is run under the sanitizers at the end. It takes about
half a minute for each on an idle core; what was seen is kept, and a run with the same seed and sources goes on there.
"""

import argparse
import hashlib
import json
import random
import re
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cmake
import ninja

ROOT = Path(__file__).parents[2]
WORK = ROOT / "build" / "mutants"
SOURCE = WORK / "source"
BUILD = WORK / "build"
#: The same with what else CI runs the tests under: what the first leaves is looked at by this one.
SANITIZED = WORK / "sanitized"
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

    path: Path
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
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n")):
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
    """Exit status, -1 where it took too long, and what was said."""
    memory = _MEMORY if limited else resource.RLIM_INFINITY  # the sanitizers' shadows take more room than there is

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    try:
        done = subprocess.run(
            words, capture_output=True, text=True, check=False, timeout=timeout, errors="replace", preexec_fn=limit
        )
    except subprocess.TimeoutExpired:
        return -1, ""
    return done.returncode, done.stdout + done.stderr


def build(folder: Path = BUILD) -> bool:
    return command(Path(cmake.CMAKE_BIN_DIR) / "cmake", "--build", folder, "--target", "wct_tests")[0] == 0


def verdict(timeout: float, tests: str = "", folder: Path = BUILD) -> str:
    """The test that notices, of those in a folder of tests, empty where none does."""
    words = (folder / "tests" / "cpp" / "wct_tests", "--abort-after=1", f"--source-file=*/tests/cpp/{tests}*")
    code, said = command(*words, timeout=timeout, limited=folder != SANITIZED)
    if code == 0:
        return ""
    if code == -1:
        return "takes too long"
    found = re.search(r"TEST CASE:\s*(.*)", said)
    return found[1] if found else f"ends with {code}"


def prepare() -> float:
    """A copy that passes; the seconds that its tests take."""
    for folder in (SOURCE, *FLAGS):
        shutil.rmtree(folder, ignore_errors=True)  # a copy that was left changed would not be compiled again
    for folder in ("cpp", "tests/cpp"):
        shutil.copytree(ROOT / folder, SOURCE / folder)
    shutil.copy(ROOT / "CMakeLists.txt", SOURCE)
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    options = ["-DWCT_TESTS=ON", "-DWCT_CHECKS=ON", "-DCMAKE_BUILD_TYPE=None"]
    maker = f"-DCMAKE_MAKE_PROGRAM={Path(ninja.BIN_DIR) / 'ninja'}"
    tool = Path(cmake.CMAKE_BIN_DIR) / "cmake"
    for folder, flags in FLAGS.items():
        words = ("-S", SOURCE, "-B", folder, "-G", "Ninja", maker, *options, f"-DCMAKE_CXX_FLAGS={flags}", *launcher)
        code, said = command(tool, *words)
        if code or not build(folder):
            sys.exit(f"the core does not build\n{said[-4000:]}")
    began = time.monotonic()
    noticed = verdict(timeout=3600.0)
    noticed = noticed or verdict(3600.0, "search", SANITIZED)
    if noticed:
        sys.exit(f"without any change this test fails: {noticed}")
    return time.monotonic() - began


class Seen:
    """What is known of the changes drawn, kept in a file as long as sources, tests and builds are the same."""

    def __init__(self, seed: int, drawn: list[Change]) -> None:
        sources = sorted((SOURCE / "cpp").rglob("*.[ch]*")) + sorted((SOURCE / "tests" / "cpp").rglob("*.[ch]*"))
        known = [str(FLAGS).encode(), *(path.read_bytes() for path in sources)]
        digest = hashlib.sha256(b"".join(known)).hexdigest()[:12]
        self._file = WORK / f"seen_{seed}_{digest}.json"
        self._seed, self._drawn = seed, drawn
        #: By the number of the change: the test that notices; "": none does; None: it does not compile.
        self.noticed: dict[int, str | None] = {}
        if self._file.exists():
            self.noticed = {int(k): test for k, test in json.loads(self._file.read_text(encoding="utf-8")).items()}

    def add(self, k: int, test: str | None) -> None:
        self.noticed[k] = test
        self._file.write_text(json.dumps(self.noticed), encoding="utf-8")
        self._write_table()

    def compiled(self) -> list[int]:
        return [k for k, test in self.noticed.items() if test is not None]

    def _write_table(self) -> None:
        rows = []
        for k in self.compiled():
            change = self._drawn[k]
            place = f"{change.path.relative_to(SOURCE)}:{change.line + 1}"
            lines = change.path.read_text(encoding="utf-8").split("\n")
            rows.append(f"| {place} | {change.described(lines)} | {self.noticed[k] or '**survives**'} |")
        killed = sum(bool(self.noticed[k]) for k in self.compiled())
        head = f"{killed} of {len(rows)} changes are noticed (seed {self._seed}, {len(self._drawn)} places).\n\n"
        table = head + "| place | change | noticed by |\n|---|---|---|\n" + "\n".join(rows) + "\n"
        (WORK / "table.md").write_text(table, encoding="utf-8")


def tried(change: Change, seconds: float, *, sanitized: bool) -> str | None:
    """The test that notices a change, "" where none does, None where it does not compile."""
    original = change.path.read_text(encoding="utf-8")
    change.path.write_text(change.applied(original.split("\n")), encoding="utf-8")
    beside = change.path.parent.name  # tests that notice most
    longest = 60.0 + 6.0 * seconds
    try:
        if sanitized:
            return verdict(4.0 * longest, beside, SANITIZED) if build(SANITIZED) else None
        return (verdict(longest, beside) or verdict(longest)) if build() else None
    finally:
        change.path.write_text(original, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=200, help="changes that compile")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    seconds = prepare()
    files = [*sorted((SOURCE / "cpp" / "search").glob("*.cpp")), SOURCE / "cpp" / "geometry" / "predicates.cpp"]
    drawn = [change for path in files if path.name != "checks.cpp" for change in changes_of(path)]
    random.Random(asked.seed).shuffle(drawn)
    seen = Seen(asked.seed, drawn)
    for k, change in enumerate(drawn):
        if len(seen.compiled()) >= asked.count:
            break
        if k not in seen.noticed:
            seen.add(k, tried(change, seconds, sanitized=False))
            sys.stderr.write(f"{len(seen.compiled())}: {seen.noticed[k]}\n")
    for k in [k for k in seen.compiled() if not seen.noticed[k]]:
        seen.add(k, tried(drawn[k], seconds, sanitized=True))
    sys.stderr.write((WORK / "table.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
