r"""Averages over the atoms of each chunk and over time.

.. math:: \bar a_c = \frac{\sum_t \sum_{i \in c} a_i(t)}{\sum_t N_c(t)}, \qquad
          \rho_c = \frac{\langle N_c \rangle}{V_c}, \qquad T_c = \frac{\sum_{i \in c} m_i v_i^2}{(\text{adof}\, N_c + \text{cdof}) k_B}

over Nrepeat samples, Nevery steps apart, known on multiples of Nfreq. ``norm sample`` averages the averages of the samples; ``norm none``
does not divide by numbers of atoms. Densities are those of bins; where chunks are no bins, of the whole box.

Source: LAMMPS manual, fix ave/chunk. Output: an array with the columns of the file (coordinates, or the number of a compressed chunk, of
chunks; numbers of atoms; values); a file.
"""
from __future__ import annotations

import numpy as np

from asemd.compute._bins import Cylinder, Frame, Grid
from asemd.compute._chunked import find_chunks
from asemd.compute.pressure import find_temperature
from asemd.errors import InputError
from asemd.fix import sampled
from asemd.fix.output_file import OutputFile
from asemd.fix.sampled import Sampled, Window
from asemd.fix.values import Value, expand, given, read
from asemd.kernels import observe
from asemd.words import choice, number, take, whole

WORDS = ("vx", "vy", "vz", "fx", "fy", "fz")
SPECIAL = ("density/number", "density/mass", "mass", "temp")
KEYWORDS = {"norm": 1, "ave": sampled.ave_count, "bias": 1, "adof": 1, "cdof": 1, "file": 1, "append": 1, "overwrite": 0, "format": 1,
            "title1": 1, "title2": 1, "title3": 1}


