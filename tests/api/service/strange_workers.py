"""What runs in the processes of a service under test: it does what an upload's first word says."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from api.service.child_process import Say, work_through
from api.service.job_results import ANNOTATED, PARTIAL, REPORT, RESULT, finish
from api.service.level_folder import LEVEL, PARTS
from scenes.errors import LevelError

HELD_BYTES = 250 << 20
FINISHES = "finishes.log"

Json = dict[str, Any]


def read(pipe: Connection, parent: int, model: str, memory: str, memory_bytes: int, seconds: float) -> None:
    del model, memory
    work_through(pipe, parent, memory_bytes, seconds, lambda: _read)


def refuse(pipe: Connection, parent: int, model: str, memory: str, memory_bytes: int, seconds: float) -> None:
    del model, memory

    def prepare() -> Any:
        raise LevelError("There is no model.", remedy="Make one.")

    work_through(pipe, parent, memory_bytes, seconds, prepare)


def measure(pipe: Connection, parent: int, device: str | None, seconds: float) -> None:
    del device
    work_through(pipe, parent, 0, seconds, lambda: _measure)


def _read(request: Json, say: Say) -> Json:
    del say
    folder = Path(request["folder"])
    word = (folder / PARTS / "0").read_bytes().split()[0].decode()
    if request["task"] == "look":
        (folder / LEVEL).mkdir()
        (folder / PARTS / "0").rename(folder / LEVEL / "level.glb")
        return {"name": "level.glb", "media_type": "model/gltf-binary", "lights": 1}
    _misbehave(word)
    (folder / "answer.json").write_text(f'{{"pid":{os.getpid()}}}')
    return {"file": "answer.json"}


def _misbehave(word: str) -> None:
    if word == "hang":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        while True:
            pass
    if word == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if word == "exit":
        os._exit(3)
    if word == "eat":
        _ = bytearray(1 << 40)
    if word == "feed":
        # What it starts eats for it.
        code = f"import time; held = bytearray({HELD_BYTES}); time.sleep(600)"
        # Each keeps the limit on addresses that it inherits; both together are too much.
        for one in [subprocess.Popen([sys.executable, "-c", code]) for _ in range(2)]:
            one.wait()
    if word == "full":
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "a secret place")
    if word == "bug":
        raise ZeroDivisionError(f"in {__file__}")


def _measure(request: Json, say: Say) -> Json:
    folder = Path(request["folder"])
    words = (folder / request["level"]).read_bytes().split()
    word = words[0].decode()
    if word == "refuse":
        raise LevelError("No light casts a shadow.", where="level.glb")
    if word == "once" and not (folder / "tried").exists():
        (folder / "tried").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if word in ("stop", "babble"):
        what = "forever" if word == "stop" else "x" * 1_000_000
        say({"kind": "progress", "done": 1, "total": 2, "what": what})
        time.sleep(3600)
    _misbehave(word)
    steps = 5
    for step in range(steps):
        say({"kind": "progress", "done": step, "total": steps, "what": f"step {step}"})
        time.sleep(0.03)
    (folder / PARTIAL).mkdir(exist_ok=True)
    for name in (RESULT, ANNOTATED, REPORT):
        (folder / PARTIAL / name).write_bytes(b'{"level": "level.glb"}' if name == RESULT else b"x")
    finish(folder)
    with (folder.parents[1] / FINISHES).open("a") as file:
        file.write(f"{folder.name}\n")
    return {"steps": steps}
