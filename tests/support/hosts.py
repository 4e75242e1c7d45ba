# SPDX-License-Identifier: BSD-3-Clause
"""Machines on one network, played by network namespaces that a switch in this process joins (wires.py).

Call in_own_network() first: it starts the script again inside a namespace in which it may do all this, without being root outside.
"""
import os
import subprocess
import sys
import time

import wires
from system import Skip


def in_own_network():
    """Goes on inside a namespace of its own, or returns False where the kernel does not allow that."""
    if os.environ.get("MODSLAM_OWN_NETWORK"):
        return True
    probe = subprocess.run(["unshare", "-rnm", "true"], capture_output=True, check=False)
    if probe.returncode != 0:
        return False
    os.environ["MODSLAM_OWN_NETWORK"] = "yes"
    os.execvp("unshare", ["unshare", "-rnm", sys.executable, *sys.argv])


def sh(words):
    done = subprocess.run(words.split(), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Skip(f"'{words}' said: {done.stderr.strip()}")
    return done.stdout


class Host:
    """One machine: a namespace that a sleeping process holds open, and a wire to the switch."""

    count = 0

    def __init__(self, name, switch, seed):
        Host.count += 1
        self.name, self.number, self.children = name, Host.count, []
        self.holder = subprocess.Popen(["unshare", "-n", "sleep", "600"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        inner, outer = f"v{self.number}", f"p{self.number}"
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == own:
            time.sleep(0.01)
        # Large frames: a message is one packet, so that lost packets are lost messages.
        sh(f"ip link add {inner} mtu 65000 type veth peer name {outer} mtu 65000")
        sh(f"ip link set {inner} netns {self.holder.pid}")
        sh(f"ip link set {outer} up")
        for words in (f"ip addr add 10.9.0.{self.number}/24 dev {inner}", f"ip link set {inner} up", "ip link set lo up",
                      f"ip route add 224.0.0.0/4 dev {inner}"):
            self.sh(words)
        self.wire = switch.plug(outer, seed + self.number)

    def inside(self, words):
        return ["nsenter", "-t", str(self.holder.pid), "-n", *map(str, words)]

    def sh(self, words):
        return sh(" ".join(self.inside(words.split())))

    def start(self, words, log, env):
        child = subprocess.Popen(self.inside(words), stdout=open(log, "w"), stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                 env={**os.environ, **env})
        self.children.append(child)
        return child

    def unread(self, child):
        """@return datagrams that the machine dropped because this process did not read them in time."""
        own = {os.readlink(f"/proc/{child.pid}/fd/{fd}") for fd in os.listdir(f"/proc/{child.pid}/fd")}
        rows = [line.split() for line in self.sh("cat /proc/net/udp").splitlines()[1:]]
        return sum(int(row[12]) for row in rows if f"socket:[{row[9]}]" in own)

    def stop(self):
        for child in self.children:
            child.terminate()
        for child in self.children:
            try:
                child.wait(10)
            except subprocess.TimeoutExpired:
                child.kill()
        self.holder.kill()
        self.holder.wait()


class Network:
    """Some hosts on a switch; nothing of it survives the with block."""

    def __init__(self, *names, seed=1):
        sh("ip link set lo up")
        self.switch = wires.Switch()
        Host.count = 0
        self.hosts = [Host(name, self.switch, 1000 * seed) for name in names]
        self.switch.start()

    def __enter__(self):
        return self.hosts

    def __exit__(self, *_):
        self.switch.stop()
        for host in self.hosts:
            host.stop()
        for host in self.hosts:
            subprocess.run(["ip", "link", "del", f"p{host.number}"], capture_output=True, check=False)
