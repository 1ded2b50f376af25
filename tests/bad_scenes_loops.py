"""Mistakes in loops, in names of styles, with groups that are empty and lines that are missing."""
from __future__ import annotations

from bad_scenes import in_data, line

line("label misspelt", "label start\njump SELF strat", "no label strat;did you mean start")
line("label in a file that is missing it", "jump x.inc end", "no label end in x.inc;there is none", files={"x.inc": "print done\n"})
line("loop without next", "label a\nprint x\njump SELF a", "loop without end;next")
line("loop of a whole file", "jump x.inc", "loop without end", at=("x.inc", "jump SELF"), files={"x.inc": "print x\njump SELF\n"})
line("loop of two files", "jump x.inc", "loop without end", at=(), files={"x.inc": "jump y.inc\n", "y.inc": "jump x.inc\n"})
line("loop that an if never leaves", "variable n equal 1\nlabel a\nif '$n > 2' then 'jump SELF b'\njump SELF a\nlabel b",
     "loop without end", at=("in.scene", "jump SELF a"))
line("loop with a counter", "variable n equal 0\nlabel a\nvariable n equal $n+1\nif '$n < 1500' then 'jump SELF a'", "",
     expect="fine", at=())
line("loop of runs without next", "variable n loop 3\nlabel a\nrun 1\nif '$(step) > 9' then 'jump SELF b'\njump SELF a\nlabel b", "",
     expect="fine", at=())
line("minimiser that is not there", "min_style foo", "unknown min_style 'foo';there are cg")
line("style of one's own without its file", "bond_style mine", "unknown bond style 'mine';--import")
line("mistake within an if", "if '$(step) == 0' then 'bond_coeff 1 x 1'", "bond_coeff;'x'", at=())
line("fix on no atoms", "group e type 1:0\nfix 2 e langevin 1 1 1 123", "fix 2;no atoms;group e is empty", expect="warning",
     at=("in.scene", "fix 2 e langevin 1 1 1 123"))
line("delay that does not fit", "neigh_modify every 3 delay 4", "neigh_modify delay 4;every 3")
line("balance of an unknown kind", "balance 1.1 foo", "balance;'foo'")
line("dump of a compute that is missing", "dump 1 all custom 1 x.dump id c_none", "no compute none")
in_data("box that is missing", "0.0 10.0 xlo xhi\n => \n", "no line xlo xhi;-0.5", ("scene.data", "4 atoms"), "warning")
