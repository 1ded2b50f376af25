"""Settings of all tests: property tests have no time limit for one example, for compilation and busy machines are not failures."""
import signal

import pytest
from hypothesis import settings

settings.register_profile("asemd", deadline=None)
settings.load_profile("asemd")


def pytest_configure(config):
    """Started in the background, a process ignores Ctrl-C, and so do its children: tests of interrupted runs would never end."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """With ``-n``, every worker begins with a stretch of files of its own and takes over what others have left: tests of one file share
    what they set up, and two workers seldom compile the same kernels at the same time. ``--dist`` says otherwise."""
    if config.getvalue("dist") == "load":       # what xdist takes where nothing is said
        from xdist.scheduler import WorkStealingScheduling
        return WorkStealingScheduling(config, log)
    return None
