"""What is served is answered whole, in order, or not at all."""

import os

import pytest

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
