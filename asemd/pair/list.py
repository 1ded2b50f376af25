r"""Interactions of listed pairs of atoms, each with a function and coefficients of its own: restraints, or pairs of a Go model.

Lines of the file are ``ID1 ID2 function coefficients [cutoff]``:

- ``lj126 epsilon sigma``: $$E = 4\epsilon [(\sigma/r)^{12} - (\sigma/r)^6]$$
- ``morse D0 alpha r0``: $$E = D_0 [1 - e^{-\alpha (r - r_0)}]^2$$
- ``harmonic K r0``: $$E = K (r - r_0)^2$$
- ``quartic K r0 b1 b2``: $$E = K (r - r_0)^2 (r - r_0 - b_1) (r - r_0 - b_2)$$

Distances are those of the closest images; with ``compat="lammps"`` those inside the box, as in LAMMPS on one processor, where energies
jump when an atom crosses a face. Beyond the cutoff, that of the line or of ``pair_style list FILE cutoff``, there is no interaction.
``pair_coeff`` takes no numbers. ``pair_modify shift yes`` makes all energies end at 0 (LAMMPS takes off other numbers: none of quartic,
far too large ones of lj126). Weights of special_bonds and exclusions do not matter. With the word ``nocheck`` pairs whose atoms do not
exist are passed over.
"""
from __future__ import annotations

import math

from asemd import words
from asemd.errors import InputError, Where
from asemd.pairstyle import PairStyle
from asemd.style import Style, register

FUNCTIONS = {"harmonic": 2, "morse": 3, "lj126": 2, "quartic": 4}


def listed(r, function, a: "energy", b, c, d, cut: "distance", offset: "energy"):
    x = r - b
    if r >= cut:
        return 0.0, 0.0
    if function == 0.0:
        return a * x * x - offset, 2.0 * a * x
    if function == 1.0:
        e = math.exp(-b * (r - c))
        return a * (1.0 - e) * (1.0 - e) - offset, 2.0 * a * b * e * (1.0 - e)
    if function == 2.0:
        s = b / r if r > 0.0 else math.inf
        s6 = s * s * s * s * s * s
        e = 4.0 * a * s6
        return e * (s6 - 1.0) - offset, (-6.0 * e * (2.0 * s6 - 1.0) / r if r > 0.0 else math.inf)
    p, q = x - c, x - d
    return a * x * x * p * q - offset, a * x * (2.0 * p * q + x * (p + q))


BOND = Style("bond", "list", listed, domain="the atoms coincide")


def read(path: str, cut: float) -> list[tuple[int, int, dict[str, float]]]:
    """Pairs of IDs of a file and their coefficients.

    Raises
    ------
    InputError
        The file cannot be read, or a line makes no sense; file and line are named.
    """
    try:
        with open(path, encoding="utf-8-sig", errors="replace") as file:
            lines = file.read().splitlines()
    except OSError as e:
        raise InputError(f"pair_style list: cannot read {path}: {e.strerror}") from None
    out = []
    for number, text in enumerate(lines, 1):
        line = text.split("#")[0].split()
        if not line:
            continue
        try:
            if len(line) < 3 or line[2] not in FUNCTIONS:
                raise InputError(f"pair_style list: a line must be ID1 ID2 function coefficients, with function {' '.join(FUNCTIONS)}")
            count = FUNCTIONS[line[2]]
            if not count <= len(line) - 3 <= count + 1:
                raise InputError(f"pair_style list: {line[2]} needs {count} coefficients and perhaps a cutoff, got {len(line) - 3} values")
            i, j = (words.whole(w, "pair_style list: atom ID") for w in line[:2])
            values = [words.number(w, f"pair_style list: {line[2]}") for w in line[3:]]
        except InputError as e:
            raise e.at(Where(path, number, text)) from None
        numbers = values[:count] + [0.0] * (4 - count)
        out.append((i, j, {"function": float(list(FUNCTIONS).index(line[2])), **dict(zip("abcd", numbers)),
                           "cut": values[count] if len(values) > count else cut, "offset": 0.0}))
    return out


class ListPair(PairStyle):
    """Has no parts: its pairs are items, as bonds are (see `asemd.items_term.ItemsTerm`)."""

    items_style = BOND

    def parse_settings(self, words_):
        if not 2 <= len(words_) <= 3:
            raise InputError(f"pair_style list needs file cutoff [check|nocheck], got {len(words_)} values")
        values = {"file": words_[0], "cut": words.number(words_[1], "pair_style list: cutoff")}
        if not values["cut"] > 0.0:
            raise InputError(f"pair_style list: the cutoff must be more than 0, got {values['cut']:g}")
        if len(words_) == 3:
            values["check"] = words.choice(words_[2], ("check", "nocheck"), "pair_style list: keyword")
        return values | {"pairs": read(values["file"], values["cut"])}

    def items(self, settings, system, shift: bool, factor: float):
        """Rows of the atoms (m, 2) and coefficients of all pairs, with energies times `factor`.

        Raises
        ------
        InputError
            An atom does not exist.
        """
        row = {int(n): k for k, n in enumerate(system.id)}
        rows, coeff = [], []
        for i, j, c in settings["pairs"]:
            missing = [n for n in (i, j) if n not in row]
            if missing and settings.get("check") == "nocheck":
                continue
            if missing or i == j:
                why = f"there is no atom {missing[0]}" if missing else "an atom has no pair with itself"
                raise InputError(f"pair_style list: pair {i} {j} of {settings['file']}: {why}")
            if shift:
                c = {**c, "offset": listed(math.nextafter(c["cut"], 0.0), *[c[n] for n in BOND.arguments[:5]], c["cut"], 0.0)[0]}
            rows.append((row[i], row[j]))
            coeff.append({**c, "a": factor * c["a"], "offset": factor * c["offset"]})
        return rows, coeff


register(ListPair("list", [], settings="file cut [check]", coeff="", units={"file": "path", "check": "word"}, doc=__doc__,
                  settings_example="pairs.txt 5.0", see="LAMMPS manual, pair_style list"))
