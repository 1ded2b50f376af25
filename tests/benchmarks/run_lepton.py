"""Steps per second with bond style harmonic and with the same spring as an expression: bead-spring chains, 32,000 atoms."""
from __future__ import annotations

from dataclasses import replace

from tests.benchmarks import compare, scenes

STYLES = {"harmonic": ("400.0", "0.97"), "lepton": ("0.97", "k*r^2;k=400.0")}      # style and its two coefficients


def script() -> str:
    """The chain scene without pair forces, so that bonds are what takes time; the bond style comes from switches."""
    replaced = {"bond_style": "bond_style ${style}", "bond_coeff": "bond_coeff 1 ${first} ${second}", "pair_style": "pair_style zero 1.12",
                "pair_coeff": "pair_coeff * *", "pair_modify": "", "special_bonds": "special_bonds lj 0 1 1"}
    return "\n".join(replaced.get((line.split() or [""])[0], line) for line in scenes.chain().splitlines())


def measure(samples: int = 7, steps: int = 100, threads: int = 1, precision: str = "double") -> dict:
    """Both styles in asemd and in LAMMPS, in turns; ``lepton / harmonic`` is the speed that the expression leaves."""
    who = [replace(c, name=f"{c.name} {style}", switches=[*c.switches, "-var", "style", style, "-var", "first", a, "-var", "second", b])
           for c in compare.contenders(threads, precision) for style, (a, b) in STYLES.items()]
    seconds = compare.alternate(who, script(), steps, samples)
    out = compare.rates(seconds, steps)
    names = list(seconds)
    out["lepton / harmonic"] = {plain.removesuffix(" harmonic"): compare.spread([a / b for a, b in zip(seconds[plain], seconds[ours])])
                                for plain, ours in zip(names[::2], names[1::2])}
    return out


if __name__ == "__main__":
    o = compare.arguments(__doc__).parse_args()
    compare.show(__doc__, measure(o.samples, o.steps, o.threads, o.precision), o.json)
