"""Averages over spatial bins and over time, in the syntax that fix ave/chunk has replaced: ``dim origin delta`` of up to three directions,
then values and the keywords norm, units, region, file, ave, overwrite, title1 to title3.

The bins are those of compute chunk/atom with styles bin/1d, bin/2d and bin/3d. Output: an array with the columns of the file.
Source: LAMMPS manual of 2013, fix ave/spatial.
"""
from __future__ import annotations

from asemd.compute._chunk_words import read as read_bins
from asemd.compute.chunk_atom import ChunkAtom
from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.ave_chunk import SPECIAL, WORDS, AveChunk
from asemd.fix.output_file import OutputFile
from asemd.fix.values import expand, read
from asemd.words import take, whole

KEYWORDS = {"norm": 1, "units": 1, "region": 1, "file": 1, "ave": sampled.ave_count, "overwrite": 0, "title1": 1, "title2": 1, "title3": 1}
DENSITIES = SPECIAL[:2]


class AveSpatial(AveChunk):
    """Averages over bins; parameters as in `asemd.fix.AveChunk`."""

    style = "ave/spatial"

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(take(words, 7, what), ("Nevery", "Nrepeat", "Nfreq")))
        rest, bins = list(words[3:]), []
        while rest and rest[0] in ("x", "y", "z") and len(bins) < 9:
            bins += take(rest, 3, f"{what} dim origin delta")
            rest = rest[3:]
        if not bins:
            raise InputError(f"{what} needs dim origin delta, dim one of x y z, got {rest[0]!r}")
        names, rest = sampled.split(rest, (*WORDS, *DENSITIES))
        options = sampled.keywords(rest, KEYWORDS, what)
        placed = [w for key in ("region", "units") if key in options for w in (key, options[key][0])]
        chunks = ChunkAtom(group, read_bins([f"bin/{len(bins) // 3}d", *bins, *placed, "nchunk", "every", "discard", "no"], session))
        chunks.id = f"of fix {session.defining}"
        values = [w if w in DENSITIES else read(w, session, what, WORDS).check("per_atom", what)
                  for w in expand(names, session, vectors=True)]
        ave, window = sampled.read_ave(options.get("ave", ["one"]), what)
        fix = cls(group, chunks, values, every, repeat, freq, options.get("norm", ["all"])[0], ave, window)
        fix.session, fix.words, fix.id = session, list(words), session.defining
        sampled.check_frequencies(fix)
        if "overwrite" in options and ave != "running":
            raise InputError(f"{what}: overwrite needs ave running")
        columns = " ".join([f"Coord{k + 1}" for k in range(len(bins) // 3)] + ["Ncount", *(v.word for v in fix.values)])
        fix.titles = {1: f"# Spatial-averaged data for fix {fix.id} and group {group}", 2: "# Timestep Number-of-bins",
                      3: f"# Bin {columns}"}
        fix.titles |= {n: options[f"title{n}"][0] for n in (1, 2, 3) if f"title{n}" in options}
        fix.overwrite = "overwrite" in options
        fix.begin(session.scene.step)
        if "file" in options:
            fix.file = OutputFile(options["file"][0], what, silent=session.passive)
            fix._header()
        return fix

    def _total(self) -> str:
        """There is no number of atoms behind that of bins."""
        return ""
