#!/usr/bin/env python3
"""What looking costs:  tools/viewer_load.py TACTUM [PAGES [SECONDS [SCENE]]]

Starts the program, lets PAGES pages without a browser look and acknowledge, and tells the share of a core that the
server's thread, the thread that feeds it and the haptic loop took. Without a SCENE it is one of twenty bodies.
"""
import base64
import os
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse

TICKS = os.sysconf("SC_CLK_TCK")


def twenty_bodies():
    """A block in the hand over eighteen more on a plate."""
    text = 'schema = 1\ndescription = "twenty bodies"\n[[body]]\nname = "plate"\npart = { box = { size_m = [0.3, 0.3, 0.01] } }\n'
    text += 'pos_m = [0, 0, -0.005]\njoint = { kind = "fixed" }\n'
    for i in range(19):
        x, y = 0.05 * (i % 5) - 0.1, 0.05 * (i // 5) - 0.08
        text += f'[[body]]\nname = "block {i}"\npart = {{ gear = {{ teeth = 18, module_m = 0.002, face_width_m = 0.01 }} }}\n'
        text += f'pos_m = [{x}, {y}, 0.012]\n'
        if i > 0:
            text += 'joint = { kind = "hinge", axis = [0, 0, 1] }\n'
    text += '[tool]\nbody = "block 0"\n[[hand.step]]\noffset_m = [0, 0, -0.008]\nduration_s = 2.0\n'
    text += '[[hand.step]]\noffset_m = [0.02, 0.01, 0]\nduration_s = 2.0\n'
    return text


class Page(threading.Thread):
    """A WebSocket that takes frames in and acknowledges them."""

    def __init__(self, address):
        super().__init__(daemon=True)
        url = urllib.parse.urlparse(address)
        self.socket = socket.create_connection((url.hostname, url.port))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {url.path}ws HTTP/1.1\r\nHost: {url.netloc}\r\nOrigin: http://{url.netloc}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n").encode())
        self.stream = self.socket.makefile("rb")
        while self.stream.readline().strip():
            pass
        self.frames = self.samples = self.bytes = 0

    def say(self, text):
        self.socket.sendall(bytes([0x81, 0x80 | len(text)]) + bytes(4) + text.encode())

    def run(self):
        try:
            while True:
                kind, length = self.stream.read(2)
                if length == 126:
                    length = struct.unpack(">H", self.stream.read(2))[0]
                elif length == 127:
                    length = struct.unpack(">Q", self.stream.read(8))[0]
                payload = self.stream.read(length)
                self.bytes += length
                if kind & 15 == 2:
                    words = struct.unpack("<8I", payload[:32])
                    self.frames += 1
                    self.samples += words[3]
                    self.say('{"do":"ack","seq":%d}' % words[1])
        except (OSError, TypeError, ValueError, struct.error):
            pass


def cpu_times(pid):
    """Seconds of every thread, by its number, with its name."""
    times = {}
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        name, fields = re.fullmatch(r"\d+ \((.*)\) (.*)", (task / "stat").read_text().strip()).groups()
        fields = fields.split()
        times[int(task.name)] = (name, (int(fields[11]) + int(fields[12])) / TICKS)
    return times


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    pages = int(arguments[1]) if len(arguments) > 1 else 1
    seconds = float(arguments[2]) if len(arguments) > 2 else 10.0
    with tempfile.TemporaryDirectory() as folder:
        scene = arguments[3] if len(arguments) > 3 else f"{folder}/twenty.toml"
        if len(arguments) <= 3:
            pathlib.Path(scene).write_text(twenty_bodies())
        program = subprocess.Popen([arguments[0], "feel", scene, "--view"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                   env={**os.environ, "DISPLAY": "", "WAYLAND_DISPLAY": ""})
        address = next(found.group() for found in (re.search(r"http://\S+", line) for line in program.stdout) if found)
        looking = [Page(address) for _ in range(pages)]
        for page in looking:
            page.start()
        time.sleep(2.0)
        before, frames, samples, size = cpu_times(program.pid), *(sum(getattr(p, k) for p in looking) for k in ("frames", "samples", "bytes"))
        start = time.monotonic()
        time.sleep(seconds)
        after, elapsed = cpu_times(program.pid), time.monotonic() - start
        for task, (name, used) in sorted(after.items()):
            role = "server" if name == "tactum-viewer" else "feeds the server" if task == program.pid else "haptic loop"
            print(f"{role:<18}{100 * (used - before.get(task, (name, 0.0))[1]) / elapsed:6.2f} % of a core")
        if pages:
            now = [sum(getattr(p, k) for p in looking) for k in ("frames", "samples", "bytes")]
            rate = [(b - a) / elapsed / pages for a, b in zip((frames, samples, size), now)]
            print(f"each of {pages} pages: {rate[0]:.1f} messages/s, {rate[1]:.0f} samples/s, {rate[2] / 1000:.0f} kB/s")
        program.terminate()
        program.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
