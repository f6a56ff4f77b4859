"""Words of other robots: what counts was made within its lease, whatever the network does."""

from __future__ import annotations

import heapq
import math
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime import peers
from eddi_runtime.peers import Fleet, Peers, Source

DIGEST = "ab" * 32
PARKED = Source("Parked", (), "arm", DIGEST, "PARKED")
LEASE = 1.0


def message(tree: Any) -> Any:
    if isinstance(tree, list):
        return [message(one) for one in tree]
    if isinstance(tree, tuple):
        return SimpleNamespace(**{field: message(value) for field, value in tree[1].items()})
    return tree


def grants(active: object = True, name: str = "PARKED") -> list[Any]:
    return [(name, active, ())]


def cart(*sources: Source, session: str = "c") -> Peers:
    return Peers(("cart", "cart", session), "cd" * 32, LEASE, sources or (PARKED,))


def arm(robot: str = "arm1", session: str = "a", digest: str = DIGEST) -> Peers:
    return Peers((robot, "arm", session), digest, LEASE, ())


def answered(listener: Peers, speaker: Peers, now: float, words: list[Any] | None = None) -> Any:
    """Have a listener tell a word, and the speaker answer it; return the answer."""
    speaker.hear(message(listener.word([], now)), now)
    answer = message(speaker.word(grants() if words is None else words, now))
    listener.hear(answer, now)
    return answer


def only(listener: Peers, now: float) -> peers.Found:
    (found,) = listener.find(now).values()
    return found


def test_a_word_counts_once_it_is_an_answer_and_until_its_lease_ends():
    listener, speaker = cart(), arm()
    assert "no word of arm on any other robot was heard" in only(listener, 0.0).word.unfit
    assert only(cart(PARKED._replace(robots=("arm1",))), 0.0).word.robot == "arm1"
    listener.hear(message(speaker.word(grants(), 0.0)), 0.0)
    assert only(listener, 0.0).word.unfit == "arm1 is heard, but has not answered this robot yet"
    answered(listener, speaker, 10.0)
    found = only(listener, 11.0)
    assert (found.word.robot, found.word.unfit) == ("arm1", "")
    assert found.receipt is not None
    assert found.receipt.age_at(11.0) == 1.0
    late = only(listener, 11.25)
    assert late.word.unfit == "the word of arm1 may be 1.25 s old, its lease is 1 s"
    assert late.receipt is not None


def test_the_shorter_lease_of_the_two_counts():
    listener = cart()
    speaker = Peers(("arm1", "arm", "a"), DIGEST, 0.25, ())
    answered(listener, speaker, 10.0)
    assert "its lease is 0.25 s" in only(listener, 10.3).word.unfit
    speaker = Peers(("arm1", "arm", "a2"), DIGEST, math.nan, ())
    answered(listener, speaker, 20.0)
    assert only(listener, 20.0).word.unfit


@pytest.mark.parametrize("again", [0, 1])
def test_a_word_that_comes_again_or_late_does_not_count_anew(again):
    listener, speaker = cart(), arm()
    first = answered(listener, speaker, 10.0)
    second = answered(listener, speaker, 10.5, grants(active=False))
    listener.hear((first, second)[again], 11.0)
    found = only(listener, 11.0)
    assert found.receipt is not None
    assert found.receipt.message is second
    assert found.receipt.age_at(11.0) == 0.5


@pytest.mark.parametrize(
    ("speaker", "words", "why"),
    [
        (arm(digest="ee" * 32), None, "another arm: its digest is eeeeeeeeeeee, abab"),
        (arm(), grants(name="OTHER"), "arm1 has the guarantee PARKED not in its word"),
        (arm(), grants() + grants(), "arm1 has the guarantee PARKED twice in its word"),
    ],
)
def test_a_word_that_is_not_the_expected_one_is_not_trusted(speaker, words, why):
    listener = cart()
    answered(listener, speaker, 10.0, words)
    assert why in only(listener, 10.0).word.unfit


def test_two_nodes_of_one_name_are_not_trusted():
    listener, one, other = cart(), arm(), arm(session="b")
    answered(listener, one, 10.0)
    answered(listener, other, 10.5)
    assert only(listener, 10.6).word.unfit == "two nodes call themselves arm1"
    assert only(listener, 11.2).word[:2] == ("arm1", "")  # the first was restarted


def test_who_grants_it_counts_before_who_does_not_and_the_first_named_before_others():
    listener = cart()
    nodes = {name: arm(name) for name in ("arm3", "arm1", "arm2")}
    for name, node in nodes.items():
        answered(listener, node, 10.0, grants(active=name != "arm1"))
    assert only(listener, 10.0).word.robot == "arm2"
    named = cart(PARKED._replace(robots=("arm3", "arm1")), session="d")
    for name, node in nodes.items():
        answered(named, node, 20.0, grants(active=name == "arm1"))
    assert only(named, 20.0).word.robot == "arm1"
    for node in nodes.values():
        answered(named, node, 30.0, grants(active=False))
    found = only(named, 30.0)
    assert (found.word.robot, found.word.unfit) == ("arm3", "")  # known to be inactive


def test_a_circle_of_three_is_broken_and_a_chain_is_not():
    before = {"a": "c", "b": "a", "c": "b"}
    ring = {
        name: Peers((name, "arm", "s"), DIGEST, LEASE, (PARKED._replace(robots=(other,)),))
        for name, other in before.items()
    }
    active: list[set[str]] = []
    for step in range(60):
        now, words = step * 0.1, {}
        for name, node in ring.items():
            found = only(node, now)
            granted = not found.word.unfit and found.receipt.message.guarantees[0].active
            own = name == "a" and step < 30  # only the first has evidence of its own
            words[name] = [("PARKED", own or granted, (found.word.robot,) if granted else ())]
        told = {name: message(ring[name].word(rows, now)) for name, rows in words.items()}
        active.append({name for name, ((_, on, _),) in words.items() if on})
        for node in ring.values():
            for word in told.values():
                node.hear(word, now)
    assert active[25] == {"a", "b", "c"}
    assert active[55] == set()


