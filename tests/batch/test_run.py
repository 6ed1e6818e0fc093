"""Batches: what a broken file costs, what is written, and what is done again."""

import contextlib
import csv
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support import mixed_batch
from support.batches import QUALITY, lines
from support.builders import bcc, jittered_cube, single
from support.processes import children, processes_in, wait_until, working_in

import wct_plugin as wct
from wct_plugin.batch.job import digest
from wct_plugin.cli import main
from wct_plugin.errors import OptionError

WCT = Path(sys.executable).with_name("wct")


@contextlib.contextmanager
def started(command, folder):
    """A batch at work, killed at the latest when the test is done with it."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as batch:
        try:
            yield batch
        finally:
            batch.kill()


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A working directory with three good files and a bad one."""
    monkeypatch.chdir(tmp_path)
    for k in range(3):
        wct.write(f"c{k}.vtu", jittered_cube(2, k))
    Path("bad.vtu").write_text("what is this?")
    return tmp_path


def test_forty_mixed_files_lose_the_bad_ones_alone(tmp_path, monkeypatch):
    mixed_batch.break_tetgen(tmp_path / "bin", monkeypatch)
    causes = mixed_batch.make(tmp_path / "in", good=32, bad=2)
    arguments = ["chain.json", "*.ply", "-o", "out", "--format", "vtu", "--jobs", "4"]
    limits = ["--timeout", "8", "--memory-limit", "400"]
    done = subprocess.run([WCT, "batch", *arguments, *limits], cwd=tmp_path / "in", capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    found = {line["input"]: line for line in lines(tmp_path / "in/out")}
    assert len(found) == len(causes) == 40
    for name, cause in causes.items():
        assert (found[name]["cause"] or "").startswith(cause), found[name]["cause"]
        assert found[name]["exit_code"] == (2 if cause else 0)
        assert bool(cause) != (tmp_path / "in/out" / name).with_suffix(".vtu").exists()
    assert "8 failed" in done.stdout
    last = done.stdout.rstrip().splitlines()[-8:]
    assert [line.partition(":")[0] for line in last] == sorted(name for name, cause in causes.items() if cause)
    assert not list((tmp_path / "in/out").glob(".*"))
    wait_until(lambda: not working_in(tmp_path), 2)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A batch of three good files, two that miss their goal, and one that is none."""
    folder = tmp_path_factory.mktemp("done")
    for k in range(3):
        wct.write(folder / f"good{k}.vtu", bcc(2))
    wct.write(folder / "jittered.vtu", jittered_cube(3))
    wct.write(folder / "flat.vtu", single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0.1]]))
    (folder / "<b>&.vtu").write_text("what is this?")
    mover = wct.Filter.apply_coord_well_centering(goal="3wc", boundary="fixed")
    return wct.run_batch(mover, [folder / "*.vtu"], folder / "out")


def test_a_record_holds_what_was_done(done):
    folder = done.csv.parent
    found = {Path(line["input"]).name: line for line in lines(folder)}
    good = found["good0.vtu"]
    assert good["input_sha256"] == digest(folder.parent / "good0.vtu")
    assert good["files"] == {"good0.vtu": digest(folder / "good0.vtu")}
    assert good["versions"]["wct_plugin"]
    assert good["after"]["tets"] == len(bcc(2).tets)
    assert good["goals"] == [
        {
            "stage": "filters.apply_coord_well_centering",
            "goal": "3wc",
            "tets": len(bcc(2).tets),
            "missed": 0,
            "valid": True,
            "most": None,
            "losses": [],
            "stopped": False,
            "exhausted": False,
            "needed": None,
        }
    ]
    assert "apply_coord_well_centering" in good["metrics"]
    assert (good["exit_code"], good["cause"], good["output"]) == (0, None, "good0.vtu")
    assert good["peak_bytes"] > 10 << 20
    said = "is no XML, or truncated (syntax error: line 1, column 0)"
    assert found["<b>&.vtu"]["cause"] == f"cannot be read as VTU: {said}"


def test_an_output_is_what_a_run_of_its_own_gives_bit_by_bit(done, tmp_path):
    folder = done.csv.parent
    mover = wct.Filter.apply_coord_well_centering(goal="3wc", boundary="fixed")
    for name in ("good0.vtu", "jittered.vtu"):
        mover.between(folder.parent / name, [tmp_path / name]).execute()
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()


def test_a_goal_that_is_missed_is_exit_code_1_with_an_output(done):
    (flat,) = (record for record in done.records if record.input.endswith("flat.vtu"))
    assert (flat.exit_code, flat.failed, done.exit_code) == (1, False, 1)
    assert flat.cause == "filters.apply_coord_well_centering: 1 of 1 tets miss the goal 3wc"
    assert (done.csv.parent / "flat.vtu").exists()


def test_summaries_have_every_file_failures_last(done):
    with done.csv.open() as file:
        rows = list(csv.DictReader(file))
    names = ["good0.vtu", "good1.vtu", "good2.vtu", "flat.vtu", "jittered.vtu", "<b>&.vtu"]
    assert [Path(row["input"]).name for row in rows] == names
    assert [row["exit_code"] for row in rows] == ["0", "0", "0", "1", "1", "2"]
    assert float(rows[0]["3wc_after"]) == 100
    page = re.sub(r'<wbr>|<span class="long">(.*?)</span>', r"\1", done.html.read_text())  # where words may break
    assert page.index("good2.vtu") < page.index("flat.vtu") < page.index("is no XML, or truncated")
    assert "://" not in page
    assert "&lt;b&gt;&amp;.vtu" in page
    assert "<b>" not in page


def test_a_tet_too_thin_to_be_measured_has_no_number(tmp_path):
    wct.write(tmp_path / "thin.vtu", single([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 5e-324]]))
    (record,) = wct.run_batch(QUALITY, [tmp_path / "thin.vtu"], tmp_path / "out").records
    assert record.exit_code == 0
    assert record.before["min_height"] is record.after["min_height"] is None


# --- resume ---------------------------------------------------------------------------------------------------------


def test_resume_does_what_is_new_or_changed_and_nothing_else(place):
    first = wct.run_batch(QUALITY, ["*.vtu"], "out")
    assert first.done_now == 4
    with pytest.raises(OptionError, match=r"manifest.jsonl exists: --resume goes on with that batch"):
        wct.run_batch(QUALITY, ["*.vtu"], "out")
    again = wct.run_batch(QUALITY, ["*.vtu"], "out", resume=True)
    assert (again.done_now, again.records) == (0, first.records)
    wct.write("c1.vtu", jittered_cube(2, 9))
    Path("out/c2.vtu").write_text("spoiled")
    wct.write("new.vtu", jittered_cube(2, 8))
    seen = []
    again = wct.run_batch(QUALITY, ["*.vtu"], "out", resume=True, progress=lambda state: seen.append(state.last))
    assert sorted(record.input for record in seen if record) == ["c1.vtu", "c2.vtu", "new.vtu"]
    assert wct.run_batch(QUALITY, ["*.vtu"], "out", retry_failed=True).done_now == 1
    assert wct.run_batch(wct.Filter.get_quality(worst=2), ["new.vtu"], "out", resume=True).done_now == 1


def test_a_torn_last_line_is_cut_off_and_done_again(place):
    wct.run_batch(QUALITY, ["c*.vtu"], "out", jobs=1)
    manifest = place / "out/manifest.jsonl"
    whole = manifest.read_bytes()
    manifest.write_bytes(whole[:-20])
    assert wct.run_batch(QUALITY, ["c*.vtu"], "out", resume=True).done_now == 1
    assert len(lines(place / "out")) == 3
    manifest.write_bytes(b'{"input": 1\n' + whole)
    with pytest.raises(wct.InputError, match=r"manifest.jsonl: line 1 is no record of a batch"):
        wct.run_batch(QUALITY, ["c*.vtu"], "out", resume=True)


def test_killed_and_resumed_nothing_is_redone_or_left_partial(tmp_path):
    mixed_batch.make(tmp_path / "in", good=8, bad=0)
    out = tmp_path / "in/out"
    command = [WCT, "batch", "chain.json", "good*.ply", "-o", "out", "--format", "vtu", "--jobs", "2", "--resume"]
    for moment in (0, 4):  # finished files at which it is killed
        with started(command, out.parent) as batch:
            wait_until(lambda: moment < len(list(out.glob("*.vtu"))), 60)  # noqa: B023
            batch.kill()
        wait_until(lambda: not working_in(tmp_path), 5)
        for path in out.glob("*.vtu"):
            assert len(wct.read(path).tets) > 0
    assert subprocess.run(command, cwd=out.parent, capture_output=True).returncode == 0
    found = lines(out)
    assert len(found) == len({line["input"] for line in found}) == 8
    left = {path.name for path in out.iterdir()}
    assert left == {f"good{k:02}.vtu" for k in range(8)} | {"manifest.jsonl", "summary.csv", "summary.html"}


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_the_jobs_and_keeps_the_manifest(sent, tmp_path, monkeypatch):
    """Ctrl-C goes to the batch alone, SIGTERM from a batch scheduler to every process of it, the first one first."""
    mixed_batch.break_tetgen(tmp_path / "bin", monkeypatch)
    mixed_batch.make(tmp_path / "in", good=3, bad=1)
    command = [WCT, "batch", "chain.json", "good*.ply", "hang*.ply", "-o", "out", "--format", "vtu", "--jobs", "2"]
    out = tmp_path / "in/out"
    with started(command, out.parent) as batch:
        wait_until(lambda: len(list(out.glob("good*.vtu"))) == 3, 60)
        wait_until(lambda: len([line for line in working_in(tmp_path) if line.startswith("sleep")]) == 2)
        wait_until(lambda: len(lines(out)) == 3)
        for process in [batch.pid] if sent == signal.SIGINT else processes_in(tmp_path):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, sent)
        _, said = batch.communicate(timeout=20)
    assert batch.returncode == 2
    assert said.endswith("error: interrupted; 3 of 4 files are finished, --resume goes on with the rest\n")
    wait_until(lambda: not working_in(tmp_path), 2)
    assert len(lines(out)) == 3
    assert not list(out.glob(".*"))


def test_a_full_disk_tells_what_is_finished(place, small_disk, capsys):
    wct.write("large.vtu", jittered_cube(8))
    Path("chain.json").write_text(json.dumps([{"type": "filters.get_quality"}]))
    assert main.run(["batch", "chain.json", "c0.vtu", "large.vtu", "-o", str(small_disk), "--jobs", "1", "-q"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "No space left on device" in said
    assert "; 1 of 2 files are finished" in said
    assert (small_disk / "c0.vtu").exists()


def test_ctrl_c_during_the_summaries_tells_what_is_finished(place, monkeypatch):
    def pressed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("wct_plugin.batch.summary.to_html", pressed)
    with pytest.raises(KeyboardInterrupt, match="1 of 1 files are finished"):
        wct.run_batch(QUALITY, ["c0.vtu"], "out")


def test_the_least_limit_is_one_still(place, monkeypatch):
    taken = []
    monkeypatch.setattr("wct_plugin.batch.run._run", lambda jobs, *_: taken.extend(jobs) or [])
    wct.run_batch(QUALITY, ["c0.vtu"], "out", memory_limit=1e-9)
    assert [job.memory for job in taken] == [1]


def test_half_a_job_at_a_time_is_refused(place):
    with pytest.raises(OptionError, match=r"jobs is 1.5; allowed is a whole number, 1 or more"):
        wct.run_batch(QUALITY, ["c0.vtu"], "out", jobs=1.5)


def test_two_batches_do_not_write_one_manifest(tmp_path, monkeypatch):
    mixed_batch.break_tetgen(tmp_path / "bin", monkeypatch)
    mixed_batch.make(tmp_path / "in", good=0, bad=1)
    wct.write(tmp_path / "cube.vtu", jittered_cube(2))
    command = [WCT, "batch", "chain.json", "hanging0.ply", "-o", "out", "--resume"]
    with started(command, tmp_path / "in") as batch:
        wait_until(lambda: any(line.startswith("sleep") for line in working_in(tmp_path)), 60)
        with pytest.raises(OptionError, match="is in use: another batch is writing to"):
            wct.run_batch(QUALITY, [tmp_path / "cube.vtu"], tmp_path / "in/out", resume=True)
        batch.kill()
    wait_until(lambda: not working_in(tmp_path), 5)


def test_shards_are_disjoint_and_one_resume_takes_them_together(place):
    for k in (1, 2):
        wct.run_batch(QUALITY, ["*.vtu"], "out", shard=(k, 2))
    parts = [{line["input"] for line in lines(place / "out", f"manifest-{k}of2.jsonl")} for k in (1, 2)]
    assert parts == [{"bad.vtu", "c1.vtu"}, {"c0.vtu", "c2.vtu"}]
    whole = wct.run_batch(QUALITY, ["*.vtu"], "out", resume=True)
    assert (whole.done_now, len(whole.records)) == (0, 4)
    assert Path("out/summary-2of2.csv").exists()
    with pytest.raises(OptionError, match=r"shard 4/3: allowed are 1/3 to 3/3"):
        wct.run_batch(QUALITY, ["*.vtu"], "out", shard=(4, 3))


# --- the process that forks -----------------------------------------------------------------------------------------


def test_a_lost_server_is_started_again_and_its_jobs_with_it(place):
    killed = []

    def kill_once(state):
        if state.last is not None and not killed:
            killed.extend(children("fork_server"))
            for process in killed:
                os.kill(process, signal.SIGKILL)

    done = wct.run_batch(QUALITY, ["c*.vtu"], "out", jobs=1, progress=kill_once)
    assert len(killed) == 1
    assert [record.exit_code for record in done.records] == [0, 0, 0]


def test_sigterm_to_the_server_is_left_to_the_caller(place):
    seen = set()

    def send(state):
        for process in children("fork_server") if state.last is not None else ():
            seen.add(process)
            os.kill(process, signal.SIGTERM)

    done = wct.run_batch(QUALITY, ["c*.vtu"], "out", jobs=1, progress=send)
    assert len(seen) == 1
    assert [record.exit_code for record in done.records] == [0, 0, 0]


def test_the_callers_main_is_not_run_again(place):
    script = (
        "import wct_plugin as wct\nprint('once')\nwct.run_batch(wct.Filter.get_quality(), ['c*.vtu'], 'out', jobs=2)\n"
    )
    Path("main.py").write_text(script)
    done = subprocess.run([sys.executable, "main.py"], capture_output=True, text=True, check=True)
    assert done.stdout == "once\n"
