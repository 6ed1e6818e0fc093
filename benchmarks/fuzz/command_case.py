"""A case of a command: a random mesh, a random command over it, perhaps something that stops it; and its judgement."""

import json
import random
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.fuzz import random_mesh, random_options
from benchmarks.fuzz.judge import exact, result, said
from wct_plugin.pipeline.stage import find_filter

#: Filters that may stand in a random chain; those that start other programs are rare, and drawn apart.
_CHAINED = (
    "meshing_well_centered", "apply_coord_well_centering", "apply_coord_well_centering", "compute_power_weights",
    "compute_scalar_by_well_centeredness", "get_quality", "generate_boundary_surface",
)  # fmt: skip
_CREATING = (
    "create_cube", "create_cube_corner", "create_lattice_tiling", "create_tetrahedron",
    "create_tetrahedron_subdivision",
)  # fmt: skip
#: CPU seconds after which a case is a finding: the work ends after some 6 s, and measuring takes a little.
CPU = 60


@dataclass(frozen=True)
class Case:
    """What is run: ``arguments`` of wct in a folder where the files of ``make`` are."""

    name: str
    arguments: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    mesh: random_mesh.Made
    options: dict[str, Any] = field(default_factory=dict)
    stop: tuple[float, int] | None = None  #: seconds after which a signal comes, and which
    limited: bool = False  #: ends by the clock
    again: bool = False  #: is run once more, on one thread, for the same bits


@dataclass(frozen=True)
class Ran:
    """How it ended."""

    code: int  #: exit code; that of a signal is negative
    text: str  #: standard output and error
    cpu: float


def _flags(options: dict[str, Any], declared: Any) -> list[str]:
    """Options as flags; those without a value are for what is true."""
    made = []
    for name, value in options.items():
        flag = f"--{name.replace('_', '-')}"
        lone = declared.get(name, {}).get("type") == "boolean" and name not in ("local_tolerance",)
        if lone:
            made += [flag] if value is True else []
        elif isinstance(value, dict):
            made += [flag, ",".join(f"{key}={one}" for key, one in value.items())]
        elif value is not None and not isinstance(value, list):
            made += [flag, str(value)]
    return made


