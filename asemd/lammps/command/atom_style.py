"""``atom_style style`` and ``atom_style hybrid style style ...``

``sphere 0|1`` says whether radii change during runs; here they may either way."""
from __future__ import annotations

from asemd.errors import InputError
from asemd.lammps import catalog
from asemd.registry import plain_name
from asemd.words import take


def run(session, args):
    take(args, 1, "atom_style")
    args = without_flags(args)
    style = plain_name(args[0])
    if not catalog.exists("atom", style):
        raise catalog.unknown("atom", args[0])
    if style == "hybrid":
        style = hybrid(args[1:])
    elif len(args) > 1:
        raise InputError(f"atom_style {style} takes no arguments, got {' '.join(args[1:])}")
    session.scene.atom_style = style


def without_flags(words: list[str]) -> list[str]:
    """The words without the number that may follow ``sphere``.

    Raises
    ------
    InputError
        It is another number than 0 or 1.
    """
    out: list[str] = []
    for word in words:
        if out and plain_name(out[-1]) == "sphere" and word.lstrip("+-").isdigit():
            if word not in ("0", "1"):
                raise InputError(f"atom_style sphere: whether radii change is 0 or 1, got {word}")
        else:
            out.append(word)
    return out


def hybrid(words: list[str]) -> str:
    """The styles behind ``hybrid``, each once, as one name."""
    names = [plain_name(w) for w in words]
    if not names:
        raise InputError("atom_style hybrid needs the names of its sub-styles")
    for name in names:
        if name == "hybrid":
            raise InputError("atom_style hybrid cannot have hybrid as a sub-style")
        if not catalog.exists("atom", name):
            raise catalog.unknown("atom", name)
        if names.count(name) > 1:
            raise InputError(f"atom_style hybrid cannot use the style {name} twice")
    return " ".join(["hybrid", *names])
