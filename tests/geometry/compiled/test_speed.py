"""While numba compiles for us the collector rests at a low level, and only then."""

import gc
from collections.abc import Iterator

import pytest
from numba import njit
from numba.core import config, event
from numba.core.errors import TypingError

from v3dcad.geometry.compiled.speed import LEVEL, hasten_compiling


class Watcher(event.Listener):
    def __init__(self) -> None:
        self.seen: list[tuple[bool, int]] = []

    def on_start(self, _: object) -> None:
        self.seen.append((gc.isenabled(), int(config.OPT)))

    def on_end(self, _: object) -> None: ...


@pytest.fixture
def watcher() -> Iterator[Watcher]:
    """Listens after a hastener of the package "ours"; both are taken away again."""
    listeners = event._registered["numba:compile"]
    before = list(listeners)
    hasten_compiling("ours")
    watcher = Watcher()
    event.register("numba:compile", watcher)
    yield watcher
    listeners[:] = before


def compiled(module, callee=None):
    def function(x):
        return x + 1 if callee is None else callee(x)

    function.__module__ = module
    return njit(function)


@pytest.mark.parametrize("collects", [True, False])
def test_a_function_of_the_package_is_compiled_quickly(watcher, collects):
    level = config.OPT
    if not collects:
        gc.disable()
    try:
        assert compiled("ours.part", compiled("ours.other"))(1) == 2
        assert gc.isenabled() == collects
    finally:
        gc.enable()
    assert watcher.seen == [(False, LEVEL)] * 2
    assert config.OPT is level


def test_others_are_compiled_as_they_would_be(watcher):
    assert compiled("oursister")(1) == 2
    assert watcher.seen == [(True, int(config.OPT))]


def test_what_ours_calls_is_compiled_quickly_too(watcher):
    assert compiled("ours.part", compiled("theirs"))(1) == 2
    assert watcher.seen == [(False, LEVEL)] * 2
    assert compiled("theirs", compiled("ours.part"))(1) == 2
    assert watcher.seen[2:] == [(True, int(config.OPT)), (False, LEVEL)]
    assert gc.isenabled()


def test_a_failure_leaves_nothing_behind(watcher):
    level, broken = config.OPT, compiled("ours.part", "no function")
    with pytest.raises(TypingError):
        broken(1)
    assert gc.isenabled()
    assert config.OPT is level
