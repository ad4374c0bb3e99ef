"""A stress test of the server: `bidir view --bind` with many clients of all kinds, for a number of seconds.

Some watch, some read slowly or not at all, some leave in the middle, some send what is no request or name
no token, some give commands. Meanwhile the status has to answer; at the end the server does so at once,
its memory has not grown, and it ends by a signal.
"""

import base64
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import threading
import time
import urllib.request

import part
import runs
from worlds import ROOM

LIMITS = runs.Limits(cpu=1e6, wall=1e6, memory=2 * runs.GIB)
# Clients at once.
CLIENTS = 48
# The longest response time of the status under load, on a busy machine. Unit: seconds.
ANSWER = 20
# The allowed growth of the server's memory after warming up. Unit: bytes.
GROWTH = 64 << 20
# Silent connections, and the longest wait of a client beside them. Unit: seconds.
IDLE = 256
CROWDED = 10
GARBAGE = (b"\0" * 64, b"GET", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
           b"\r\n" * 999,
           b"POST /status HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n", b"GET /" + b"a" * 70000,
           b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 5000 + b"\r\n",
           b"GET /../../etc/passwd HTTP/1.1\r\nHost: a\r\n\r\n", b"GET /%ff%00 HTTP/1.1\r\nHost: a\r\n\r\n")
PAGES = ("", "status", "log", "render.png", "render.exr", "strategies", "strategies.png?kind=raw&s=1&t=2", "pixel?x=3&y=2",
         "sample?x=3&y=2",
         "pixel?x=-1&y=1e9", "sample?x=99999999999&y=", "assets/app.js", "assets/../x", "live", "none")
COMMANDS = ({"command": "pause"}, {"command": "resume"}, {"command": "restart"}, {"command": "home"},
            {"command": "orbit", "yaw": 0.1, "pitch": 0.05}, {"command": "dolly", "factor": 1.1},
            {"command": "orbit", "yaw": 1e38, "pitch": -1e38}, {"command": "dolly", "factor": 0},
            {"command": "pan", "right": 1e30, "up": 0}, {"command": "walk", "forward": 0.1},
            {"command": "method", "lane": "a", "integrator": "bdpt", "shadowRays": "auto"},
            {"command": "method", "lane": "z", "integrator": "", "shadowRays": "\u0000"},
            {"command": "split", "on": True}, {"command": "split", "on": False},
            {"command": "strategies", "lane": "a", "vertices": 4},
            {"command": "strategies", "lane": "a", "vertices": 2 ** 53},
            {"command": "save", "name": "../../x.exr"}, {"command": "none"}, [], "", 1e999)


class Server:
    def __init__(self, work, folder):
        part.write(folder, "room.pbrt", ROOM)
        self.command = work.bidir("view", "room.pbrt", "--bind", "0.0.0.0", "--port", 0, "-q", "--threads", 1,
                                  "--size", "96x64")
        self.said = open(os.path.join(folder, ".said"), "wb")
        self.process = subprocess.Popen(self.command, cwd=folder, stdout=subprocess.PIPE, stderr=self.said,
                                        stdin=subprocess.DEVNULL, text=True, env=runs.environment())
        line = self.process.stdout.readline()
        found = re.search(r"http://[^/]*:(\d+)(/\S*)", line)
        if not found:
            raise RuntimeError("%s prints no URL: %r" % (" ".join(self.command), line))
        self.port, self.path = int(found[1]), found[2]

    def target(self, page):
        """The path of a page, with the token that the URL has."""
        path, _, token = self.path.partition("?")
        page, _, query = page.partition("?")
        queries = "&".join(filter(None, (query, token)))
        return path + page + ("?" + queries if queries else "")

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), ANSWER)

    def status(self):
        """Returns the response time of the status in seconds. Raises OSError if there is no response."""
        begin = time.monotonic()
        url = "http://127.0.0.1:%d%s" % (self.port, self.target("status"))
        with urllib.request.urlopen(url, timeout=ANSWER) as answer:
            json.load(answer)
        return time.monotonic() - begin

    def memory(self):
        """Unit: bytes."""
        with open("/proc/%d/status" % self.process.pid, encoding="ascii") as file:
            return 1024 * int(re.search(r"VmRSS:\s+(\d+) kB", file.read())[1])


def request(server, page, method="GET"):
    head = "%s %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n" % (method, server.target(page), server.port)
    return head.encode()


