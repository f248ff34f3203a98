"""What completion shows of the public modules: their own names, sorted, and nothing that they merely import."""

import inspect

import pytest

import warpffrf as wf

MODULES = [name for name in wf.__all__ if inspect.ismodule(getattr(wf, name))]


@pytest.mark.parametrize("name", MODULES)
def test_a_module_shows_its_public_names_alone(name: str) -> None:
    module = getattr(wf, name)
    assert dir(module) == sorted(module.__all__)
    for public in module.__all__:
        value = getattr(module, public)
        home = getattr(value, "__module__", module.__name__) if callable(value) else module.__name__
        assert not public.startswith("_") and home.startswith("warpffrf"), public
        if inspect.isclass(value) or inspect.isfunction(value):
            assert inspect.getdoc(value), public


def test_the_package_shows_its_public_names_alone() -> None:
    assert set(dir(wf)) == {*wf.__all__, "__version__"}
    assert len(MODULES) >= 13
