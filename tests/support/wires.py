# SPDX-License-Identifier: BSD-3-Clause
"""A switch whose wires lose, delay, double and reorder packets: raw sockets on one end of each wire, and a seeded random number generator.

Does in user space what netem does in kernels that have it, and knows exactly what it did, by LCM channel.
"""
import collections
import heapq
import random
import select
import socket
import struct
import threading
import time

ETH_P_ALL = 3
SOL_PACKET, PACKET_STATISTICS, PACKET_IGNORE_OUTGOING = 263, 6, 23
LARGEST = 66000
AT_ONCE = 50  # packets of one wire before another's turn
IP_AT, UDP = 14, 17
HEAD_OF_STATUS = 120  # bytes of a packet: the heads of Ethernet, IP, UDP and LCM, time and name


class Wire:
    """What one machine sends goes through here. Only packets of the bus (to 239.0.0.0/8) have a bad time."""

    def __init__(self, interface, seed):
        self.interface = interface
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
        self.socket.setsockopt(SOL_PACKET, PACKET_IGNORE_OUTGOING, 1)
        self.socket.bind((interface, 0))
        self.random = random.Random(seed)
        self.loss = self.doubled = self.reordered = self.delay_s = self.jitter_s = 0.0
        self.sent, self.dropped = collections.Counter(), collections.Counter()  # by channel
        self.cut_behind, self.cut = b"", threading.Event()

    def cut_after_word_of(self, process, patience_s=10):
        """Loses everything from behind the next STATUS of that process on, which arrives. @return whether it spoke in time."""
        self.cut.clear()
        self.cut_behind = b"\0" + bytes([len(process) + 1]) + process.encode() + b"\0"  # LCM's string, at the head of a STATUS
        return self.cut.wait(patience_s)

    def overrun(self):
        """@return how many packets the kernel dropped since the last call because this process was too slow."""
        return struct.unpack("=II", self.socket.getsockopt(SOL_PACKET, PACKET_STATISTICS, 8))[1]

    def fate(self, frame):
        """@return after how many seconds the frame arrives, once for each time that it does."""
        if frame[IP_AT + 16] != 239:
            return [0.0]
        name = channel(frame)
        self.sent[name] += 1
        if self.cut_behind and name == "STATUS" and self.cut_behind in frame[:HEAD_OF_STATUS]:
            self.cut_behind, self.loss = b"", 1.0
            self.cut.set()
            return [self.delay_s]
        if self.random.random() < self.loss:
            self.dropped[name] += 1
            return []
        delays = [self.delay_s + self.jitter_s * self.random.uniform(-1, 1)]
        if self.random.random() < self.reordered:
            delays[0] = 0.0  # overtakes those before it
        if self.random.random() < self.doubled:
            delays.append(delays[0] + 0.001)
        return delays


def channel(frame):
    """Of an LCM packet; fragments behind the first count as ''."""
    payload = frame[IP_AT + 4 * (frame[IP_AT] & 15) + 8:]
    if payload[:4] == b"LC02":
        return payload[8:].split(b"\0", 1)[0].decode(errors="replace")
    return ""


def without_checksum(frame):
    """Senders leave the sum to a card that is not there; 0 says that there is none."""
    at = IP_AT + 4 * (frame[IP_AT] & 15)
    return frame[:at + 6] + b"\0\0" + frame[at + 8:]


class Switch:
    """Hands on what comes from each wire to all others, in a thread of its own."""

    def __init__(self):
        self.wires, self.waiting, self.count, self.running = [], [], 0, False
        self.thread = threading.Thread(target=self.work, daemon=True)

    def plug(self, interface, seed):
        self.wires.append(Wire(interface, seed))
        return self.wires[-1]

    def start(self):
        self.running = True
        self.thread.start()

    def stop(self):
        self.running = False
        self.thread.join()
        for wire in self.wires:
            wire.socket.close()

    def work(self):
        sockets = {wire.socket: wire for wire in self.wires}
        while self.running:
            timeout = min(0.2, max(0.0, self.waiting[0][0] - time.monotonic())) if self.waiting else 0.2
            for ready in select.select(list(sockets), [], [], timeout)[0]:
                for _ in range(AT_ONCE):
                    try:
                        self.take(sockets[ready])
                    except BlockingIOError:
                        break
            while self.waiting and self.waiting[0][0] <= time.monotonic():
                _, _, wire, frame = heapq.heappop(self.waiting)
                self.hand_on(wire, frame)

    def take(self, wire):
        frame = wire.socket.recv(LARGEST, socket.MSG_DONTWAIT)
        if len(frame) < 34 or frame[12:14] != b"\x08\x00":
            return
        if frame[IP_AT + 9] == UDP:
            frame = without_checksum(frame)
        for delay_s in wire.fate(frame):
            if delay_s <= 0:
                self.hand_on(wire, frame)
            else:
                self.count += 1  # equal times keep their order
                heapq.heappush(self.waiting, (time.monotonic() + delay_s, self.count, wire, frame))

    def hand_on(self, wire, frame):
        for other in self.wires:
            if other is not wire:
                other.socket.send(frame)
