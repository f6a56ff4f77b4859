"""How long claims outlive silence, and what rests on what is accepted."""

from pathlib import Path

from eddi_scaffold.deployments.lifetimes import bounds
from eddi_scaffold.deployments.support import WiredMonitor, acceptances
from eddi_scaffold.deployments.wiring import members_of
from eddi_scaffold.packages.assembly import monitors_of
from tests.deployments.wiring.test_wiring import CONFIG, CONSERT

LINK = "  - {{id: b, type: eddi_messages.ConSertOutput, topic: {}/out}}"
SENSOR = "  - {id: s, type: std_msgs.Bool, topic: /fine}"
READ = "requires: [b], field: 'guarantees[G].active'"


def chain(folder: Path, *ages: str, frequency: float = 2.0) -> list[WiredMonitor]:
    """Make monitors m0, m1, ... each of which reads the one before it; ages of their inputs."""
    configs = []
    for k, age in enumerate(ages):
        (folder / f"m{k}.yml").write_text(CONSERT.format(), "utf-8")
        sources, input_ = (LINK.format(f"m{k - 1}"), READ) if k else (SENSOR, "requires: [s]")
        text = CONFIG.format(id=f"m{k}", sources=sources, input=input_, topic=f"m{k}/out")
        text = text.replace("max_age: 0.5", f"max_age: {age}")
        text = text.replace("type: ConSert,", f"type: ConSert, frequency: {frequency},")
        configs.append(folder / f"m{k}_config.yml")
        configs[-1].write_text(text, "utf-8")
    return members_of(monitors_of(None, configs)[0])


def test_a_chain_adds_a_period_for_each_monitor(tmp_path: Path) -> None:
    found = bounds(chain(tmp_path, "0.7", "1.2", "1.2"))
    # 0.7 + 3 * 0.5 while all live; whatever dies, every age counts
    assert [(one.claim, round(one.seconds, 9), round(one.any_seconds, 9)) for one in found] == [
        ("m0.G", 1.2, 1.2),
        ("m1.G", 1.7, 2.9),
        ("m2.G", 2.2, 4.6),
    ]
    assert {one.source for one in found} == {"/fine"}
    assert found[2].as_text() == "m2.G goes away at most 2.2 s after /fine fell silent"


def test_without_a_limit_there_is_no_bound(tmp_path: Path) -> None:
    first, second = bounds(chain(tmp_path, "none", "1.2"))
    assert first.as_text() == "m0.G may outlive /fine for ever"
    assert second.as_json() == {
        "claim": "m1.G", "source": "/fine", "bound_s": None, "bound_any_s": None,
    }  # fmt: skip


def test_what_is_accepted_on_a_link_is_not_what_is_accepted_of_a_sensor(tmp_path: Path) -> None:
    (one,) = acceptances(chain(tmp_path, "0.7", "none", "1.2"))
    assert (one.monitor, one.topics, one.claims) == ("m1", ("/m0/out",), ("m1.G", "m2.G"))
    assert one.as_text() == (
        "input 'E' of m1, `max_age: none`: m1.G, m2.G rest on the last value of /m0/out for ever"
    )
    assert one.as_json() == {
        "monitor": "m1", "input": "E", "key": "max_age: none", "accepts": "the last value",
        "topics": ["/m0/out"], "claims": ["m1.G", "m2.G"], "seconds": None,
    }  # fmt: skip
