"""What LAMMPS is asked in its own process (`asemd.testing.oracle.ask`): scripts, as text."""
from __future__ import annotations

from asemd import coulomb_table

COMMANDS = r"""
def execute(lmp, commands):
    for line in commands:
        try:
            lmp.command(line)
        except Exception as e:
            # the message without the place in LAMMPS's own source and the echo of the line
            message = " ".join(str(e).split()).removeprefix("ERROR: ").partition(" (src/")[0]
            return {"error": message, "command": line}
    return {}
"""

TENSOR = "kspace_modify pressure/scalar no"


def comparable(interactions) -> list[str]:
    """Commands after which LAMMPS computes what it has in tables and what is computed here, and has the pressure tensor of msm."""
    return [*coulomb_table.without(interactions), *([TENSOR] if interactions.kspace.startswith("msm") else [])]


# energies, virials and forces of a scene, and its forces again after each category of `order` is taken away
ZERO_STEP = COMMANDS + r"""
lmp = start(*given["switches"])
categories, order = given["categories"], given["order"]
computes = [f"compute virial_{c} all pressure NULL {c}" for c in categories]
columns = " ".join(f"c_virial_{c}[1]" for c in categories)
answer = execute(lmp, [*given["commands"], *computes, f"thermo_style custom step pe press {columns}",
                       "thermo_modify norm no", "run 0 post no"])
if not answer:
    answer = {"id": np.sort(by_id(lmp, "id")), "energy": {k: lmp.get_thermo(k) for k in given["energies"]},
              "virial": {c: np.array([lmp.extract_compute(f"virial_{c}", 0, 1)[k] for k in range(6)]) for c in categories},
              "volume": lmp.get_thermo("vol"), "nktv2p": lmp.extract_global("nktv2p"), "forces": [by_id(lmp, "f")]}
    for category in order:
        if category == order[-1]:
            answer["forces"].append(np.zeros_like(answer["forces"][0]))
            break
        if category == "kspace":
            lines = ["kspace_modify compute no"]
        elif category == "pair":
            lines = ["kspace_style none", f"pair_style zero {given['cutoff']!r} nocoeff", "pair_coeff * *"]
        else:
            lines = [f"{category}_style zero nocoeff", f"{category}_coeff *"]
        failed = execute(lmp, [*lines, "run 0 post no"])
        if failed:
            answer = failed
            break
        answer["forces"].append(by_id(lmp, "f"))
lmp.close()
"""

# thermo rows of runs, with all digits
ROWS = COMMANDS + r"""
import os, re, tempfile
handle, log = tempfile.mkstemp(dir=sys.argv[1])
os.close(handle)
lmp = lammps(cmdargs=["-screen", "none", "-log", log, *given["switches"]])
answer, rows, run, places = {}, [], 0, []
for line in given["commands"]:
    if line.split()[0] in ("run", "minimize"):
        answer = execute(lmp, ["thermo_modify format none", "thermo_modify line yaml format float %.17g", f"print 'ASEMD RUN {run}'", line])
        run += 1
    else:
        answer = execute(lmp, [line])
    if answer:
        break
lmp.close()
run, keys = -1, []
for line in Path(log).read_text().splitlines():
    if line.startswith("ASEMD RUN "):
        run = int(line.split()[2])
    elif line.startswith("keywords: ["):
        keys = re.findall(r"'([^']*)'", line)
    elif line.startswith("  - ["):
        values = [w.strip() for w in line[5:].rstrip("] ").split(",") if w.strip()]
        if len(values) == len(keys):
            rows.append([run, {k: float(v) for k, v in zip(keys, values)}])
answer["rows"] = rows
"""
