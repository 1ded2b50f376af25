"""Steps of the Nose-Hoover integrators with a temperature that has a bias, or degrees of freedom of its own; not compiled.

The bias (a flow, or components that do not count) is taken from the velocities before thermostat and barostat scale them, and given back
afterwards. `asemd.fix.nvt` and `asemd.fix.npt` have the formulas.
"""
from __future__ import annotations

import numpy as np

from asemd.fix.barostat import barostat_chain, dilate_box, measure_pressure, push_box, target_pressure
from asemd.fix.nose_hoover import NoseHoover, nose_hoover_chain
from asemd.fix.thermostat import scale_thermal
from asemd.kernels.box import follow

# flows that LAMMPS takes from the present positions; others are those of the last temperature
LIVE = ("temp/ramp", "temp/region", "temp/deform", "viscosity/cos")


def scale(fix, loop, factor: float) -> None:
    """The thermostat's factor: of velocities without their bias, and of what turns."""
    if hasattr(fix, "scale_thermal"):
        fix.scale_thermal(loop)
        return
    scale_thermal(loop, fix.temp, fix.group, factor)
    if fix.turns:
        fix.turning[0][loop.groups[fix.group]] *= factor


def kick(fix, loop, bit: int) -> None:
    """Half a step of the forces, and of the torques."""
    s = loop.state
    if fix.turns:
        fix.kick_turning(loop, bit)
    mine = (s.mask & bit) != 0
    s.v[:, mine] += 0.5 * loop.dt * s.inverse_mass[mine] * s.f[:, mine]


def move(fix, loop, bit: int) -> None:
    """The positions and orientations."""
    s = loop.state
    if fix.turns:
        fix.turn(loop, bit)
    mine = (s.mask & bit) != 0
    s.x[:, mine] += loop.dt * s.v[:, mine]


def take_along(fix, loop, turn: int) -> None:
    """Atoms follow half a step of the box."""
    s, before, after = loop.state, fix.b[11 + turn, :3, None], fix.b[12 + turn, :3, None]
    mine = (s.mask & int(fix.q[21])) != 0
    s.x[:, mine] = after + fix.m[2 + turn] @ (s.x[:, mine] - before)


def flow(fix, loop) -> np.ndarray:
    """(n, 3) the bias of the present velocities."""
    loop.sync_out()
    return loop.system.v - fix.temp.remove_bias(loop.snapshot()) if fix.temp.bias else np.zeros_like(loop.system.v)


def drag(fix, loop, bias: np.ndarray) -> None:
    """The friction by the box: a quarter step twice, with the shear in between."""
    loop.sync_out()
    mine, v = loop.groups[fix.group], loop.system.v
    thermal, factors, rate = (v - bias)[mine] * fix.b[14, :3], fix.b[14, :3], fix.b[7]
    if fix.q[0] == 3.0:
        x, y, z = thermal.T
        yz, xz, xy = 0.5 * loop.dt * rate[3:6]
        thermal = np.stack([x - y * xy - z * xz, y - z * yz, z], axis=1)
    v[mine] = bias[mine] + thermal * factors
    loop.sync_in()


def measure(fix, loop, begins: bool) -> None:
    """Kinetic tensors now; that of a temperature which is the pressure's alone is measured where a step begins, as in LAMMPS."""
    loop.sync_out()
    state, own = loop.snapshot(), fix.press.temperature or fix.temp
    for temp, row in ((fix.temp, 9), (own, 10)):
        if row == 9 or own is fix.temp or begins:
            fix.b[row] = temp.vector(state)[:6]
            if fix.q[0] == 1.0:         # then LAMMPS takes the scalar, which counts degrees of freedom
                dimension = int(fix.q[26])
                fix.b[row, :dimension] = temp.dof(state) * state.units.boltz * temp.scalar(state) / dimension


def begin(fix: NoseHoover, loop) -> None:
    """The first half of a step."""
    th, s, p, bit, box = loop._thread(), loop.state, fix.p, loop.group_bit(fix.group), hasattr(fix, "press")
    if box and fix.q[11] > 0.0:
        barostat_chain(th, fix.q, fix.b, fix.e, p[3] * p[13])
    if hasattr(fix, "aim_in_python"):
        measure(fix, loop, True)
        fix.aim_in_python(loop)
    if fix.thermal:
        p[15] = p[2]
        nose_hoover_chain(th, p)
        scale(fix, loop, p[12])
    if box:
        measure(fix, loop, True)
        fix.flow, fix.seen = flow(fix, loop), loop.engine.builds
        measure_pressure(s, fix.q, fix.b, fix.w)
        target_pressure(th, s, fix.q, fix.b, fix.m)
        push_box(th, s, p, fix.q, fix.b, fix.m)
        drag(fix, loop, fix.flow)
    kick(fix, loop, bit)
    if box:
        dilate_box(th, s, fix.q, fix.b, fix.m, 0)
        dilate_box(th, s, fix.q, fix.b, fix.m, 1)
        follow(s.box)
        take_along(fix, loop, 0)
    move(fix, loop, bit)
    if box:
        take_along(fix, loop, 1)


def end(fix: NoseHoover, loop) -> None:
    """The second half of a step."""
    th, s, p, box = loop._thread(), loop.state, fix.p, hasattr(fix, "press")
    kick(fix, loop, loop.group_bit(fix.group))
    if box:
        if fix.seen != loop.engine.builds:      # LAMMPS measures once more after a list build
            loop.sync_out()
            fix.temp.scalar(loop.snapshot())
        anew = fix.temp.hides or fix.temp.style in LIVE or fix.seen != loop.engine.builds
        drag(fix, loop, flow(fix, loop) if anew else fix.flow)
        measure(fix, loop, False)
    loop.sync_out()
    state = loop.snapshot()
    p[2], p[11] = fix.temp.dof(state), fix.temp.scalar(state)
    if box:
        measure_pressure(s, fix.q, fix.b, fix.w)
        push_box(th, s, p, fix.q, fix.b, fix.m)
    if fix.thermal:
        aimed = p[15]       # its target, and with it the energy of the chain, stay those of this step
        nose_hoover_chain(th, p)
        p[15] = aimed
        scale(fix, loop, p[12])
    if box and fix.q[11] > 0.0:
        barostat_chain(th, fix.q, fix.b, fix.e, p[3] * p[13])
