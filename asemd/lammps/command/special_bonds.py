"""``special_bonds keyword values ...``: how much of a pair interaction is left between atoms one, two and three bonds apart."""
from __future__ import annotations

from asemd.lammps.setup_log import report_special


def run(session, args):
    scene = session.scene
    before = _of_lists(scene.interactions)
    scene.interactions.set_special(args)
    if scene.system is not None and _of_lists(scene.interactions) != before:
        scene.system.topology.frozen = None     # lists of 1-3 and 1-4 pairs are made anew
        report_special(session)


def _of_lists(interactions) -> tuple:
    """What the lists of partners depend on."""
    return interactions.special_lj[1:], interactions.special_coul[1:], interactions.special_angle, interactions.special_dihedral
