"""Two robots of one fleet: on one ROS 1 master, or in two network namespaces with DDS."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from eddi_scaffold.kinds.consert import BETWEEN_ROBOTS, MESSAGES
from tests.cli.command import run
from tests.contract.stages import Stage, environment, free_domain
from tests.data_files import data_text
from tests.package_texts import facts_in
from tests.ros1.world import PROBES, PYTHON, make_messages

HERE = Path(__file__).parent
ARM = data_text("fleet/arm_config.yml")
CART = data_text("fleet/cart_config.yml")
BOOL = "std_msgs/Bool"


class Robots(Stage):
    """Both packages, and how their nodes are started."""

    place = ()

    def begin(self):
        """Generate both, and begin to hear."""
        arm = self._generated("arm", ARM)
        digest = facts_in(arm).digest
        self.packages = {
            "arm": arm,
            "cart": self._generated("cart", CART.replace("DIGEST", digest)),
        }
        self.ear, self.source = self.new_probe("cart"), self.new_probe("cart")
        self.brake = self.new_probe("arm")
        self.ear.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        self.ear.subscribe("/cart/guarantees")
        self.feed(self.source, "/cart/in/healthy", BOOL, True, connected=False)

    def _generated(self, name, config):
        path = self.folder / f"{name}_config.yml"
        path.write_text(config, "utf-8")
        done = run("generate", *self.place, "-m", HERE / f"{name}.yml", "-c", path, cwd=self.folder)
        assert done.status == 0, done.err
        return self._package(name)

    def braked(self, value=True, robot="arm1"):
        """Have the sensor of an arm publish."""
        self.feed(self.brake, f"/{robot}/in/brake", BOOL, value, connected=False)

    def silent(self, robot="arm1"):
        """Have the sensor of an arm publish no more."""
        self.brake.do("stop", topic=f"/{robot}/in/brake")

    def entered(self, *, yes, timeout=15.0):
        """Wait until the cart may enter, or may not."""
        self.until(*(["Enter"] if yes else []), name="/cart", timeout=timeout)

    def why(self, words):
        """Wait until the diagnostics of the cart say why."""
        return self.told(words, "/cart/cart", timeout=15.0)


class Ros1Robots(Robots):
    """Two namespaces on one master."""

    def __init__(self, folder):
        super().__init__(folder, make_messages(folder / "messages", {**MESSAGES, **BETWEEN_ROBOTS}))
        (folder / "src").mkdir()
        self.place = ("-w", folder)
        self.core = self.master()

    def _package(self, name):
        return self.folder / "src" / "eddi_monitor" / name

    def new_probe(self, _robot="cart"):
        return self.probe(self.core)

    def start(self, model, robot):
        """Start the node of a robot."""
        package = self.packages[model]
        env = self.env(self.core)
        env["PYTHONPATH"] = f"{package / 'src'}:{env['PYTHONPATH']}"
        words = [f"__ns:=/{robot}", f"_robot:={robot}"]
        return self.process([PYTHON, str(package / "scripts/RosNode.py"), *words], env)


class DdsRobots(Robots):
    """A network namespace for each robot, and a cable between them that can be cut."""

    def __init__(self, folder):
        super().__init__(folder, None)
        self.place = ("--platform", "dds", "-o", folder)
        self.lock, self.domain = free_domain()
        self.spaces = {"arm": f"eddi-{os.getpid()}-a", "cart": f"eddi-{os.getpid()}-c"}
        self._links = {"arm": f"ed{os.getpid()}a", "cart": f"ed{os.getpid()}c"}
        for space in self.spaces.values():
            ip("netns", "add", space)
        a, c = self._links["arm"], self._links["cart"]
        ip("link", "add", a, "type", "veth", "peer", "name", c)
        for k, (robot, space) in enumerate(self.spaces.items(), 1):
            ip("link", "set", self._links[robot], "netns", space)
            ip("-n", space, "addr", "add", f"10.213.7.{k}/24", "dev", self._links[robot])
            ip("-n", space, "link", "set", self._links[robot], "up", "multicast", "on")
            ip("-n", space, "link", "set", "lo", "up")

    def _package(self, name):
        return self.folder / name

    def _env(self, robot):
        (self.folder / f"{robot}.xml").write_text(
            "<CycloneDDS><Domain><General><Interfaces>"
            f'<NetworkInterface name="{self._links[robot]}"/></Interfaces></General>'
            "<Discovery><LeaseDuration>3s</LeaseDuration><SPDPInterval>1s</SPDPInterval>"
            "</Discovery></Domain></CycloneDDS>",
            "utf-8",
        )
        uri = (self.folder / f"{robot}.xml").as_uri()
        return {**environment(self.domain, self.folder), "CYCLONEDDS_URI": uri}

    def _inside(self, robot, *command):
        return ["ip", "netns", "exec", self.spaces[robot], *map(str, command)]

    def new_probe(self, robot="cart"):
        program = self._inside(robot, sys.executable, PROBES / "dds.py")
        return self.probe_of(program, self._env(robot))

    def start(self, model, robot):
        """Start the node of a robot."""
        words = ["--ros-args", "-r", f"__ns:=/{robot}", "-p", f"robot:={robot}"]
        command = self._inside(model, sys.executable, "-m", model, *words)
        return self.process(command, self._env(model))

    def cut(self):
        """Let nothing pass between the robots."""
        rules = (
            "table inet cut {\n chain inbound {\n type filter hook input priority 0; policy drop;\n"
            ' iifname "lo" accept\n }\n}\n'
        )
        command = self._inside("cart", "nft", "-f", "-")
        subprocess.run(command, input=rules, text=True, check=True)

    def join(self):
        """Let everything pass again."""
        subprocess.run(self._inside("cart", "nft", "delete", "table", "inet", "cut"), check=True)

    def destroy(self):
        super().destroy()
        for space in self.spaces.values():
            ip("netns", "delete", space)
        self.lock.close()


def ip(*words):
    """Change the network."""
    subprocess.run(["ip", *words], check=True, capture_output=True)


def why_no_namespaces():
    """Return why there can be no network of our own, ``None`` when there can."""
    for tool in ("ip", "nft"):
        if shutil.which(tool) is None:
            return f"{tool} is missing: apt-get install iproute2 nftables"
    name = f"eddi-{os.getpid()}-try"
    made = subprocess.run(["ip", "netns", "add", name], check=False, capture_output=True, text=True)
    if made.returncode:
        return f"no network namespace can be made here: {made.stderr.strip()}"
    rule = ["ip", "netns", "exec", name, "nft", "add", "table", "inet", "try"]
    tried = subprocess.run(rule, check=False, capture_output=True, text=True)
    ip("netns", "delete", name)
    return f"nftables do not work here: {tried.stderr.strip()}" if tried.returncode else None
