"""What is published or served arrives as it was sent, whole and in order, or not at all."""

import os
from threading import Event

import pytest

from surefoot.bus.errors import BusError
from surefoot.bus.session import Session


@pytest.fixture
def sessions():
    namespace = f"session-{os.getpid()}"
    hub = Session(namespace, hub=True)
    client = Session(namespace, connect_ms=5000)
    yield hub, client
    client.close()
    hub.close()


def test_all_that_is_served_is_answered_in_order(sessions):
    hub, client = sessions
    many = [str(number).encode() for number in range(120)]
    hub.serve("many", lambda: many)
    hub.serve("none", list)
    assert client.ask("many") == many
    assert hub.ask("many") == many
    assert client.ask("none") == client.ask("nobody") == []


def test_half_an_answer_is_none(sessions):
    hub, client = sessions
    prefix = f"session-{os.getpid()}/half"

    def answer(query):
        with query:
            for index in (0, 2):  # the link has dropped between the two
                query.reply(f"{prefix}/{index}-3", b"part")

    hub._kept.append(hub._session.declare_queryable(f"{prefix}/*", answer))
    assert client.ask("half") == []


def test_what_is_not_as_it_was_sent_is_dropped_and_counted(sessions):
    hub, client = sessions
    heard, last = [], Event()

    def hear(key, payload):
        heard.append(payload)
        if payload == b"last":
            last.set()

    client.subscribe("some", hear)
    newest = client.newest("other")
    hub.serve("served", lambda: [b"answer"])
    hub.serve_each("numbered", lambda number: b"answer")
    assert client.ask("served") == [b"answer"] and client.ask_each("numbered", 7) == b"answer"
    seal = hub._seal
    hub._seal = lambda key, payload: seal(key, payload[:-1])  # the link has added a byte
    hub.put("some", b"damaged")
    hub.put("other", b"damaged")
    assert client.ask("served") == []
    with pytest.raises(BusError, match="damaged"):
        client.ask_each("numbered", 7)
    hub._seal = lambda key, payload: seal(f"{key}s", payload)  # it was said under another key
    hub.put("some", b"astray")
    hub._seal = seal
    hub.put("some", b"last")
    assert last.wait(30.0)
    assert heard == [b"last"] and heard[0].writer == hub.mark
    assert newest() is None
    assert client.damaged == 5
