"""How many threads compute."""
from __future__ import annotations

import os

from asemd.report.knob import Knob


def cores() -> int:
    """Cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


class Threads(Knob):
    """``--threads``: 1, 2, 4 and so on up to the cores of the machine."""

    name, title, order = "threads", "threads", 35

    def needs(self, scene):
        return None if cores() > 1 else "this machine has one core"

    def values(self, scene):
        counts = [2**k for k in range(cores().bit_length()) if 2**k <= cores()]
        return [*counts, *([cores()] if cores() not in counts else [])]

    def current(self, scene):
        return scene.threads

    def apply(self, scene, value, folder):
        scene.threads = value

    def options(self, value):
        return ["--threads", str(value)]

    def phrase(self, value):
        return f"{value} thread{'s' * (value != 1)}"