def upgraded(server):
    """A WebSocket."""
    peer = server.connect()
    key = base64.b64encode(os.urandom(16))
    peer.sendall(request(server, "live") + b"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                 b"Sec-WebSocket-Key: " + key + b"\r\n\r\n")
    peer.recv(4096)
    return peer


def frame(payload, kind=1):
    """A message of a client, whose mask is zero."""
    length = len(payload)
    size = bytes([128 | length]) if length < 126 else bytes([254]) + struct.pack(">H", length)
    return bytes([128 | kind]) + size + bytes(4) + payload


def watches(server, chance):
    with upgraded(server) as peer:
        for _ in range(chance.randint(1, 40)):
            peer.recv(1 << 16)


def reads_nothing(server, chance):
    with upgraded(server):
        time.sleep(chance.uniform(0.5, 4))


def says_nothing(server, chance):
    with server.connect():
        time.sleep(chance.uniform(0.5, 4))


def writes_slowly(server, chance):
    with server.connect() as peer:
        for byte in request(server, "status")[:chance.randint(2, 20)]:
            peer.sendall(bytes([byte]))
            time.sleep(0.1)


def leaves(server, chance):
    """Resets the connection while the answer comes."""
    with server.connect() as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        peer.sendall(request(server, chance.choice(PAGES)) + b"\r\n")
        if chance.random() < 0.5:
            peer.recv(chance.randint(1, 4096))


def asks(server, chance):
    with server.connect() as peer:
        method = chance.choice(("GET", "GET", "GET", "POST", "HEAD", "DELETE", "\u00e9"))
        peer.sendall(request(server, chance.choice(PAGES), method) + b"Connection: close\r\n\r\n")
        while peer.recv(1 << 16):
            pass


def sends_garbage(server, chance):
    with server.connect() as peer:
        peer.sendall(chance.choice((*GARBAGE, chance.randbytes(chance.randint(1, 9999)))))
        peer.settimeout(2)
        peer.recv(4096)


def guesses(server, chance):
    with server.connect() as peer:
        peer.sendall(b"GET /status?token=%d HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n" % chance.getrandbits(64))
        peer.recv(4096)


def commands(server, chance):
    with upgraded(server) as peer:
        for _ in range(chance.randint(1, 8)):
            payload = json.dumps(chance.choice(COMMANDS)).encode()
            kind = chance.choice((1, 1, 1, 1, 2, 9, 15))
            peer.sendall(frame(payload, kind))
            peer.recv(1 << 16)
        if chance.random() < 0.2:
            peer.sendall(chance.randbytes(chance.randint(1, 200)))


KINDS = (watches, reads_nothing, says_nothing, writes_slowly, leaves, asks, asks, sends_garbage, guesses, commands)


class Clients:
    """Threads that play one client after the other until the end."""

    def __init__(self, server, seed):
        self.server, self.count = server, 0
        self.ended = threading.Event()
        self.threads = [threading.Thread(target=self.play, args=(random.Random("%d %d" % (seed, i)),), daemon=True)
                        for i in range(CLIENTS)]

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        for thread in self.threads:
            thread.join(2 * ANSWER)

    def play(self, chance):
        while not self.ended.is_set():
            try:
                chance.choice(KINDS)(self.server, chance)
            except OSError:
                # The server may refuse, and end conversations.
                time.sleep(0.05)
            self.count += 1


def besiege(work, server, seconds, folder):
    """The clients, and the checks of the server meanwhile."""
    end = time.monotonic() + seconds
    warm, first, most = time.monotonic() + 0.3 * seconds, None, 0
    with Clients(server, work.options.seed) as clients:
        while time.monotonic() < end and server.process.poll() is None:
            try:
                fault = None
                server.status()
            except (OSError, ValueError) as error:
                fault = "the status does not answer: %s" % error
            work.case("under siege", fault, folder, server.command)
            if server.process.poll() is None and time.monotonic() > warm:
                first = first or server.memory()
                most = max(most, server.memory())
            time.sleep(min(1.0, seconds / 10))
    work.cases += clients.count
    return first, most


def crowded(server):
    """Returns the reason why a client cannot connect beside many silent ones. None: it can."""
    idle = []
    try:
        idle += [server.connect() for _ in range(IDLE)]
        seconds = server.status()
        return "the status takes %.1f s" % seconds if seconds > CROWDED else None
    except (OSError, ValueError) as error:
        return "the status does not answer: %s" % error
    finally:
        for peer in idle:
            peer.close()


def finish(work, server, folder, memory):
    """The checks at the end."""
    def check(title, fault):
        work.case(title, fault, folder, server.command)

    if server.process.poll() is not None:
        return check("the end", "the server has ended with %d" % server.process.returncode)
    try:
        seconds = server.status()
        check("the end", "the status takes %.1f s" % seconds if seconds > CROWDED else None)
    except (OSError, ValueError) as error:
        check("the end", "the status does not answer: %s" % error)
    check("beside %d idle connections" % IDLE, crowded(server))
    first, most = memory
    if first:
        grown = most - first
        check("memory", "grows by %d MiB" % (grown >> 20) if grown > GROWTH else None)
    server.process.send_signal(signal.SIGTERM)
    try:
        code = server.process.wait(30)
        check("a signal", None if code in (0, 130, 143) else "the server ends with %d" % code)
    except subprocess.TimeoutExpired:
        check("a signal", "the server does not end")
    check("messages", "panics" if "panicked" in runs.said(folder) else None)


def run(work):
    if not os.path.exists("/proc/self/status"):
        work.skipped = "the memory of the server is read from /proc"
        return
    with work.folder() as folder:
        server = Server(work, folder)
        try:
            memory = besiege(work, server, work.count(), folder)
            finish(work, server, folder, memory)
        finally:
            server.process.kill()
            server.process.wait()
            server.said.close()
