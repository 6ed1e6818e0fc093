"""A page in a running Chromium without a window, told over a pipe what to do; scripts run in it, pictures are taken."""

import base64
import json
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

#: WebGL by software, so that pictures are the same on every machine.
SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
NO_GL = ("--disable-gpu", "--disable-3d-apis")

_FLAGS = (
    "--headless", "--no-sandbox", "--remote-debugging-pipe", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars",
)  # fmt: skip


class Tab:
    """One page and what can be asked of it."""

    def __init__(self, send: int, receive: int) -> None:
        self._out, self._in = os.fdopen(send, "wb", buffering=0), os.fdopen(receive, "rb", buffering=0)
        self._count, self._rest, self._session = 0, b"", None
        self.said: list[str] = []  #: what the page wrote to its console, and its faults
        self.asked: list[str] = []  #: what it asked the network for
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self._call(f"{domain}.enable")

    def close(self) -> None:
        self._out.close()
        self._in.close()

    def open(self, page: Path, width: int = 1280, height: int = 900) -> None:
        """Show a file."""
        self._call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        self._call("Page.navigate", url=page.absolute().as_uri())
        self.wait_for(f"document.readyState === 'complete' && location.href.endsWith({json.dumps(page.name)})")

    def run(self, script: str) -> Any:
        """The value of an expression, a promise's once it is there."""
        found = self._call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise AssertionError(found["exceptionDetails"])
        return found["result"].get("value")

    def wait_for(self, condition: str, seconds: float = 30.0) -> None:
        """Until an expression is true."""
        end = time.monotonic() + seconds
        while not self.run(condition):
            assert time.monotonic() < end, f"not within {seconds} s: {condition}; the page said {self.said}"
            time.sleep(0.05)

    def scroll_to(self, element: str) -> None:
        """Until it is in the middle."""
        middle = "{block: 'center', behavior: 'instant'}"
        self.run(f"document.querySelector({json.dumps(element)}).scrollIntoView({middle})")

    def drag(self, element: str, right: int, down: int) -> None:
        """Press the mouse in the middle of an element and move it."""
        self.scroll_to(element)
        x, y = self.run(
            f"(box => [box.left + box.width / 2, box.top + box.height / 2])"
            f"(document.querySelector({json.dumps(element)}).getBoundingClientRect())"
        )
        mouse = {"button": "left", "clickCount": 1}
        self._call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, **mouse)
        self._call("Input.dispatchMouseEvent", type="mouseMoved", x=x + right, y=y + down, buttons=1, **mouse)
        self._call("Input.dispatchMouseEvent", type="mouseReleased", x=x + right, y=y + down, **mouse)

    def picture(self, element: str = "") -> NDArray[np.uint8]:
        """(height, width, 3) of the first element that a selector names, or of all of the page."""
        area = self.run(
            f"(box => ({{x: box.left + scrollX, y: box.top + scrollY, width: box.width, height: box.height}}))"
            f"(document.querySelector({json.dumps(element or 'html')}).getBoundingClientRect())"
        )
        found = self._call("Page.captureScreenshot", clip={**area, "scale": 1}, captureBeyondViewport=True)
        image = Image.open(BytesIO(base64.b64decode(found["data"])))
        return np.asarray(image.convert("RGB"))

    def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._out.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self._note(answer.get("method"), answer.get("params", {}))

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            part = self._in.read(1 << 20)
            assert part, "Chromium has ended"
            self._rest += part
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def _note(self, event: str | None, about: dict[str, Any]) -> None:
        if event == "Runtime.consoleAPICalled":
            self.said.append(" ".join(str(one.get("value", one.get("description"))) for one in about["args"]))
        elif event == "Runtime.exceptionThrown":
            details = about["exceptionDetails"]
            self.said.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Log.entryAdded":
            self.said.append(about["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            self.asked.append(about["request"]["url"][:200])


@contextmanager
def tab(folder: Path, flags: tuple[str, ...] = SOFTWARE_GL) -> Iterator[Tab]:
    """A page of a Chromium of its own."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert chromium, "no Chromium; `make test` installs it"
    theirs_in, ours_out = os.pipe()
    ours_in, theirs_out = os.pipe()

    def on_3_and_4() -> None:  # where Chromium expects the pipe
        first, second = os.dup(theirs_in), os.dup(theirs_out)
        os.dup2(first, 3)
        os.dup2(second, 4)

    process = subprocess.Popen(
        [chromium, *_FLAGS, *flags, f"--user-data-dir={folder / 'profile'}"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, close_fds=False, preexec_fn=on_3_and_4,
    )  # fmt: skip
    os.close(theirs_in)
    os.close(theirs_out)
    page = Tab(ours_out, ours_in)
    try:
        yield page
    finally:
        page.close()
        process.terminate()
        process.wait(30)
