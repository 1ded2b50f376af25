"""Steps per second with bond style harmonic and with the same spring as an expression: bead-spring chains, 32,000 atoms."""
from __future__ import annotations

from tests.benchmarks import compare, scenes

STYLES = {
    "harmonic": ("bond_style harmonic", "bond_coeff 1 400.0 0.97"),
    "lepton": ("bond_style lepton", 'bond_coeff 1 0.97 "k*r^2; k=400.0"'),
}


def script(style: str) -> str:
    """The chain scene without pair forces and with these bonds, so that bonds are what takes time."""
    replaced = {"bond_style": STYLES[style][0], "bond_coeff": STYLES[style][1], "pair_style": "pair_style zero 1.2",
                "pair_coeff": "pair_coeff * *", "pair_modify": ""}
    return "\n".join(replaced.get((line.split() or [""])[0], line) for line in scenes.chain().splitlines())


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double") -> dict:
    """Both styles in asemd and in LAMMPS; ``lepton of harmonic``: how much speed the expression leaves."""
    out: dict = {"steps_per_second": {}, "lepton of harmonic": {}}
    for style in STYLES:
        seconds = compare.alternate(compare.contenders(threads, precision), script(style), steps, samples)
        for name, rate in compare.rates(seconds, steps)["steps_per_second"].items():
            out["steps_per_second"][f"{name} {style}"] = rate
    for name in seconds:
        out["lepton of harmonic"][name] = (out["steps_per_second"][f"{name} lepton"]["median"]
                                           / out["steps_per_second"][f"{name} harmonic"]["median"])
    return out


if __name__ == "__main__":
    o = compare.arguments(__doc__).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
