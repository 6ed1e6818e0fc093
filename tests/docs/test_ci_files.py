"""Workflows, templates, recipe and pins: what can be known of them without the machines that they are for."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
PINS = dict(re.findall(r"^([\w-]+)==(\S+)$", (ROOT / ".ci/tools.txt").read_text(encoding="utf-8"), flags=re.M))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_may_little_and_end(path):
    text = path.read_text(encoding="utf-8")
    workflow = yaml.safe_load(text)
    assert workflow["permissions"] == {"contents": "read"}
    for job in workflow["jobs"].values():
        assert 0 < job["timeout-minutes"] <= 90
        for step in job["steps"]:
            if step.get("uses", "").startswith("actions/checkout@"):
                assert step["with"] == {"persist-credentials": False}
    assert "secrets." not in text  # PyPI trusts the workflow itself


def test_other_files_of_yaml_are_some():
    forms = [path for path in (ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml"]
    for path in forms:
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        assert {"name", "description", "body"} <= set(form)
        names = [part["id"] for part in form["body"]]
        assert len(names) == len(set(names)) > 1


def test_the_recipe_asks_for_what_the_package_asks_for():
    """But for fTetWild, which conda does not have; meshio's extras are named."""
    recipe = yaml.safe_load((ROOT / "conda/recipe.yaml").read_text(encoding="utf-8"))
    assert recipe["context"]["version"] == PROJECT["version"]
    wanted = {
        f"{canonicalize_name(one.name)} {one.specifier}"
        for one in map(Requirement, PROJECT["dependencies"])
        if one.name != "pytetwild"
    }
    assert set(recipe["requirements"]["run"]) == wanted | {"python", "h5py", "netcdf4"}


def test_tools_are_pinned_in_one_place():
    config = (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8")
    used = re.findall(r"\[([\w-]+)==([^\]]+)\]", config)
    assert len(used) == 5
    assert [PINS[name] for name, _ in used] == [version for _, version in used]
    for path in [*WORKFLOWS, ROOT / "Makefile"]:
        text = path.read_text(encoding="utf-8")
        for tools in re.findall(r"pip install -c \.ci/tools\.txt ([\w -]+)$", text, flags=re.M):
            assert set(tools.split()) - {"-e"} <= set(PINS), tools
