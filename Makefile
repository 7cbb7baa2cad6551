# `make train` and `make test` work as the first command in a fresh clone.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= $(if $(filter file,$(origin PYTHON)),.venv,.venv-$(notdir $(PYTHON)))
BIN := $(VENV)/bin
SIMULATIONS ?= 100
BALANCE_SIMULATIONS ?= 300
BALANCE_SECONDS ?= 10
BALANCE_NEWTONS ?= 75 125
PUSHES ?= 8
WORKERS ?= $(shell nproc)
SEED ?= 1
RUN ?= runs/$(shell date +%Y%m%d-%H%M%S)

.PHONY: help install train test test-slow lint format docs bench tables clean

help:  ## show what can be made
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 12

install: $(VENV)/installed  ## create the environment in .venv, with the tested versions; with PYTHON=python3.13, in .venv-python3.13

$(VENV)/installed: setup.cfg pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; (3, 10) <= sys.version_info[:2] <= (3, 13) or sys.exit("sarah is tested with Python 3.10 to 3.13: make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip -c constraints.txt
	$(BIN)/pip install --quiet -c constraints.txt --editable '.[dev]'
	@touch $@

train: RUN := $(RUN)
train: install  ## both trainings with NAF, figures, reports and robustness table: a robot that steps in place and comes back from pushes
	$(BIN)/sarah-train --task stepping --simulations $(SIMULATIONS) --seed $(SEED) \
		--workers $(WORKERS) --run-dir $(RUN)/stepping
	$(BIN)/sarah-train --task balance --from $(RUN)/stepping --simulations $(BALANCE_SIMULATIONS) --seed $(SEED) \
		--episode.time-limit $(BALANCE_SECONDS) --episode.push.newtons $(BALANCE_NEWTONS) \
		--workers $(WORKERS) --run-dir $(RUN)/balance
	$(BIN)/sarah-figures $(RUN)/stepping $(RUN)/balance --out $(RUN)/figures
	$(BIN)/sarah-report $(RUN)/stepping --workers $(WORKERS)
	$(BIN)/sarah-report $(RUN)/balance --workers $(WORKERS)
	$(BIN)/sarah-eval $(RUN)/balance --robustness $(RUN)/figures --episodes $(PUSHES) --workers $(WORKERS)

test: install  ## the tests
	$(BIN)/python -m pytest -n 2 --dist worksteal -m 'not slow'

test-slow: install  ## the slow tests: minutes of simulation
	$(BIN)/python -m pytest -m slow

lint: install  ## style, types and which package imports which
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy -p sarah
	$(BIN)/lint-imports --no-logo

format: install  ## put the style right
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: install  ## the documentation, into build/docs
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going docs build/docs
	@echo build/docs/index.html

bench: install  ## how fast it is: simulation, workers, learner; minutes
	$(BIN)/python benchmarks/throughput.py

tables: install  ## the tables of the README and docs: hours of simulation
	$(BIN)/python benchmarks/landscape.py --engines pybullet mujoco --episodes 3 --seconds 12
	$(BIN)/python benchmarks/landscape.py --task balance --engines pybullet mujoco --episodes 12 --seconds 8
	$(BIN)/python benchmarks/engines.py
	$(BIN)/python benchmarks/clock.py
	$(BIN)/python benchmarks/physics.py
	$(BIN)/python benchmarks/physics.py --random 40 --seeds 4
	$(BIN)/python benchmarks/physics.py 0.2,0,0,0 0.3,0,0,0 0.4,0,0,0 0.5,0,0,0 0.6,0,0,0 0.7,0,0,0 --newtons 100
	$(BIN)/python benchmarks/first_training.py --algo naf --episodes 12 --reference-episodes 4
	$(BIN)/python benchmarks/robot.py --pushes 20 --unpushed 2
	$(BIN)/python benchmarks/hip_laws.py pitch:swing:1 acceleration:both:1 acceleration:held:1 acceleration:sampled:1 \
		angle:swing:1 --newtons 105 --pushes 200 --unpushed 2
	$(BIN)/python benchmarks/stepping_and_hips.py
	$(BIN)/python benchmarks/second_training.py --algo naf

clean:  ## remove what was built, but no runs
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
