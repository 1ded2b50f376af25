r"""Machine-learned potentials of descriptors of an atom's neighbours: linear, quadratic, or a neural network.

$$E=\sum_iE_{model}(\mathbf B_i)$$

``pair_style mliap model KIND FILE descriptor KIND FILE`` with the models linear, quadratic and nn. Descriptors are sna, the components of
the bispectrum as in `pair snap`, or so3, those of the smooth SO(3) power spectrum

$$p_{nn'l}=2\sqrt2\,\pi(2l+1)^{-1/2}\sum_mc_{nlm}c_{n'lm},\quad c_{nlm}=\int g_n(r)Y_{lm}(\hat{\mathbf r})
\sum_kw_kf_c(r_k)e^{-\alpha|\mathbf r-\mathbf r_k|^2}d\mathbf r$$

The descriptor file has their parameters and the elements. ``pair_coeff * *`` and an element for each type. The descriptor ace and models in
Python are not supported. The radial part of so3 comes from a table as exact as doubles are; LAMMPS, which computes Bessel functions by
recursion and spherical harmonics by angles, loses digits, and leaves out neighbours that are very close (1e-8).

Source: LAMMPS manual, pair_style mliap; A. Rohskopf et al., J. Mater. Res. 38, 5136 (2023); H. Yanxon, D. Zagaceta, B. Tang, D. Matteson
and Q. Zhu, Mach. Learn.: Sci. Technol. 2, 027001 (2021).
"""
from __future__ import annotations

import numpy as np

from asemd.bispectrum import bispectrum
from asemd.errors import InputError, nearest
from asemd.kernels import power_spectrum as so3
from asemd.kernels.snap import HELPERS, snap
from asemd.manybody import element_of
from asemd.pair.snap import DESCRIBED, SNAP, read_parameters
from asemd.pairstyle import PairTables
from asemd.potential_file import PotentialFile, Record
from asemd.power_spectrum import power_spectrum
from asemd.style import register

ACTIVATIONS = ("linear", "sigmoid", "tanh", "relu")
CHOICES = {"model": ("linear", "quadratic", "nn"), "descriptor": ("sna", "so3")}
WHOLE = {"nmax": (1, 12), "lmax": (0, 12)}      # keywords of descriptor files of so3 with their limits
SO3 = ("rcutfac", "alpha", *WHOLE)              # all of them, with DESCRIBED


