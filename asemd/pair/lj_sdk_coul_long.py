r"""pair_style lj/spica/coul/long under its former name; see there."""
from __future__ import annotations

from asemd.pair.lj_spica_coul_long import SpicaLongPair
from asemd.style import register

style = register(SpicaLongPair("lj/sdk/coul/long"))
