# SPDX-License-Identifier: BSD-3-Clause
"""Machines on one network, played by network namespaces that a virtual switch joins; packets between them can be lost (nftables).

Call in_own_network() first: it starts the script again inside a namespace in which it may do all this, without being root outside.
"""
import json
import os
import subprocess
import sys
import time

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
    """One machine: a namespace that a sleeping process holds open."""

    count = 0

    def __init__(self, name):
        Host.count += 1
        self.name, self.number, self.children = name, Host.count, []
        self.holder = subprocess.Popen(["unshare", "-n", "sleep", "1000"])
        inner = f"v{self.number}"
        own = os.readlink("/proc/self/ns/net")
        while os.readlink(f"/proc/{self.holder.pid}/ns/net") == own:
            time.sleep(0.01)
        # Large frames: a message is one packet, so that lost packets are lost messages.
        sh(f"ip link add {inner} mtu 65000 type veth peer name p{self.number} mtu 65000")
        sh(f"ip link set {inner} netns {self.holder.pid}")
        sh(f"ip link set p{self.number} master switch up")
        for words in (f"add chain bridge lossy p{self.number}", f"add rule bridge lossy switch iifname p{self.number} jump p{self.number}"):
            subprocess.run(["nft", words], check=True)
        for words in (f"ip addr add 10.9.0.{self.number}/24 dev {inner}", f"ip link set {inner} up", "ip link set lo up",
                      f"ip route add 224.0.0.0/4 dev {inner}"):
            self.sh(words)

    def inside(self, words):
        return ["nsenter", "-t", str(self.holder.pid), "-n", *map(str, words)]

    def sh(self, words):
        return sh(" ".join(self.inside(words.split())))

    def start(self, words, log, env):
        child = subprocess.Popen(self.inside(words), stdout=open(log, "w"), stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                 env={**os.environ, **env})
        self.children.append(child)
        return child

    def lose(self, percent):
        """So much of what this host sends on the bus gets lost in the switch from now on; dropped() counts all."""
        self.dropped_before = self.dropped()
        sh(f"nft flush chain bridge lossy p{self.number}")
        some = "" if percent >= 100 else f"numgen random mod 1000 < {10 * percent} "
        subprocess.run(["nft", f'add rule bridge lossy p{self.number} ip daddr 239.0.0.0/8 {some}counter packets {self.dropped_before} bytes 0 drop'], check=True)

    def dropped(self):
        rules = json.loads(sh(f"nft -j list chain bridge lossy p{self.number}"))["nftables"]
        return sum(part["counter"]["packets"] for rule in rules for part in rule.get("rule", {}).get("expr", []) if "counter" in part)

    def disorder(self):
        """Delays, doubles and reorders what it sends. @return False where the kernel cannot."""
        done = subprocess.run(self.inside(f"tc qdisc add dev v{self.number} root netem delay 5ms 3ms duplicate 1% reorder 10%".split()),
                              capture_output=True, check=False)
        return done.returncode == 0

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

    def __init__(self, *names):
        sh("ip link set lo up")
        sh("ip link add switch mtu 65000 type bridge mcast_snooping 0")
        sh("ip link set switch up")
        sh("nft add table bridge lossy")
        subprocess.run(["nft", "add chain bridge lossy switch { type filter hook prerouting priority -300; }"], check=True)
        self.hosts = [Host(name) for name in names]

    def __enter__(self):
        return self.hosts

    def __exit__(self, *_):
        for host in self.hosts:
            host.stop()
        sh("nft delete table bridge lossy")
        sh("ip link del switch")
