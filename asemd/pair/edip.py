r"""Environment-dependent interatomic potential (EDIP) of silicon: pairs and angles that depend on the coordination of an atom.

The formula is that of `pair edip/multi`, for one element. LAMMPS looks its functions up in tables with 8000 points per distance unit and
interpolates; here they are computed, so that energies agree to eight digits. Lines between points are no energy that forces could follow
from: their slopes have steps of 1e-4, which LAMMPS's own forces, from tables of the derivatives, do not show. ``compat="lammps"`` has
what LAMMPS's tables have.
"""
from __future__ import annotations

import copy

from asemd.errors import InputError
from asemd.pair.edip_eight import edip_eight
from asemd.pair.edip_multi import EDIP, HELPERS, edip
from asemd.style import register


class OneElement(EDIP):
    def read(self, file, elements, settings):
        if len(elements) > 1:
            raise InputError(f"{file.what}: it is for one element, got {' '.join(elements)}; use edip/multi")
        return super().read(file, elements, settings)

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        twin = copy.copy(self)
        twin.kernel_constants = {"TABLED": True}
        return twin


register(OneElement("edip", site=edip, eight=edip_eight, eight_rows=17, helpers=HELPERS, rooms=9, converts=False,
                    example="Si.edip Si", doc=__doc__, see="J. F. Justo, M. Z. Bazant, E. Kaxiras, V. V. Bulatov, S. Yip, "
                    "Phys. Rev. B 58, 2539 (1998)"))
