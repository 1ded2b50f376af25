"""``pair_coeff I J values``"""
from __future__ import annotations

from asemd import units as unit_styles
from asemd.lammps.live_coefficients import fill


def report_files(session, args) -> None:
    """What LAMMPS's log says about potential files, those of this command."""
    for use in session.scene.interactions.uses["pair"]:
        if use.style.many:
            told = [c for c in use.coeff.values() if "file" in c and {*c.get("head", [c["file"]]), *c.get("element", ())} <= set(args)]
            for c in {c["file"]: c for c in told}.values():
                file, units = c["units"], session.scene.units
                for line in use.style.report(c):
                    session.print(line)
                if use.style.unit_factor(c, unit_styles.get(units)) != 1.0 and units != "ase":
                    session.warn(f"Converting {use.style.reads} potential in {file.units} units to {units} units")


def set_masses(interactions, before: set[int], system) -> None:
    """Masses of atom types by the potential files of this command, where these have some; `before`: coefficients that were there."""
    for use in interactions.uses["pair"]:
        for (i, j), c in use.coeff.items():
            if i == j and id(c) not in before and (masses := getattr(use.style, "masses", None)):
                system.mass[i] = masses(c, i)


def run(session, args):
    scene = session.scene
    before = {id(c) for use in scene.interactions.uses["pair"] for c in use.coeff.values()}
    with session.passing_warnings():
        scene.interactions.set_coeff("pair", args, scene.need_system("pair_coeff"))
        set_masses(scene.interactions, before, scene.system)
        report_files(session, args)
    fill(session, "pair")
