"""``run N [upto] [start N1] [stop N2] [pre yes|no] [post yes|no] [every M commands...]``"""
from __future__ import annotations

from asemd.errors import InputError, nearest
from asemd.lammps.driver import Driver, Plan
from asemd.words import take, whole, yes_no

KEYWORDS = ("upto", "start", "stop", "pre", "post", "every")


def run(session, args):
    scene = session.scene
    scene.need_system("run")
    steps = whole(take(args, 1, "run")[0], "run")
    words, options, every, commands = list(args[1:]), {}, 0, []
    while words:
        key = words.pop(0)
        if key not in KEYWORDS:
            raise InputError(f"run: unknown keyword {key!r}{nearest(key, KEYWORDS)}")
        if key == "upto":
            options["upto"] = True
            continue
        value = take(words, 1, f"run {key}")[0]
        del words[0]
        if key == "every":
            every, commands, words = whole(value, "run every"), words, []
            if every <= 0:
                raise InputError(f"run every: must be positive, got {value}")
            if not commands:
                raise InputError("run every needs commands after the number of steps, or NULL for none")
        else:
            options[key] = yes_no(value, f"run {key}") if key in ("pre", "post") else whole(value, f"run {key}")
    begin = scene.step
    if options.get("upto"):
        if steps < begin:
            raise InputError(f"run upto {steps}: the current step is {begin} already")
        steps -= begin
    if steps < 0:
        raise InputError(f"run: the number of steps must not be negative, got {steps}")
    if session.switches.cap is not None:
        steps = min(steps, session.switches.cap)
    first, last = options.get("start", begin), options.get("stop", begin + steps)
    if first > begin or last < begin + steps:
        raise InputError(f"run: start {first} and stop {last} must enclose the steps of this run, {begin} to {begin + steps}")
    pre, post = options.get("pre", True), options.get("post", True)
    if not pre and scene.respa:
        raise InputError("run pre no does not go with run_style respa: leave it out")
    if session.timer.expired and not session.dry:
        return
    if not every:
        Driver(session, Plan(steps, first, last, pre, post)).run()
        return
    segments(session, steps, every, commands, options.get("start"), options.get("stop"), pre, post)


def segments(session, steps: int, every: int, commands: list[str], start: int | None, stop: int | None, pre: bool, post: bool) -> None:
    """``run ... every``: short runs with commands between them; without start and stop each of them is a series of its own."""
    done = 0
    while done < steps or steps == 0:
        part, now = min(every, steps - done), session.scene.step
        first, last = now if start is None else start, now + part if stop is None else stop
        Driver(session, Plan(part, first, last, pre or done == 0, post or done + part == steps)).run()
        done += part
        if commands != ["NULL"]:
            session.between = True
            try:
                for command in commands:
                    session.execute(command)
            finally:
                session.between = False
        if steps == 0 or session.timer.expired:
            break
