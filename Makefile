# make demo   a real surface through fTetWild, well-centered, measured, written
# make test   the whole suite           make lint   style, types, who imports whom           make bench   ours and the peers side by side
# make wheel  built, audited, installed without a compiler, at work
# make docs   the site in build/site; docs/filters.md, the types of wct_plugin.Filter and the stub of the core, made from declarations
# Each sets up what it needs: Debian packages that are missing, a virtual environment in .venv, an editable install.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CORE := $(wildcard cpp/*/*.h cpp/*/*.cpp)
CORE_TESTS := $(wildcard tests/cpp/*/*.h tests/cpp/*/*.cpp)

# Headers and venv for Debian's own Python; for the tests, doctest for those of the core, TetGen, CalculiX, a browser, and the X and
# GL libraries that the wheels of gmsh and pymeshlab load.
DEB_BUILD := $(shell $(PYTHON) -c 'import sysconfig,os;print("" if os.path.exists(sysconfig.get_path("include")+"/Python.h") else "python3-dev")') \
             $(shell $(PYTHON) -c 'import ensurepip' 2>/dev/null || echo python3-venv)
DEB_TEST := doctest-dev tetgen calculix-ccx chromium libgl1 libglu1-mesa libopengl0 libxrender1 libxcursor1 libxft2 libxinerama1
SUDO := $(shell [ "$$(id -u)" = 0 ] || echo sudo)

.PHONY: demo test bench kills stops mutants fuzz lint docs wheel clean

demo: $(VENV)/.demo
	$(BIN)/wct optimize "$$($(BIN)/python -c 'import importlib.util as u; print(u.find_spec("pymeshlab").submodule_search_locations[0])')/tests/sample_meshes/bone.ply" \
		bone.vtu --allow-released --html bone.html; code=$$?; [ $$code -le 1 ] && echo "wrote bone.vtu and bone.html" && exit 0; exit $$code

# A worker that crashes ends the run with its name: replaced, it can leave the others waiting for ever.
test: $(VENV)/.test
	$(BIN)/python -m pytest -n logical --dist loadfile --max-worker-restart 0

# Types and the import rule are checked on a copy in which filters/ is where it is installed, as wct_plugin.filters; Python
# runs without site there, as the editable install would give it the modules of the source tree.
lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/clang-format --dry-run --Werror $(CORE) $(CORE_TESTS)
	$(BIN)/actionlint
	$(BIN)/hadolint Dockerfile
	rm -rf build/lint && mkdir -p build/lint && cp -r wct_plugin build/lint && cp -r filters build/lint/wct_plugin
	cd build/lint && $(abspath $(BIN))/mypy --config-file ../../pyproject.toml -p wct_plugin
	cd build/lint && $(abspath $(BIN))/mypy --platform win32 --config-file ../../pyproject.toml -p wct_plugin
	cd build/lint && PYTHONPATH=$$($(abspath $(BIN))/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))') \
		$(abspath $(BIN))/python -S -c 'from importlinter.cli import lint_imports_command; lint_imports_command()' ../../pyproject.toml
	$(BIN)/python -m pytest -q tests/cpp/test_layers.py

wheel: $(VENV)/.test
	.ci/wheel

# make kills [COUNT=times that each command is killed]
kills: $(VENV)/.test
	$(BIN)/python -m benchmarks.kills $(COUNT)

# make stops [MOST=calls of each visit to a stage]: runs stopped in every stage, and what is left
stops: $(VENV)/.test
	$(BIN)/python -W ignore -m benchmarks.stops $(if $(MOST),--most $(MOST))

# make mutants [COUNT=200] [SEED=1]: changes of the Python modules that judge, and the tests that notice them
mutants: $(VENV)/.test
	$(BIN)/python -m benchmarks.mutants $(if $(COUNT),--count $(COUNT)) $(if $(SEED),--seed $(SEED))

# make fuzz [MINUTES=30] [SEED=n] [KIND=file, command or tie] [CASES=of each kind, at most], or CASE=kind:seed:number: one case once more; findings in build/fuzz/findings
fuzz: $(VENV)/.test
	PYTHONPATH=. $(BIN)/python -m benchmarks.fuzz $(if $(MINUTES),--minutes $(MINUTES)) $(if $(SEED),--seed $(SEED)) $(if $(KIND),--kind $(KIND)) \
		$(if $(CASES),--cases $(CASES)) $(if $(CASE),--case $(CASE))

docs: $(VENV)/.test
	$(BIN)/wct filters --markdown docs/filters.md
	$(BIN)/python -m wct_plugin.pipeline.stub wct_plugin/pipeline/signatures.pyi
	$(BIN)/python -m nanobind.stubgen -q -m wct_plugin.core._core -o wct_plugin/core/_core.pyi
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

# make bench [MESHES=folder] [SURFACES=folder of surfaces with the meshes' names] [TIMEOUT=seconds per tool and mesh]
#            [MOST=tets at which the growth curve stops]: kernels.md, bench.md, reading.md, growth.md in build/bench
bench: $(VENV)/.bench
	PYTHONPATH=tests $(BIN)/python -m benchmarks.kernels
	PYTHONPATH=tests $(BIN)/python -m benchmarks $(if $(MESHES),--meshes '$(MESHES)') $(if $(SURFACES),--surfaces '$(SURFACES)') \
		$(if $(TIMEOUT),--timeout $(TIMEOUT))
	PYTHONPATH=tests $(BIN)/python -m benchmarks.reading
	PYTHONPATH=tests $(BIN)/python -m benchmarks.growth $(if $(MOST),--most $(MOST))

# Editable installs see edits to Python files at once; a changed core, declaration or list of filters installs again.
$(VENV)/.demo: pyproject.toml CMakeLists.txt $(CORE) | $(BIN)/python
	$(BIN)/pip install -e '.[view]'
	touch $@

$(VENV)/.test: pyproject.toml .ci/tools.txt CMakeLists.txt $(CORE) | $(BIN)/python deb-test
	$(BIN)/pip install -c .ci/tools.txt -e '.[test]'
	touch $@ $(VENV)/.demo

# One peer at a time: where one has no wheel, its row says "not installed".
$(VENV)/.bench: $(VENV)/.test
	for peer in $$($(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["bench"])'); \
		do $(BIN)/pip install "$$peer" || echo "$$peer: not installed"; done
	touch $@

$(BIN)/python:
	$(call apt,$(strip $(DEB_BUILD)))
	$(PYTHON) -m venv $(VENV)

.PHONY: deb-test
deb-test:
	$(call apt,$(shell command -v dpkg-query >/dev/null && for p in $(DEB_TEST); do dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || echo $$p; done))

apt = $(if $(1),$(SUDO) apt-get update -q && $(SUDO) apt-get install -qy --no-install-recommends $(1))

clean:
	rm -rf $(VENV) build dist bone.vtu bone.html
