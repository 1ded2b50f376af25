"""Settings that change how pair interactions count: ``pair_modify`` and ``special_bonds``."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from asemd import words as read
from asemd.errors import InputError, nearest
from asemd.registry import plain_name

if TYPE_CHECKING:
    from asemd.forcefield import Interactions
    from asemd.uses import Use

KEYWORDS = ("pair", "shift", "tail", "compute", "mix", "table", "table/disp", "tabinner", "tabinner/disp", "nofdotr", "neigh/trim",
            "special", "compute/tally")
MIX_RULES = ("geometric", "arithmetic", "sixthpower")
FACTORS = {          # special_bonds NAME -> Lennard-Jones and Coulomb factors of 1-2, 1-3, 1-4 pairs
    "amber": ((0.0, 0.0, 0.5), (0.0, 0.0, 5.0 / 6.0)),
    "charmm": ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "dreiding": ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0)),
    "fene": ((0.0, 1.0, 1.0), (0.0, 1.0, 1.0)),
}


def modify_pair(interactions: Interactions, words: list[str]) -> None:
    """``pair_modify WORDS``."""
    if not interactions.uses["pair"]:
        raise InputError("pair_modify command before pair_style is defined")
    if not words:
        raise InputError("pair_modify needs a keyword")
    words, target = list(words), None
    if words[0] == "pair":
        if not interactions.hybrid["pair"] or len(words) < 2:
            raise InputError("pair_modify pair needs pair_style hybrid and the name of a sub-style")
        target, words = interactions.sub_style("pair", plain_name(words[1]), words[2:])
        words = _of_sub_style(target, words)
    while words:
        keyword, *words = words
        what = f"pair_modify {keyword}"
        if keyword == "nofdotr":      # how the virial is summed, not what it is
            continue
        if keyword in ("special", "compute/tally", "pair"):
            raise InputError(f"{what} must stand first: pair_modify pair NAME {keyword} ...")
        if keyword not in KEYWORDS:
            raise InputError(f"unknown pair_modify keyword {keyword!r}{nearest(keyword, KEYWORDS)}")
        value = read.take(words, 1, what)[0]
        words = words[1:]
        if keyword in ("shift", "tail", "compute", "neigh/trim"):
            new: Any = read.yes_no(value, what)
            if keyword == "neigh/trim":       # only makes lists of sub-styles shorter
                continue
        elif keyword == "mix":
            new = read.choice(value, MIX_RULES, what)
        else:
            new = read.whole(value, what) if keyword.startswith("table") else read.number(value, what)
            if new < 0:
                raise InputError(f"{what} must not be negative, got {value}")
            interactions.table[keyword] = new
            continue
        if target is not None:
            if keyword == "tail":       # of the hybrid as a whole, too: without it no sub-style has a tail
                for use in interactions.uses["pair"]:
                    use.modify.setdefault("tail", interactions.tail)
                interactions.tail = new
            target.modify[keyword] = new
        else:
            setattr(interactions, keyword, new)
            for use in interactions.uses["pair"]:
                use.modify.pop(keyword, None)


def _of_sub_style(use: Use, words: list[str]) -> list[str]:
    """``special lj|coul|lj/coul w12 w13 w14`` and ``compute/tally yes|no`` right after the name of a sub-style; returns what follows."""
    while words and words[0] in ("special", "compute/tally"):
        what = f"pair_modify pair {use.label} {words[0]}"
        if words[0] == "special":
            kind, *three = read.take(words[1:], 4, what)
            weights = tuple(read.number(w, what) for w in three)
            for name in ("lj", "coul") if read.choice(kind, ("lj", "coul", "lj/coul"), what) == "lj/coul" else (kind,):
                use.special[name] = weights
            words = words[5:]
        else:
            read.yes_no(read.take(words[1:], 1, what)[0], what)     # which computes see the pairs; there are none that would
            words = words[2:]
    return words


def check_special(interactions: Interactions) -> None:
    """Refuse weights of a sub-style where the common one says that pairs are left out (0) or like any other (1).

    Raises
    ------
    InputError
        The message names the sub-style and the kind of pairs.
    """
    for use in interactions.uses["pair"]:
        for name, weights in use.special.items():
            for kind, (own, common) in enumerate(zip(weights, getattr(interactions, f"special_{name}")), 2):
                if own != common and common in (0.0, 1.0):
                    raise InputError(f"pair_modify pair {use.label} special {name}: weight {own:g} of 1-{kind} pairs is incompatible with "
                                     f"special_bonds, where it is {common:g}: give these pairs another one there, such as 1e-20 or 0.5")


def set_special(interactions: Interactions, words: list[str]) -> None:
    """``special_bonds WORDS``; what is not said goes back to its default."""
    if not words:
        raise InputError("special_bonds needs a keyword")
    lj = coul = (0.0, 0.0, 0.0)
    flags = {"angle": False, "dihedral": False}
    words = list(words)
    while words:
        keyword, *words = words
        what = f"special_bonds {keyword}"
        if keyword in FACTORS:
            lj, coul = FACTORS[keyword]
        elif keyword in ("lj", "coul", "lj/coul"):
            three = tuple(read.number(w, what) for w in read.take(words, 3, what))
            words = words[3:]
            if any(not 0.0 <= w <= 1.0 for w in three):
                raise InputError(f"{what}: factors must be between 0 and 1, got {' '.join(f'{w:g}' for w in three)}")
            lj = three if keyword != "coul" else lj
            coul = three if keyword != "lj" else coul
        elif keyword in flags:
            flags[keyword] = read.yes_no(read.take(words, 1, what)[0], what)
            words = words[1:]
        elif keyword == "extra":       # room for bonds made later; lists grow by themselves here
            read.whole(read.take(words, 1, what)[0], what)
            words = words[1:]
        elif keyword == "one/five":
            if read.yes_no(read.take(words, 1, what)[0], what):
                raise InputError(f"{what} yes needs atom_style amoeba, the only one with lists of 1-5 pairs, which does not exist here")
            words = words[1:]
        else:
            known = *FACTORS, "lj", "coul", "lj/coul", "one/five", *flags
            raise InputError(f"unknown special_bonds keyword {keyword!r}{nearest(keyword, known)}")
    interactions.special_lj, interactions.special_coul = lj, coul
    interactions.special_angle, interactions.special_dihedral = flags["angle"], flags["dihedral"]
