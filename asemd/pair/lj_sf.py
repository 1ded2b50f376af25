r"""pair_style lj/smooth/linear under its former name; see there."""
from __future__ import annotations

from asemd.pair.lj_smooth_linear import LinearPair
from asemd.style import register

register(LinearPair("lj/sf", __doc__))
