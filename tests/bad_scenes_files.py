"""Mistakes that end in strange places: full disks, devices, endless words, formats of a million columns."""
from __future__ import annotations

from bad_scenes import RUN, line

FULL = "No space left on device"
line("dump on a full disk", "dump d all custom 1 /dev/full id x", f"dump d;cannot write /dev/full;{FULL}", at=RUN)
line("log on a full disk", "log /dev/full", f"cannot write log file /dev/full;{FULL}", at=None)
line("restart on a full disk", "write_restart /dev/full", f"cannot write restart file /dev/full;{FULL}")
line("restart file that is a folder", "write_restart .", "cannot write restart file .;directory")
line("restart file nobody wants", "write_restart /dev/null", "", expect="fine", at=())
line("integer of many digits", "run " + "9" * 20000, "run;999;too large", at=("in.scene", "run " + "9" * 20000))
line("word without end", "bogus" + "x" * 20000, r"^.{0,1000}$", at=())
line("text without end", "bogus " + "x " * 20000, r"unknown command 'bogus';^.{0,1000}$", at=())
line("escape sequence", "bogus \x1b[31mred", r"bogus \\x1b\[31mred", at=())
line("format of a million columns", "variable n equal 1\nprint $(v_n:%9000000.3f)", "%9000000.3f;format")
line("thermo format of a million columns", "thermo_modify format float %9000000.3f", "%9000000.3f;format")
line("variable format of a million columns", "variable n equal 1\nvariable y format n %9000000.3f", "%9000000.3f;format")
line("dump format of a million columns", "dump d all custom 1 x.dump id x\ndump_modify d format float %9000000.3f", "%9000000.3f;format")
