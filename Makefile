# make demo   the main job, end to end, on simulated hardware
# make test   all tests
# make bench  measure the kernels
# make help   the rest
PYTHON ?= python3
BIN := .venv/bin
COMPILED := setup.py robotd/grid/kernels/build.py $(wildcard robotd/grid/kernels/*/*.[ch] firmware_proto/c/*.[ch]) robotd/sim/firmware/firmware_build.py
WORLD ?= laboratory
SEED ?= 1
PYTEST_ARGS ?=
ONLY ?=
ROOT ?=

.DEFAULT_GOAL := help
.PHONY: help console ui-test console-bench load demo demo-real demo-busy test bench bench-peers paper conservative exact docs deb arm lowest supply faults interop replay-many liars fuzz safety stops kills heads heart lag worlds senses spread truth firmware-test kernels-sanitized lint types contracts check clean

help:  ## Say what can be made
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  make \1\t/' | expand -t 22

demo: .venv/.demo  ## Map a room, localize in it, serve the pose: simulated robot, real serial protocol, real daemon
	@$(BIN)/robotctl demo room $(WORLD) --seed $(SEED) --out demo

demo-real: .venv/.demo  ## The same in a recorded building: make demo-real LOG=path/to/a/carmen.log.gz
	@test -n "$(LOG)" || { echo "usage: make demo-real LOG=path/to/a/carmen.log.gz" >&2; exit 2; }
	@$(BIN)/robotctl demo building "$(LOG)" --out demo

console: .venv/.console  ## The robot in a browser: simulated robot, daemon, gateway; prints an address to open (Ctrl-C ends it)
	@$(BIN)/robotctl demo console $(WORLD) --seed $(SEED) --out console

ui-test: .venv/.ui  ## The console: its types and units by Node, its flows in Debian's Chromium (apt-get install chromium)
	@$(BIN)/python -m tests.ui.run

demo-busy: .venv/.dev  ## Whether make demo finishes beside busy programs: N="2 4 8" RUNS=10 NICE=0 HARSH=1 LOG=... (an hour)
	@$(BIN)/python -m tests.studies.busy.run --world $(WORLD) $(if $(N),--busy $(N)) $(if $(RUNS),--runs $(RUNS)) \
		$(if $(NICE),--nice $(NICE)) $(if $(HARSH),--harsh) $(if $(LOG),--log "$(LOG)")

# Tests start some hundred programs of ours: none compiles again what the one before did, whatever the caller exports.
test: export PYTHONDONTWRITEBYTECODE :=
test: .venv/.dev  ## Run all tests
	@echo "robotd: running all tests (about five minutes on two cores)"
	@$(BIN)/python -m pytest -n 3 --dist worksteal -q $(PYTEST_ARGS)  # three on two cores: the slowest wait for real time

bench: .venv/.dev  ## Measure the engine: all of it into docs/benchmarks, or a part: make bench ONLY=counting
	@$(BIN)/python -m tests.benchmarks.run $(if $(ONLY),--only $(ONLY))

bench-peers: .venv/.dev  ## Localizers of others beside ours, on the same questions: installs them for the run; writes docs/benchmarks/peers.md
	@$(BIN)/python -m tests.benchmarks.peers.run

paper: .venv/.dev  ## The paper's five tests in simulated rooms, as pictures and tables: writes docs/paper (a minute)
	@$(BIN)/python -m tests.studies.paper.run

conservative: .venv/.dev  ## Look 10 000 times for a true pose that the conservative mode loses
	@$(BIN)/python -m tests.studies.conservative.run $(if $(CASES),--cases $(CASES))

exact: .venv/.dev  ## The exact algorithm measured, and the paper's figures of it: writes docs/exact (minutes)
	@$(BIN)/python -m tests.studies.exact.run

faults: .venv/.dev  ## Everything that can go wrong on a serial line, in every state of the daemon: a table (two minutes)
	@$(BIN)/python -m tests.studies.faults.run $(if $(ONLY),--only $(ONLY))

replay-many: .venv/.dev  ## Random sessions with faults, stalls, kills and dying clients, each replayed: COUNT=500 REAL=20 (real ones: minutes)
	@$(BIN)/python -m tests.studies.replay_many.run --count $(or $(COUNT),500) --real $(or $(REAL),20)

firmware-test: .venv/.dev  ## The boards' C against Python under the sanitizers: vectors, random frames, random lives
	@$(BIN)/python -m pytest -q tests/studies/firmware
	@$(BIN)/python -m tests.studies.firmware.run

kernels-sanitized: .venv/.dev  ## All tests that call a kernel, with every kernel under the address and undefined-behaviour sanitizers (minutes)
	@$(BIN)/python -m tests.studies.sanitized.run

liars: .venv/.dev  ## Devices that lie, with right checksums, in every state of the daemon: 10 000 lies, a table (ten minutes)
	@$(BIN)/python -m tests.studies.liars.run $(if $(TRIALS),--trials $(TRIALS))

fuzz: .venv/.dev  ## Strange bytes for every parser, a minute each: make fuzz FUZZ_SECONDS=5; keeps what it learns in tests/studies/fuzz/corpus
	@$(BIN)/python -m tests.studies.fuzz.run $(if $(FUZZ_SECONDS),--seconds $(FUZZ_SECONDS)) $(if $(ONLY),--only $(ONLY))

safety: .venv/.dev  ## How late stops are on the wires in real time, all processors busy (half an hour; make safety SHARE=0.1; ONLY=gateway: of the console)
	@$(BIN)/python -m tests.studies.safety.run $(if $(SHARE),--share $(SHARE)) $(if $(ONLY),--only "$(ONLY)")

load: .venv/.dev  ## Two hundred browsers of the console, ten of them stalled and one hostile: a table (three minutes; PAGES=50)
	@$(BIN)/python -m tests.studies.console.load $(if $(PAGES),--pages $(PAGES))

console-bench: .venv/.ui  ## What the console costs, and how soon people see something, in Debian's Chromium: a table (five minutes)
	@$(BIN)/python -m tests.studies.console.bench $(if $(SECONDS_EACH),--seconds $(SECONDS_EACH))

kills: .venv/.dev  ## A daemon that explores, killed at every write of its maps; another one goes on from each (minutes; ONLY=laboratory SEEDS=3)
	@$(BIN)/python -m tests.studies.kills.run $(if $(ONLY),--only $(ONLY)) $(if $(SEEDS),--seeds $(SEEDS))

heads: .venv/.dev  ## Kill or stop the process that computes, whatever the robot is at: TRIALS=200, a table (half an hour)
	@$(BIN)/python -m tests.studies.heads.run $(if $(TRIALS),--trials $(TRIALS))

stops: .venv/.dev  ## Whether the robot comes to rest whatever ends the daemon, whatever its devices speak: a table (minutes)
	@$(BIN)/python -m tests.studies.stops.run $(if $(ONLY),--only $(ONLY)) $(if $(TRIALS),--trials $(TRIALS))

worlds: .venv/.dev  ## Whether whole daemons map hard worlds and find themselves in them, 20 robots in each: a table (ten minutes; make worlds SEEDS=3 ONLY=hall)
	@$(BIN)/python -m tests.studies.worlds.run $(if $(SEEDS),--seeds $(SEEDS)) $(if $(ONLY),--only $(ONLY))

truth: .venv/.dev  ## All ways to ask of all logs in ROBOTD_DATA, by robotctl eval: writes docs/truth/<date>.md (hours; make truth SHARE=0.1)
	@$(BIN)/python -m tests.studies.truth.run $(if $(SHARE),--share $(SHARE)) $(if $(ONLY),--only $(ONLY))

spread: .venv/.dev  ## A thousand short recordings asked by one worker and by two, ended, killed, resumed: the same answers, how soon (an hour; COUNT=100)
	@$(BIN)/python -m tests.studies.spread.run $(if $(COUNT),--count $(COUNT)) $(if $(ONLY),--only "$(ONLY)")

senses: .venv/.dev  ## How few readings tell where it is, which of two equal rooms it is, and whether being carried off shows (minutes; PLACES=20; LOG=path/to/a/raw.log: being carried off in that building alone)
	@$(BIN)/python -m tests.studies.senses.run $(if $(LOG),--log "$(LOG)") $(if $(PLACES),--places $(PLACES) --twins $(PLACES) --carried $(PLACES)) $(if $(CUTOFF),--cutoff $(CUTOFF))

height: .venv/.dev  ## What maps at several tilts gain among tables, sideboards and crates: looks and ways, a table (minutes; PLACES=20)
	@$(BIN)/python -m tests.studies.height.run $(if $(PLACES),--places $(PLACES))

sessions: .venv/.dev  ## A hundred stops, then fifty more with furniture moved: whether it stays found, and lists what changed (minutes each; SEEDS=1)
	@$(BIN)/python -m tests.studies.sessions.run $(if $(SEEDS),--seeds $(SEEDS)) $(if $(FIRST),--first $(FIRST)) $(if $(LATER),--later $(LATER))

heart: .venv/.dev  ## Whether a stop is on the wires in time, whatever clients do and whatever becomes of the front: writes docs/benchmarks/heart.md (two hours; TRIALS=20)
	@$(BIN)/python -m tests.studies.heart.run $(if $(TRIALS),--trials $(TRIALS) --endings $(TRIALS)) $(if $(ONLY),--only "$(ONLY)")

first-hour: .venv/.dev  ## A new user's first hour, by commands alone: wheel, config init, calibrate, maps in and out; needs ROBOTD_DATA (minutes)
	@$(BIN)/python -m tests.studies.first_hour.run

docs: .venv/.docs  ## The pages as a site, in build/docs: every warning an error, every link followed, nothing foreign
	@$(BIN)/sphinx-build -q -W --keep-going -b html -c docs/site . build/docs
	@$(BIN)/python docs/site/check.py build/docs

deb: .venv/.dev  ## A Debian package in build/deb, with lintian's word on it; make deb ROOT=directory (of debootstrap; as root) installs, runs, upgrades, purges it there
	@$(BIN)/python -m pip wheel -q --disable-pip-version-check --no-deps -w build/deb .
	@$(BIN)/python systemd/debian/build.py build/deb/robotd-*.whl build/deb
	@if command -v lintian >/dev/null; then lintian --tag-display-limit 0 build/deb/robotd_*-1.deb build/deb/robotd-gateway_*-1.deb; else echo "lintian is not installed: not asked"; fi
	@if test -n "$(ROOT)"; then $(BIN)/python systemd/debian/build.py --revision 2 build/deb/robotd-*.whl build/deb && \
		$(BIN)/python systemd/debian/try.py $(ROOT) build/deb/robotd_*-1.deb build/deb/robotd_*-2.deb; fi

arm: .venv/.dev  ## The wheel for aarch64 by Debian's cross compiler, and the tests of kernels and engine on it, played by qemu (an hour)
	@$(BIN)/python -m tests.studies.arm.run $(ONLY)

lowest: .venv/.dev  ## The tests with the lowest version of every dependency that is allowed, in an environment of their own (minutes)
	@$(BIN)/python -m tests.studies.lowest.run $(ONLY)

supply: .venv/.dev  ## What an installed wheel consists of: a bill of materials (CycloneDX), licences, known vulnerabilities (a minute)
	@$(BIN)/python -m tests.studies.supply.run

interop: .venv/.dev  ## Each form of other programs, written and read, a line each: sizes, counts, how far what comes back is (a minute)
	@$(BIN)/python -m tests.studies.interop.run

lag: .venv/.dev  ## How late the event loop is while the daemon works hard, quiet and beside busy programs: writes docs/benchmarks/loop-lag.md
	@$(BIN)/python -m tests.studies.lag.run

lint: .venv/.dev  ## Check format and style
	@echo "robotd: ruff"
	@$(BIN)/ruff format --check --quiet .
	@$(BIN)/ruff check --quiet .
	@echo "robotd: clang-format"
	@$(BIN)/clang-format --dry-run --Werror robotd/grid/kernels/*/*.[ch]

types: .venv/.dev  ## Check types
	@echo "robotd: mypy --strict"
	@$(BIN)/mypy

contracts: .venv/.dev  ## Check which room may import which, and that generated files are fresh
	@echo "robotd: import contracts"
	@$(BIN)/lint-imports --no-cache
	@$(BIN)/python -m firmware_proto.generate --check

check: lint types contracts test  ## Everything that CI checks

clean:  ## Remove the environment and all that was made
	@rm -rf .venv build demo *.egg-info robotd/grid/kernels/*.so robotd/sim/firmware/*.so .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache

.venv/bin/python:
	@echo "robotd: making a Python environment in .venv (once)"
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "robotd needs Python 3.11 or newer: make PYTHON=python3.11 ...")'
	@$(PYTHON) -m venv .venv

.venv/.demo: pyproject.toml $(COMPILED) | .venv/bin/python
	@echo "robotd: installing robotd and what it needs (once, under a minute)"
	@test -e .venv/.dev || $(BIN)/python -m pip install -qq --disable-pip-version-check -e '.[plots]'
	@touch $@

.venv/.console: pyproject.toml $(COMPILED) | .venv/bin/python
	@echo "robotd: installing robotd, its gateway and what the console is built with (once, a minute)"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check -e '.[plots,gateway,console]'
	@touch $@

.venv/.ui: .venv/.dev
	@echo "robotd: installing what the console is built and tried with (once)"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check -e '.[ui]'
	@touch $@

.venv/.dev: pyproject.toml $(COMPILED) | .venv/bin/python
	@echo "robotd: installing robotd and its development tools (once, about a minute)"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check -e '.[dev]'
	@touch $@

.venv/.docs: pyproject.toml | .venv/.dev
	@echo "robotd: installing what makes a site of the pages (once)"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check -e '.[docs]'
	@touch $@
