PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CPP := $(shell find cpp python -name '*.?pp')
SOURCES := pyproject.toml CMakeLists.txt README.md $(CPP) $(shell find ngsxfem_contact -type f ! -name '*.so' ! -name '*.pyc' ! -name _build_info.py)
BUILD_REQUIRES = $(shell sed -n 's/^requires = \[\(.*\)\]/\1/p' pyproject.toml | tr , ' ')

.DELETE_ON_ERROR:
.PHONY: help demo test dev notebooks docs lint format tidy stubs coverage sanitize wheel release clean

help: ## show these targets (default)
	@sed -n 's/^\([a-z]*\):.*## /  make \1\t/p' Makefile

demo: $(VENV)/plot.stamp ## build the package into .venv and run its main job in results/
	mkdir -p results
	cd results && $(CURDIR)/$(BIN)/python -m ngsxfem_contact

test: $(VENV)/test.stamp ## build the package into .venv and run its tests, on all cores
	$(BIN)/python -m pytest --numprocesses auto --dist worksteal $(PYTEST)

dev: $(VENV)/dev.stamp ## editable install into .venv that compiles only what changed
	$(BIN)/pip install --no-build-isolation -c tools/constraints.txt -e '.[plot,test]'

notebooks: $(VENV)/docs.stamp ## execute the tutorials to notebooks in docs/tutorials
	$(BIN)/python tools/notebooks.py

docs: notebooks ## build the documents in build/docs, warnings are errors
	$(BIN)/sphinx-build -W --keep-going -q docs build/docs

lint: $(VENV)/dev_tools.stamp ## check format, style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	@! grep -nP '\t|\s$$' $(CPP) || { echo "C++ has tabs, or blanks at the end of a line"; exit 1; }

format: $(VENV)/dev_tools.stamp ## format Python (C++ is set by hand: i+1, and 2*x*y beside a + b, say what belongs together)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# clang does not know two options of g++ that NGSolve's targets bring.
tidy: $(VENV)/dev_tools.stamp ## look for mistakes in the C++ with clang-tidy, ten minutes
	$(BIN)/cmake -S . -B build/tidy -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN)/ninja) -DCMAKE_EXPORT_COMPILE_COMMANDS=ON \
	  -DPython3_EXECUTABLE=$(abspath $(BIN)/python)
	sed -i 's/ -fabi-version=17//; s/ -fcx-limited-range//' build/tidy/compile_commands.json
	$(BIN)/clang-tidy -p build/tidy --quiet $(filter %.cpp,$(CPP))

stubs: $(VENV)/dev_tools.stamp ## write the types of the extension, ngsxfem_contact/*.pyi
	$(BIN)/python tools/stubs.py

coverage: $(VENV)/dev_tools.stamp ## run the tests with an instrumented build, report the lines reached
	tools/coverage.sh $(BIN)/python

sanitize: $(VENV)/dev_tools.stamp ## run the tests under the address and undefined-behaviour sanitizers
	tools/sanitize.sh $(BIN)/python

wheel: $(VENV)/dev_tools.stamp ## build sdist and wheel in dist/, as a release does
	$(BIN)/python -m build
	sh tools/repair_wheel.sh $$(ls -t dist/*-linux_*.whl | head -n 1) dist $(BIN)/python
	rm -f dist/*-linux_*.whl

release: $(VENV)/dev_tools.stamp ## cut VERSION=..., build sdist and wheel in dist/, try them; nothing is committed or uploaded
	$(BIN)/python tools/release.py $(VERSION)

clean: ## remove all that was built, and .venv; keep results/
	rm -rf build dist docs/tutorials $(VENV) ngsxfem_contact/_build_info.py ngsxfem_contact/_ngsxfem_contact*.so

$(VENV)/venv.stamp:
	@command -v $(PYTHON) > /dev/null || { echo "missing: $(PYTHON)"; \
	  echo "  on Debian/Ubuntu: sudo apt-get install python3 python3-venv python3-dev"; exit 1; }
	@$(PYTHON) tools/check_prerequisites.py
	$(PYTHON) -m venv $(VENV)
	@# `study`, beside the package, is found from every folder, after what is installed
	echo $(CURDIR) > $$($(BIN)/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/study.pth
	touch $@

# What `make dev` installed stays editable.
$(VENV)/package.stamp: $(VENV)/venv.stamp $(SOURCES)
	@echo "compiling the core, some minutes; lines [n/N] count its files"
	if [ -e $(VENV)/dev.stamp ]; then $(BIN)/pip install -v --no-build-isolation -e .; else $(BIN)/pip install -v .; fi
	touch $@

$(VENV)/dev_tools.stamp: $(VENV)/package.stamp
	$(BIN)/pip install -c tools/constraints.txt 'ngsxfem_contact[dev,test,plot]'
	touch $@

# The package is installed already: this only adds what the extra needs.
$(VENV)/%.stamp: $(VENV)/package.stamp tools/constraints.txt
	$(BIN)/pip install -c tools/constraints.txt 'ngsxfem_contact[$*]'
	touch $@

$(VENV)/dev.stamp: $(VENV)/venv.stamp pyproject.toml
	$(BIN)/pip install $(BUILD_REQUIRES)
	touch $@
