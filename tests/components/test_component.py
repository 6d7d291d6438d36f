"""What is too old, or dated too far ahead, is nothing to act on."""

from dataclasses import replace

import numpy as np
import pytest

from surefoot.bus.messages import OperatorCommand, StateEstimate
from surefoot.bus.topics import TOPICS
from surefoot.components.component import Inbox, Outbox

KEY = "state/estimate"
LIMIT_S = TOPICS[KEY].stale_after_s


@pytest.mark.parametrize(
    ("date", "fresh"),
    [
        (100.0, True),
        (100.0 - 0.9 * LIMIT_S, True),
        (100.0 + 0.9 * LIMIT_S, True),
        (100.0 - 1.1 * LIMIT_S, False),
        (100.0 + 1.1 * LIMIT_S, False),
        (-1e300, False),
        (1e300, False),
    ],
)
def test_a_message_is_fresh_within_its_limit_before_and_after_its_date(date, fresh):
    inbox = Inbox((KEY,))
    inbox.deliver(KEY, StateEstimate(t=date, valid=True))
    assert (inbox.fresh(KEY, 100.0) is not None) == fresh


def test_age_means_nothing_where_the_topic_has_no_limit():
    inbox = Inbox(("operator/command",))
    inbox.deliver("operator/command", OperatorCommand(t=5.0, valid=True))
    assert inbox.fresh("operator/command", 1e6) is not None and inbox.fresh("operator/command", 0.0) is not None


def test_a_published_message_is_the_same_under_its_number():
    sent = []
    outbox = Outbox((KEY,), lambda key, message: sent.append(message), boot=3)
    message = StateEstimate(t=2.0, valid=True, p_WB=np.array([1.0, 2.0, 3.0]))
    outbox.publish(KEY, message)
    outbox.publish(KEY, message)
    for seq, each in enumerate(sent):
        assert vars(each) == vars(replace(message, seq=seq, boot=3)) and type(each) is StateEstimate
    assert message.seq == message.boot == 0
