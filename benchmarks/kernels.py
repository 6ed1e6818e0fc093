"""Run the kernel benchmarks, if pytest-benchmark is there, and write their rates: ``python -m benchmarks.kernels``."""

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

_ROOT = Path(__file__).resolve().parents[1]


@click.command()
@click.option("--out", default=Path("build/bench"), type=click.Path(path_type=Path), show_default=True)
def main(out: Path) -> None:
    """Write kernels.md and kernels.json, pytest-benchmark's own record."""
    if find_spec("pytest_benchmark") is None:
        click.echo("kernels: pytest-benchmark is not installed", err=True)
        return
    out.mkdir(parents=True, exist_ok=True)
    record = (out / "kernels.json").resolve()
    options = ["--benchmark-timer=time.process_time", f"--benchmark-json={record}", "--benchmark-columns=median,iqr"]
    command = [sys.executable, "-m", "pytest", "-q", *options, "benchmarks/bench_kernels.py"]
    code = subprocess.run(command, cwd=_ROOT)
    if code.returncode:
        sys.exit(code.returncode)
    text = markdown(json.loads(record.read_text()))
    (out / "kernels.md").write_text(text)
    click.echo(text)


def markdown(record: dict[str, Any]) -> str:
    """Pytest-benchmark's record as a table of rates."""
    lines = ["# Kernels", "", "| kernel | rate | unit | median CPU ms | rounds |", "| --- | --- | --- | --- | --- |"]
    for row in record["benchmarks"]:
        name = row["name"].removeprefix("test_").replace("_", " ")
        stats, extra = row["stats"], row["extra_info"]
        median = 1e3 * stats["median"]
        lines.append(f"| {name} | {extra['rate']:.1f} | {extra['unit']} | {median:.1f} | {stats['rounds']} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    sys.exit(main())
