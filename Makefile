PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := setup.py pyproject.toml CMakeLists.txt README.md \
  $(wildcard cpp/*.?pp python/*.?pp) \
  $(filter-out %/_build_info.py,$(wildcard ngsxfem_contact/*.py)) ngsxfem_contact/py.typed
BUILD_REQUIRES = $(shell sed -n 's/^requires = \[\(.*\)\]/\1/p' pyproject.toml | tr , ' ')

.DELETE_ON_ERROR:
.PHONY: help demo test dev clean

help: ## show these targets (default)
	@sed -n 's/^\([a-z]*\):.*## /  make \1\t/p' Makefile

demo: $(VENV)/plot.stamp ## build the package into .venv and run its main job in results/
	mkdir -p results
	cd results && ../$(BIN)/python -m ngsxfem_contact

test: $(VENV)/test.stamp ## build the package into .venv and run its tests
	$(BIN)/python -m pytest tests

dev: $(VENV)/dev.stamp ## editable install into .venv that compiles only what changed
	$(BIN)/pip install --no-build-isolation -e '.[plot,test]'

clean: ## remove all that was built, and .venv; keep results/
	rm -rf build *.egg-info $(VENV) ngsxfem_contact/_build_info.py ngsxfem_contact/_ngsxfem_contact*.so

$(VENV)/venv.stamp:
	@command -v $(PYTHON) > /dev/null || { echo "missing: $(PYTHON)"; \
	  echo "  on Debian/Ubuntu: sudo apt-get install python3 python3-venv python3-dev"; exit 1; }
	@$(PYTHON) tools/check_prerequisites.py
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/package.stamp: $(VENV)/venv.stamp $(SOURCES)
	rm -rf build/lib*
	$(BIN)/pip install .
	touch $@

# The package is installed already: this only adds what the extra needs.
$(VENV)/%.stamp: $(VENV)/package.stamp
	$(BIN)/pip install 'ngsxfem_contact[$*]'
	touch $@

$(VENV)/dev.stamp: $(VENV)/venv.stamp pyproject.toml
	$(BIN)/pip install $(BUILD_REQUIRES)
	touch $@
