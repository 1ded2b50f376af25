"""The knobs that every scene may have, one a file; see `asemd.report.knob`."""
