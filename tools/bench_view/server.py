"""A running `bidir view`, and its clients."""

import base64
import json
import os
import re
import selectors
import signal
import socket
import subprocess
import threading
import time
import urllib.request

import harness

# The longest wait. Unit: seconds.
PATIENCE = 60.0
# The interval between checks for the end of a pass. Unit: seconds.
GAP = 0.005
# The first part of a render, which sends frames more often. Unit: seconds.
YOUTH = 4.0


class View:
    """A server for the duration of the block."""

    def __init__(self, program, scene, size):
        command = [program, "view", scene, "--size", size, "--port", "0", "-q"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        if not self.url.startswith("http://"):
            self.process.kill()
            raise harness.Failed("`%s` printed no URL" % " ".join(command))
        self.address = re.match(r"http://([^/:]+):(\d+)/", self.url).groups()
        self.first_memory = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(PATIENCE)

    def lane(self):
        """Returns the numbers of the render, and the samples of a pass."""
        with urllib.request.urlopen(self.url + "status", timeout=PATIENCE) as answer:
            status = json.load(answer)
        left, top, right, bottom = status["film"]["crop"]
        return status["lanes"][0]["passes"], (right - left) * (bottom - top)

    def settle(self):
        """Waits until the render is in its steady state."""
        time.sleep(YOUTH)
        self.pass_end()
        self.first_memory = self.status_memory("VmRSS")

    def pass_end(self):
        """Waits for the end of a pass. Returns its time, its number, and the samples of a pass."""
        before, _ = self.lane()
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            passes, samples = self.lane()
            if passes > before:
                return time.monotonic(), passes, samples
            time.sleep(GAP)
        raise harness.Failed("the render makes no passes")

    def rate(self, seconds):
        """Returns samples per second, and processor seconds per sample, of whole passes in about this
        many seconds."""
        begin, first, samples = self.pass_end()
        used = harness.processor_time(self.process.pid)
        time.sleep(seconds)
        end, last, _ = self.pass_end()
        count = (last - first) * samples
        return count / (end - begin), (harness.processor_time(self.process.pid) - used) / count

    def status_memory(self, name):
        with open("/proc/%d/status" % self.process.pid, encoding="ascii") as file:
            return 1024 * int(re.search(name + r":\s+(\d+) kB", file.read())[1])

    def memory(self):
        """Returns the first, current and largest memory. Unit: bytes."""
        return self.first_memory, self.status_memory("VmRSS"), self.status_memory("VmHWM")


def connected(address):
    """Opens a WebSocket."""
    host, port = address
    peer = socket.create_connection((host, int(port)), PATIENCE)
    key = base64.b64encode(os.urandom(16)).decode()
    head = ("GET /live HTTP/1.1\r\nHost: %s:%s\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: %s\r\n\r\n" % (host, port, key))
    peer.sendall(head.encode())
    answer = b""
    while not answer.endswith(b"\r\n\r\n"):
        byte = peer.recv(1)
        if not byte:
            raise harness.Failed("the server has closed a connection")
        answer += byte
    if b" 101 " not in answer.split(b"\r\n")[0]:
        raise harness.Failed("no WebSocket: %r" % answer)
    return peer


class Clients:
    """Clients for the duration of the block; the last one never reads."""

    def __init__(self, view, count):
        self.peers = [connected(view.address) for _ in range(count)]
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.read)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        for peer in self.peers:
            peer.close()

    def read(self):
        """Receives all that the server sends to all clients but the last."""
        room = bytearray(1 << 20)
        with selectors.DefaultSelector() as selector:
            for peer in self.peers[:-1]:
                selector.register(peer, selectors.EVENT_READ)
            while not self.ended.is_set():
                for key, _ in selector.select(0.1):
                    if not key.fileobj.recv_into(room):
                        selector.unregister(key.fileobj)
