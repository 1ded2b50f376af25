r"""pair_style lj/spica under its former name; see there."""
from __future__ import annotations

from asemd.pair.lj_spica import SpicaPair
from asemd.style import register

style = register(SpicaPair("lj/sdk"))
