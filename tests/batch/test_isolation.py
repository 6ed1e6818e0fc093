"""What a job does to its own process, in native code or not, is one line in its record and nobody else's loss."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.builders import kuhn_cube
from support.processes import children, wait_until

import wct_plugin as wct
from wct_plugin.batch import process_sessions, starters
from wct_plugin.batch.isolation import ForkServer, run_isolated
from wct_plugin.batch.job import Job
from wct_plugin.errors import OptionError

#: A filter of another package that breaks in the way that the file's name says.
BREAKER = '''
import ctypes, os, signal, subprocess, sys, time
from wct_plugin.mesh import TetMesh
from wct_plugin.plugins import FilterStage, Options

class Breaker(FilterStage[Options]):
    """Break."""
    name, takes, gives, declaration = "meshing_breaker", TetMesh, TetMesh, Options

    def run(self, mesh, progress):
        match os.path.basename(mesh.source).removesuffix(".vtu"):
            case "segfault":
                ctypes.string_at(0)
            case "abort":
                os.write(2, b"terminate called after throwing an instance of 'std::bad_alloc'\\n")
                os.abort()
            case "exit":
                print("no licence")
                os._exit(3)
            case "sys_exit":
                sys.exit("done with it")
            case "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            case "hang":
                signal.signal(signal.SIGTERM, signal.SIG_IGN)
                subprocess.Popen(["sh", "-c", "sleep 987 & wait"], process_group=0)
                while True:
                    time.sleep(1)
            case "orphan":
                subprocess.Popen(["sh", "-c", "sleep 986 &"], process_group=0).wait()
            case "greedy":
                hoard = []
                while True:
                    hoard.append(bytearray(1 << 24))
            case "memory_error":
                bytearray(1 << 60)
            case "bug":
                1 / 0
            case "recursion":
                def deeper(): return deeper()
                deeper()
        return mesh, {}
'''
CAUSES = {
    "abort": "crashed with SIGABRT; it last said: terminate called after throwing an instance of 'std::bad_alloc'",
    "bug": "internal error in stage 2 of 3 (filters.meshing_breaker), please report it: ZeroDivisionError: division",
    "exit": "ended without a result, exit code 3; it last said: no licence",
    "good": "",
    "greedy": "was stopped when it used ",
    "hang": "was stopped after ",
    "killed": "was killed, most likely because the system ran out of memory",
    "memory_error": "ran out of memory",
    "orphan": "",
    "recursion": "internal error in stage 2 of 3 (filters.meshing_breaker), please report it: RecursionError: maximum",
    "segfault": "crashed with SIGSEGV",
    "sys_exit": "internal error, please report it: SystemExit: done with it",
}


def commands(word):
    """Processes of anyone whose command line has ``word`` in it."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except OSError:
            continue
        if word in line:
            found.append(line)
    return found


def breaker(site, monkeypatch):
    """Install the filter that breaks."""
    info = site / "wct_breaker-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "wct_breaker.py").write_text(BREAKER)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: wct_breaker\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[wct_plugin.filters]\nmeshing_breaker = wct_breaker:Breaker\n")
    monkeypatch.syspath_prepend(str(site))


@pytest.fixture(params=["forked", "spawned"])
def starting(request, monkeypatch):
    """How jobs are started: as on Linux, and as on Windows and macOS."""
    monkeypatch.setattr(starters, "forks", lambda: request.param == "forked")
    return request.param


def test_every_way_to_break_costs_one_file(starting, tmp_path, monkeypatch):
    breaker(tmp_path / "site", monkeypatch)
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)  # the last words are heard without it
    monkeypatch.chdir(tmp_path)
    forked = starting == "forked"
    causes = dict(CAUSES)
    if not forked:  # then nothing stops it
        del causes["greedy"]
    for name in causes:
        wct.write(f"{name}.vtu", kuhn_cube(1))
    chain, limit = wct.Filter.meshing_breaker(), 400 if forked else None
    start = time.monotonic()
    done = wct.run_batch(chain, ["*.vtu"], "out", jobs=3, timeout=3 if forked else 8, memory_limit=limit)
    assert time.monotonic() - start < 100
    for record in done.records:
        cause = causes[record.input.removesuffix(".vtu")]
        assert (record.cause or "").startswith(cause), record.cause
        assert record.failed == bool(cause)
        assert Path("out", record.input).exists() != record.failed
    assert len(done.records) == len(causes)
    wait_until(lambda: not commands("sleep 987") and not commands("sleep 986"), 5)


