r"""Modified embedded-atom method (MEAM): an embedded-atom potential whose densities depend on angles, with screening of neighbours.

$$E=\sum_iF_i(\bar\rho_i)+\tfrac12\sum_i\sum_{j\ne i}S_{ij}f_c(r_{ij})\phi_{ij}(r_{ij}),\quad F(\bar\rho)=AE_c\bar\rho\ln\bar\rho,\quad
\bar\rho_i=\frac{\rho^{(0)}_i}{\rho_i^0}G(\Gamma_i),\quad\Gamma_i=\sum_{h=1}^3t^{(h)}_i\Big(\frac{\rho_i^{(h)}}{\rho_i^{(0)}}\Big)^2$$

$\rho^{(h)}$ are moments of order h of $\rho_0e^{-\beta^{(h)}(r/r_e-1)}$ of the neighbours; $\phi$ follows from the energy of a reference
structure (`asemd.meam_reference`). Atoms in the ellipse between i and j screen them from each other: $S_{ij}=\prod_kS_{ikj}$. Second
neighbours may be part of the reference (2NN MEAM, ``nn2``). ``pair_coeff * * LIBRARY EL1 EL2 ... FILE`` (or NULL) and for each type one
of the elements. The files and what they say: `asemd.meam_file`.

With different ``scale`` of pairs of types (``fix adapt``) our force is the gradient of the energy that LAMMPS reports;
``compat="lammps"`` scales what embedding energies have of a pair like the pair.

Source: LAMMPS manual, pair_style meam; Baskes, Phys. Rev. B 46, 2727 (1992); Lee and Baskes, ibid. 62, 8564 (2000).
"""
from __future__ import annotations

import copy

import numpy as np

from asemd.errors import InputError
from asemd.kernels.meam import COLUMNS, HELPERS, MOMENTS, meam_forces
from asemd.manybody import ManyBody, element_of
from asemd.meam_file import NEIGHBORS, read_library, read_parameters
from asemd.meam_reference import POINTS, Reference
from asemd.pairstyle import PairTables
from asemd.potential_file import PotentialFile, file_among
from asemd.splines import polynomials
from asemd.style import register


class ModifiedEmbedded(ManyBody):
    """Styles meam and, with a `second` set of densities, meam/ms."""

    head_words = "LIBRARY EL1 EL2 ... FILE (or NULL)"
    coefficients = ("scale",)
    like_lammps = False

    def __init__(self, name: str, second: bool, **options):
        super().__init__(name, forces=meam_forces, helpers=HELPERS, rooms=3, shares=7 + MOMENTS * (1 + second), converts=False, **options)
        self.second, self.kernel_constants = second, {"SECOND": second, **COLUMNS}

    def variant(self, settings, compat=""):
        if compat != "lammps":
            return self
        if "_twin" not in vars(self):
            self._twin = copy.copy(self)
            self._twin.like_lammps = True
        return self._twin

    def head(self, words, what):
        return file_among(words, 2, what, "NULL") + 1

    def head_for(self, files, elements):
        return [*files, *elements, "NULL"] if len(files) == 1 else list(files)

    def read_head(self, head, elements, settings):
        what = f"pair_coeff {self.name}"
        library, *listed, name = head
        if len(set(listed)) < len(listed):
            raise InputError(f"{what}: an element is there twice between the files: {' '.join(listed)}")
        for e in elements:
            if e not in listed:
                raise InputError(f"{what}: element {e} is not among those between the files, {' '.join(listed)}")
        file = PotentialFile(library, what)
        files, made = [file], self.read(file, tuple(listed), settings)
        if name != "NULL":
            files.append(PotentialFile(name, what))
            read_parameters(files[-1], made)
        made.complete()
        return {"parameters": made, "files": files, "tables": {}}, file

    def read(self, file, elements, settings):
        made = read_library(file, elements, self.second)
        made.ialloy = int(self.second)
        return made

    def join(self, old, new):
        return {**new, "scale": 1.0}

    def masses(self, coeff, i: int) -> float:
        """Mass of atom type `i` by the library."""
        p = coeff["data"]["parameters"]
        return float(p.mass[p.elements.index(coeff["element"][i - 1])])

    def report(self, coeff):
        return [f"Reading MEAM {kind} file {file.name} with DATE: {file.date}"
                for kind, file in zip(("library", "potential"), coeff["data"]["files"]) if file.date]

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        p, unit, n = c["data"]["parameters"], self.unit_factor(c, units), ntypes + 1
        where = [p.elements.index(e) if e is not None else -1 for e in element]
        reference = Reference(p, self.second)
        atoms, bounds, widest = np.zeros((n, 28)), np.zeros((n, n, n, 2)), np.zeros((n, n))
        offset, scale, rows = np.zeros((n, n), np.int64), np.ones((n, n)), np.zeros((1, n, n))
        for i, a in enumerate(where):
            if a >= 0:
                atoms[i] = self._atom(reference, a, unit)
        high = np.maximum(p.Cmax, 2.0)
        wide = (high * high / (4.0 * (high - 1.0))).max(axis=2)      # r_ik^2 / r_ij^2 of an atom k that screens
        tables, step = [], 1.1 * p.rc / POINTS
        at = {}
        for i, j in {key for pair in filled for key in (pair, pair[::-1])}:
            a, b = key = tuple(sorted((where[i], where[j])))
            if key not in at:
                known = c["data"]["tables"]
                if key not in known:
                    known[key] = polynomials(reference.table(a, b)[0], flat=True)
                at[key] = len(tables) * (POINTS - 1)
                tables.append(unit * known[key])
            offset[i, j], scale[i, j] = at[key], filled[min(i, j), max(i, j)].get("scale", 1.0)
            widest[i, j] = wide[a, b] * (1.0 + 1e-12)
            rows[0, i, j] = p.rc**2 * wide.max()
            for k, e in enumerate(where):
                if e >= 0:
                    bounds[i, j, k] = p.Cmin[where[i], where[j], e], p.Cmax[where[i], where[j], e]
        constants = [p.rc, 1.0 / p.delr, 1.0 / step, POINTS - 2.0, p.ialloy, p.mixture_ref_t, p.emb_lin_neg, p.gsmooth_factor,
                     float(self.like_lammps)]
        return PairTables(rows, np.array(constants, float), (atoms, bounds, widest, np.concatenate(tables), offset, scale))

    def _atom(self, reference: Reference, a: int, unit: float) -> np.ndarray:
        """Row of the kernel's table of an element, see the columns in `asemd.kernels.meam`."""
        p = reference.p
        z, lattice = NEIGHBORS[p.lattce[a, a]], p.lattce[a, a]
        factor = p.t[a] if p.ialloy == 1 else np.ones(3)
        in_forces = p.t[a] if self.second and self.like_lammps else factor
        background = p.rho0[a] * z if p.mixture_ref_t == 1 or p.bkgd_dyn == 1 else reference.rho_ref[a]
        return np.concatenate([[p.re[a, a], p.rho0[a]], p.beta[a], p.beta_m[a], p.rho0[a] * factor, p.rho0[a] * p.t_m[a], p.t[a],
                               [unit * p.A[a] * p.Ec[a, a], p.ibar[a], background, z], reference.shape(lattice, a, a),
                               p.rho0[a] * in_forces])


register(ModifiedEmbedded("meam", False, doc=__doc__, example="library.meam Si C SiC.meam Si",
                          see="M. I. Baskes, Phys. Rev. B 46, 2727 (1992); B.-J. Lee and M. I. Baskes, ibid. 62, 8564 (2000)"))
