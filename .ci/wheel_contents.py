"""Look into the wheel and the source archive in a folder: they hold what they should, and the wheel nothing else."""

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path


def wheel(path: Path) -> None:
    """Our packages as git has them, the compiled core, and no C++."""
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    assert tops == {"wct_plugin"}, f"top-level names in the wheel: {tops}"
    ours = subprocess.run(
        ["git", "ls-files", "wct_plugin", "filters"], capture_output=True, text=True, check=True
    ).stdout
    wanted = {f"wct_plugin/{name}" if name.startswith("filters/") else name for name in ours.splitlines()}
    assert len(wanted) > 150, wanted
    assert wanted <= set(names), f"the wheel lacks {sorted(wanted - set(names))}"
    compiled = [name for name in names if name.startswith("wct_plugin/core/_core.") and not name.endswith(".pyi")]
    assert compiled, "no compiled core"
    source = [name for name in names if name.endswith((".cpp", ".h", ".a", ".cmake"))]
    assert not source, f"C++ source or library in the wheel: {source}"


def source_archive(path: Path) -> None:
    """What it takes to build."""
    with tarfile.open(path) as archive:
        names = archive.getnames()
    for needed in ("CMakeLists.txt", "cpp/bindings/module.cpp", "filters/get_quality.py", "LICENSE"):
        assert any(name.endswith("/" + needed) for name in names), f"the source archive lacks {needed}"


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    wheel(next(folder.glob("*.whl")))
    source_archive(next(folder.glob("*.tar.gz")))
    print("wheel and source archive hold what they should")  # noqa: T201
