"""The examples in docstrings give what they say."""

import doctest
import importlib
import pkgutil

import pytest

import ngsxfem_contact

MODULES = [
    module.name.removeprefix("ngsxfem_contact.")
    for module in pkgutil.walk_packages(ngsxfem_contact.__path__, "ngsxfem_contact.")
    if not module.name.endswith("__main__")
]


def examples(name):
    """The DocTests of a module that have examples."""
    return [test for test in doctest.DocTestFinder().find(importlib.import_module(f"ngsxfem_contact.{name}")) if test.examples]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    for test in examples(name):
        runner.run(test)
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize("name, described", [("_ngsxfem_contact", "Crack"), ("material", "Elasticity"), ("contact.problem", "ContactProblem")])
def test_examples_are_found(name, described):
    assert any(test.name.endswith(f".{described}") for test in examples(name))
