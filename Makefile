# Development commands. They make the virtual environment when it is missing or its requirements changed.

PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
BIN := .venv/bin
STAMP := .venv/.installed
VERIFY := .venv/.installed_verify
CHECKED := warpffrf kernels tests demos bench docs

# Test workers share the cores, the unit of time is defined on one thread, and on many small matrices the threads of a
# BLAS wait for each other: one BLAS thread each.
demo demos test test-floor verify bench bench-store bench-compare wheel-test study docs validate: \
	export OPENBLAS_NUM_THREADS ?= 1

.PHONY: .venv demo demos docs test test-floor verify bench bench-store bench-compare lint format types wheel-test clean \
	study validate

.venv: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(if $(PYTHON),,$(error Python 3.11 or newer was not found; call make with PYTHON=/path/to/python3))
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dev]"
	touch $@

demo: $(STAMP)
	$(BIN)/warpffrf demo two-rollers

demos: $(STAMP)
	set -e; for script in demos/[a-z]*.py; do echo "== $$script"; $(BIN)/warpffrf demo $$(basename $$script .py | tr _ -); done

test: lint types
	$(BIN)/python -m pytest

# The lowest versions that pyproject.toml allows, in an environment of their own, with tests that use each of them.
FLOOR := build/floor
FLOOR_TESTS := tests/conformance/test_floor.py tests/model/mesh/test_mesh_reader.py tests/model/mesh/test_mesh_select.py \
	tests/model/scene/test_public.py tests/offline/bodies/test_reduction.py tests/online/run/test_threads.py tests/output/recording/test_recorder.py \
	tests/output/files/test_results_file.py tests/output/plots/test_panels.py tests/cli/test_cli.py tests/scene_file/test_scene_file.py
test-floor:
	$(PYTHON) -m venv --clear $(FLOOR)
	$(FLOOR)/bin/python -m pip install --quiet --disable-pip-version-check -c constraints-floor.txt \
		-e . hypothesis "meshio>=5.3.5" psutil pytest pytest-xdist
	$(FLOOR)/bin/python -m pytest $(FLOOR_TESTS)

# The site, out/site/index.html: notebooks run where their code has changed, with the kernels that tests have compiled;
# warnings are errors.
docs: export WARP_CACHE_PATH ?= $(CURDIR)/.warp_cache/tests
DOCS := .venv/.installed_docs
$(DOCS): $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[docs]"
	touch $@

docs: $(DOCS)
	$(BIN)/sphinx-build -q -W --keep-going -c docs -d out/doctrees . out/site

# EXUDYN, which some of the slow tests compare with, is installed for them.
$(VERIFY): $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[verify]"
	touch $@

verify: $(VERIFY)
	EXAMPLES=2 $(BIN)/python -m pytest -m "slow or not slow"

# Within 15 minutes on two cores; many scripts have longer runs behind options. The last table compares with the stored run.
bench: $(STAMP)
	rm -f out/bench/*.json
	mkdir -p out/bench
	set -e; for script in $(filter-out bench/compare_%.py bench/live_%.py,$(wildcard bench/*.py bench/step/*.py)); do \
		echo "== $$script"; $(BIN)/python $$script --json out/bench/$$(basename $$script .py).json; done
	$(BIN)/python bench/compare_runs.py

# The last run of `make bench` becomes what later ones on this machine are compared with: only of a quiet machine.
bench-store: $(STAMP)
	$(BIN)/python bench/compare_runs.py --store

# docs/speed_error.md with a page a study, docs/stability: half an hour, on a quiet machine.
study: $(STAMP)
	$(BIN)/python -m studies speed_error
	$(BIN)/python -m studies stability

# docs/verification.md: every published and closed-form case, within half an hour on two cores. It fails where a row misses
# its tolerance that is not known to.
validate: $(STAMP)
	$(BIN)/python -m studies validate

# The working tree beside another commit: make bench-compare BASE=commit
BASE ?= HEAD
bench-compare: $(STAMP)
	$(BIN)/python bench/compare_commits.py --base $(BASE) --bodies out/bench/compared

lint: $(STAMP)
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/ruff format --check $(CHECKED)
	$(BIN)/lint-imports

types: $(STAMP)
	$(BIN)/pyright --threads 2 --pythonpath $(BIN)/python

format: $(STAMP)
	$(BIN)/ruff check --fix $(CHECKED)
	$(BIN)/ruff format $(CHECKED)

# What a user gets: a source distribution, the wheel that is built from it, in an environment of its own, run from another
# folder with a cold cache of kernels: a scene of its own, and all that README.md and docs/ print.
wheel-test: $(STAMP)
	rm -rf build/wheel
	$(PYTHON) -m venv build/wheel/tools
	build/wheel/tools/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt hatchling
	build/wheel/tools/bin/hatchling build -t sdist -d build/wheel
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir build/wheel build/wheel/*.tar.gz
	$(BIN)/python tests/wheel_contents.py build/wheel/*.whl build/wheel/*.tar.gz
	$(PYTHON) -m venv build/wheel/venv
	build/wheel/venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt build/wheel/*.whl
	mkdir -p build/wheel/elsewhere
	cp tests/wheel_smoke.py build/wheel/elsewhere/
	cd build/wheel/elsewhere && WARP_CACHE_PATH=kernels ../venv/bin/python -I wheel_smoke.py && ../venv/bin/warpffrf info smoke.h5
	build/wheel/venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt "warpffrf[arrays,fmu,tables]"
	$(BIN)/python tests/wheel_blocks.py build/wheel/venv build/wheel/elsewhere

clean:
	rm -rf build dist out .warp_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
