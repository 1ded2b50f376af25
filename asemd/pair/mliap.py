r"""Machine-learned potentials of components of the bispectrum: linear, quadratic, or a neural network.

$$E=\sum_iE_{model}(\mathbf B_i)$$

``pair_style mliap model KIND FILE descriptor sna FILE`` with the models linear, quadratic and nn; the components are those of `pair snap`,
the descriptor file has their parameters and the elements. ``pair_coeff * *`` and an element for each type. The descriptors so3 and ace and
models in Python are not supported.

Source: LAMMPS manual, pair_style mliap; A. Rohskopf et al., J. Mater. Res. 38, 5136 (2023).
"""
from __future__ import annotations

import numpy as np

from asemd.bispectrum import bispectrum
from asemd.errors import InputError, nearest
from asemd.kernels.snap import HELPERS, snap
from asemd.pair.snap import SNAP, read_parameters
from asemd.potential_file import PotentialFile, Record
from asemd.style import register

ACTIVATIONS = ("linear", "sigmoid", "tanh", "relu")
CHOICES = {"model": ("linear", "quadratic", "nn"), "descriptor": ("sna",)}


class MLIAP(SNAP):
    """Style mliap; its settings have the files."""

    head_words = ""
    coefficients = ()

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
        p = read_parameters(file)
        for e in elements:
            if e not in p["elems"]:
                raise InputError(f"{file.what}: {file.name} has no element {e}, only {' '.join(p['elems'])}")
        p["quadraticflag"] = int(settings["model"] == "quadratic")
        return p

    def read_head(self, head, elements, settings):
        what = f"pair_coeff {self.name}"
        model, second = PotentialFile(settings["model file"], what), PotentialFile(settings["descriptor file"], what)
        p = self.read(second, elements, settings)
        tables, named = bispectrum(p["twojmax"], bool(p["bnormflag"])), p["elems"]
        count = len(tables.components) * (len(named) ** 3 if p["chemflag"] else 1)
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
        shown = [f"SNAP keyword {' '.join(line.split())} " for _, line in second.lines]
        return [f"Reading potential file {f.name} with DATE: {f.date}" for f in (model, second) if f.date] + shown


register(MLIAP("mliap", site=snap, helpers=HELPERS, converts=False, doc=__doc__, settings="model KIND file descriptor kind FILE",
               settings_example="model linear Ta06A.mliap.model descriptor sna Ta06A.mliap.descriptor", example="Ta",
               units=dict.fromkeys(("model", "KIND", "file", "descriptor", "kind", "FILE"), "word"),
               see="A. Rohskopf et al., J. Mater. Res. 38, 5136 (2023)"))
