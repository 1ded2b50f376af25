"""Settings of all tests: property tests have no time limit for one example, for compilation and busy machines are not failures."""
import os
import signal
from collections import Counter

import pytest
from hypothesis import settings

settings.register_profile("asemd", deadline=None, derandomize=True)     # the same examples each time
settings.register_profile("search", deadline=None)      # others: pytest --hypothesis-profile=search
settings.load_profile("asemd")


os.environ.setdefault("ASEMD_COMPILERS", "1")      # the workers of a run of tests are several processes already


def pytest_configure(config):
    """Started in the background, a process ignores Ctrl-C, and so do its children: tests of interrupted runs would never end."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Of a test marked `part(n)`, compiled, every n-th case runs, the others with `-m slow`; without compiler all run."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return
    seen: Counter = Counter()
    for item in items:
        mark = item.get_closest_marker("part")
        if mark:
            name = item.nodeid.partition("[")[0]
            seen[name] += 1
            if (seen[name] - 1) % mark.args[0]:
                item.add_marker(pytest.mark.slow)
