"""The same batch on a dask cluster of real processes, one of which is killed at work."""

import os
import signal
import time
from pathlib import Path

import pytest
from support import mixed_batch
from support.batches import QUALITY, lines
from support.builders import jittered_cube
from support.processes import wait_until, working_in
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.batch.executors import _check_workers, _look_round
from wct_plugin.batch.job import RECORD
from wct_plugin.errors import OptionError

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("ignore")  # dask's own


@pytest.fixture(scope="module")
def cluster():
    """Two workers, each with a nanny that starts it again, as on a real cluster."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as made:
        yield made


def test_a_killed_worker_loses_nothing(cluster, tmp_path):
    causes = mixed_batch.make(tmp_path / "in", good=8, bad=0)
    chain = wct.Pipeline.from_json(mixed_batch.CHAIN)
    killed = []

    def kill_one(state):
        at_work = [one for one in (tmp_path / "out/.wct-batch").iterdir() if not (one / RECORD).exists()]
        if state.finished and len(at_work) == 2 and not killed:  # a job on each of the workers
            killed.append(next(iter(cluster.workers.values())).process.pid)
            os.kill(killed[0], signal.SIGKILL)

    inputs = [tmp_path / "in" / name for name in causes]
    done = wct.run_batch(chain, inputs, tmp_path / "out", scheduler=cluster.scheduler_address, progress=kill_one)
    assert killed
    assert [record.exit_code for record in done.records] == [0] * 8
    assert sorted(path.name for path in (tmp_path / "out").glob("*.vtu")) == [f"good{k:02}.vtu" for k in range(8)]
    assert len(lines(tmp_path / "out")) == 8
    assert not list((tmp_path / "out").glob(".*"))


def test_what_breaks_a_job_is_its_own_cause_not_the_workers_end(cluster, tmp_path):
    wct.write(tmp_path / "good.vtu", jittered_cube(4))
    (tmp_path / "bad.vtu").write_text("what is this?")
    before = [nanny.process.pid for nanny in cluster.workers.values()]
    done = wct.run_batch(QUALITY, [tmp_path / "*.vtu"], tmp_path / "out", scheduler=cluster.scheduler_address)
    assert [(Path(one.input).name, one.exit_code) for one in done.records] == [("good.vtu", 0), ("bad.vtu", 2)]
    assert done.failed[0].cause == "cannot be read as VTU: is no XML, or truncated (syntax error: line 1, column 0)"
    assert [nanny.process.pid for nanny in cluster.workers.values()] == before


def test_jobs_on_workers_end_when_the_batch_is_given_up(tmp_path, monkeypatch):
    mixed_batch.break_tetgen(tmp_path / "bin", monkeypatch)  # before the workers start, which inherit the PATH
    mixed_batch.make(tmp_path / "in", good=0, bad=1)
    chain = wct.Pipeline.from_json(mixed_batch.CHAIN)

    def give_up(state):
        if any(line.startswith("sleep") for line in working_in(tmp_path)):
            raise KeyboardInterrupt

    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        with pytest.raises(KeyboardInterrupt):
            wct.run_batch(
                chain,
                [tmp_path / "in/hanging0.ply"],
                tmp_path / "out",
                suffix="vtu",
                scheduler=cluster.scheduler_address,
                progress=give_up,
            )
        wait_until(lambda: not working_in(tmp_path), 10)
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["manifest.jsonl"]
    assert lines(tmp_path / "out") == []


def test_a_scheduler_that_is_not_there(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wct.write("x.vtu", jittered_cube(1))
    Path("chain.json").write_text('[{"type": "filters.get_quality"}]')
    monkeypatch.setattr("wct_plugin.batch.executors.CONNECT_SECONDS", 1)
    start = time.monotonic()
    said = refused(capsys, "batch", "chain.json", "x.vtu", "-o", "out", "--scheduler", "tcp://localhost:9")
    assert said.startswith("scheduler tcp://localhost:9: cannot be reached: ")
    assert time.monotonic() - start < 15


def test_workers_that_do_not_share_the_directory_are_refused():
    _check_workers({"tcp://a:1": _look_round("/")}, Path("/"))
    with pytest.raises(OptionError, match=r"worker tcp://a:1 does not see the directory /none"):
        _check_workers({"tcp://a:1": _look_round("/none")}, Path("/none"))
    with pytest.raises(OptionError, match=r"worker tcp://a:1 has wct_plugin 0.0, here is"):
        _check_workers({"tcp://a:1": ("0.0", True)}, Path("/"))
    with pytest.raises(OptionError, match=r"worker tcp://a:1 cannot do jobs: ModuleNotFoundError: no wct_plugin"):
        _check_workers({"tcp://a:1": ModuleNotFoundError("no wct_plugin")}, Path("/"))
