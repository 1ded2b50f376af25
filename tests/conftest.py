"""Settings of all tests: property tests have no time limit for one example, for compilation and busy machines are not failures."""
import signal

from hypothesis import settings

settings.register_profile("asemd", deadline=None)
settings.load_profile("asemd")


def pytest_configure(config):
    """Started in the background, a process ignores Ctrl-C, and so do its children: tests of interrupted runs would never end."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