class AveChunk(Sampled):
    """Averages over chunks and time.

    Parameters
    ----------
    group : str
        The atoms that count.
    chunks : asemd.compute.ChunkAtom
    values : sequence of str, Compute, (Compute, column) or callable
        ``vx`` ... ``fz``, ``density/number``, ``density/mass``, ``mass``, ``temp``; computes with values per atom; functions of a Snapshot.
    sample_every, repeat, freq : int
        Steps between samples, samples of an average, steps between averages.
    norm : str
        ``all``, ``sample``, ``none``.
    ave, window, file
        As in `asemd.fix.AveTime`.
    flow : Temp, optional
        Takes a flow off the velocities for ``temp``.
    adof, cdof : float
        Degrees of freedom of an atom (by default the dimension) and of a chunk.

    Raises
    ------
    InputError
        Intervals that do not fit together, no chunks, no value.
    """

    style = "ave/chunk"

    def __init__(self, group: str = "all", chunks=None, values=(), sample_every: int = 1, repeat: int = 1, freq: int = 1, norm: str = "all",
                 ave: str = "one", window: int = 0, file: str = "", flow=None, adof: float | None = None, cdof: float = 0.0):
        what = f"fix {self.style}"
        own = [Value(v, "special", v) if isinstance(v, str) and v in SPECIAL else given(v, k) for k, v in enumerate(values, 1)]
        super().__init__(group, own, sample_every, repeat, freq)
        if chunks is None or chunks.style != "chunk/atom":
            raise InputError(f"{what} needs a compute chunk/atom")
        if not own:
            raise InputError(f"{what} needs at least one value")
        if flow is not None and not flow.bias:
            raise InputError(f"{what} bias: compute {flow.id} (style {flow.style}) takes no bias off the velocities")
        self.chunks, self.flow, self.adof, self.cdof = chunks, flow, adof, cdof
        self.norm = choice(norm, ("all", "sample", "none"), f"{what} norm")
        self.window, self.ave = Window(ave, window), ave
        self.overwrite, self.format, self.titles, self.path = False, " %g", {}, file
        self.holding, self._shape = False, None
        self.result: np.ndarray | None = None       # (chunks, 1 + values): atoms, values
        self.labels = np.zeros((0, 0))
        self._page: tuple[np.ndarray, str] | None = None      # labels, and the lines of the file with room for numbers
        if file:
            self.file = OutputFile(file, what)
            self._header()

    @classmethod
    def from_lammps(cls, group, words, session):
        what = f"fix {cls.style}"
        take(words, 5, what)
        every, repeat, freq = (whole(w, f"{what} {n}") for w, n in zip(words, ("Nevery", "Nrepeat", "Nfreq")))
        chunks = find_chunks(words[3], what, session)
        names, rest = sampled.split(words[4:], (*WORDS, *SPECIAL))
        options = sampled.keywords(rest, KEYWORDS, what)
        values = [w if w in SPECIAL else read(w, session, what, WORDS).check("per_atom", what)
                  for w in expand(names, session, vectors=True)]
        ave, window = sampled.read_ave(options.get("ave", ["one"]), what)
        flow = find_temperature(options["bias"][0], session, what) if "bias" in options else None
        fix = cls(group, chunks, values, every, repeat, freq, options.get("norm", ["all"])[0], ave, window, "", flow,
                  number(options["adof"][0], f"{what} adof") if "adof" in options else None,
                  number(options.get("cdof", ["0"])[0], f"{what} cdof"))
        fix.session, fix.words, fix.id = session, list(words), session.defining
        sampled.check_frequencies(fix)
        if "overwrite" in options and ave != "running":
            raise InputError(f"{what}: overwrite needs ave running")
        fix.overwrite, fix.format = "overwrite" in options, options.get("format", [" %g"])[0]
        fix.titles = {n: options[f"title{n}"][0] for n in (1, 2, 3) if f"title{n}" in options}
        fix.path = next((options[k][0] for k in reversed(options) if k in ("file", "append")), "")
        fix.begin(session.scene.step)
        if fix.path:
            fix.file = OutputFile(fix.path, what, "append" in options, session.passive)
            fix._header()
        return fix

    def to_lammps(self) -> list[str]:
        own = [*(str(n) for n in (self.sample_every, self.repeat, self.freq)), self.chunks.id, *(v.word for v in self.values)]
        return getattr(self, "words", own)

    # ---- samples
    def setup(self, loop) -> None:
        super().setup(loop)
        self.needs |= self.chunks.needs

    def sample(self, snapshot) -> None:
        if self.count == 0 and not self.holding:
            self.chunks.hold(snapshot)
            self.holding = True
        at, chunks = self.chunks.assign(snapshot)
        mask = snapshot.mask(self.group)
        at = at - 1 if mask.all() else np.where(mask, at, 0) - 1
        atoms = np.zeros(chunks)
        observe.count(at, atoms)
        now = np.stack([atoms if v.word == "density/number" else self._of_chunks(v, snapshot, at, chunks) for v in self.values], axis=1)
        now = np.stack([self._per_sample(v, column, atoms, snapshot) for v, column in zip(self.values, now.T)], axis=1)
        if self.count == 0:
            self._atoms_sum, self._sum = np.zeros(chunks), np.zeros((chunks, len(self.values)))
        self._atoms_sum, self._sum = self._atoms_sum + atoms, self._sum + now
        self._last = snapshot

    def _of_chunks(self, value: Value, snapshot, at: np.ndarray, chunks: int) -> np.ndarray:
        """(chunks,) the sum of a value over the atoms of each chunk."""
        system, u, out = snapshot.system, snapshot.units, np.zeros(chunks)
        if value.kind != "special":
            observe.total(at, np.ascontiguousarray(value.per_atom(snapshot)), out)
        elif value.id == "temp":
            v = system.v
            if self.flow is not None:
                v = np.where(snapshot.mask(self.flow.group)[:, None], self.flow.remove_bias(snapshot), v)
            observe.heat(at, system.atom_masses(), v, out)
            out *= u.mvv2e / u.boltz
        else:
            observe.total(at, system.atom_masses(), out)
        return out

    def _degrees(self, atoms: np.ndarray, samples: int, snapshot) -> np.ndarray:
        return self.cdof * samples + (snapshot.dimension if self.adof is None else self.adof) * atoms

    def _per_sample(self, value: Value, total: np.ndarray, atoms: np.ndarray, snapshot) -> np.ndarray:
        """The averages of one sample, for ``norm sample``; temperatures with ``none`` too."""
        if value.word in ("density/number", "density/mass") or self.norm == "all" or (self.norm == "none" and value.word != "temp"):
            return total
        by = self._degrees(atoms, 1, snapshot) if value.word == "temp" else atoms
        return np.divide(total, by, out=np.zeros_like(total), where=atoms > 0)

    def conclude(self, step: int) -> None:
        snapshot, columns = self._last, []
        for value, total in zip(self.values, self._sum.T):
            if value.word in ("density/number", "density/mass"):
                factor = snapshot.units.mv2d if value.word == "density/mass" else 1.0
                columns.append(total * factor / (self.repeat * self._volumes(snapshot)))
            elif self.norm != "all":
                columns.append(total / self.repeat)
            else:
                by = self._degrees(self._atoms_sum, self.repeat, snapshot) if value.word == "temp" else self._atoms_sum
                columns.append(np.divide(total, by, out=np.zeros_like(total), where=self._atoms_sum > 0))
        new = np.column_stack([self._atoms_sum / self.repeat, *columns])
        if self.ave != "one" and self._shape not in (None, new.shape):
            raise InputError(f"fix {self.id} (style {self.style}): the number of chunks changed from {self._shape[0]} to {len(new)}, which "
                             f"ave {self.ave} cannot average")
        self._shape = new.shape
        self.result = self.window.add(new)
        self.labels = self._labels(snapshot)
        self._write(step)
        if self.ave == "one" and self.holding:
            self.chunks.release()
            self.holding = False
        self._last = None

    def _volumes(self, snapshot) -> float | np.ndarray:
        """Volume of each bin, or of the box."""
        s, system = self.chunks.settings, snapshot.system
        edges, bins = np.diag(system.box.cell).copy(), s.bins
        if system.dimension == 2:
            edges[2] = 1.0
        volume = float(np.prod(edges))
        if not bins:
            return volume
        frame = Frame(system, s.units == "reduced")

        def part(layer) -> float:
            return layer.delta if s.units == "reduced" else layer.delta / edges[layer.axis]
        if isinstance(bins, Grid):
            return volume * float(np.prod([part(layer) for layer in bins.layers]))
        least, most = bins._ends(frame)
        r = least + np.arange(bins.count + 1) * (most - least) / bins.count
        if isinstance(bins, Cylinder):
            thick = edges[bins.layers.axis] * part(bins.layers)
            return np.repeat(np.pi * np.diff(r**2) * thick, len(self._atoms_sum) // bins.count)
        return (4.0 / 3.0 * np.pi * np.diff(r**3))[:len(self._atoms_sum)]

    def _labels(self, snapshot) -> np.ndarray:
        """(chunks, columns): numbers before compression, coordinates."""
        s, n = self.chunks.settings, len(self._atoms_sum)
        columns = [self.chunks.numbers_of_chunks(snapshot)[:n, None]] if s.compress else []
        columns += [self.chunks.coordinates(snapshot)] if s.bins else []
        return np.hstack(columns) if columns else np.zeros((n, 0))

    # ---- file
    def _header(self) -> None:
        s = self.chunks.settings
        names = ["OrigID"] * bool(s.compress) + [f"Coord{k + 1}" for k in range(s.bins.directions if s.bins else 0)]
        words = " ".join([*names, "Ncount", *(v.word for v in self.values)])
        lines = (self.titles.get(1, f"# Chunk-averaged data for fix {self.id} and group {self.group}"),
                 self.titles.get(2, "# Timestep Number-of-chunks Total-count"), self.titles.get(3, f"# Chunk {words}"))
        self.file.write("".join(f"{line}\n" for line in lines))
        self.file.mark()

    def _write(self, step: int) -> None:
        if self.file is None:
            return
        if self.overwrite:
            self.file.rewind()
        text = f"{step} {len(self.result)}{self._total()}\n"
        integers = bool(self.chunks.settings.compress)
        if self._page is None or not np.array_equal(self._page[0], self.labels):
            line = "  %d" + "".join(" %d" if integers and j == 0 else " %g" for j in range(self.labels.shape[1]))
            rest = " %g" + self.format * len(self.values) + "\n"
            self._page = self.labels, "".join([line % (k, *row) + rest for k, row in enumerate(self.labels.tolist(), 1)])
        try:
            text += self._page[1] % tuple(self.result.ravel().tolist())
        except (TypeError, ValueError):
            raise InputError(f"fix {self.id} (style {self.style}): format {self.format!r} does not show one number") from None
        self.file.write(text)

    def _total(self) -> str:
        return f" {float(np.sum(self.result[:, 0])) * self.window.norm:g}"

    # ---- outputs
    outputs = ("array",)

    @property
    def size(self) -> int:
        return len(self.result) if self.result is not None else 0

    def array_columns(self) -> int:
        s = self.chunks.settings
        return bool(s.compress) + (s.bins.directions if s.bins else 0) + 1 + len(self.values)

    def extensive_at(self, index) -> bool:
        return False

    def array(self, i: int, j: int) -> float:
        """Column `j` of the line of chunk `i` in the file, without the first."""
        if not 1 <= j <= self.array_columns() or i < 1:
            raise InputError(f"fix {self.id} (style {self.style}) has {self.array_columns()} columns, there is no element [{i}][{j}]")
        if self.result is None or i > len(self.result):
            return 0.0
        width = self.labels.shape[1]
        return float(self.labels[i - 1, j - 1] if j <= width else self.result[i - 1, j - 1 - width])

    def whole_vector(self, column: int | None = None) -> np.ndarray:
        """A column (from 1) of the array."""
        return np.array([self.array(k, column or 1) for k in range(1, self.size + 1)])
