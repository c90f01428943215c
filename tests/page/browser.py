"""Drives a headless Chromium over its debugging pipe: pages, pointer, fingers and keys. Python's own library only."""
import base64
import json
import os
import shutil
import subprocess
import tempfile

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE_S = 120  # for what comes in any case: only a browser that hangs gets there


def program():
    """Path of the browser, None where there is none."""
    return next((path for name in PROGRAMS if (path := shutil.which(name))), None)


class Browser:
    """One page of one browser."""

    def __init__(self, width=1440, height=900):
        self.messages = []  # of the console, and what was thrown
        self.requests = []  # what the page asked for that it does not carry itself
        self._number = 0
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()

        def at_3_and_4():
            os.dup2(to_browser, 13)
            os.dup2(from_browser, 14)
            os.dup2(13, 3)
            os.dup2(14, 4)

        self._process = subprocess.Popen(
            [program(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run", "--disable-background-networking",
             "--remote-debugging-pipe", f"--user-data-dir={self._profile.name}", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=at_3_and_4, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._rest = b""
        self._session = None
        target = next(info for info in self.call("Target.getTargets")["targetInfos"] if info["type"] == "page")
        self._session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.size(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._out)
        os.close(self._in)
        self._profile.cleanup()

    def _receive(self):
        while b"\0" not in self._rest:
            more = os.read(self._in, 1 << 20)
            if not more:
                raise RuntimeError("the browser ended")
            self._rest += more
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)

    def _note(self, message):
        what, about = message.get("method"), message.get("params", {})
        if what == "Runtime.exceptionThrown":
            self.messages.append(about["exceptionDetails"].get("exception", {}).get("description", about["exceptionDetails"]["text"]))
        elif what == "Runtime.consoleAPICalled":
            self.messages.append(" ".join(str(each.get("value", each.get("description"))) for each in about["args"]))
        elif what == "Log.entryAdded":
            self.messages.append(about["entry"]["text"])
        elif what == "Network.requestWillBeSent" and not about["request"]["url"].startswith("data:"):
            self.requests.append(about["request"]["url"])

    def call(self, method, **params):
        """One command of the DevTools protocol, and its answer."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._note(answer)

    def size(self, width, height, touch=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch)

    def open(self, path):
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        self.until("document.readyState === 'complete'")

    def ask(self, script):
        """The value of an expression, promises awaited."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, condition):
        """Waits for an event, not for a time: the condition is looked at in each of the page's frames."""
        self.ask(f"""new Promise((good, bad) => {{
          const end = Date.now() + {1000 * PATIENCE_S};
          (function look() {{
            if ({condition}) good();
            else if (Date.now() > end) bad(new Error('never came: ' + {json.dumps(condition)}));
            else setTimeout(look, 20);
          }})();
        }})""")

    def settled(self):
        """Two frames were drawn."""
        self.ask("new Promise(good => requestAnimationFrame(() => requestAnimationFrame(good)))")

    def place(self, selector, x=0.5, y=0.5):
        """A place within an element, scrolled into view; as shares of its width and height."""
        return self.ask(f"""(() => {{
          const element = document.querySelector({json.dumps(selector)});
          element.scrollIntoView({{block: 'center'}});
          const box = element.getBoundingClientRect();
          return [box.left + box.width * {x}, box.top + box.height * {y}];
        }})()""")

    def mouse(self, kind, at, buttons=0, clicks=0):
        self.call("Input.dispatchMouseEvent", type="mouse" + kind, x=at[0], y=at[1], button="left" if buttons or clicks else "none", buttons=buttons, clickCount=clicks)

    def move(self, at):
        self.mouse("Moved", at)

    def click(self, selector):
        at = self.place(selector)
        self.move(at)
        self.mouse("Pressed", at, 1, 1)
        self.mouse("Released", at, 0, 1)

    def double_click(self, at):
        self.move(at)
        for clicks in (1, 2):
            self.mouse("Pressed", at, 1, clicks)
            self.mouse("Released", at, 0, clicks)

    def drag(self, start, end):
        self.move(start)
        self.mouse("Pressed", start, 1, 1)
        for share in (0.25, 0.5, 0.75, 1):
            self.mouse("Moved", [a + (b - a) * share for a, b in zip(start, end)], 1)
        self.mouse("Released", end, 0, 1)

    def swipe(self, start, end):
        """With one finger."""
        point = lambda at: [{"x": at[0], "y": at[1]}]
        self.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=point(start))
        for share in (0.1, 0.25, 0.5, 0.75, 1):
            self.call("Input.dispatchTouchEvent", type="touchMove", touchPoints=point([a + (b - a) * share for a, b in zip(start, end)]))
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def key(self, name, text=None):
        code = {"ArrowLeft": 37, "ArrowRight": 39, "End": 35, "Home": 36, "Enter": 13, " ": 32, "Tab": 9}[name]
        more = {"text": text} if text else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=name, code=name, windowsVirtualKeyCode=code, **more)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=name, code=name, windowsVirtualKeyCode=code)

    def dark(self, yes):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if yes else "light"}])

    def picture(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
