"""Renders a recording and encodes it as an MP4."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from surefoot.bus.errors import RecordingError
from surefoot.config.typed_toml import ConfigError
from surefoot.tools.offscreen import NO_RENDERER, Offscreen
from surefoot.tools.tables.recording_tables import load
from surefoot.tools.tables.table import NotRecorded

SIZE_LEAST, SIZE_MOST = 64, 3840
"""Of a side [pixels]."""

_QUALITY = {"crf": "21", "preset": "veryfast"}
_TOLD_EVERY = 100  # frames


@dataclass(frozen=True)
class FilmSpec:
    """What is filmed, and how.

    Attributes:
        recording, out: the files.
        speed: seconds of the run for each of the film.
        fps: frames a second of the film.
        width, height: in pixels, even.
        begin_s, end_s: of the run's clock; beyond the recording: as far as it goes.
    """

    recording: Path
    out: Path
    speed: float = 1.0
    fps: int = 30
    width: int = 960
    height: int = 540
    begin_s: float = float("-inf")
    end_s: float = float("inf")

    def __post_init__(self) -> None:
        for name, value in (("width", self.width), ("height", self.height)):
            if value % 2 or not SIZE_LEAST <= value <= SIZE_MOST:
                raise ConfigError(
                    f"--size, {name} {value}: an even number from {SIZE_LEAST} to {SIZE_MOST} pixels"
                )
        if not 0.01 <= self.speed <= 100.0:
            raise ConfigError(f"--speed {self.speed:g}: allowed 0.01 to 100")
        if not 1 <= self.fps <= 120:
            raise ConfigError(f"--fps {self.fps}: allowed 1 to 120")
        if self.out.suffix != ".mp4":
            raise ConfigError(f"--out {self.out}: a film is an .mp4")
        if not self.out.parent.is_dir():
            raise ConfigError(f"--out {self.out}: there is no folder {self.out.parent}; make it first")


def make_film(spec: FilmSpec, say: Callable[[str], None], offscreen: Offscreen | None = None) -> int:
    """Make the film; returns how many frames it has.

    Raises:
        ConfigError: the encoder is not installed, or nothing here can draw; says what to install.
        RecordingError: it is no recording, or holds nothing of that time.
    """
    try:
        import av  # noqa: F401
    except ImportError:
        raise ConfigError("a film needs PyAV: pip install 'surefoot[video]'") from None
    _check_span(spec)
    told = (offscreen or Offscreen()).run(film, (spec,))
    if NO_RENDERER in told:
        raise ConfigError(
            f"{told[NO_RENDERER]}. It needs no display, but EGL (Debian: apt install libegl1 libgl1-mesa-dri) or "
            "OSMesa (apt install libosmesa6); MUJOCO_GL=egl or osmesa asks for one of them"
        )
    if "failure" in told:
        raise RecordingError(f"{spec.recording}: not filmed: {told['failure'].removeprefix('error: ')}")
    say(f"{told['frames']} frames of {told['shown']}")
    return told["frames"]


def _check_span(spec: FilmSpec) -> None:
    """Say before anything is rendered that there is nothing to render."""
    recording = load(spec.recording)
    begin, end = recording.span_s
    if max(spec.begin_s, begin) >= min(spec.end_s, end):
        raise NotRecorded(
            f"{spec.recording}: nothing from {spec.begin_s:g} to {spec.end_s:g} s; it is of {begin:.3f} to "
            f"{end:.3f} s"
        )
    if not {"sim/truth", "state/estimate"} & set(recording):
        raise NotRecorded(
            f"{spec.recording}: neither sim/truth nor state/estimate in it: nothing is known of the robot"
        )


def film(spec: FilmSpec) -> dict:
    """Render and encode in this process, with the backend of its environment; says what fails of that itself."""
    import av

    from surefoot.tools.video.scenes import Scenes, frame_times

    recording = load(spec.recording)
    begin, end = recording.span_s
    scenes = Scenes(recording, frame_times(max(spec.begin_s, begin), min(spec.end_s, end), spec.fps, spec.speed))
    deployment = recording.deployment
    try:
        from surefoot.tools.video.camera import Camera

        camera = Camera(deployment, spec.width, spec.height)
    except Exception as error:  # what is missing of GL shows as almost any kind of error
        return {NO_RENDERER: f"{type(error).__name__}: {error}"}
    unfinished = spec.out.with_suffix(".part.mp4")
    with av.open(str(unfinished), "w", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(spec.fps), options=_QUALITY)
        stream.width, stream.height, stream.pix_fmt = spec.width, spec.height, "yuv420p"
        for number, instant in enumerate(scenes):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(camera.picture(instant), format="rgb24")))
            if (number + 1) % _TOLD_EVERY == 0:
                print(f"{number + 1} of {len(scenes)} frames", flush=True)
        container.mux(stream.encode())
    camera.close()
    unfinished.replace(spec.out)
    return {"frames": len(scenes), "shown": "the truth" if scenes.true else "the estimate"}
