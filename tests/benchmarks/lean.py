"""What it saves to leave out what a scene does not need: time and memory of five scenes as they are, and with everything switched on.

Everything: charges and a Coulomb part, bonded partners, angles and dihedrals (with coefficients of zero), the image shifts of a tilted cell
in three dimensions, and energy and virial on every step. The atoms move in the same way, which the energies show.

``python -m tests.benchmarks.lean --docs`` measures, keeps the figures in docs/measured/lean.json and puts the table into docs/plan.md.
"""
from __future__ import annotations

import json
import math
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.benchmarks import compare, scenes

FILE, PAGE = scenes.ROOT / "docs" / "measured" / "lean.json", scenes.ROOT / "docs" / "plan.md"
BEGIN, END = "<!-- lean: begin -->", "<!-- lean: end -->"
AGREE = 1e-6        # of the potential energy, after the first steps
TILT = 1e-9         # the cell counts as tilted, and is not
KINDS = {2: "bond", 3: "angle", 4: "dihedral"}


@dataclass
class Atoms:
    """Positions, charges, and the items of chains of `length` atoms, in a box."""

    x: np.ndarray
    box: tuple[float, float, float]
    length: int = 1
    q: np.ndarray = field(default=None)

    def style(self, full: bool) -> str:
        """The atom style."""
        return "full" if full or self.q is not None else "molecular" if self.length > 1 else "atomic"

    def items(self, k: int) -> list[list[int]]:
        """All items of `k` atoms in a row."""
        starts = [c + i + 1 for c in range(0, len(self.x), self.length) for i in range(self.length - k + 1)]
        return [[start + j for j in range(k)] for start in starts]

    def data(self, full: bool, flat: bool = False, kinds=(2,)) -> str:
        """The data file: bare, or with everything."""
        n, charge = len(self.x), self.q if self.q is not None else np.zeros(len(self.x))
        style = self.style(full)
        items = {k: self.items(k) for k in ((2, 3, 4) if full and self.length > 3 else kinds if self.length > 1 else ())}
        out = ["atoms", "", f"{n} atoms", "1 atom types"]
        out += [line for k, v in items.items() for line in (f"{len(v)} {KINDS[k]}s", f"1 {KINDS[k]} types")]
        height = 60.0 if flat and full else 1.0 if flat else self.box[2]
        low = -0.5 * height if flat else 0.0
        out += [f"0 {self.box[0]} xlo xhi", f"0 {self.box[1]} ylo yhi", f"{low} {low + height} zlo zhi"]
        out += [f"{TILT} {TILT} {TILT} xy xz yz"] * full + ["", "Masses", "", "1 1", "", f"Atoms # {style}", ""]
        for i, x in enumerate(self.x):
            molecule = [str(i // self.length + 1)] * (style != "atomic")
            out.append(" ".join([str(i + 1), *molecule, "1", *[f"{charge[i]:.3f}"] * (style == "full"), *(f"{a:.6f}" for a in x)]))
        for k, v in items.items():
            out += ["", f"{KINDS[k].capitalize()}s", "", *(f"{m} 1 " + " ".join(map(str, item)) for m, item in enumerate(v, 1))]
        return "\n".join(out) + "\n"


@dataclass
class Scene:
    """A scene in both forms; `pairs` is the pair style as it is, with its coefficients, `strong` that with everything."""

    name: str
    atoms: Atoms
    pairs: tuple[str, str]
    strong: tuple[str, str]
    kinds: tuple[int, ...] = (2,)
    flat: bool = False
    open: bool = False
    dt: float = 0.002
    stiff: float = 100.0
    speed: float = 1.0

    def script(self, full: bool) -> str:
        """Up to the run."""
        atoms = self.atoms
        kinds = (2, 3, 4) if full and atoms.length > 3 else self.kinds if atoms.length > 1 else ()
        pair, coeff = self.strong if full else self.pairs
        lines = ["units lj", f"dimension {2 if self.flat and not full else 3}", f"atom_style {atoms.style(full)}",
                 f"boundary {'s s s' if self.open and not full else 'p p p'}", *[f"pair_style {pair}"] * bool(pair),
                 *(f"{KINDS[k]}_style harmonic" for k in kinds), "read_data data.full" if full else "read_data data.lean",
                 *[f"pair_coeff * * {coeff}"] * bool(pair)]
        values = {2: f"{self.stiff} 1", 3: "20 120" if 3 in self.kinds else "0 120", 4: "1 1 3" if 4 in self.kinds else "0 1 3"}
        lines += [f"{KINDS[k]}_coeff 1 {values[k]}" for k in kinds] + ["special_bonds lj/coul 0 0 1"] * (atoms.length > 1 and bool(pair))
        lines += [f"variable v{a} atom {self.speed}*sin({k}*id)" for k, a in ((12.9, "x"), (7.3, "y"), (3.1, "z"))]
        lines += [f"velocity all set v_vx v_vy {'0.0' if self.flat else 'v_vz'}", "fix 1 all nve", f"timestep {self.dt}",
                  f"thermo {1 if full else 1000000}", "thermo_style custom step pe press" if full else "thermo_style custom step pe"]
        return "\n".join([*lines, ""])


def chains(count: int, length: int, apart: float = 2.5, charge: float = 0.0) -> Atoms:
    """Zigzag chains on a square grid."""
    along = np.arange(length)
    one = np.column_stack([0.866 * along, 0.5 * (along % 2), 0.1 * (along % 3)])
    side = math.ceil(count**0.5)
    x = np.concatenate([one + (1.0, 1.0 + apart * (c % side), 1.0 + apart * (c // side)) for c in range(count)])
    q = charge * (-1.0) ** np.arange(len(x)) if charge else None
    return Atoms(x, (0.866 * length + max(4.0, 0.5 * apart), apart * side + 1.0, apart * side + 1.0), length, q)


def grid(counts: tuple[int, int, int], spacing: float) -> Atoms:
    """Atoms on a simple grid."""
    x = np.stack(np.meshgrid(*[np.arange(c) for c in counts], indexing="ij"), -1).reshape(-1, 3) * spacing
    return Atoms(x + 0.3 * spacing * np.array([1.0, 1.0, 0.0 if counts[2] == 1 else 1.0]), tuple(spacing * c for c in counts))


def five(small: bool = False) -> list[Scene]:
    """The scenes; `small`: only to see that they work."""
    lj, both, nothing = ("lj/cut 2.5", "1 1"), ("lj/cut/coul/cut 2.5", "1 1"), ("lj/cut/coul/cut 2.5", "0 1")
    edge, many, plane = (8, 20, 30) if small else (30, 2000, 200)
    return [
        Scene("LJ gas without bonds", grid((edge,) * 3, 2.2), lj, both),
        Scene("bonded chains without pairs", chains(many, 20), ("", ""), nothing),
        Scene("LJ in two dimensions", grid((plane, plane, 1), 1.15), lj, both, flat=True),
        Scene("single molecule without a box", chains(1, 60, apart=60.0), ("lj/cut 8.0", "0.1 1"), ("lj/cut/coul/cut 8.0", "0.1 1"),
              kinds=(2, 3, 4), open=True, speed=0.3),
        Scene("charged molecules, cut-off Coulomb", chains(many // 4, 20, charge=0.3), ("coul/cut 3.0", ""), ("lj/cut/coul/cut 3.0", "0 1"),
              kinds=(2, 3), speed=0.3),
    ]


def measure(steps: int = 200, samples: int = 5, small: bool = False) -> dict:
    """Seconds a step in turns, megabytes, and the energies after the first steps, of both forms of each scene."""
    out = {}
    for scene in five(small):
        forms = {}
        with tempfile.TemporaryDirectory() as tmp:
            running = {}
            try:
                for form, full in (("lean", False), ("full", True)):
                    folder = Path(tmp) / form
                    folder.mkdir()
                    (folder / f"data.{form}").write_text(scene.atoms.data(full, scene.flat, scene.kinds))
                    running[form] = compare.Running(compare.Contender(form, "asemd"), folder, "log.x")
                    running[form].do([*scene.script(full).splitlines(), "run 10"])
                    forms[form] = {"seconds": [], "energy": energy(folder / "log.x")}
                for _ in range(samples):
                    for form, r in running.items():
                        forms[form]["seconds"].append(r.do([f"run {steps} pre no post no"])["seconds"] / steps)
                        forms[form]["memory"] = largest_memory(r.process.pid)
            finally:
                for r in running.values():
                    r.stop()
        lean, full = forms["lean"], forms["full"]
        if not math.isclose(lean["energy"], full["energy"], rel_tol=AGREE, abs_tol=1e-9):
            raise AssertionError(f"{scene.name}: not the same scene, energies {lean['energy']} and {full['energy']}")
        ratio = compare.spread([b / a for a, b in zip(lean["seconds"], full["seconds"])])
        out[scene.name] = {"atoms": len(scene.atoms.x), "ratio": ratio,
                           **{form: {**compare.spread(v.pop("seconds")), **v} for form, v in forms.items()}}
    return out


def largest_memory(process: int) -> float:
    """Megabytes; Linux only, nan elsewhere. What `resource` tells includes the process that started this one."""
    status = Path(f"/proc/{process}/status")
    found = re.search(r"VmHWM:\s*(\d+)", status.read_text()) if status.exists() else None
    return int(found[1]) / 1024 if found else math.nan


def energy(log: Path) -> float:
    """Potential energy in the last thermo row."""
    rows = [line.split() for line in log.read_text().splitlines() if line.split()[:1] == ["10"]]
    return float(rows[-1][1])


def table(result: dict) -> str:
    """Markdown."""
    lines = ["| scene | atoms | \u00b5s a step | with everything | times | memory, MB | with everything |",
             "|---|---:|---:|---:|---:|---:|---:|"]
    for name, r in result.items():
        lean, full, t = r["lean"], r["full"], r["ratio"]
        spread = f"{t['median']:.2f} [{t['q1']:.2f}, {t['q3']:.2f}]"
        lines.append(f"| {name} | {r['atoms']} | {1e6 * lean['median']:.3g} | {1e6 * full['median']:.3g} | {spread} | "
                     f"{lean['memory']:.0f} | {full['memory']:.0f} |")
    return "\n".join(lines)


def into_page(text: str, found: dict) -> str:
    """The page with the table between its marks."""
    head, _, rest = text.partition(BEGIN)
    machine = found["machine"]
    where = f"{machine['cpu']}, one thread, double precision, numba {machine['numba']}; medians, quartiles in brackets."
    return f"{head}{BEGIN}\n{table(found['scenes'])}\n\n{where}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    p = compare.arguments(__doc__, samples=7)
    p.add_argument("--docs", action="store_true", help="keep the figures and put the table into the documentation")
    o = p.parse_args()
    measure(1, 1)       # kernels are compiled
    found = {"machine": compare.machine(), "scenes": measure(o.steps, o.samples)}
    print(table(found["scenes"]))
    if o.docs:
        FILE.write_text(json.dumps(found, indent=1) + "\n")
        PAGE.write_text(into_page(PAGE.read_text(), found))