class MLIAP(SNAP):
    """Style mliap; its settings have the files."""

    head_words = ""
    coefficients = ()

    def variant(self, settings, compat=""):
        if settings["descriptor"] == "so3":
            return POWER
        return super().variant(settings, compat)

    def parse_coeff(self, words, settings):
        style = self.variant(settings)
        return super().parse_coeff(words, settings) if style is self else style.parse_coeff(words, settings)

    def parse_settings(self, words):
        what, values, k = f"pair_style {self.name}", {}, 0
        while k < len(words):
            name = words[k]
            if name not in CHOICES:
                raise InputError(f"{what}: unknown keyword {name!r}, expected model or descriptor{nearest(name, CHOICES)}")
            if k + 3 > len(words):
                raise InputError(f"{what}: {name} needs a kind and a file")
            if words[k + 1] not in CHOICES[name]:
                raise InputError(f"{what}: {name} must be one of {' '.join(CHOICES[name])}, got {words[k + 1]}")
            values[name], values[f"{name} file"] = words[k + 1], words[k + 2]
            k += 3
        for name in CHOICES:
            if name not in values:
                raise InputError(f"{what} needs {name}, a kind and a file")
        return values

    def format_settings(self, settings):
        return [word for name in CHOICES for word in (name, settings[name], settings[f"{name} file"])]

    def head(self, words, what):
        return 0

    def read(self, file, elements, settings):
        return {**read_parameters(file), "quadraticflag": int(settings["model"] == "quadratic")}

    def described(self, p: dict):
        """Tables of the descriptors, and how many there are."""
        tables = bispectrum(p["twojmax"], bool(p["bnormflag"]))
        return tables, len(tables.components) * (len(p["elems"]) ** 3 if p["chemflag"] else 1)

    def read_head(self, head, elements, settings):
        what = f"pair_coeff {self.name}"
        model, second = PotentialFile(settings["model file"], what), PotentialFile(settings["descriptor file"], what)
        p = self.read(second, elements, settings)
        for e in elements:
            if e not in p["elems"]:
                raise InputError(f"{second.what}: {second.name} has no element {e}, only {' '.join(p['elems'])}")
        (tables, count), named = self.described(p), p["elems"]
        data = {"elements": named, "parameters": p, "files": (model, second), "tables": tables}
        values = self.read_model(model, settings["model"], named, count, data)
        data["by_element"] = {e: (r, w, v) for e, r, w, v in zip(named, p["radelems"], p["welems"], values)}
        return data, model

    def read_model(self, file: PotentialFile, kind: str, named, count: int, data: dict) -> list[np.ndarray]:
        """Coefficients of each element; of a network they come to `data`."""
        lines = [(number, line.split()) for number, line in file.lines]
        if len(lines) < 2:
            raise file.error("the file ends before the coefficients", len(file.raw))
        head = Record(lines[0][1], file.where(lines[0][0]), file.what)
        elements, each = head.whole("the number of elements"), head.whole("the number of coefficients")
        if elements != len(named):
            raise InputError(f"{file.what}: {file.name} is for {elements} elements, the descriptor for {' '.join(named)}", head.where)
        wanted, layers, rest = 1 + count, [], lines[1:]
        if kind == "quadratic":
            wanted += count * (count + 1) // 2
        if kind == "nn":
            record, rest = Record(lines[1][1], file.where(lines[1][0]), file.what), lines[2:]
            if record.word("NET") != "NET" or record.whole("the number of descriptors") != count:
                raise InputError(f"{file.what}: expected NET and {count} descriptors", record.where)
            wanted, inputs = 0, count
            for _ in range(record.whole("the number of layers")):
                function, nodes = record.word("an activation"), record.whole("a number of nodes")
                if function not in ACTIVATIONS or nodes < 1:
                    raise InputError(f"{file.what}: a layer is one of {' '.join(ACTIVATIONS)} and its nodes, got {function} {nodes}",
                                     record.where)
                layers.append((ACTIVATIONS.index(function), nodes))
                wanted, inputs = wanted + nodes * (inputs + 1), nodes
            if not layers or layers[-1][1] != 1:
                raise InputError(f"{file.what}: the last layer of the network must have one node", record.where)
        if each != wanted:
            raise InputError(f"{file.what}: {file.name} announces {each} coefficients, descriptor and model ask for {wanted}", head.where)
        size = wanted + (2 * count if kind == "nn" else 0)
        values: list[float] = []
        for number, words in rest:
            record = Record(words, file.where(number), file.what)
            values += [record.number("a coefficient") for _ in words]
        if len(values) < elements * size:
            raise file.error(f"the file ends before the last of {elements * size} coefficients, {len(values)} of them were read",
                             len(file.raw))
        table = np.array(values[:elements * size]).reshape(elements, size)
        if kind != "nn":
            return list(table)
        data["net"], data["layers"] = dict(zip(named, table)), np.array(layers, np.int64)
        return [np.zeros(1)] * elements

    def report(self, coeff):
        model, second = coeff["data"]["files"]
        word = "SO3" if "lmax" in coeff["data"]["parameters"] else "SNAP"
        shown = [f"{word} keyword {' '.join(line.split())} " for _, line in second.lines]
        return [f"Reading potential file {f.name} with DATE: {f.date}" for f in (model, second) if f.date] + shown


