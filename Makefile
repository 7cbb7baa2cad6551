# `make train` and `make test` work as the first command in a fresh clone.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= $(if $(filter file,$(origin PYTHON)),.venv,.venv-$(notdir $(PYTHON)))
BIN := $(VENV)/bin
# Numbers of episodes of the First and the Second Training; by default those of sarah-train.
EPISODES ?=
BALANCE_EPISODES ?=
# Pushes in each direction of the robustness table; by default 8.
PUSHES ?=
WORKERS ?= $(shell env -u OMP_NUM_THREADS nproc)
SEED ?= 1
RUN ?= runs/$(shell date +%Y%m%d-%H%M%S)
RUN := $(RUN)
NAME ?=
TIMINGS := throughput episodes updates decisions viewer
PAGE := tests/viewer/test_page.py
ENDURANCE := kills killed_workers killed_logs resume long_run protections pushes

# Refused before anything is installed or trained.
whole = $(if $($(1)),$(if $(shell printf %s '$(subst ','\'',$($(1)))' | grep -xE '[1-9][0-9]*'),,$(error $(1) must be a whole number above 0, not '$($(1))')))
$(foreach name,EPISODES BALANCE_EPISODES PUSHES,$(call whole,$(name)))
$(if $(filter 1,$(words $(RUN))),,$(error RUN must be a path without spaces, not '$(RUN)'))

.PHONY: help install train second-training robustness figures stepping-report balance-report test test-page test-slow lint format docs results bench endurance mutants clean

help:  ## show what can be made
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 12

install: $(VENV)/installed  ## create the environment in .venv, with the tested versions; with PYTHON=python3.13, in .venv-python3.13

# To compile all modules, of which most are never imported, would take half of the time.
$(VENV)/installed: EXTRAS := dev
$(VENV)/ready: EXTRAS := mujoco,video
$(VENV)/installed $(VENV)/ready: setup.cfg pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; (3, 10) <= sys.version_info[:2] <= (3, 13) or sys.exit("sarah is tested with Python 3.10 to 3.13: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip -c constraints.txt
	$(BIN)/pip install --quiet --no-compile -c constraints.txt --editable '.[$(EXTRAS)]'
	@touch $@

train: $(or $(wildcard $(VENV)/installed),$(VENV)/ready)  ## both trainings with NAF, figures, reports and robustness table: a robot that steps in place and comes back from pushes
	$(BIN)/sarah-train --task stepping $(EPISODES:%=--episodes %) --seed $(SEED) \
		--workers $(WORKERS) --out $(RUN)/stepping
	@echo "the second training, and beside it the report of the first"
	@$(MAKE) --no-print-directory --jobs=2 second-training stepping-report RUN=$(RUN)
	@echo "robustness, and beside it figures and the report of the second training"
	@$(MAKE) --no-print-directory --jobs=3 robustness figures balance-report RUN=$(RUN)
	@echo "all of it is in $(RUN): open $(RUN)/balance/report.html"

second-training:
	$(BIN)/sarah-train --task balance --from $(RUN)/stepping $(BALANCE_EPISODES:%=--episodes %) --seed $(SEED) \
		--workers $(WORKERS) --out $(RUN)/balance

robustness:
	$(BIN)/sarah-eval $(RUN)/balance --robustness --out $(RUN)/figures --episodes $(or $(PUSHES),8) --workers $(WORKERS)

# What runs beside something else says only what goes wrong, so that its words do not stand between the other's.
quietly = @said=$$(TQDM_DISABLE=1 $(1) 2>&1) || { printf '%s\n' "$$said" >&2; exit 1; }

figures:
	$(call quietly,$(BIN)/sarah-figures $(RUN)/stepping $(RUN)/balance --out $(RUN)/figures)

stepping-report balance-report:
	$(call quietly,$(BIN)/sarah-report $(RUN)/$(@:-report=))

# One thread for each process: two of them share the machine, and threads that wait for each other cost more than they do.
test: install  ## the tests, except those of the viewer's page
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal -m 'not slow' --durations 20 --ignore=$(PAGE)

test-page: install  ## the tests of the viewer's page, in Chromium
	$(BIN)/python -m pytest $(PAGE)

test-slow: install  ## the slow tests: minutes of simulation
	$(BIN)/python -m pytest -m slow

lint: install  ## style, types and which package imports which
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

format: install  ## put the style right
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: install  ## the documentation, into build/docs
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going -c docs . build/docs
	@echo build/docs/index.html

results: install  ## rewrite tables, figures and pictures of all pages; with NAME=landscape, make that result first
	@for name in $(NAME); do $(BIN)/python -m experiments $$name || exit 1; done
	$(BIN)/python -m experiments.pages

bench: install  ## how fast it is: simulation, workers, learner, viewer; minutes
	@for name in $(TIMINGS); do $(BIN)/python -m benchmarks $$name --out build/bench || exit 1; done

endurance: install  ## kills, faults and long runs; half an hour
	@for name in $(ENDURANCE); do $(BIN)/python -m tests.endurance $$name --out build/endurance || exit 1; done
	$(BIN)/python -m tests.endurance.stable_baselines3_tests

mutants: install  ## do the tests see changes to core files? each must kill nine of ten; half an hour
	$(BIN)/python -m tests.endurance mutants --out build/endurance

clean:  ## remove what was built, but no runs
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
