"""A page in headless Firefox, over its Marionette protocol, moved by real input."""

import base64
import json
import os
import socket
import subprocess
import time
from pathlib import Path


class Firefox:
    def __init__(self, program, profile, width=1280, height=900):
        profile = Path(profile)
        profile.mkdir(parents=True, exist_ok=True)
        (profile / "user.js").write_text('user_pref("marionette.port", 0);\nuser_pref("browser.shell.checkDefaultBrowser", false);\n')
        self.child = subprocess.Popen(
            [program, "--headless", "--marionette", "--no-remote", "--profile", str(profile), "--width", str(width),
             "--height", str(height)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, "HOME": str(profile)})
        self.number = 0
        self.rest = b""
        self.socket = self.connect(profile / "MarionetteActivePort")
        self.receive()  # what it is
        self.ask("WebDriver:NewSession", capabilities={"alwaysMatch": {"acceptInsecureCerts": True}})
        self.ask("WebDriver:SetWindowRect", width=width, height=height)

    def connect(self, port_file, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                return socket.create_connection(("127.0.0.1", int(port_file.read_text())), timeout=120)
            except (OSError, ValueError):
                time.sleep(0.1)
        self.child.kill()
        raise TimeoutError("Firefox does not listen")

    def close(self):
        self.socket.close()
        self.child.kill()
        self.child.wait()

    def receive(self):
        while b":" not in self.rest:
            self.rest += self.socket.recv(65536)
        length, self.rest = self.rest.split(b":", 1)
        while len(self.rest) < int(length):
            self.rest += self.socket.recv(1 << 20)
        message, self.rest = self.rest[:int(length)], self.rest[int(length):]
        return json.loads(message)

    def ask(self, command, **parameters):
        self.number += 1
        text = json.dumps([0, self.number, command, parameters]).encode()
        self.socket.sendall(str(len(text)).encode() + b":" + text)
        _, number, error, result = self.receive()
        assert number == self.number
        if error:
            raise RuntimeError(f"{command}: {error['message']}")
        return result.get("value", result) if isinstance(result, dict) else result

    def open(self, address):
        self.ask("WebDriver:Navigate", url="about:blank")
        self.ask("WebDriver:Navigate", url=address)

    def value(self, expression):
        script = f"const {{pcorReport}} = window; return JSON.stringify({expression});"
        found = self.ask("WebDriver:ExecuteScript", script=script, args=[])
        return None if found is None else json.loads(found)

    def drag(self, x, y, to_x, to_y):
        move = {"type": "pointerMove", "duration": 0, "origin": "viewport"}
        actions = [{**move, "x": round(x), "y": round(y)}, {"type": "pointerDown", "button": 0},
                   {**move, "x": round((x + to_x) / 2), "y": round((y + to_y) / 2)},
                   {**move, "x": round(to_x), "y": round(to_y)}, {"type": "pointerUp", "button": 0}]
        self.ask("WebDriver:PerformActions", actions=[
            {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}])

    def screenshot(self):
        return base64.b64decode(self.ask("WebDriver:TakeScreenshot", full=True))
