"""Fourier transforms between a mesh and its waves, by a library, in parts that the threads of a kernel call back.

With several threads each transforms its planes along the last two directions and, after all have met, its share of the second direction
along the first one. Small meshes, for which that would take longer than it saves, are left to the first thread.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from asemd.kernels.callback import Callback

POINTS = 4000         # of a mesh, for each thread that takes part
TOGETHER = 2**19      # bytes of several fields that are transformed in one call; larger ones are, in turns, faster


class Transforms:
    """The parts of the transforms of a term.

    Parameters
    ----------
    term : asemd.kspace.pppm.PPPMTerm
        Has the arrays ``density (..., nx, ny, nz)`` and ``wave (..., nx, ny, nz // 2 + 1)`` of charges, ``waves`` and ``field`` of what
        acts on them, ``shares`` and ``share_field``; they are looked up in each call.
    threads : int
        Of the kernel.
    """

    def __init__(self, term, threads: int):
        self.term = term
        nx, ny, _ = term.mesh
        points = int(nx) * int(ny) * int(term.mesh[2])
        self.parts = max(1, min(threads, int(nx), int(ny), points // POINTS))
        self.threads = threads
        self.calls = [self._of_thread(k) for k in range(self.parts)]

    def addresses(self, tid: int) -> tuple:
        """What thread `tid` calls: forward, forward across, backward across, backward, backward for shares of atoms; 0 for nothing."""
        return tuple(call.address if call else 0 for call in self.calls[tid]) if tid < self.parts else (0,) * 5

    def _of_thread(self, k: int) -> tuple[Callback | None, ...]:
        nx, ny, _ = (int(n) for n in self.term.mesh)
        shares = Callback(self._backward_shares) if k == 0 else None
        if self.parts == 1:
            return Callback(self._forward), None, None, Callback(self._backward), shares
        planes = slice(nx * k // self.parts, nx * (k + 1) // self.parts)
        rows = slice(ny * k // self.parts, ny * (k + 1) // self.parts)
        return tuple(Callback(partial(f, s)) for f, s in ((self._forward_planes, planes), (self._forward_across, rows),
                                                        (self._backward_across, rows), (self._backward_planes, planes))) + (shares,)

    def _forward(self) -> None:
        from scipy import fft
        self.term.wave[:] = fft.rfftn(self.term.density, axes=(-3, -2, -1))

    def _backward(self) -> None:
        _to_fields(self.term.waves, self.term.field)

    def _backward_shares(self) -> None:
        _to_fields(self.term.shares, self.term.share_field, self.threads)

    def _forward_planes(self, planes: slice) -> None:
        from scipy import fft
        self.term.wave[..., planes, :, :] = fft.rfftn(self.term.density[..., planes, :, :], axes=(-2, -1))

    def _forward_across(self, rows: slice) -> None:
        from scipy import fft
        _in_place(fft.fft, self.term.wave[..., rows, :])

    def _backward_across(self, rows: slice) -> None:
        from scipy import fft
        _in_place(fft.ifft, self.term.waves[..., rows, :])

    def _backward_planes(self, planes: slice) -> None:
        from scipy import fft
        for wave, field in zip(self.term.waves, self.term.field):
            field[planes] = fft.irfftn(wave[planes], s=field.shape[1:], axes=(1, 2))


def _in_place(transform: Callable, wave) -> None:
    """Transform along the first of three directions; the library does it in place where it can."""
    out = transform(wave, axis=-3, overwrite_x=True)
    if not np.may_share_memory(out, wave):
        wave[...] = out


def _to_fields(waves, fields, threads: int = 1) -> None:
    from scipy import fft
    size = fields.shape[1:]
    if fields.nbytes <= TOGETHER:
        fields[:] = fft.irfftn(waves, s=size, axes=(1, 2, 3), workers=threads)
        return
    for wave, field in zip(waves, fields):
        field[:] = fft.irfftn(wave, s=size, workers=threads)
