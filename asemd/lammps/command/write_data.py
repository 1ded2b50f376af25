"""``write_data file keyword value ...``; ``*`` in the name stands for the timestep."""
from __future__ import annotations

import warnings

from asemd.errors import InputError, InputWarning, nearest
from asemd.lammps.command.write_restart import settle
from asemd.lammps.data_write import write_data
from asemd.lammps.setup_log import report_mixing
from asemd.words import choice, take

KEYWORDS = ("pair", "nocoeff", "nofix", "nolabelmap", "types", "triclinic/general")


def run(session, args):
    scene, system = session.scene, session.scene.need_system("write_data")
    path = take(args, 1, "write_data")[0].replace("*", str(scene.step))
    fixes = [f for f in scene.fixes.values() if getattr(f, "writedata", False)]
    options, coeffs, words = {}, True, args[1:]
    while words:
        key, *words = words
        if key == "pair":
            options["pair"] = choice(take(words, 1, "write_data pair")[0], ("ii", "ij"), "write_data pair")
            words = words[1:]
        elif key == "types":
            options["types"] = choice(take(words, 1, "write_data types")[0], ("numeric", "labels"), "write_data types")
            words = words[1:]
        elif key == "nocoeff":
            coeffs = False
        elif key == "nolabelmap":
            options["labels"] = False
        elif key == "triclinic/general":
            if system.rotation is None:
                raise InputError("write_data triclinic/general: the simulation box is not general triclinic")
            options["general"] = True
        elif key == "nofix":
            fixes = []
        else:
            raise InputError(f"write_data: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
    report_mixing(session, "write_data")
    with warnings.catch_warnings(record=True) as caught, session.progress("lines") as progress:
        warnings.simplefilter("always", InputWarning)
        write_data(path, system, scene.interactions if coeffs else None, progress=progress, fixes=fixes, **options)
    for warning in caught:
        session.warn(str(warning.message))
    settle(session)
