"""What the virial of every step costs, which barostats need: processor time of a run with and without it, in turns, and with the energies
of every step instead."""
from __future__ import annotations

import time

from tests.benchmarks import compare, scenes

SCRIPT = scenes.lj((20, 20, 20))


def loops() -> dict[str, object]:
    """Sessions of the LJ melt: plain, with the virial of every step."""
    from asemd.fix import Fix
    from asemd.lammps import Lammps

    class Watch(Fix):
        """Asks for the virial and does nothing."""

        style, virial_every = "watch", 1

    out = {}
    for name in ("plain", "virial"):
        lmp = Lammps(cmdargs=["-screen", "none", "-log", "none"])
        lmp.commands_string(SCRIPT)
        if name == "virial":
            watch = Watch()
            watch.id = "watch"
            lmp.session.scene.fixes["watch"] = watch
        lmp.commands_string("run 20\n")
        out[name] = lmp
    return out


def measure(samples: int = 5, steps: int = 100) -> dict:
    """Milliseconds of processor time per step, and those with the virial in terms of those without."""
    sessions = loops()
    seen: dict[str, list[float]] = {name: [] for name in (*sessions, "energies")}
    for _ in range(samples):
        for name in seen:
            lmp = sessions.get(name, sessions["plain"])
            began = time.process_time()
            if name == "energies":
                for _ in range(steps):
                    lmp.session.loop.advance(1)
            else:
                lmp.commands_string(f"run {steps} pre no\n")
            seen[name].append(1e3 * (time.process_time() - began) / steps)
    return {"ms per step": {name: compare.spread(values) for name, values in seen.items()},
            "virial / plain": compare.spread([v / p for v, p in zip(seen["virial"], seen["plain"], strict=True)])}


if __name__ == "__main__":
    o = compare.arguments(__doc__, samples=5, steps=100).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps), o.json)
