"""``dump ID group extxyz N file``: the extended XYZ format, with cell, velocities and forces.

Source: https://github.com/libAtoms/extxyz, LAMMPS manual, dump extxyz. ASE and OVITO read it.
"""
from __future__ import annotations

from asemd.dump import frame
from asemd.dump.xyz import XYZ
from asemd.errors import InputError

# thermo keywords that bring the potential energy, the temperature and the pressure tensor with them
POTENTIAL = {"pe", "etotal", "evdwl", "ecoul", "epair", "ebond", "eangle", "edihed", "eimp", "emol", "elong", "etail", "enthalpy",
             "econserve", "c_thermo_pe"}
TEMPERATURE = {"temp", "ke", "etotal", "enthalpy", "econserve", "press", "c_thermo_temp", "c_thermo_press"}
TENSOR = {"pxx", "pyy", "pzz", "pxy", "pxz", "pyz"}
COLUMNS = {"vel": ("vel:R:3", ["vx", "vy", "vz"]), "forces": ("forces:R:3", ["fx", "fy", "fz"]), "mass": ("mass:R:1", ["mass"])}


class ExtXYZ(XYZ):
    """Element (or type label) and position, velocity and force of each atom; the comment line has step, time, cell and periodicity.

    The potential energy, temperature and pressure tensor are added on steps whose thermo row knows them. ``dump_modify vel no``,
    ``forces no``, ``mass yes`` choose the columns.
    """

    style = "extxyz"
    KEYWORDS = {**XYZ.KEYWORDS, **dict.fromkeys(COLUMNS, 1)}

    def __init__(self, group: str, every: int, path: str, *, variables=None, regions=None):
        self.vel = self.forces = True
        self.mass = False
        super().__init__(group, every, path, variables=variables, regions=regions)
        self._arrange()
        self.numeric = False

    def _arrange(self) -> None:
        self.columns = ["typelabel", "x", "y", "z", *(c for name, (_, own) in COLUMNS.items() if getattr(self, name) for c in own)]

    def check_scene(self, system):
        super().check_scene(system)
        if self.numeric or not (self.element or system.labels.get("atom")):
            raise InputError(f"dump extxyz: atoms need names: dump_modify {self.id} element ..., or type labels (labelmap)")

    def symbols(self, view):
        self.check_scene(view.system)
        return super().symbols(view)

    def head(self, snapshot, step, n):
        box, _ = frame(snapshot.system.box)
        parts = [f"Timestep={step} Time={step * snapshot.dt:f}", f'pbc="{" ".join("FT"[int(p)] for p in box.periodic)}"',
                 f'Lattice="{" ".join(f"{c:g}" for row in box.cell for c in row)}"', *self._known(step)]
        properties = ["species:S:1:pos:R:3", *(text for name, (text, _) in COLUMNS.items() if getattr(self, name))]
        return f"{n}\n{' '.join(parts)} Properties={':'.join(properties)}\n"

    def _known(self, step: int) -> list[str]:
        """What the thermo row of this step knows of the whole system."""
        words, moment = self.variables.provider.thermo_words(step) if self.variables else ((), None)
        parts = []
        if POTENTIAL & set(words):
            parts.append(f"Potential_energy={_number(moment.potential())}")
        if TEMPERATURE & set(words):
            parts.append(f"Temperature={_number(moment.temperature())}")
        if TENSOR & set(words):
            xx, yy, zz, xy, xz, yz = (moment.pressure(i) for i in range(6))
            parts.append(f'Stress="{" ".join(map(_number, (xx, xy, xz, xy, yy, yz, xz, yz, zz)))}"')
        return parts

    def _modify_flag(self, values, what, key):
        super()._modify_flag(values, what, key)
        self._arrange()


def _number(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e16 else repr(float(value))
