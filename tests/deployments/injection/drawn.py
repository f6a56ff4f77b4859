"""Random monitors of the pool on a recording that is good for a while, then bad topic by topic."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

import yaml

from eddi_scaffold.config.schema import Reaction
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import Member
from tests.data_files import write_files
from tests.deployments.cases import data_message
from tests.deployments.drawing import Wiring, _value
from tests.deployments.pool.networks import USUAL
from tests.deployments.pool.templates import OUT, SOURCE_TYPES, dump, with_topics
from tests.deployments.world import MS

FAULTS = ["drop", "nan", "delay", "delay 0.4 s", "duplicate", "freeze"]
GOOD_MS, BAD_MS = 9000, 2500


def drawn(rng: Random, folder: Path) -> tuple[list[Member], Recording]:
    wiring = Wiring(rng)
    for _ in range(rng.choice((1, 2, 3, 4))):
        template = wiring.choose()
        if template not in [one.template for one in wiring.instances]:
            wiring.add(template)
    configs = []
    for instance in wiring.instances:
        files = dict(with_topics(instance.template, {**instance.topics, OUT: instance.out}))
        name = f"{instance.template.name}_config.yml"
        config = yaml.load(files[name], yaml.CSafeLoader)
        config["Model"]["frequency"] *= rng.choice((1, 1, 2, 2.5, 5))
        write_files(folder, {**files, name: dump(config)})
        configs.append(folder / name)
    monitors, _ = monitors_of(None, configs)
    rng.shuffle(monitors)
    members = [Member(monitor) for monitor in monitors]
    target = rng.randrange(len(members))
    claim = rng.choice(members[target].monitor.facts.claims).id
    config = members[target].monitor.config
    if claim:
        reaction = Reaction(guarantee=claim, ftti=1.0, reaction=0.5, faults=FAULTS)
        held = config.config.model_copy(update={"Reactions": [reaction]})
        bound = replace(members[target].monitor, config=replace(config, config=held))
        members[target] = Member(bound)
    samples = sorted(_samples(rng, wiring), key=lambda sample: sample.t)
    return members, Recording(0, _end(wiring) * MS, tuple(samples))


def _end(wiring: Wiring) -> int:
    return GOOD_MS + 2 * BAD_MS * len(wiring.offers)


def _samples(rng: Random, wiring: Wiring) -> Iterator[Sample]:
    for number, (topic, offer) in enumerate(wiring.offers.items()):
        good, period = wiring.slots[topic].good, rng.choice((100, 150, 250, 400))
        begin = GOOD_MS + 2 * number * BAD_MS
        lasting = rng.random() < 0.5
        bad = _value(rng, offer, good, 0)
        for k, t in enumerate(range(rng.randrange(0, 100), _end(wiring), period)):
            value = [USUAL[k % 5]] if offer == "array" else good
            if begin <= t < begin + BAD_MS:
                value = bad if lasting else _value(rng, offer, good, k)
            yield Sample(t * MS, topic, data_message(f"std_msgs/{SOURCE_TYPES[offer]}", value))
