"""``dump ID group movie N file colour diameter keywords...``: the pictures of ``dump image`` as one film."""
from __future__ import annotations

import os
import shutil
import subprocess

from asemd.dump.image import Image
from asemd.errors import InputError
from asemd.words import number

ANIMATED = {".gif": "GIF", ".webp": "WEBP", ".apng": "PNG", ".png": "PNG"}     # endings Pillow writes; the others need ffmpeg


class Movie(Image):
    """A film: gif, webp or apng by Pillow; mp4, mkv, avi, mpg ... by the program ffmpeg, which must be installed.

    ``dump_modify framerate`` (24 per second) and ``bitrate`` (2000 kbit/s, only with ffmpeg) as in LAMMPS.
    """

    style = "movie"
    wildcards = ""
    one_each = False
    KEYWORDS = {**{k: n for k, n in Image.KEYWORDS.items() if k not in ("maxfiles", "nfile", "fileper", "pad")},
                "bitrate": 1, "framerate": 1}

    def __init__(self, group: str, every: int, path: str, colour: str, diameter: str, *, variables=None, regions=None):
        super().__init__(group, every, path, colour, diameter, variables=variables, regions=regions)
        self.bitrate, self.framerate = 2000.0, 24.0
        self._frames: list = []

    def __getstate__(self):
        return {**super().__getstate__(), "_frames": []}

    def _check_path(self, path):
        super()._check_path(path)
        if self._animated(path) is None and _ffmpeg() is None:
            raise InputError(f"dump movie: {path} needs the program ffmpeg (pip install imageio-ffmpeg), or choose .gif, .webp or .apng")

    @staticmethod
    def _animated(path: str) -> str | None:
        return ANIMATED.get(os.path.splitext(path)[1].lower())

    def write_view(self, snapshot, step, view):
        picture = self.picture(snapshot, view)
        if self._animated(self.path):
            from PIL import Image as Picture
            if not self._frames:
                self._probe()
            frame = Picture.fromarray(picture)
            self._frames.append(frame.quantize(256, dither=Picture.Dither.NONE) if self.path.lower().endswith(".gif") else frame)
            return
        if self._file is None:
            self._file = self._start()
        try:
            self._file.stdin.write(picture.tobytes())
        except OSError as e:
            raise self.cannot_write(self.path, e) from None

    def _probe(self) -> None:
        """Fail now rather than at the end of the run."""
        try:
            with open(self.path, "wb"):
                return
        except OSError as e:
            raise self.cannot_write(self.path, e) from None

    def _start(self) -> subprocess.Popen:
        self._probe()
        return subprocess.Popen(
            [_ffmpeg(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{self.width}x{self.height}", "-r",
             f"{self.framerate:g}", "-i", "-", "-an", "-b:v", f"{self.bitrate:g}k", "-pix_fmt", "yuv420p", "-vf",
             "pad=ceil(iw/2)*2:ceil(ih/2)*2", self.path], stdin=subprocess.PIPE)

    def close(self):
        """Finish the film."""
        if self._file is not None:
            self._file.stdin.close()
            code, self._file = self._file.wait(), None
            if code:
                raise InputError(f"dump {self.id}: ffmpeg could not write {self.path} (status {code})")
        if self._frames:
            first, *rest = self._frames
            kind, duration = self._animated(self.path), 1000.0 / self.framerate
            try:
                first.save(self.path, kind, save_all=True, append_images=rest, duration=duration, loop=0)
            except OSError as e:
                raise self.cannot_write(self.path, e) from None

    def _modify_bitrate(self, values, what, session):
        self.bitrate = self._rate(values, what)

    def _modify_framerate(self, values, what, session):
        self.framerate = self._rate(values, what)

    @staticmethod
    def _rate(values, what) -> float:
        value = number(values[0], what)
        if value <= 0.0:
            raise InputError(f"{what}: must be positive, got {values[0]}")
        return value


def _ffmpeg() -> str | None:
    """The program, on the path or from the package imageio-ffmpeg."""
    found = shutil.which("ffmpeg")
    if found is None:
        try:
            import imageio_ffmpeg
            found = imageio_ffmpeg.get_ffmpeg_exe()
        except (ImportError, RuntimeError):
            return None
    return found