class PowerSpectrumMLIAP(MLIAP):
    """Style mliap with the descriptor so3."""

    def variant(self, settings, compat=""):
        return self

    def read(self, file, elements, settings):
        found: dict = {}
        known = (*SO3, *DESCRIBED)
        for number, line in file.lines:
            record = Record(line.split(), file.where(number), file.what)
            keyword = record.word()
            if keyword not in known:
                raise file.error(f"unknown keyword {keyword!r}{nearest(keyword, known)}", number)
            if keyword == "nelems" or keyword in WHOLE:
                found[keyword] = record.whole(keyword)
                lo, hi = WHOLE.get(keyword, (1, np.inf))
                if not lo <= found[keyword] <= hi:
                    raise file.error(f"{keyword} must be {lo} to {hi}, got {found[keyword]}", number)
            elif keyword in SO3:
                found[keyword] = record.number(keyword)
                if not found[keyword] > 0.0:
                    raise file.error(f"{keyword} must be positive, got {found[keyword]:g}", number)
            else:
                read = record.word if keyword == "elems" else record.number
                found[keyword] = tuple(read(keyword) for _ in range(found.get("nelems", 0)))
            if len(record.words) > record.at:
                raise file.error(f"a word too many after {keyword}: {record.words[record.at]}", number)
        for keyword in known:
            if keyword not in found:
                raise InputError(f"{file.what}: {file.name} has no {keyword}")
        return found

    def described(self, p):
        tables = power_spectrum(p["nmax"], p["lmax"], p["alpha"], p["rcutfac"])
        return tables, tables.count

    def room_for(self, tables, width):
        _, _, pairs, strengths, radial, _, layers = tables.arrays
        lines, nlm, nq = int(tables.constants[0]) + 1, len(strengths), radial.shape[2]
        numbers = 2 * nq // lines * nlm + 2 * len(pairs) * lines + 2 * int(layers[:, 1].sum()) + 3 * nlm + 2 * nq * width
        return -(-numbers // width) + 1

    def pack_pairs(self, settings, filled, ntypes, units, shift=False):
        element, c = element_of(filled, ntypes), next(iter(filled.values()))
        data, unit = c["data"], self.unit_factor(c, units)
        p, tables, named = data["parameters"], data["tables"], data["elements"]
        by_type, rows = np.zeros((ntypes + 1, 2)), np.zeros((1, ntypes + 1, ntypes + 1))
        beta = np.zeros((ntypes + 1, len(data["by_element"][named[0]][2])))
        net, layers = data.get("net", {}), data.get("layers", np.zeros((0, 2), np.int64))
        nets = np.zeros((ntypes + 1, len(next(iter(net.values()), ()))))
        for t, e in enumerate(element):
            if e is not None:
                radius, weight, values = data["by_element"][e]
                by_type[t], beta[t] = (radius, weight), unit * values
                nets[t] = net.get(e, ())
        for i, j in filled:      # the density ends at rcutfac, pairs may end before
            rows[0, i, j] = rows[0, j, i] = (p["rcutfac"] * min(1.0, by_type[i, 0] + by_type[j, 0])) ** 2
        constants = [p["lmax"], tables.per_interval, settings["model"] == "quadratic", unit]
        return PairTables(rows, np.array(constants, float), (by_type, beta, tables.pairs, tables.strengths, tables.radial, nets, layers))


POWER = PowerSpectrumMLIAP("mliap", site=so3.spectrum, helpers=so3.HELPERS, converts=False, doc=__doc__,
                           settings="model KIND file descriptor kind FILE", example="Si",
                           units=dict.fromkeys(("model", "KIND", "file", "descriptor", "kind", "FILE"), "word"))
register(MLIAP("mliap", site=snap, helpers=HELPERS, converts=False, doc=__doc__, settings="model KIND file descriptor kind FILE",
               settings_example="model linear Ta06A.mliap.model descriptor sna Ta06A.mliap.descriptor", example="Ta",
               units=dict.fromkeys(("model", "KIND", "file", "descriptor", "kind", "FILE"), "word"),
               see="A. Rohskopf et al., J. Mater. Res. 38, 5136 (2023)"))