def _optimize(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    name = draw.choice(("meshing_well_centered", "meshing_well_centered", "apply_coord_well_centering"))
    source, target = (
        f"in{draw.choice(('.vtu', '.vtu', '.msh', '.mesh'))}",
        f"out{draw.choice(('.vtu', '.vtu', '.msh', '.mesh'))}",
    )
    mesh.write(folder / source)
    options = random_options.options_of(draw, name)
    if name == "meshing_well_centered" and draw.random() < 0.45:
        options["goal"] = draw.choice(("delaunay", "one-sided"))
        options.pop("edge_length", None)
        options.pop("force", None)
    if (
        name == "meshing_well_centered"
    ):  # walls that are thin for their body take tets by the thousand, and time for each
        options.setdefault("max_tets", 3000)
    declared = find_filter(name).declaration.model_json_schema()["properties"]
    arguments = ["optimize", source, target, "--filter", name, "--json", "report.json", *_flags(options, declared)]
    limited, stop = draw.random() < 0.6, None
    if limited:
        arguments += ["--time-limit", f"{10.0 ** draw.uniform(-3, 0):.4f}"]
    elif draw.random() < 0.4:
        stop = (draw.uniform(0, 1.5), draw.choice((2, 15)))
    again = not limited and stop is None
    outputs = (target, "report.json")
    return Case(
        "optimize", tuple(arguments), (source,), outputs, mesh, options | {"filter": name}, stop, limited, again
    )


def _run(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    mesh.write(folder / "in.vtu")
    stages: list[Any] = ["in.vtu"] if draw.random() < 0.9 else [{"type": "readers.mesh", "filename": "in.vtu"}]
    names = draw.choices(_CHAINED, k=draw.randint(1, 3))
    if draw.random() < 0.95:
        names.sort(key="generate_boundary_surface".__eq__)  # what comes behind it would get a surface
    for name in names:
        stages.append({"type": f"filters.{name}", **random_options.options_of(draw, name)})
    if draw.random() < 0.03:
        stages.append({"type": "filters.generate_tetrahedralization", "mesher": "tetgen"})
    surface = any(isinstance(one, dict) and "boundary_surface" in one["type"] for one in stages[1:])
    stages.append("out.ply" if surface != (draw.random() < 0.05) else "out.vtu")
    if draw.random() < 0.05:
        draw.shuffle(stages)
    text = json.dumps(stages)
    if draw.random() < 0.05:
        at = draw.randrange(len(text))
        text = text[:at] + draw.choice(("", "[", "}", '"', "nan", "\\", "1e999")) + text[at + 1 :]
    (folder / "chain.json").write_text(text)
    limit = ("--time-limit", f"{10.0 ** draw.uniform(-2, 0):.4f}")
    outputs = ("out.vtu", "out.ply", *re.findall(r"\w+\.(?:vtu|ply)", text))  # a changed text may name another
    return Case("run", ("run", "chain.json", *limit), ("in.vtu", "chain.json"), outputs, mesh, limited=True)


def _report(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    mesh.write(folder / "in.vtu")
    more = draw.choice(((), ("--exact",), ("--html", "out.html")))
    arguments = ("report", "in.vtu", "--json", "report.json", *more)
    return Case("report", arguments, ("in.vtu",), ("report.json", "out.html"), mesh)


def _dual(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    mesh.write(folder / "in.vtu")
    target = draw.choice(("out.npz", "out.npz", "out.vtu", "out.json", "out"))
    return Case("dual", ("dual", "in.vtu", target), ("in.vtu",), (target,), mesh)


def _create(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    name = draw.choice(_CREATING)
    stage = {"type": f"filters.{name}", **random_options.options_of(draw, name)}
    (folder / "chain.json").write_text(json.dumps([stage, "out.vtu"]))
    return Case("create", ("run", "chain.json", "--time-limit", "5"), ("chain.json",), ("out.vtu",), mesh)


def _object(draw: random.Random, mesh: random_mesh.Made, folder: Path) -> Case:
    """Another library's mesh goes through a filter, in Python, by :mod:`benchmarks.fuzz.object_program`."""
    mesh.write(folder / "in.vtu")
    library = draw.choice(("meshio", "pyvista", "arrays"))
    name = draw.choice(("apply_coord_well_centering", "compute_scalar_by_well_centeredness", "meshing_well_centered"))
    more = {"goal": "delaunay"} if name == "meshing_well_centered" else {}
    arguments = (library, name, json.dumps(random_options.options_of(draw, name) | more))
    return Case("object", arguments, ("in.vtu",), ("out.vtu",), mesh)


_COMMANDS = {"optimize": 53, "run": 19, "report": 11, "dual": 5, "create": 5, "object": 7}


def make(seed: int, number: int, folder: Path) -> Case:
    """The case of a seed and number; its inputs are written into the empty ``folder``."""
    draw = random.Random(f"command {seed} {number}")
    makers = {
        "optimize": _optimize,
        "run": _run,
        "report": _report,
        "dual": _dual,
        "create": _create,
        "object": _object,
    }
    mesh = random_mesh.make(draw)
    return makers[draw.choices(list(_COMMANDS), list(_COMMANDS.values()))[0]](draw, mesh, folder)


# --- judging --------------------------------------------------------------------------------------------------------


def judge(case: Case, ran: Ran, folder: Path) -> list[str]:
    """The faults of what a case left in its folder."""
    faults = said.faults_of_output(ran.text)
    if ran.cpu > CPU:
        faults.append(f"the command took more than {CPU} s of CPU time")
    left = {path.name for path in folder.iterdir()} - {*case.inputs, "printed"}
    if case.stop and ran.code == -case.stop[1] and not ran.text and not left:
        return faults  # it came before the command could hear it
    if ran.code < 0:
        return [*faults, f"the command died of signal {-ran.code}"]
    if ran.code not in (0, 1, 2):
        return [*faults, f"the exit code is {ran.code}"]
    if strange := left - {*case.outputs}:
        faults.append(f"{min(strange)} is left")
    if ran.code == 2:
        errors = [line for line in ran.text.splitlines() if line.startswith("error: ")]
        if len(errors) != 1 and not ran.text.startswith("Usage: "):
            faults.append(f"exit code 2 with {len(errors)} lines of errors")
        if left and "written before" not in ran.text:
            faults.append(f"exit code 2, and {min(left)} is written")
        return faults
    if ran.code == 1 and case.name in ("report", "dual", "create"):
        return faults
    if case.name == "optimize":
        faults += _judge_optimized(case, ran, folder)
    elif case.name == "report":
        mesh = _given(case)
        reports = json.loads((folder / "report.json").read_text())
        faults += result.faults_of_report(reports.get("report", reports), mesh)
    elif (folder / "out.vtu").exists() and case.name != "dual":
        made = result.load(folder / "out.vtu")
        if len(made.tets) and (case.name == "create" or not result.faults_of_mesh(_given(case))):
            faults += result.faults_of_mesh(made)
    return faults


def _given(case: Case) -> result.Arrays:
    mesh = case.mesh
    return result.Arrays(mesh.points, mesh.tets, mesh.regions, mesh.facets, mesh.facet_tags)


def _judge_optimized(case: Case, ran: Ran, folder: Path) -> list[str]:
    target = folder / case.outputs[0]
    if not target.exists():
        return ["there is no output"]
    old, new = result.load(folder / case.inputs[0]), result.load(target)
    if result.faults_of_mesh(old):  # nothing is promised of what is none
        return []
    if faults := result.faults_of_mesh(new):
        # Of what overlaps as it comes nothing is promised; tets may without a vertex in another.
        return [] if ran.code == 1 and "overlaps itself" in ran.text else faults
    reports = json.loads((folder / "report.json").read_text())
    told = ran.text.replace("\n", " ")
    new = result.with_old_tags(new, told)
    faults = result.faults_of_report(reports["before"], old)
    faults += result.faults_of_report(reports["after"], new)
    missed = ran.code == 1
    lost = result.faults_of_regions(old, new, volumes=not (missed and ("volume" in told or "size of" in told)))
    if not (missed and ("size of" in told or "group" in told)):
        lost += result.faults_of_groups(old, new)
    faults += lost
    goal = case.options.get("goal", "cwc")
    if goal in ("3wc", "cwc", "2wc"):
        before = exact.count_flags(old.points, old.tets, exact.TIE)  # what is so by too little, no flag says
        after = exact.count_flags(new.points, new.tets)
        fits = len(old.tets) <= case.options.get("max_tets", len(old.tets))  # else what came is no choice
        if fits and result.share(after, goal, len(new.tets)) < result.share(before, goal, len(old.tets)):
            faults.append(
                f"fewer tets are {goal}: {after[goal]} of {len(new.tets)} after {before[goal]} of {len(old.tets)}"
            )
        if ran.code == 0 and after[goal] < len(new.tets):
            faults.append(f"exit code 0, and {len(new.tets) - after[goal]} tets are not {goal}")
    if case.mesh.box and _planes_promised(case, old):
        faults += result.faults_of_planes(old, new)
        if ran.code == 0 and case.options.get("periodic") is True:
            faults += result.faults_of_pairs(old, new)
    return faults


def _planes_promised(case: Case, old: result.Arrays) -> bool:
    """Whether all sides are large enough to stay plane, 28 tolerances and 3 % of the diagonal, with creases between."""
    if case.options.get("crease_angle", 0.0) >= 90.0:
        return False
    spans = np.concatenate([np.diff(np.unique(old.points[:, axis])) for axis in range(3)])
    tolerance = case.options.get("tolerance") or 1e-3
    diagonal = float(np.linalg.norm(np.ptp(old.points, axis=0)))
    return isinstance(tolerance, float) and bool(spans.min() > max(0.03, 28 * tolerance) * diagonal)
