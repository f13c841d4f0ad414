"""A page in headless chromium, moved by the input of a mouse and a keyboard as a reader's hand moves it."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

SELF_TEST = f"({Path(__file__).with_name('self_test.js').read_text()})(pcorReport)"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

# A page in the background, as every page without a window is to Chromium, gets less processor time and slow timers.
FOREGROUND = ("--disable-renderer-backgrounding", "--disable-backgrounding-occluded-windows", "--disable-background-timer-throttling")
# Pages of one process keep compiled scripts; nothing is fetched or synchronized.
ALONE = ("--disable-site-isolation-trials", "--disable-extensions", "--disable-component-update", "--disable-background-networking",
         "--disable-sync")


def skip_without(browser, name):
    """Without the browser, exits as a skipped test, or as a failed one if PCOR_REQUIRE_<NAME> is set."""
    if browser is None:
        print(f"{name} is not installed; reports were not looked at", file=sys.stderr)
        sys.exit(1 if os.environ.get(f"PCOR_REQUIRE_{name.upper()}") else 77)


class PageTest(unittest.TestCase):
    """Tests of pages in one browser, with a folder for its profile and for files of the tests."""

    @classmethod
    def make_folder(cls):
        directory = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a browser that ends still writes
        cls.addClassCleanup(directory.cleanup)
        cls.folder = Path(directory.name)
        return cls.folder

    @classmethod
    def start(cls, make, *arguments, **more):
        cls.browser = make(*arguments, **more)
        cls.addClassCleanup(cls.browser.close)


class Browser:
    """One tab, spoken to over the pipe of the DevTools protocol."""

    def __init__(self, program, profile, width=1280, height=900, words=(), environment=None):
        from_us, to_browser = os.pipe()
        from_browser, to_us = os.pipe()

        # The browser reads at descriptor 3 and writes at 4; a shell puts the pipes there.
        self.child = subprocess.Popen(
            ["/bin/sh", "-c", f'exec "$@" 3<&{from_us} 4>&{to_us}', "sh", program, "--headless=new", "--no-sandbox",
             "--disable-gpu", *FOREGROUND, *ALONE, f"--user-data-dir={profile}", f"--window-size={width},{height}", *words, "--remote-debugging-pipe"],
            env=environment, pass_fds=(from_us, to_us), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(from_us)
        os.close(to_us)
        self.out = os.fdopen(to_browser, "wb")
        self.into = os.fdopen(from_browser, "rb")
        self.received = b""
        self.number = 0
        self.session = None
        self.errors = []  # what a page threw or told on its console
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.ask(f"{domain}.enable")

    def close(self):
        self.child.kill()
        self.child.wait()
        self.out.close()
        self.into.close()

    def message(self):
        while b"\0" not in self.received:
            more = self.into.read1(1 << 16)
            if not more:
                raise EOFError("the browser has ended")
            self.received += more
        text, _, self.received = self.received.partition(b"\0")
        found = json.loads(text)
        kind, told = found.get("method"), found.get("params")
        if kind == "Runtime.exceptionThrown":
            self.errors.append(told["exceptionDetails"]["text"])
        elif kind == "Runtime.consoleAPICalled":
            self.errors.append(f"{told['type']}: {[each.get('value') for each in told['args']]}")
        elif kind == "Log.entryAdded":
            self.errors.append(told["entry"]["text"])
        return found

    def ask(self, method, **parameters):
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            command["sessionId"] = self.session
        self.out.write(json.dumps(command).encode() + b"\0")
        self.out.flush()
        while True:
            found = self.message()
            if found.get("id") == self.number:
                if "error" in found:
                    raise RuntimeError(f"{method}: {found['error']['message']}")
                return found["result"]

    def open(self, address):
        """A new page, also if only the part after # differs from the last."""
        self.ask("Page.navigate", url="about:blank")
        self.ask("Page.navigate", url=address)
        self.wait("Boolean(window.pcorReport && window.pcorReport.ready)")

    def resize(self, width, height=900):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def screenshot(self, **more):
        """A picture of the page, PNG."""
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png", **more)["data"])

    def self_test(self, address):
        """Results of the test of a page."""
        self.errors.clear()
        self.open(address)
        return self.value(SELF_TEST)

    def wait(self, condition, seconds=60):
        """Waits for a condition; automatic changes of the page take time on a busy machine."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                if self.value(condition):
                    return
            except RuntimeError:
                pass  # the page is not there yet
            time.sleep(0.02)
        raise TimeoutError(condition)

    def value(self, expression):
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']['exception'].get('description')}")
        return answer["result"].get("value")

    def settle(self):
        """Until what was scrolled is where the mouse will find it."""
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def mouse(self, kind, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def point(self, x, y):
        self.mouse("mouseMoved", x, y)

    def click(self, x, y, count=1):
        for each in range(1, count + 1):
            self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=each)
            self.mouse("mouseReleased", x, y, button="left", clickCount=each)

    def drag(self, x, y, to_x, to_y):
        self.point(x, y)
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        for part in (0.3, 0.7, 1.0):
            self.mouse("mouseMoved", x + part * (to_x - x), y + part * (to_y - y), button="left", buttons=1)
        self.mouse("mouseReleased", to_x, to_y, button="left", clickCount=1)

    def wheel(self, x, y, turn, control=False):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=turn, modifiers=2 if control else 0)

    def key(self, key, shift=False):
        for kind in ("keyDown", "keyUp"):
            more = {"text": key} if kind == "keyDown" and len(key) == 1 else {}
            self.ask("Input.dispatchKeyEvent", type=kind, key=key, modifiers=8 if shift else 0, **more)