def test_no_robot_counts_for_itself():
    listener = cart(PARKED._replace(model="cart"))
    other = Peers(("cart", "cart", "z"), DIGEST, LEASE, ())
    answered(listener, other, 10.0)
    assert "no word" in only(listener, 10.0).word.unfit
    listener.hear(message(listener.word(grants(), 10.0)), 10.0)
    assert "no word" in only(listener, 10.0).word.unfit


def test_what_is_remembered_is_bounded(monkeypatch):
    monkeypatch.setattr(peers, "_MOST", 5)
    listener = cart()
    for number in range(20):
        listener.hear(message(arm(session=str(number)).word([], 0.0)), float(number))
    _, word = listener.word([], 20.0)
    assert len(listener._speakers) == 5
    assert word["heard"] == []  # an arm does not listen
    listener.hear(message(cart(session="d").word([], 0.0)), 100.0)
    assert len(listener._speakers) == 1


def test_a_forged_number_does_not_silence_a_robot_for_ever():
    """A word in its name, with a number above all of its own."""
    listener, speaker, others = cart(), arm(), [arm("arm2"), arm("arm3")]
    for one in (*others, speaker):
        answered(listener, one, 0.0)
    forged = message(speaker.word([], 0.0))
    forged.sequence = 2**64 - 1
    listener.hear(forged, 0.0)
    for second in range(1, 63):
        for other in others:
            answered(listener, other, float(second), grants(active=False))
            answered(listener, speaker, float(second))
    assert only(listener, 62.0).word[:2] == ("arm1", "")


def test_a_word_that_rests_on_very_many_is_not_passed_on(monkeypatch):
    monkeypatch.setattr(peers, "_MOST", 3)
    for many, passed in ((3, True), (4, False)):
        listener, speaker = cart(), arm()
        speaker.hear(message(listener.word([], 10.0)), 10.0)
        word = message(speaker.word(grants(), 10.0))
        word.guarantees[0].rests_on = [f"r{k}/m" for k in range(many)]
        listener.hear(word, 10.0)
        assert (only(listener, 10.0).word.unfit == "") is passed
        _, told = listener.word([("Enter", True, ("arm1",))], 10.0)
        assert len(told["guarantees"][0][1]["rests_on"]) == (many + 1) * passed


def test_a_fleet_names_its_node():
    fleet = Fleet("cart", "/eddi/peers", None, LEASE, (PARKED,))
    assert fleet.joined("", "m", "d").name[:2] == ("cart", "m")
    assert fleet.joined("cart7", "m", "d").name[0] == "cart7"
    assert fleet.joined("", "m", "d").name != fleet.joined("", "m", "d").name


class ByReceipt(Peers):
    """What one would write first: a word is as old as its receipt."""

    def _echoed(self, message: Any) -> float:
        return self.now

    def hear(self, message: Any, now: float) -> None:
        self.now = now
        super().hear(message, now)


def lives(seed: int, made: type[Peers]) -> tuple[int, int]:
    """Run a fleet on a bad network; return how often a word counted, and counted when too old."""
    chance = Random(seed)
    names = [f"r{k}" for k in range(chance.randint(2, 4))]
    offset = {name: chance.uniform(0.0, 1e5) for name in names}  # no clock is like another
    source = Source("Peer", (), "arm", DIGEST, "PARKED")
    sessions = iter(range(10**6))

    def start(name: str) -> Peers:
        return made((name, "arm", str(next(sessions))), DIGEST, LEASE, (source,))

    nodes = {name: start(name) for name in names}
    queue: list[tuple[float, int, str, Any]] = []
    number, counted, wrong, cut = 0, 0, 0, set()
    born: dict[int, tuple[float, Any]] = {}  # holds the words, so that no id comes again
    for step in range(300):
        now = step * 0.1
        if chance.random() < 0.05:  # a partition begins or ends
            cut = {name for name in names if chance.random() < 0.4}
        if chance.random() < 0.03:
            name = chance.choice(names)
            nodes[name] = start(name)
        while queue and queue[0][0] <= now:
            _, _, to, word = heapq.heappop(queue)
            nodes[to].hear(word, now + offset[to])
        for name in names:
            if chance.random() < 0.1:
                continue  # a step is late
            node = nodes[name]
            found = only(node, now + offset[name])
            if not found.word.unfit:
                counted += 1
                wrong += now - born[id(found.receipt.message)][0] > LEASE + 1e-9
            word = message(node.word(grants(chance.random() < 0.5), now + offset[name]))
            born[id(word)] = now, word
            for to in names:
                for _ in range(chance.choice((0, 1, 1, 1, 2))):  # lost, and twice
                    slow = chance.uniform(0.5, 6.0) if chance.random() < 0.2 else 0.0
                    slow += 30.0 * ((to in cut) != (name in cut)) * chance.random()
                    number += 1
                    heapq.heappush(queue, (now + slow, number, to, word))
    return counted, wrong


def test_no_word_counts_beyond_its_lease_on_any_network():
    found = [lives(seed, Peers) for seed in range(12)]
    assert sum(counted for counted, _ in found) > 3000
    assert [wrong for _, wrong in found] == [0] * len(found)


def test_the_network_is_bad_enough():
    assert sum(lives(seed, ByReceipt)[1] for seed in range(3)) > 10