def test_spawned_jobs_give_what_forked_ones_do(tmp_path, monkeypatch):
    """The same bits, and what they took."""
    monkeypatch.chdir(tmp_path)
    wct.write("a.vtu", kuhn_cube(2))
    chain = wct.Filter.meshing_well_centered(goal="delaunay")
    forked = wct.run_batch(chain, ["a.vtu"], "forked").records[0]
    monkeypatch.setattr(starters, "forks", lambda: False)
    spawned = wct.run_batch(chain, ["a.vtu"], "spawned").records[0]
    assert (spawned.exit_code, spawned.files, spawned.after) == (forked.exit_code, forked.files, forked.after)
    assert spawned.cpu_seconds > 0
    assert spawned.peak_bytes > 20 << 20
    with pytest.raises(OptionError, match="memory_limit cannot be kept"):
        wct.run_batch(chain, ["a.vtu"], "limited", memory_limit=100)


CALLER = """
import sys
from wct_plugin.batch import starters
starters.forks = lambda: False
import wct_plugin as wct
wct.run_batch(wct.Filter.meshing_breaker(), ["hang.vtu"], "out")
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_spawned_job_ends_with_its_caller(how, tmp_path, monkeypatch):
    breaker(tmp_path / "site", monkeypatch)
    monkeypatch.chdir(tmp_path)
    wct.write("hang.vtu", kuhn_cube(1))
    Path("caller.py").write_text(CALLER)
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "site")}
    with subprocess.Popen([sys.executable, "caller.py"], env=environment, stderr=subprocess.DEVNULL) as caller:
        wait_until(lambda: commands("sleep 987"), 60)
        caller.send_signal(how)
        caller.wait(20)
    wait_until(lambda: not commands("sleep 987") and not commands("batch.spawning"), 10)


def test_the_server_ends_with_us_and_starts_when_needed():
    with ForkServer():
        assert children("fork_server") == []  # nothing was asked of it


def test_a_server_that_cannot_start_costs_one_job(tmp_path, monkeypatch):
    wct.write(tmp_path / "cube.vtu", kuhn_cube(1))
    chain = [{"type": "filters.get_quality"}]
    job = Job(str(tmp_path / "cube.vtu"), "cube.vtu", chain, "2", str(tmp_path), str(tmp_path))
    with ForkServer() as server:
        with monkeypatch.context() as broken:
            broken.setattr(sys, "executable", str(tmp_path / "gone"))
            record, _ = run_isolated(job, server)
        assert record.cause == "no process could be started for the job: No such file or directory"
        assert run_isolated(job, server)[0].exit_code == 0


def test_a_server_that_has_hung_up_but_is_still_there_is_replaced(tmp_path):
    wct.write(tmp_path / "cube.vtu", kuhn_cube(1))
    job = Job(str(tmp_path / "cube.vtu"), "cube.vtu", [{"type": "filters.get_quality"}], "2", *2 * [str(tmp_path)])
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as gmsh leaves it: a careless send would end us
    try:
        with ForkServer() as server:
            assert run_isolated(job, server)[0].exit_code == 0
            assert server._control is not None
            server._control.shutdown(socket.SHUT_RDWR)  # as a process does that is killed, before it has ended
            assert run_isolated(job, server)[0].exit_code == 0
    finally:
        signal.signal(signal.SIGPIPE, before)


def test_memory_is_counted_per_session():
    used = process_sessions.resident()
    assert used[os.getsid(0)] > 50 << 20  # we ourselves have NumPy
    status = Path("/proc/self/status").read_text()
    own = int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmRSS"))) << 10
    assert used[os.getsid(0)] > 0.8 * own
