r"""pair_style lj/spica/coul/msm under its former name; see there."""
from __future__ import annotations

import inspect

from asemd.pair.coul_msm import coul_msm
from asemd.pair.lj_spica_coul_long import SpicaLongPair
from asemd.style import register

register(SpicaLongPair("lj/sdk/coul/msm", coul_msm, inspect.cleandoc(__doc__)))
