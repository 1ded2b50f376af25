"""All benchmarks: ``python -m tests.benchmarks [NAME ...] [--samples 7] [--threads 1 2] [--readme] [--quick]``.

Without names all of them run: the scenes of the table of speeds (`tests.benchmarks.cases`), ``sizes``, ``watchdog``, ``memory``,
``startup`` and ``peers``.
``--readme`` keeps the figures in ``docs/measured/benchmarks.json``, each as soon as it is there, and puts the tables into the README and
``docs/speed.md``; figures of other names stay. On a processor with AVX-512, ``NUMBA_CPU_NAME=haswell python -m tests.benchmarks`` gives the
figures of one with AVX2.
"""
from __future__ import annotations

import argparse
import json
from pathlib import Path

from tests.benchmarks import cases, compare, memory, page, peers, sizes, startup, watchdog

OTHERS = {"watchdog": lambda quick: {"watchdog, percent of the loop": watchdog.measure(2 if quick else 5, quick)},
          "memory": lambda quick: {"memory": memory.measure(samples=1 if quick else 3)},
          "startup": lambda quick: {"start-up": startup.measure(2 if quick else 5)},
          "peers": lambda quick: {"peers": peers.measure(1 if quick else 2, quick)}}


def main() -> None:
    p = argparse.ArgumentParser(description="All benchmarks, or those named.")
    p.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join((*cases.NAMES, 'sizes', *OTHERS))}")
    p.add_argument("--samples", type=int, default=7)
    p.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    p.add_argument("--json", help="write the figures to this file too")
    p.add_argument("--readme", action="store_true", help="keep the figures, and write the tables into README.md and docs/speed.md")
    p.add_argument("--quick", action="store_true", help="short runs that only show that the scripts work")
    o = p.parse_args()
    known = (*cases.NAMES, "sizes", *OTHERS)
    if unknown := [name for name in o.names if name not in known]:
        p.error(f"no benchmark {', '.join(map(repr, unknown))}; there are {', '.join(known)}")
    if o.quick and o.readme:
        p.error("--quick measures nothing that is worth a place in the README")
    samples, found = 2 if o.quick else o.samples, {"machine": compare.machine()}

    def take(part: str, new: dict, lines: list[str]) -> None:
        found[part] = {**found.get(part, {}), **new}
        print(*lines, sep="\n", flush=True)
        if o.readme:
            page.keep({part: new})
    for threads in o.threads:
        for name in cases.NAMES:
            if (o.names and name not in o.names) or (name.startswith("small") and threads > 1):
                continue
            new = cases.measure(name, threads, samples, o.quick)
            take("cases", new, [cases.row(title, result) for title, result in new.items()])
    if not o.names or "sizes" in o.names:
        new = sizes.measure(min(samples, 5), largest=40_000, work=1e6) if o.quick else sizes.measure(min(samples, 5))
        take("sizes", new, sizes.table(new))
    for name, function in OTHERS.items():
        if not o.names or name in o.names:
            new = function(o.quick)
            take("other", new, [line for title, values in new.items() for line in compare.lines(title, values)])
    if o.json:
        Path(o.json).write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
