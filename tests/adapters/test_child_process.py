"""Programs run as children: what they print, how they end, and that nothing of theirs survives."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.processes import wait_until, working_in

from wct_plugin.adapters import child_process, ftetwild, tetgen
from wct_plugin.errors import NeighbourError

FAMILY = ["sh", "-c", "sleep 60 & sleep 60 & wait"]


def test_output_is_both_streams_and_stdin_is_empty(tmp_path: Path) -> None:
    assert child_process.run(["sh", "-c", "pwd; echo words >&2; cat"], tmp_path, None, "Sh") == f"{tmp_path}\nwords\n"


def test_an_exit_code_and_the_last_words(tmp_path: Path) -> None:
    with pytest.raises(
        child_process.ChildError, match=r"^Sh failed with exit code 3; it last said: two \| three$"
    ) as caught:
        child_process.run(["sh", "-c", "echo one; echo; echo ' two'; echo three; exit 3"], tmp_path, None, "Sh")
    assert caught.value.output == "one\n\n two\nthree\n"


def test_a_signal(tmp_path: Path) -> None:
    with pytest.raises(child_process.ChildError, match=r"^Sh crashed with SIGABRT$"):
        child_process.run(["sh", "-c", "kill -ABRT $$"], tmp_path, None, "Sh")


def test_a_folder_or_program_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(NeighbourError, match=r"^Sh cannot be started: No such file or directory$"):
        child_process.run(["sh"], tmp_path / "none", None, "Sh")
    with pytest.raises(NeighbourError, match=r"^Nothing .*no-such-program.*No such file or directory"):
        child_process.run(["no-such-program"], tmp_path, None, "Nothing")


def test_a_timeout_ends_the_whole_family(tmp_path: Path) -> None:
    start = time.monotonic()
    with pytest.raises(NeighbourError, match=r"^Sh was stopped after 0\.3 s, its timeout; less is faster$"):
        child_process.run(FAMILY, tmp_path, 0.3, "Sh", advice="less is faster")
    assert time.monotonic() - start < 10
    wait_until(lambda: not working_in(tmp_path), 2)


def test_ctrl_c_ends_the_whole_family(tmp_path: Path) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    old = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(KeyboardInterrupt):
            child_process.run(FAMILY, tmp_path, None, "Sh")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)
    wait_until(lambda: not working_in(tmp_path), 2)


def test_it_does_not_outlive_us(tmp_path: Path) -> None:
    """Whoever kills a batch kills its processes, which cannot answer."""
    code = "import sys; from wct_plugin.adapters import child_process; "
    code += "child_process.run(['sleep', '60'], sys.argv[1], None, 'Sleep')"
    with subprocess.Popen([sys.executable, "-c", code, tmp_path]) as parent:
        wait_until(lambda: any(command.startswith("sleep") for command in working_in(tmp_path)))
        os.kill(parent.pid, signal.SIGKILL)
    wait_until(lambda: not working_in(tmp_path), 2)


def test_a_memory_limit(tmp_path: Path) -> None:
    command = [sys.executable, "-c", "import time; time.sleep(0.2); print(len(bytes(300 << 20)))"]
    assert child_process.run(command, tmp_path, None, "Python", memory=1 << 30) == f"{300 << 20}\n"
    with pytest.raises(child_process.ChildError, match=r"^Python failed with exit code 1; .*MemoryError$"):
        child_process.run(command, tmp_path, None, "Python", memory=200 << 20)


def test_what_is_printed_is_heard_while_it_runs(tmp_path: Path) -> None:
    heard: list[str] = []
    script = "import time; print('pass 1', flush=True); time.sleep(1.5); print('pass 2', flush=True)"
    said = child_process.run([sys.executable, "-c", script], tmp_path, None, "It", heard=heard.append)
    assert heard[0] == "pass 1\n"
    assert said == "pass 1\npass 2\n"


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("Loading mesh...\n", ""),
        ("max_energy = 68.4528\navg_energy = 6.5\n", "worst energy 68.5"),
        ("//////////////// pass 0 ////////////////\nmax_energy = 13.474\nmax_energy = 12", "pass 1, worst energy 13.5"),
        (
            "/// pass 3 ///\nmax_energy = 9.4\n//////////// postprocessing ////////////\n",
            "postprocessing, worst energy 9.4",
        ),
    ],
)
def test_where_ftetwild_stands(said: str, words: str) -> None:
    assert ftetwild._standing(said) == words


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("Opening surface.poly.\n", ""),
        ("Delaunizing vertices...\nDelaunay seconds:  0.006\nCreating surface mesh ...\n", "creating surface mesh"),
        ("Refining mesh...\n", "refining mesh"),
    ],
)
def test_where_tetgen_stands(said: str, words: str) -> None:
    assert tetgen._standing(said) == words
