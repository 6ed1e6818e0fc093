"""Commands as a reader of the documents would type them."""

import os
import subprocess
import sys
from pathlib import Path

#: Where the package's own commands are, first.
PATH = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"


def type_in(command: list[str], place: Path) -> str:
    """Run a command where the package's own are on the PATH; it has to succeed. What it printed."""
    environment = os.environ | {"PATH": PATH}
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, f"{command[-1]}\n{done.stderr}"
    return done.stdout
